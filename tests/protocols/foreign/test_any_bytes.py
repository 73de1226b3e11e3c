"""Any bytes under any name are read, or refused in one sentence that says what was found."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.foreign_bytes import read_or_refused, small_files
from support.mutate import mutated, mutated_text

from armodal.protocols.foreign.inspection import inspect_file

ENDINGS = (
    ".txt",
    ".csv",
    ".lvm",
    ".tdms",
    ".wav",
    ".mat",
    ".npy",
    ".npz",
    ".uff",
    ".h5",
    ".zip",
    "",
)
QUICK = settings(
    max_examples=examples(40),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
pytestmark = pytest.mark.filterwarnings("ignore")  # of libraries, about the bytes they are given


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return small_files(tmp_path_factory.mktemp("files"))


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("place")


def one_sentence(said):
    assert said is None or ("\n" not in said and len(said) < 3000)


def test_every_small_file_is_read_as_it_is(files, place):
    for name, data in files.items():
        (place / name).write_bytes(data)
        looked = inspect_file(place / name)
        assert looked.content is not None, name
        if name != "geometry.unv":
            assert looked.content.frfs or looked.content.hits, name


def test_prefixes_are_read_or_refused(files, place):
    for name, data in files.items():
        for end in np.unique(np.linspace(0, len(data) - 1, 25).astype(int)):
            one_sentence(read_or_refused(place / name, data[:end]))


@given(st.data())
@QUICK
def test_changed_bytes_are_read_or_refused(files, place, data):
    name = data.draw(st.sampled_from(sorted(files)))
    raw = bytearray(files[name])
    raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    one_sentence(read_or_refused(place / name, bytes(raw)))


@given(st.data())
@QUICK
def test_any_content_under_any_ending_is_read_or_refused(files, place, data):
    name = data.draw(st.sampled_from(sorted(files)))
    ending = data.draw(st.sampled_from(ENDINGS))
    one_sentence(read_or_refused(place / f"other{ending}", files[name]))


@given(st.binary(max_size=400), st.sampled_from(ENDINGS))
@QUICK
def test_any_bytes_are_read_or_refused(place, data, ending):
    one_sentence(read_or_refused(place / f"any{ending}", data))


NUMBERS = st.floats(width=32) | st.integers(-5, 5)
CELLS = st.one_of(
    NUMBERS.map(str),
    NUMBERS.map(lambda x: f"{x}".replace(".", ",")),
    st.complex_numbers(allow_nan=False, max_magnitude=1e6).map(lambda z: f"{z:g}"),
    st.sampled_from(
        ["", "Hz", "Real", "Imag", "time [s]", "force [N]", "coherence", "nan", "-", "1e999"]
    ),
)


@given(
    st.lists(st.lists(CELLS, min_size=1, max_size=6), max_size=12),
    st.sampled_from(["\t", ",", ";", " ", "  "]),
    st.sampled_from(["utf-8", "utf-16", "latin-1", "utf-8-sig"]),
    st.integers(1, 30),
)
@settings(QUICK, max_examples=examples(80))
def test_any_table_is_read_or_refused(place, rows, delimiter, encoding, repeats):
    text = "\n".join(delimiter.join(row) for row in rows * repeats)
    one_sentence(read_or_refused(place / "table.txt", text.encode(encoding, "replace")))


@given(
    st.integers(1, 7),
    st.integers(1, 90),
    st.floats(1e-6, 1e3),
    st.integers(0, 2**32 - 1),
    st.sampled_from(["\t", ",", ";", " "]),
)
@settings(QUICK, max_examples=examples(80))
def test_any_table_of_numbers_with_an_even_column_is_read_or_refused(
    place, columns, rows, step, seed, delimiter
):
    rng = np.random.default_rng(seed)
    numbers = rng.standard_normal((rows, columns)) * 10.0 ** rng.integers(-6, 6, columns)
    numbers[:, 0] = step * np.arange(rows)
    text = "\n".join(delimiter.join(f"{x:.8g}" for x in row) for row in numbers)
    one_sentence(read_or_refused(place / "even.txt", text.encode()))


@pytest.mark.long
def test_many_changes_of_every_format_are_read_or_refused(files, place):
    rng = np.random.default_rng(11)
    for name, data in files.items():
        change = (
            mutated_text if name.endswith((".txt", ".csv", ".lvm", ".uff", ".unv")) else mutated
        )
        for _ in range(300):
            one_sentence(read_or_refused(place / name, change(data, rng)))
