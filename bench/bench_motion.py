"""Logs of far moves by the MuJoCo maker: does the gap close for a true effect, and for no null?

Every arm of the makers; an axis in its second link that is in the machine that made the log, or is
not. Told is how far the plain and the corrected arm are off the log, in somebody's MJCF.
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import mujoco
from support.added import axis, with_effects
from support.ideal_maker import LOSS_S, Ideal
from support.maker_log import arm_of, move_log, with_axis
from support.own_mjcf import own_mjcf

from armodal.analyzer.simulator.motion import compare_with_motion
from armodal.hil_sim.makers.arms import ARMS

LOSS = 1e-4
OF_DRIVE = 0.5  # the axis's compliance over the second joint's


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    for name in ARMS:
        ideal = Ideal(name)
        arm = arm_of(ideal, LOSS_S)
        first, second, third, *_, last = arm.joints
        compliance = OF_DRIVE / ideal.stiffness[second.name]
        link = second.link.name
        corrected = with_effects(arm, axis(link, compliance, LOSS))
        tip = next(point.id for point in arm.points if point.link == last.link.name)
        turns = {first.name: 0.6, second.name: 0.2, third.name: -0.3}
        machine = ideal.machine()
        for what, own in (
            ("with the axis", with_axis(machine, link, compliance, LOSS)),
            ("without", machine),
        ):
            log = move_log(ideal, own, point=tip, turns_rad=turns)
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "mine.xml"
                path.write_text(own_mjcf(arm), encoding="utf-8")
                (row,) = compare_with_motion(log, arm, corrected, path, mujoco, lambda _: None)
            print(
                f"{name}, log {what}: plain arm {100 * row.error_before:.1f} % off, corrected arm "
                f"{100 * row.error_after:.1f} %"
            )


if __name__ == "__main__":
    main()
