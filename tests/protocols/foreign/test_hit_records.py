"""Single hits on the arm: which sensors they can have, where they strike, what is refused."""

import numpy as np
import pytest
from support.foreign_samples import accelerance, frf_set, si_set, write_sets
from support.manifests import hit_signals, manifest, posture, run

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.daq.judge_imported import judged
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.errors import ForeignFileError

JOINTS = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
FREQ = 0.25 * np.arange(1, 41)
NODES = 'nodes = { "105" = "5", "101" = "1" }'


def save_hit(path, *, channels=1, n=2048):
    t, force, responses = hit_signals(n=n, channels=channels)
    np.save(path, np.vstack([t, force, responses]))


@pytest.mark.parametrize("channels", [4, 7, 30])
@pytest.mark.parametrize("arm", ["none", "rv4frl"])
def test_more_accelerations_than_a_sensor_has_are_refused(tmp_path, arm, channels):
    save_hit(tmp_path / "h.npy", channels=channels)
    names = ", ".join(f"'5:{'xyz'[i % 3]}'" for i in range(channels))  # all at one point
    files = f'[{{ path = "h.npy", responses = [{names}], reference = "1:x" }}]'
    body = posture(files, joints_deg=[] if arm == "none" else JOINTS)
    with pytest.raises(ForeignFileError, match=f"up to 3, at a point, got {channels} at 5"):
        run(manifest(tmp_path, body, arm=f'"{arm}"'))


def test_several_sensors_a_hit_are_records_of_their_own_points(tmp_path):
    names = '["1:x", "1:y", "1:z", "2:x", "2:y", "2:z"]'
    save_hit(tmp_path / "h.npy", channels=6)
    body = posture(f'[{{ path = "h.npy", responses = {names}, reference = "3:-z" }}]')
    session = run(manifest(tmp_path, body))
    assert [hit.sensor_point for hit in session.hits] == ["1", "2"]
    assert {hit.hit_point for hit in session.hits} == {"3"}
    one, other = (hit.counts[:, 1:].max(axis=0) for hit in session.hits)
    scale = np.array([c.scale for c in session.header.dictionary.channels])[1:]
    # Channel k of the file is k times the first: the second sensor's are 4, 5, 6 times as large.
    assert np.allclose(other * scale / (one * scale), [4.0, 2.5, 2.0], rtol=1e-6)


@pytest.mark.parametrize(("n", "kept"), [(2047, 2047), (2049, 2048)])
def test_records_a_sample_apart_are_cut_with_a_word(tmp_path, n, kept):
    save_hit(tmp_path / "a.npy")
    save_hit(tmp_path / "b.npy", n=n)
    session = run(manifest(tmp_path, posture('["a.npy", "b.npy"]')))
    assert {len(hit.counts) for hit in session.hits} == {kept}
    assert any(f"the first {kept} are used" in text for text in session.warnings)


def test_hits_of_other_channels_at_one_point_are_refused(tmp_path):
    save_hit(tmp_path / "a.npy", channels=1)
    save_hit(tmp_path / "b.npy", channels=3)
    with pytest.raises(ForeignFileError, match="wanted 2 channels at point"):
        run(manifest(tmp_path, posture('["a.npy", "b.npy"]')))


def test_a_triaxial_and_a_uniaxial_sensor_share_a_hit(tmp_path):
    save_hit(tmp_path / "h.npy", channels=4)
    names = '["1:x", "1:y", "1:z", "2:z"]'
    body = posture(f'[{{ path = "h.npy", responses = {names}, reference = "3:-z" }}]')
    session = run(manifest(tmp_path, body))
    assert {hit.sensor_point for hit in session.hits} == {"1", "2"}
    assert any("at 2 have fewer axes" in text for text in session.warnings)
    superset = Superset(session.header.arm)
    (frf,) = estimate_frfs(judged(session), superset)
    assert [dof.point for dof in frf.responses] == ["1", "1", "1", "2"]
    assert frf.responses[3].direction.tolist() == [0.0, 0.0, 1.0]
    # Channel k of the file is k times the first; counts are rounded to 2^-30.
    size = np.abs(frf.values[:, 0]) / np.abs(frf.values[0, 0])
    assert np.allclose(size, np.array([[1.0], [2.0], [3.0], [4.0]]), rtol=1e-4)
    assert (frf.variance > 0.0).all()


@pytest.mark.parametrize(
    ("lengths", "kept", "word"),
    [
        ((2048, 1500, 2048), {1500}, "the first 1"),
        ((2048, 2048, 300), {2048}, "less than half"),
    ],
)
def test_records_of_other_lengths_are_cut_or_left_out_with_a_word(tmp_path, lengths, kept, word):
    for i, n in enumerate(lengths):
        save_hit(tmp_path / f"h{i}.npy", n=n)
    session = run(manifest(tmp_path, posture('["h0.npy", "h1.npy", "h2.npy"]')))
    assert {len(hit.counts) for hit in session.hits} == kept
    assert any(word in text for text in session.warnings)


@pytest.mark.parametrize(
    "keys", [{"averages": 3}, {"window_decay_rad_s": 2.5}, {"window_decay_rad_s": 0.0}]
)
def test_what_only_averaged_frfs_have_is_refused_for_single_hits(tmp_path, keys):
    save_hit(tmp_path / "h.npy")
    (key,) = keys
    with pytest.raises(ForeignFileError, match=f"{key}: wanted none for single hits"):
        run(manifest(tmp_path, posture('["h.npy"]', **keys)))


def hit_of_node(folder):
    """A hit on node 101 along its link's x, felt at node 105."""
    save_hit(folder / "h.npy", channels=3)
    names = '["105:x", "105:y", "105:z"]'
    return f'[{{ path = "h.npy", responses = {names}, reference = "101:x" }}]'


def frfs_of_node(folder):
    sets = [
        frf_set(105, accelerance(FREQ, i, 0), FREQ, rsp_dir=i + 1, ref_node=101, ref_dir=1)
        for i in range(3)
    ]
    write_sets(folder / "a.uff", [si_set(), *sets])
    return '["a.uff"]'


def struck(session):
    """Point and direction of every hit, or of every FRF's reference."""
    if session.hits:
        return [(hit.hit_point, hit.hit_direction) for hit in session.hits]
    return [(dof.point, dof.direction) for dof in session.frfs[0].references]


@pytest.mark.parametrize("files", [hit_of_node, frfs_of_node])
@pytest.mark.parametrize("told", ["101", "1"], ids=["node", "point"])
def test_the_hit_point_may_be_a_node_or_its_point(tmp_path, files, told):
    body = posture(files(tmp_path), joints_deg=JOINTS, axes="link", hit_point=told)
    session = run(manifest(tmp_path, body, arm='"rv4frl"', head=NODES))
    arm = load_arm("rv4frl")
    R = link_pose(arm, arm.point("1").link, np.radians(JOINTS))[:3, :3]
    ((point, direction),) = struck(session)
    assert point == "1"
    assert np.allclose(direction, R[:, 0], atol=1e-12)  # a product of six rotations
    assert session.header.plan.fixed_point == "1"


@pytest.mark.parametrize("files", [hit_of_node, frfs_of_node])
def test_a_hit_point_that_the_arm_has_not_is_refused(tmp_path, files):
    body = posture(files(tmp_path), joints_deg=JOINTS, axes="link", hit_point="77")
    with pytest.raises(ForeignFileError, match="node 77"):
        run(manifest(tmp_path, body, arm='"rv4frl"', head=NODES))


def test_the_hit_point_of_a_plain_structure_is_mapped_too(tmp_path):
    body = posture(frfs_of_node(tmp_path), hit_point="101")
    session = run(manifest(tmp_path, body, head=NODES))
    assert [dof.point for dof in session.frfs[0].references] == ["1"]
    assert {point.id for point in session.header.arm.points} == {"1", "5"}
