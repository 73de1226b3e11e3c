"""The force in one file, its responses in another."""

import io
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.foreign_bytes import small_files
from support.foreign_samples import write_sets
from support.foreign_writers import lvm, table, wav
from support.manifests import RATE, hit_signals, manifest, posture, run

from armodal.protocols.errors import ArmodalError, ForeignFileError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.file_pairs import with_forces
from armodal.protocols.foreign.guess import guess_manifest
from armodal.protocols.foreign.inspection import inspect_file
from armodal.protocols.foreign.measured import Hints, NotToldError

T, FORCE, (RESPONSE,) = hit_signals()


def as_mat(variables):
    stream = io.BytesIO()
    scipy.io.savemat(stream, variables)
    return stream.getvalue()


def as_npy(rows):
    stream = io.BytesIO()
    np.save(stream, rows)
    return stream.getvalue()


def as_uff(folder, values, *, number, label):
    told = {"type": 58, "binary": 0, "func_type": 1, "abscissa_spec_data_type": 17}
    content = {
        **told,
        "rsp_node": 3,
        "rsp_dir": 3,
        "ref_node": 0,
        "ref_dir": 0,
        "x": T,
        "data": values,
        "ordinate_spec_data_type": number,
        "ordinate_axis_units_lab": label,
        "orddenom_spec_data_type": 0,
        "id1": "hit",
        "rsp_ent_name": "NONE",
        "ref_ent_name": "NONE",
    }
    return write_sets(folder / "one.uff", [content]).read_bytes()


def as_file(folder, kind, name, values):
    """One signal as a file of a format, by a name of its own where the format has names."""
    is_force = name == "force"
    unit = "N" if is_force else "m/s^2"
    head = f"time [s];{name} [{unit}]\n"
    write = {
        "txt": lambda: table([T, values]).encode(),
        "csv": lambda: bytes(head + table([T, values], ";"), "utf-8"),
        "lvm": lambda: lvm(1 / RATE, [{name: values}], units=(unit,)),
        "wav": lambda: wav(RATE, [values / 100.0], kind="float32"),
        "mat": lambda: as_mat({"time": T, name: values}),
        "npy": lambda: as_npy(np.vstack([T, values])),
        "uff": lambda: as_uff(folder, values, number=13 if is_force else 12, label=unit),
    }
    return write[kind]()


KINDS = ("txt", "csv", "lvm", "wav", "mat", "npy", "uff")


def two(folder, kind, other, *, force=FORCE, response=RESPONSE):
    (folder / f"a_force.{kind}").write_bytes(as_file(folder, kind, "force", force))
    (folder / f"a_acc.{other}").write_bytes(as_file(folder, other, "acc", response))
    return folder / f"a_acc.{other}", folder / f"a_force.{kind}"


def scaled(kind, other):
    return Hints(
        force_scale=100.0 if kind == "wav" else 1.0,
        response_scale=100.0 if other == "wav" else 1.0,
    )


def pairs():
    """Each format with each; in the quick tests each with itself and with the next one."""
    for number, (other, kind) in enumerate(product(KINDS, KINDS)):
        beside = number % (len(KINDS) + 1) < 2
        yield pytest.param(other, kind, marks=() if beside else pytest.mark.long)


@pytest.mark.parametrize(("other", "kind"), [*pairs()])
def test_force_and_response_of_any_two_formats_are_one_hit(tmp_path, kind, other):
    response, force = two(tmp_path, kind, other)
    told = scaled(kind, other)
    hints = Hints(
        force_file=force, force_scale=told.force_scale, response_scale=told.response_scale
    )
    (hit,) = read_content(response, hints).hits
    assert hit.rate_hz == RATE
    # 24 bits of a float of up to 51 N, and E13.5 of a universal file in text.
    assert np.allclose(hit.force_n, FORCE, rtol=1e-5, atol=1e-5)
    assert np.allclose(hit.acceleration_m_s2, [RESPONSE], rtol=1e-5, atol=1e-5)


def test_the_manifest_names_the_file_of_the_force(tmp_path):
    two(tmp_path, "csv", "csv")
    files = (
        '[{ path = "a_acc.csv", force = "a_force.csv", responses = ["5:z"], reference = "1:-z" }]'
    )
    (hit,) = run(manifest(tmp_path, posture(files))).hits
    assert (hit.sensor_point, hit.hit_point) == ("5", "1")
    assert hit.hit_direction.tolist() == [0.0, 0.0, -1.0]


def test_another_force_is_another_session(tmp_path):
    two(tmp_path, "csv", "csv")
    files = '[{ path = "a_acc.csv", force = "a_force.csv" }]'
    first = run(manifest(tmp_path, posture(files))).header.session_id
    two(tmp_path, "csv", "csv", force=2.0 * FORCE)
    assert run(manifest(tmp_path, posture(files))).header.session_id != first


def test_unequal_lengths_are_cut_to_the_shorter_and_said(tmp_path):
    (tmp_path / "f.txt").write_text(table([T[:1500], FORCE[:1500]]))
    (tmp_path / "a.txt").write_text(table([T, RESPONSE]))
    content = read_content(tmp_path / "a.txt", Hints(force_file=tmp_path / "f.txt"))
    (hit,) = content.hits
    assert len(hit.force_n) == hit.acceleration_m_s2.shape[1] == 1500
    assert any("1500 and 2048 samples long: the first 1500 are used" in w for w in content.said)


def test_other_rates_and_other_times_are_refused_in_one_sentence(tmp_path):
    (tmp_path / "a.txt").write_text(table([T, RESPONSE]))
    (tmp_path / "rate.txt").write_text(table([2.0 * T, FORCE]))
    (tmp_path / "later.txt").write_text(table([T + 0.5, FORCE]))
    for name, words in (
        ("rate.txt", "the responses have 4096 Hz, the force 2048 Hz"),
        ("later.txt", "the force begins at 0.5 s, the responses at 0 s"),
    ):
        with pytest.raises(ForeignFileError, match=words) as caught:
            read_content(tmp_path / "a.txt", Hints(force_file=tmp_path / name))
        assert "\n" not in str(caught.value)


def test_a_rate_that_one_file_tells_holds_for_both_and_one_that_none_tells_is_asked(tmp_path):
    np.save(tmp_path / "f.npy", FORCE)
    np.save(tmp_path / "a.npy", RESPONSE)
    (tmp_path / "a.txt").write_text(table([T, RESPONSE]))
    told = Hints(force_file=tmp_path / "f.npy")
    assert read_content(tmp_path / "a.txt", told).hits[0].rate_hz == RATE
    with pytest.raises(NotToldError, match="`rate_hz`") as caught:
        read_content(tmp_path / "a.npy", told)
    assert caught.value.key == "rate_hz"
    told = Hints(force_file=tmp_path / "f.npy", rate_hz=RATE)
    assert read_content(tmp_path / "a.npy", told).hits[0].rate_hz == RATE


def test_a_file_of_two_forces_is_asked_for_the_one_and_the_manifest_names_it(tmp_path):
    (tmp_path / "f.csv").write_text("time [s],left,right\n" + table([T, FORCE, 2 * FORCE], ","))
    (tmp_path / "a.csv").write_text("time [s],acc\n" + table([T, RESPONSE], ","))
    with pytest.raises(NotToldError, match=r"got 2 signals \(left, right\)"):
        read_content(tmp_path / "a.csv", Hints(force_file=tmp_path / "f.csv"))
    hints = Hints(force_file=tmp_path / "f.csv", variables={"force": ("right",)})
    (hit,) = read_content(tmp_path / "a.csv", hints).hits
    assert np.allclose(hit.force_n, 2 * FORCE, atol=1e-6)


def test_matrices_of_hits_pair_row_by_row(tmp_path):
    scale = np.array([[1.0], [2.0], [3.0]])
    (tmp_path / "f.mat").write_bytes(as_mat({"hammer": scale * FORCE}))
    (tmp_path / "a.mat").write_bytes(as_mat({"acc": scale * RESPONSE}))
    hints = Hints(force_file=tmp_path / "f.mat", rate_hz=RATE)
    hits = read_content(tmp_path / "a.mat", hints).hits
    assert [round(float(hit.force_n.max())) for hit in hits] == [50, 100, 150]
    for hit, factor in zip(hits, (1.0, 2.0, 3.0), strict=True):
        assert np.array_equal(hit.acceleration_m_s2[0], factor * RESPONSE)


@pytest.mark.parametrize(
    ("names", "pairs"),
    [
        (["hit1_force.txt", "hit1_acc.txt"], [("hit1_acc.txt", "hit1_force.txt")]),
        (["Hammer.txt", "Resp.txt"], [("Resp.txt", "Hammer.txt")]),
        (
            ["force.txt", "acc1.txt", "acc2.txt"],
            [("acc1.txt", "force.txt"), ("acc2.txt", "force.txt")],
        ),
        (
            ["p1 force.txt", "p2 force.txt", "p1 acc.txt", "p2 acc.txt"],
            [("p1 acc.txt", "p1 force.txt"), ("p2 acc.txt", "p2 force.txt")],
        ),
        (["force1.txt", "acc2.txt"], [("force1.txt", None), ("acc2.txt", None)]),
        (["a.txt", "b.txt"], [("a.txt", None), ("b.txt", None)]),
    ],
)
def test_names_tell_which_force_belongs_to_which_response(tmp_path, names, pairs):
    for name in names:
        is_force = "orce" in name or "amm" in name
        (tmp_path / name).write_text(table([T, FORCE if is_force else RESPONSE]))
    found = with_forces([tmp_path / name for name in names])
    assert [(p.name, f.name if f else None) for p, f in found] == pairs


def test_a_file_that_holds_both_is_no_half_of_a_pair(tmp_path):
    for name in ("hammer 1.txt", "acc 1.txt"):
        (tmp_path / name).write_text("time [s]\tforce\tacc\n" + table([T, FORCE, RESPONSE]))
    files = [tmp_path / "hammer 1.txt", tmp_path / "acc 1.txt"]
    assert with_forces(files) == [(file, None) for file in files]


def test_a_pair_alone_is_imported_by_the_manifest_guessed_of_it(tmp_path):
    response, force = two(tmp_path, "txt", "txt")
    looked = [inspect_file(p, force=f) for p, f in with_forces([force, response])]
    found = guess_manifest(looked, tmp_path)
    assert not found.doubts
    assert any("its force is in a_force.txt" in text for text in found.guesses)
    (tmp_path / "m.toml").write_text(found.text)
    (hit,) = run(Path(tmp_path / "m.toml")).hits
    assert hit.verdict.peak_n == pytest.approx(FORCE.max(), rel=1e-6)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    data = small_files(folder)
    for name, raw in data.items():
        (folder / name).write_bytes(raw)
    return folder, data


@given(st.data())
@settings(
    max_examples=examples(60),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@pytest.mark.filterwarnings("ignore")  # of libraries, about the bytes they are given
def test_any_two_files_are_read_or_refused_in_one_sentence(files, data):
    folder, small = files
    name = data.draw(st.sampled_from(sorted(small)))
    other = data.draw(st.sampled_from(sorted(small)))
    raw = bytearray(small[other])
    if data.draw(st.booleans()):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    force = folder / f"changed {other}"
    force.write_bytes(raw)
    said = ""
    try:
        inspect_file(folder / name, force=force)
    except ArmodalError as error:
        said = str(error)
    assert "\n" not in said
    assert len(said) < 3000
