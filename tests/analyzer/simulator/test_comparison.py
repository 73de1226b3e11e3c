"""A session's hits in somebody's MJCF, simulated in time."""

import re
from dataclasses import replace

import pytest
from support.added import axis, with_effects
from support.offline_lab import first_postures, simulate_session
from support.own_mjcf import own_mjcf
from support.small_case import small_case

from armodal.analyzer.simulator.comparison import compare_with_simulator
from armodal.analyzer.simulator.in_time import first_hits
from armodal.hil_sim.study.plant_of_arm import plant_of_arm
from armodal.protocols.errors import EstimateError
from armodal.protocols.plan import plan_from_text

mujoco = pytest.importorskip("mujoco")

pytestmark = pytest.mark.usefixtures("not_apart")


@pytest.fixture(scope="module")
def few_hits():
    """A few mountings of two postures."""
    whole = small_case(8, "ur5").session()
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
    rows = compare_with_simulator(few_hits, plain, plain, model, mujoco, told.append)
    assert [row.error_before for row in rows] == [row.error_after for row in rows]
    assert len(rows) == 2
    assert "hits on the corrected arm, in time" in told
    # The case hides nothing: beside it a wrong axis is worse.
    worse = compare_with_simulator(few_hits, plain, corrected, model, mujoco, told.append)
    assert all(row.error_after > row.error_before for row in worse)


def test_the_accelerometers_mass_rides_on_the_point_that_it_is_mounted_at(arm, tmp_path):
    """A sensor of 0.3 kg on the hand: told of it the simulator meets the session, else not."""
    heavy = 0.3
    told = first_postures(1, points=("5",))
    mass = re.compile(r"(\[sensor\][^\[]*mass_kg = )[0-9.]+")
    plan = plan_from_text(mass.sub(rf"\g<1>{heavy}", told.text), arm)
    k, c = (
        [belief.value if belief else None for belief in (getattr(j, key) for j in arm.joints)]
        for key in ("stiffness", "damping")
    )
    plant = plant_of_arm(arm, k, c, sensor_kg=heavy)
    session = simulate_session(1, plan=plan, arm=arm, plant=plant, hits_per_point=1)
    light = replace(session, header=replace(session.header, plan=told))
    model = tmp_path / "mine.xml"
    model.write_text(own_mjcf(arm), encoding="utf-8")
    right, wrong = (
        compare_with_simulator(own, arm, arm, model, mujoco, lambda _: None)[0].error_after
        for own in (session, light)
    )
    assert right < 0.25  # crooked mountings, gains and aim of the laboratory
    assert wrong > 2.0 * right


def test_a_session_without_records_of_hits_is_refused(session):
    with pytest.raises(EstimateError, match="wanted a session with records of hits"):
        first_hits(replace(session, hits=()))
