"""A robot of others, its own MJCF: read as an arm, patched with effects, and moved along a log.

    bench_own_mjcf.py ur5e.xml

Wanted: MuJoCo's frequencies within 0.2 % of the arm file's in 20 postures for every effect, and a
log of the corrected arm closer to the corrected model than to the plain one. Stiffness is guessed
by `armodal arm new`.
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import mujoco
from support.added import any_of, axis, with_effects
from support.linear_log import linear_log

from armodal.analyzer.export.by_mujoco import compare_frequencies
from armodal.analyzer.export.exported import BELOW_HZ, ready_for_export
from armodal.analyzer.export.mjcf_patch import patched_mjcf
from armodal.analyzer.own_arm.draft import Wanted, draft_arm
from armodal.analyzer.simulator.motion import beside_motion
from armodal.protocols.robot.remarks import Remarks

KINDS = (
    "bearing",
    "rotor",
    "coupling",
    "payload",
    "released_joint",
    "base",
    "link_bending",
    "link_torsion",
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mjcf", type=Path)
    source = parser.parse_args().mjcf
    arm = draft_arm(source, "theirs", Wanted(), Remarks()).arm
    link = arm.joints[1].link.name
    cases = {"axis": [axis(link)]} | {kind: [any_of(arm, kind)] for kind in KINDS}
    with tempfile.TemporaryDirectory() as folder:
        for name, effects in cases.items():
            ready = ready_for_export(with_effects(arm, *effects))
            out = Path(folder) / "out.xml"
            text, _ = patched_mjcf(arm, ready.tree, source, out, mujoco)
            out.write_text(text, encoding="utf-8")
            found = compare_frequencies(
                ready.correction,
                ready.tree,
                mujoco,
                mujoco.MjModel.from_xml_path(str(out)),
                n_postures=20,
                below_hz=BELOW_HZ,
            )
            print(f"{name}: {100 * found.largest:.4f} %, {found.n_modes} modes")
        corrected = with_effects(arm, axis(link))
        middle = [0.5 * sum(joint.range_rad) + 0.4 for joint in arm.joints]
        tip = next(p.id for p in arm.points if p.link == arm.joints[-1].link.name)
        for name, own in (("the corrected arm's", corrected), ("the plain arm's", arm)):
            log = linear_log(own, middle, point=tip)
            (row,) = beside_motion(log, arm, corrected, source, mujoco, lambda _: None)
            print(
                f"a log, {name}: plain arm {100 * row.error_before:.1f} % off, corrected arm "
                f"{100 * row.error_after:.1f} %"
            )


if __name__ == "__main__":
    main()
