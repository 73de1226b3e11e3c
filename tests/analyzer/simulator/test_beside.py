"""A session's hits in somebody's MJCF, simulated in time."""

from dataclasses import replace

import pytest
from support.added import axis, with_effects
from support.own_mjcf import own_mjcf

from armodal.analyzer.simulator.beside import beside_simulator
from armodal.analyzer.simulator.in_time import first_hits
from armodal.hil_sim.study import make_case
from armodal.protocols.errors import EstimateError

mujoco = pytest.importorskip("mujoco")


@pytest.fixture(scope="module")
def few_hits():
    """A few mountings of two postures."""
    whole = make_case(seed=8, arm="ur5").session()
    names = [posture.name for posture in whole.header.plan.postures[:2]]
    points = list(dict.fromkeys(hit.sensor_point for hit in whole.hits))[:4]
    chosen = [h for h in whole.hits if h.posture in names and h.sensor_point in points]
    return replace(whole, hits=tuple(chosen))


@pytest.mark.long
def test_the_simulator_s_own_records_are_met_by_the_arm_that_made_them(few_hits, tmp_path):
    plain = few_hits.header.arm
    corrected = with_effects(plain, axis("forearm", compliance=3e-5))
    model = tmp_path / "mine.xml"
    model.write_text(own_mjcf(plain), encoding="utf-8")
    # With one arm twice, what differs from the measurement is the same.
    told = []
    rows = beside_simulator(few_hits, plain, plain, model, mujoco, told.append)
    assert [row.error_before for row in rows] == [row.error_after for row in rows]
    assert len(rows) == 2
    assert "hits on the corrected arm, in time" in told
    # The case hides nothing: beside it a wrong axis is worse.
    worse = beside_simulator(few_hits, plain, corrected, model, mujoco, told.append)
    assert all(row.error_after > row.error_before for row in worse)


def test_a_session_without_records_of_hits_is_refused(session):
    with pytest.raises(EstimateError, match="wanted a session with records of hits"):
        first_hits(replace(session, hits=()))
