"""A gap on a trajectory that the MuJoCo maker made: far moves, equations not the analyzer's."""

import pytest
from support.added import axis, with_effects
from support.ideal_maker import LOSS_S, Ideal
from support.maker_log import arm_of, move_log, with_axis
from support.own_mjcf import own_mjcf

from armodal.analyzer.simulator.motion import compare_with_motion

mujoco = pytest.importorskip("mujoco")

pytestmark = pytest.mark.usefixtures("not_apart")

COMPLIANCE, LOSS = 1e-5, 1e-4


@pytest.mark.long
@pytest.mark.parametrize("true", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_true_effect_closes_the_gap_on_a_far_move_and_a_null_s_opens_it(true, tmp_path):
    ideal = Ideal("ur10e")
    arm = arm_of(ideal, LOSS_S)
    first, second, third, *_, last = arm.joints
    corrected = with_effects(arm, axis(second.link.name, COMPLIANCE, LOSS))
    machine = ideal.machine()
    if true:
        machine = with_axis(machine, second.link.name, COMPLIANCE, LOSS)
    log = move_log(
        ideal,
        machine,
        point=next(point.id for point in arm.points if point.link == last.link.name),
        turns_rad={first.name: 0.6, second.name: 0.3, third.name: -0.4},
    )
    path = tmp_path / "mine.xml"
    path.write_text(own_mjcf(arm), encoding="utf-8")
    (row,) = compare_with_motion(log, arm, corrected, path, mujoco, lambda _: None)
    right, wrong = row.error_after, row.error_before
    if not true:
        right, wrong = wrong, right
    # Near the band's low end the arm sags in the simulator, where the maker's springs are stretched
    # beforehand, and gravity turns in the sensor.
    assert right < 0.08
    assert wrong > 0.2
