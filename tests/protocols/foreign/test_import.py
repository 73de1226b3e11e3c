"""From manifest and files to a session, and everything that can be wrong on the way."""

import json

import numpy as np
import pytest
import scipy.io
from support.foreign_samples import accelerance, chain_file, frf_set, si_set, write_sets
from support.manifests import RATE, hit_signals, manifest, posture, run

from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.errors import ArmodalError, ForeignFileError
from armodal.protocols.frf_records import FrfForm
from armodal.protocols.session.hdf5 import read_session, write_session

FREQ = 0.25 * np.arange(400)


def one(folder, sets, **keys):
    write_sets(folder / "a.uff", sets)
    return run(manifest(folder, posture('["a.uff"]', **keys)))


def chain_sets(**changes):
    return [frf_set(i + 1, accelerance(FREQ, i, 0), FREQ, **changes) for i in range(3)]


# FRFs -------------------------------------------------------------------------------------------


def test_frfs_become_the_matrix_of_a_posture(tmp_path):
    session = one(tmp_path, [si_set(), *chain_sets()], averages=5)
    frf = session.frfs[0]
    assert frf.form is FrfForm.ACCELERANCE
    assert frf.freq_hz[0] == 0.25  # 0 Hz is left out
    assert [dof.point for dof in frf.responses] == ["1", "2", "3"]
    assert np.allclose(frf.values[1, 0], accelerance(FREQ, 1, 0)[1:], atol=1e-10)
    assert frf.n_hits.tolist() == [[5], [5], [5]]
    assert np.isnan(frf.coherence).all()
    assert (frf.variance == 0).all()


def test_an_imported_session_survives_its_file(tmp_path):
    session = one(tmp_path, [si_set(), *chain_sets()])
    write_session(session, tmp_path / "s.h5")  # reads back and compares every field
    assert read_session(tmp_path / "s.h5").frfs[0].posture == "one"


def test_frfs_that_no_file_has_are_not_measured(tmp_path):
    """Three references, no driving points: what sensors in the hammer's way leave out."""
    sets = [
        frf_set(i + 1, accelerance(FREQ, i, j), FREQ, ref_node=j + 1)
        for i in range(3)
        for j in range(3)
        if i != j
    ]
    coherences = [
        frf_set(i + 1, np.full(400, 0.9), FREQ, func_type=6, ref_node=j + 1)
        for i, j in ((1, 0), (0, 1), (2, 0))
    ]
    session = one(tmp_path, [si_set(), *sets, *coherences], averages=5)
    write_session(session, tmp_path / "s.h5")
    for frf in (session.frfs[0], read_session(tmp_path / "s.h5").frfs[0]):
        points = [int(dof.point) - 1 for dof in frf.responses]
        hits = [int(dof.point) - 1 for dof in frf.references]
        hole = np.equal.outer(points, hits)
        assert np.array_equal(frf.measured, ~hole)
        assert not frf.values[hole].any()
        assert np.isposinf(frf.variance[hole]).all()
        assert (frf.variance[~hole] == 0).all()
        assert np.array_equal(frf.n_hits, np.where(hole, 0, 5))
    said = " ".join(session.warnings)
    assert "3 of 9 FRFs were not measured and are left out: " in said
    assert "1 z over 1" in said
    assert "3 FRFs have no coherence" in said  # of six, not of nine


def test_a_matrix_filled_with_zeros_or_nan_has_holes_there(tmp_path):
    values = np.array([[accelerance(FREQ[1:], i, j) for j in range(2)] for i in range(3)])
    values[0, 0], values[1, 1] = 0.0, np.nan
    np.savez(tmp_path / "a.npz", freq_hz=FREQ[1:], frf=values, form="accelerance", unit="SI")
    files = '[{ path = "a.npz", responses = ["1:z", "2:z", "3:z"], references = ["1:z", "2:z"] }]'
    session = run(manifest(tmp_path, posture(files)))
    frf = session.frfs[0]
    holes = {
        (frf.responses[i].point, frf.references[j].point) for i, j in np.argwhere(~frf.measured)
    }
    assert holes == {("1", "1"), ("2", "2")}
    assert sum("taken as not measured" in text for text in session.warnings) == 2


def test_missing_units_are_said(tmp_path):
    session = one(tmp_path, chain_sets())
    assert any("units are not told" in text for text in session.warnings)
    told = run(manifest(tmp_path, posture('["a.uff"]'), head='units = "SI"'))
    assert not any("units" in text for text in told.warnings)


def test_units_of_the_manifest_scale_the_numbers(tmp_path):
    write_sets(tmp_path / "a.uff", chain_sets())
    head = 'units = { response = "g", force = "N" }'
    frf = run(manifest(tmp_path, posture('["a.uff"]'), head=head)).frfs[0]
    # text keeps 12 digits
    assert np.allclose(frf.values[0, 0], 9.80665 * accelerance(FREQ, 0, 0)[1:], rtol=1e-9)


def test_coherence_is_matched_by_degrees_of_freedom(tmp_path):
    coherence = [frf_set(i + 1, np.full(400, 0.9 + 0.01 * i), FREQ, func_type=6) for i in (2, 0, 1)]
    frf = one(tmp_path, [si_set(), *chain_sets(), *coherence], averages=3).frfs[0]
    assert np.allclose(frf.coherence[:, 0, 0], [0.90, 0.91, 0.92])


def test_the_manifest_s_hit_goes_before_the_file_s_reference(tmp_path):
    direction = [0.6, 0.0, 0.8]
    frf = one(tmp_path, chain_sets(), hit_point="9", hit_direction=direction).frfs[0]
    assert frf.references[0].point == "9"
    assert np.allclose(frf.references[0].direction, direction)


def test_directions_of_a_link_are_turned_into_the_base(tmp_path):
    joints = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
    sets = [si_set(), *(frf_set(5, accelerance(FREQ, i, 0), FREQ, rsp_dir=i + 1) for i in range(3))]
    write_sets(tmp_path / "a.uff", sets)
    arm = load_arm("rv4frl")
    R = link_pose(arm, arm.point("5").link, np.radians(joints))[:3, :3]
    body = posture('["a.uff"]', joints_deg=joints, axes="link", hit_direction=[1.0, 0.0, 0.0])
    frf = run(manifest(tmp_path, body, arm='"rv4frl"')).frfs[0]
    assert np.allclose([dof.direction for dof in frf.responses], R.T)


def test_nodes_are_mapped_to_points_of_the_arm(tmp_path):
    joints = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
    sets = [
        si_set(),
        *(frf_set(105, accelerance(FREQ, i, 0), FREQ, rsp_dir=i + 1) for i in range(3)),
    ]
    write_sets(tmp_path / "a.uff", sets)
    body = posture('["a.uff"]', joints_deg=joints)
    head = 'nodes = { "105" = "5" }'
    frf = run(manifest(tmp_path, body, arm='"rv4frl"', head=head)).frfs[0]
    assert {dof.point for dof in frf.responses} == {"5"}
    with pytest.raises(ForeignFileError, match="node 105"):
        run(manifest(tmp_path, body, arm='"rv4frl"'))


def test_geometry_of_dataset_15_places_new_points_on_links(tmp_path):
    joints = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
    arm = load_arm("rv4frl")
    T = link_pose(arm, "forearm", np.radians(joints))
    local = np.array([0.05, -0.02, 0.1])
    x, y, z = T[:3, :3] @ local + T[:3, 3]
    nodes = {"type": 15, "node_nums": [201], "x": [x], "y": [y], "z": [z]}
    sets = [si_set(), nodes]
    sets += [frf_set(201, accelerance(FREQ, i, 0), FREQ, rsp_dir=i + 1) for i in range(3)]
    write_sets(tmp_path / "a.uff", sets)
    body = posture('["a.uff"]', joints_deg=joints)
    session = run(manifest(tmp_path, body, arm='"rv4frl"', head='links = { "201" = "forearm" }'))
    point = session.header.arm.point("201")
    assert point.link == "forearm"
    assert np.allclose(point.position_m, local, atol=1e-5)  # E13.5 keeps 6 digits
    write_session(session, tmp_path / "s.h5")


def test_a_urdf_alone_is_an_arm_of_rigid_joints(tmp_path):
    urdf = ARMS_DIRECTORY / "rv4frl.urdf"
    joints = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
    nodes = {"type": 15, "node_nums": [1], "x": [0.3], "y": [0.0], "z": [0.5]}
    sets = [si_set(), nodes]
    sets += [frf_set(1, accelerance(FREQ, i, 0), FREQ, rsp_dir=i + 1) for i in range(3)]
    write_sets(tmp_path / "a.uff", sets)
    body = posture('["a.uff"]', joints_deg=joints)
    session = run(
        manifest(tmp_path, body, arm=json.dumps(str(urdf)), head='links = { "1" = "forearm" }')
    )
    assert [joint.stiffness for joint in session.header.arm.joints] == [None] * 6
    write_session(session, tmp_path / "s.h5")


# Hits -------------------------------------------------------------------------------------------


def _save(folder, kind, t, force, responses):
    table = np.vstack([t, force, responses])
    path = folder / f"h.{kind}"
    if kind == "npy":
        np.save(path, table)
    elif kind == "npz":
        np.savez(path, time=t, force=force, acceleration=responses)
    elif kind == "mat":
        scipy.io.savemat(path, {"time": t, "force": force, "acceleration": responses})
    elif kind == "csv":
        names = ["time [s]", "force [N]", *(f"acc_{c} [m/s^2]" for c in "xyz"[: len(responses)])]
        np.savetxt(path, table.T, delimiter=",", header=",".join(names), comments="")
    else:
        common = {"func_type": 1, "abscissa_spec_data_type": 17, "orddenom_spec_data_type": 0}
        sets = [si_set(), frf_set(1, force, t, **common, ordinate_spec_data_type=13)]
        sets += [
            frf_set(2, row, t, **common, rsp_dir=i + 1, ordinate_spec_data_type=12)
            for i, row in enumerate(responses)
        ]
        write_sets(path, sets)
    return path


@pytest.mark.parametrize("kind", ["npy", "npz", "mat", "csv", "uff"])
@pytest.mark.parametrize("channels", [pytest.param(1, marks=pytest.mark.long), 3])
def test_a_hit_comes_back_from_every_format(tmp_path, kind, channels):
    t, force, responses = hit_signals(channels=channels)
    path = _save(tmp_path, kind, t, force, responses)
    session = run(manifest(tmp_path, posture(json.dumps([path.name]))))
    (hit,) = session.hits
    scale = np.array([channel.scale for channel in session.header.dictionary.channels])
    signals = hit.counts * scale
    assert session.header.plan.sampling.rate_hz == RATE
    # 2^-31 of the largest value by the counts; 12 digits of text in UFF
    assert np.allclose(signals[:, 0], force, atol=1e-7)
    assert np.allclose(signals[:, 1:], responses.T, atol=1e-7)
    assert abs(hit.trigger_sample - hit.first_sample - 201) <= 1  # 5 % of the peak
    write_session(session, tmp_path / "s.h5")


def test_hits_of_several_files_make_one_posture(tmp_path):
    for i in range(3):
        t, force, responses = hit_signals(seed=i)
        np.save(tmp_path / f"h{i}.npy", np.vstack([t, force, responses]))
    session = run(manifest(tmp_path, posture('["h0.npy", "h1.npy", "h2.npy"]')))
    assert [hit.number for hit in session.accepted("one")] == [1, 2, 3]


def test_pickles_are_never_loaded(tmp_path):
    np.save(tmp_path / "h.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(ForeignFileError, match="never unpickled"):
        run(manifest(tmp_path, posture('["h.npy"]')))
    np.savez(tmp_path / "h.npz", time=np.array([{"a": 1}], dtype=object))
    with pytest.raises(ForeignFileError, match="never unpickled"):
        run(manifest(tmp_path, posture('["h.npz"]')))


@pytest.mark.parametrize("kind", ["npy", "npz", "mat", "csv"])
def test_a_truncated_array_file_is_one_error(tmp_path, kind):
    t, force, responses = hit_signals(n=96)
    path = _save(tmp_path, kind, t, force, responses)
    data = path.read_bytes()
    # A table of text cut behind a line, or a last digit, is a shorter table.
    whole = {len(data) - 1} if kind == "csv" else set()
    for end in {*range(0, min(len(data), 700), 7), len(data) - 2, len(data) // 2} - whole:
        path.write_bytes(data[:end])
        try:
            session = run(manifest(tmp_path, posture(json.dumps([path.name]))))
        except ArmodalError as error:
            assert "\n" not in str(error)  # noqa: PT017 - most ends raise, some do not
        else:
            assert kind == "csv"
            assert session.hits


# Bad input --------------------------------------------------------------------------------------


def _write_nan(path):
    write_sets(path, [frf_set(1, accelerance(FREQ, 0, 0), FREQ)])
    lines = path.read_bytes().split(b"\n")
    lines[20] = b"%20s" % b"NaN" + lines[20][20:]
    path.write_bytes(b"\n".join(lines))


@pytest.mark.parametrize(
    ("sets", "wanted"),
    [
        ([frf_set(1, [1 + 1j, 2 + 1j], [0.0, 1.0])], "two lines or more"),
        ([frf_set(1, np.zeros(50, complex), FREQ[:50])], "constant 0"),
        ([frf_set(1, np.full(50, 2 + 1j), FREQ[:50])], "constant"),
        ([frf_set(1, 1e-32 * accelerance(FREQ, 0, 0), FREQ)], "up to"),
        (
            [frf_set(1, np.arange(9) + 1j, FREQ[[1, 2, 3, 5, 4, 6, 7, 8, 9]], abscissa_spacing=0)],
            "increase",
        ),
        ([frf_set(1, np.arange(9) + 1j, -FREQ[:9])], "increase"),
        (
            [
                frf_set(
                    1,
                    np.arange(9) + 1j,
                    FREQ[:9],
                    ordinate_spec_data_type=0,
                    orddenom_spec_data_type=0,
                )
            ],
            "form unknown",
        ),
        ([frf_set(1, np.arange(1.0, 10.0), FREQ[:9])], "complex"),
        ([*chain_sets(), frf_set(1, accelerance(FREQ, 0, 0), FREQ)], "twice"),
        ([*chain_sets(), frf_set(9, accelerance(2 * FREQ, 0, 0), 2 * FREQ)], "same lines"),
    ],
    ids=[
        "single line",
        "zero",
        "constant",
        "next to nothing",
        "not increasing",
        "negative",
        "form",
        "real",
        "twice",
        "lines",
    ],
)
def test_a_bad_frf_is_refused_in_one_sentence(tmp_path, sets, wanted):
    with pytest.raises(ForeignFileError, match=wanted) as caught:
        one(tmp_path, sets)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("reaches", "said"),
    [(1.25, "the coherence reaches 1.25: clipped to 1"), (3.0, "it is left out")],
)
def test_a_coherence_above_one_is_clipped_with_a_word(tmp_path, reaches, said):
    coherence = np.linspace(0.5, reaches, 400)
    sets = [frf_set(i + 1, coherence, FREQ, func_type=6) for i in range(3)]
    session = one(tmp_path, [si_set(), *chain_sets(), *sets], averages=3)
    assert any(said in text for text in session.warnings)
    found = session.frfs[0].coherence
    # How far above 1 it is tells how wrong it is below: only the variance clips it.
    assert np.isnan(found).all() if reaches > 2 else found.max() == reaches


def test_frfs_a_line_apart_are_cut_to_the_common_ones(tmp_path):
    sets = chain_sets()
    sets[1] = frf_set(2, accelerance(FREQ[:-1], 1, 0), FREQ[:-1])
    session = one(tmp_path, [si_set(), *sets])
    assert session.frfs[0].freq_hz[-1] == FREQ[-2]
    assert any("the common ones are used" in text for text in session.warnings)


def test_nan_in_an_frf_is_refused_but_not_at_zero_hertz(tmp_path):
    _write_nan(tmp_path / "a.uff")
    with pytest.raises(ForeignFileError, match="NaN"):
        run(manifest(tmp_path, posture('["a.uff"]')))
    path = chain_file(tmp_path / "a.uff")
    lines = path.read_bytes().split(b"\n")
    at = next(i for i, line in enumerate(lines) if line.startswith(b"   0.00000000000e+00"))
    lines[at] = b"%20s%20s" % (b"NaN", b"NaN") + lines[at][40:]
    path.write_bytes(b"\n".join(lines))
    assert run(manifest(tmp_path, posture('["a.uff"]'))).frfs


@pytest.mark.parametrize(
    ("body", "wanted"),
    [
        ("[[postures]]\nname = 1\nfiles = ['a']", "name"),
        ("[[postures]]\nname = 'a'\nfiles = []", "files"),
        ("[[postures]]\nname = 'a'\nfiles = ['a.uff']\nspeed = 3", "unknown key"),
        (
            "[[postures]]\nname = 'a'\nfiles = [{ path = 'a.uff', rate = 3.0 }]",
            "unknown key 'rate'",
        ),
        ("[[postures]]\nname = 'a'\nfiles = [{ path = 3 }]", "path: wanted a string, got 3"),
        ("[[postures]]\nname = 'a'\nfiles = ['a.uff']\nhit_direction = [1.0, 1.0, 0.0]", "length"),
        ("[[postures]]\nname = 'a'\nfiles = ['a.uff']\njoints_deg = [1.0]", "joints_deg"),
        ("[[postures]]\nname = 'a'\nfiles = ['b.uff']", "b.uff"),
        ("[[postures]]\nname = 'a'\nfiles = ['a.exe']", ".exe"),
    ],
)
def test_a_wrong_manifest_is_refused(tmp_path, body, wanted):
    chain_file(tmp_path / "a.uff")
    with pytest.raises(ForeignFileError, match=wanted):
        run(manifest(tmp_path, body))


def test_names_in_files_never_become_paths(tmp_path):
    name = "../../evil"
    chain_file(tmp_path / "a.uff", id1="../../evil", rsp_ent_name="../evil")
    body = f"[[postures]]\nname = {json.dumps(name)}\nfiles = ['a.uff']"
    session = run(manifest(tmp_path, body))
    write_session(session, tmp_path / "s.h5")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.uff", "manifest.toml", "s.h5"]
