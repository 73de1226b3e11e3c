import contextlib

import numpy as np
import pytest
import pyuff
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.foreign_samples import frf_set, si_set, whole_file, write_sets

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.foreign.uff_measured import uff_content
from armodal.protocols.foreign.uff_read import read_uff, uff_from_bytes
from armodal.protocols.foreign.uff_write import write_uff

# Text has 12 significant digits (E20.11), single precision and positions 6 (E13.5); numbers here
# stay below 10. An uneven abscissa in text has 6 digits below 100, an even one 10.
TEXT, SHORT, ABSCISSA = 1e-11, 5e-5, 5e-4


@pytest.fixture(params=[False, True], ids=["text", "binary"])
def binary(request):
    return request.param


def test_what_is_written_is_read_back(tmp_path, binary):
    file = whole_file(np.random.default_rng(1))
    write_uff(file, tmp_path / "a.uff", binary=binary)
    back = read_uff(tmp_path / "a.uff")
    assert back.header == file.header
    assert back.units == file.units
    assert np.array_equal(back.nodes.number, file.nodes.number)
    assert np.allclose(back.nodes.position, file.nodes.position, atol=SHORT)
    assert back.trace_lines[0].name == "line"
    assert np.array_equal(back.trace_lines[0].nodes, file.trace_lines[0].nodes)
    for one, other in zip(file.functions, back.functions, strict=True):
        assert np.allclose(one.values, other.values, rtol=0, atol=0 if binary else TEXT * 10)
        assert np.allclose(one.abscissa, other.abscissa, rtol=0, atol=ABSCISSA)
        for name in ("kind", "response_node", "response_direction", "identification", "even"):
            assert getattr(one, name) == getattr(other, name)
        assert (other.numerator_unit, other.denominator_unit) == ("m/s^2", "N")
    real, complex_ = back.shapes
    assert real.shape.dtype == np.float64
    assert real.pole_rad_s is None
    assert np.allclose(real.shape, file.shapes[0].shape, atol=SHORT)
    assert np.allclose(complex_.shape, file.shapes[1].shape, atol=SHORT)
    assert complex_.pole_rad_s == -1 + 20j
    assert complex_.modal_a == 0.5 - 2j


def test_what_is_written_pyuff_reads_as_the_same_numbers(tmp_path, binary):
    file = whole_file(np.random.default_rng(2))
    path = tmp_path / "a.uff"
    write_uff(file, path, binary=binary)
    sets = pyuff.UFF(str(path)).read_sets()
    assert [s["type"] for s in sets] == [151, 164, 15, 82, 58, 58, 58, 58, 55, 55]
    functions = [s for s in sets if s["type"] == 58]
    for one, other in zip(file.functions, functions, strict=True):
        assert np.allclose(one.values, other["data"], rtol=0, atol=0 if binary else TEXT * 10)
        assert np.allclose(one.abscissa, other["x"], rtol=0, atol=ABSCISSA)
        assert other["rsp_dir"] == -2


def test_an_even_abscissa_keeps_ten_digits(tmp_path, binary):
    file = whole_file(np.random.default_rng(3), n=1000)
    write_uff(file, tmp_path / "a.uff", binary=binary)
    found = pyuff.UFF(str(tmp_path / "a.uff")).read_sets()
    x = next(s["x"] for s in found if s["type"] == 58 and s["abscissa_spacing"] == 1)
    # 0.8064516129, rounded at the tenth digit, times 999 lines
    assert np.max(np.abs(x - np.arange(1000) * (51200 / 31 / 2048))) < 1000 * 5e-11


def test_binary_data_announce_their_true_length(tmp_path):
    file = whole_file(np.random.default_rng(4))
    write_uff(file, tmp_path / "a.uff", binary=True)
    for content in pyuff.UFF(str(tmp_path / "a.uff")).read_sets():
        if content["type"] == 58:
            numbers = len(content["data"]) * (2 if np.iscomplexobj(content["data"]) else 1)
            numbers += 0 if content["abscissa_spacing"] else len(content["data"])
            assert content["n_bytes"] == 8 * numbers


@pytest.mark.parametrize("double", [False, True])
@pytest.mark.parametrize("even", [0, 1])
@pytest.mark.parametrize("is_complex", [False, True])
def test_files_pyuff_wrote_are_read(tmp_path, double, even, is_complex):
    rng = np.random.default_rng(5)
    x = 0.5 * np.arange(20) if even else np.sort(rng.uniform(0, 9, 20))
    data = rng.standard_normal(20) + (1j * rng.standard_normal(20) if is_complex else 0.0)
    content = frf_set(7, data, x, abscissa_spacing=even)
    content["ord_data_type"] = (6 if double else 5) if is_complex else (4 if double else 2)
    path = tmp_path / "a.uff"
    pyuff.UFF(str(path)).write_sets([content], mode="add", force_double=double)
    found = read_uff(path).functions[0]
    assert np.allclose(found.values, data, rtol=0, atol=TEXT * 10 if double else SHORT)
    assert np.allclose(found.abscissa, x, rtol=0, atol=SHORT)


def _binary_58(order, kind, numbers, *, points, even, gap=b"", abscissa=None):
    """A 58b dataset as analysers write it, in either byte order and precision."""
    flag = 1 if order == "<" else 2
    size = 8 if kind in {4, 6} else 4
    rows = numbers.astype(f"{order}f{size}").reshape(points, -1)
    if abscissa is None:
        data = rows.tobytes()
    else:
        own = abscissa.astype(f"{order}f4")
        data = b"".join(own[i].tobytes() + rows[i].tobytes() for i in range(points))
    header = [
        "    -1",
        f"    58b{flag:6d}{2:6d}{11:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}",
        *["NONE"] * 5,
        f"{4:5d}{1:10d}{0:5d}{0:10d} {'NONE':10s}{5:10d}{3:4d} {'NONE':10s}{6:10d}{-3:4d}",
        f"{kind:10d}{points:10d}{even:10d}{0.0:13.5e}{0.5:13.5e}{0.0:13.5e}",
        f"{18:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'Hz':20s}",
        f"{12:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'m/s^2':20s}",
        f"{13:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'N':20s}",
        f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}",
    ]
    return "\r\n".join(header).encode() + b"\r\n" + data + gap + b"    -1\r\n"


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", [2, 4, 5, 6])
@pytest.mark.parametrize("gap", [b"", b"\r\n"])
def test_binary_data_in_either_byte_order_and_precision(order, kind, gap):
    rng = np.random.default_rng(6)
    per = 2 if kind >= 5 else 1
    numbers = rng.standard_normal(10 * per).astype(np.float32).astype(float)
    found = uff_from_bytes(
        _binary_58(order, kind, numbers, points=10, even=1, gap=gap), "a"
    ).functions[0]
    wanted = numbers if per == 1 else numbers[::2] + 1j * numbers[1::2]
    assert np.array_equal(found.values, wanted)
    assert (found.response_node, found.reference_node) == (5, 6)
    assert (found.response_direction, found.reference_direction) == (3, -3)


def test_an_uneven_binary_abscissa_may_be_single_beside_double():
    rng = np.random.default_rng(7)
    x = np.sort(rng.uniform(1, 9, 10)).astype(np.float32)
    numbers = rng.standard_normal(20)
    data = _binary_58("<", 6, numbers, points=10, even=0, abscissa=x)
    found = uff_from_bytes(data, "a").functions[0]
    assert np.array_equal(found.abscissa, x.astype(float))
    assert np.array_equal(found.values, numbers[::2] + 1j * numbers[1::2])


def test_a_closing_line_inside_binary_data_does_not_end_them():
    # The eight bytes "\n    -1\n" are a float64 like any other.
    numbers = np.frombuffer(b"\n    -1\n" * 4, dtype="<f8")
    data = _binary_58("<", 6, numbers, points=2, even=1)
    found = uff_from_bytes(data + data, "a")
    assert len(found.functions) == 2
    assert np.array_equal(found.functions[1].values.view(float), numbers)


def test_strange_characters_in_identification_lines_shift_nothing(tmp_path):
    path = write_sets(tmp_path / "a.uff", [frf_set(2, np.arange(5) + 1j, np.arange(5.0))])
    text = path.read_bytes().replace(b"NONE" + b" " * 76, "Prüfling\x0c\x85 größe".encode(), 1)
    found = uff_from_bytes(text, "a").functions[0]
    assert found.response_node == 2
    assert np.allclose(found.values, np.arange(5) + 1j)


def test_fortran_exponents_are_numbers(tmp_path):
    path = write_sets(tmp_path / "a.uff", [frf_set(2, 1e3 * (np.arange(5) + 1j), np.arange(5.0))])
    head, _, tail = path.read_bytes().partition(b"NONE                 NONE                \n")
    found = uff_from_bytes(head + _ + tail.replace(b"e+", b"D+").replace(b"e-", b"D-"), "a")
    assert np.allclose(found.functions[0].values, 1e3 * (np.arange(5) + 1j))


@pytest.mark.parametrize("each", [7, pytest.param(1, marks=pytest.mark.long)])
def test_every_truncation_is_one_error_or_whole_datasets(tmp_path, binary, each):
    file = whole_file(np.random.default_rng(8), n=9)
    path = tmp_path / "a.uff"
    write_uff(file, path, binary=binary)
    data = path.read_bytes()
    n_whole = len(uff_from_bytes(data, "a").functions)
    for end in range(0, len(data), each):
        try:
            found = uff_from_bytes(data[:end], "a")
        except ForeignFileError as error:
            assert "\n" not in str(error)  # noqa: PT017 - most ends raise, some do not
            continue
        # Cut between two datasets, the rest is a universal file of its own.
        assert data[:end].rstrip().endswith(b"    -1")
        assert len(found.functions) <= n_whole


@given(st.binary(max_size=300))
@settings(max_examples=examples(200))
def test_any_bytes_are_read_or_refused_in_one_sentence(data):
    try:
        uff_from_bytes(data, "a")
    except ForeignFileError as error:
        assert str(error).count("\n") == 0  # noqa: PT017 - most bytes raise, some do not


@given(st.data())
@settings(max_examples=examples(150))
def test_changed_bytes_are_read_or_refused(data):
    raw = bytearray(_WHOLE)
    for _ in range(data.draw(st.integers(1, 4))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(ForeignFileError):
        uff_from_bytes(bytes(raw), "a")


def _whole_bytes():
    numbers = np.random.default_rng(9).standard_normal(20)
    return (
        _binary_58("<", 6, numbers, points=10, even=1)
        + b"""    -1
    15
         1         0         0        11  1.00000E+00  2.00000E+00  3.00000E+00
    -1
    -1
    82
         1         2         0
NONE
         1         1
    -1
"""
    )


_WHOLE = _whole_bytes()


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (b"", "empty"),
        (b"hello", "no universal file"),
        (b"    -1\n    58\n    -1\n", "11 records"),
        (b"    -1\n    58b     1     2\n", "truncated"),
        (b"    -1\n   164\nabc\n    -1\n", "type 164"),
        (b"    -1\n    15\n 1 2 3\n    -1\n", "seven numbers"),
    ],
)
def test_what_is_no_dataset_is_told(text, wanted):
    with pytest.raises(ForeignFileError, match=wanted):
        uff_from_bytes(text, "a")


def test_an_announced_giant_is_refused_before_memory_is_taken():
    data = _binary_58("<", 6, np.zeros(20), points=10, even=1).replace(
        b"        10         1", b" 999999999         1"
    )
    with pytest.raises(ForeignFileError, match="number of points"):
        uff_from_bytes(data, "a")


def test_nan_is_refused_where_pyuff_would_write_zero(tmp_path):
    file = whole_file(np.random.default_rng(10))
    bad = file.functions[1].values.copy()
    bad[3] = np.nan
    object.__setattr__(file.functions[1], "values", bad)
    with pytest.raises(ForeignFileError, match="NaN"):
        write_uff(file, tmp_path / "a.uff")
    assert list(tmp_path.iterdir()) == []


def test_datasets_of_other_types_are_told_by_name(tmp_path):
    path = write_sets(tmp_path / "a.uff", [si_set()])
    path.write_bytes(path.read_bytes() + b"    -1\n  2414\n 1\n    -1\n")
    assert read_uff(path).skipped == (2414,)
    (said,) = uff_content(read_uff(path), Hints(), "a.uff").said
    assert "2414 (analysis data)" in said
