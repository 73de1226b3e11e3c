"""A robot of others, its own MJCF: read as an arm, patched with effects, moved by a log, and hit.

    bench_own_mjcf.py ur5e.xml

Wanted: MuJoCo's frequencies within 0.2 % of the arm file's in 20 postures for every effect; a log
of the corrected arm, and a session that the simulated laboratory measures on it by a plan of its
own, closer to the corrected model than to the plain one; of the plain arm the other way round.
Stiffness is guessed by `armodal arm new`, and the laboratory's is the same.
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import mujoco
import numpy as np
from support.added import AXIS_DIRECTION, AXIS_POINT, added, any_of, axis, with_effects
from support.linear_log import linear_log
from support.offline_lab import simulate_session

from armodal.analyzer.export.by_mujoco import compare_frequencies
from armodal.analyzer.export.exported import BELOW_HZ, ready_for_export
from armodal.analyzer.export.mjcf_patch import patched_mjcf
from armodal.analyzer.own_arm.draft import Wanted, draft_arm
from armodal.analyzer.planning.made import made_plan
from armodal.analyzer.simulator.comparison import compare_with_simulator
from armodal.analyzer.simulator.motion import compare_with_motion
from armodal.hil_sim.plant import build_plant
from armodal.hil_sim.plant_file import PlantFile
from armodal.hil_sim.study.of_file import with_file_effects
from armodal.hil_sim.study.plant_of_arm import plant_of_arm
from armodal.protocols.plan import plan_from_text
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.sensors_file import CATALOGUE

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
    draft = draft_arm(source, "theirs", Wanted(), Remarks())
    arm = draft.arm
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
            (row,) = compare_with_motion(log, arm, corrected, source, mujoco, lambda _: None)
            print(
                f"a log, {name}: plain arm {100 * row.error_before:.1f} % off, corrected arm "
                f"{100 * row.error_after:.1f} %"
            )
    hit_by_plan(draft, source)


def hit_by_plan(draft, source: Path) -> None:
    """Sessions of the arm with a clear axis in its upper arm and without, beside both models."""
    arm, link = draft.arm, draft.arm.joints[1].link.name
    plan = plan_from_text(
        made_plan(
            arm,
            np.random.default_rng(0),
            name="bench",
            bodies=draft.bodies,
            floor_m=None,
            equipment=CATALOGUE,
            n_tests=4,
            minutes=95.0,
        ).text,
        arm,
    )
    where = {"link": link, "direction": AXIS_DIRECTION, "point_m": AXIS_POINT}
    compliance = 0.5 / arm.joints[1].stiffness.value
    own = added("link_axis", link, where, std=1e-3, axis_compliance=compliance, axis_loss=1e-4)
    corrected = with_effects(arm, own)
    for name, made in (("the corrected arm's", corrected), ("the plain arm's", arm)):
        k = [joint.stiffness.value if joint.stiffness else None for joint in arm.joints]
        c = [joint.damping.value if joint.damping else None for joint in arm.joints]
        own_tables = plant_of_arm(arm, k, c, sensor_kg=plan.sensor.mass_kg).truth.model_dump()
        tables = with_file_effects(own_tables | {"effects": []}, made, 1)
        plant = build_plant(PlantFile.model_validate(tables))
        session = simulate_session(1, plan=plan, arm=arm, plant=plant, hits_per_point=1)
        for row in compare_with_simulator(session, arm, corrected, source, mujoco, lambda _: None):
            print(
                f"hits, {name}, {row.posture}{', validation' if row.validation else ''}: plain arm "
                f"{100 * row.error_before:.1f} % off, corrected arm {100 * row.error_after:.1f} %, "
                f"to {row.top_hz:.0f} Hz"
            )


if __name__ == "__main__":
    main()
