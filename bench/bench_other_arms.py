"""Arms nobody tuned to, from the example-robot-data package: plan, workspace, mozzi, identify.

Needs the package (pip install example-robot-data, about 130 MB); says so where it is absent.
"""

import importlib.util
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.any_arm import arm_text_of_urdf
from support.offline_lab import simulate_session

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.planning.clearance import Clearance
from armodal.analyzer.planning.equations import planned_arm
from armodal.analyzer.planning.plan_text import plan_text
from armodal.analyzer.planning.selective import plan_tests
from armodal.analyzer.workspace.spectrum import elastic_joints
from armodal.analyzer.workspace.study import study_workspace
from armodal.hil_sim.study.plant_of_arm import plant_of_arm
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.urdf import read_urdf
from armodal.tui.commands.mozzi import load_tool

URDFS = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
}
OFF = 1.3  # truth over belief


def data_folder() -> Path | None:
    spec = importlib.util.find_spec("cmeel")
    roots = [Path(p) for p in sys.path if p] + ([Path(spec.origin).parent] if spec else [])
    for root in roots:
        folder = root / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        if folder.is_dir():
            return folder
    return None


def try_arm(name: str, urdf: Path, folder: Path) -> None:
    shutil.copy(urdf, folder / urdf.name)
    chain = read_urdf(urdf.read_text())
    (folder / f"{name}.toml").write_text(arm_text_of_urdf(name, urdf.name, chain))
    arm = load_arm(folder / f"{name}.toml")
    elastic = elastic_joints(arm)
    began = time.perf_counter()
    plan = plan_tests(
        planned_arm(arm), np.random.default_rng(0), clearance=Clearance(floor_m=-0.5), n_tests=4
    )
    print(f"{name}: plan {time.perf_counter() - began:.1f} s, {plan.n_needed} tests needed")
    study = study_workspace(arm, elastic, 100_000)
    print(f"{name}: frequencies {study.f_hz.mean.round(1)} ± {study.f_hz.std.round(1)} Hz")
    middle = [float(np.rad2deg(np.mean(joint.range_rad))) for joint in arm.joints]
    found, _ = load_tool(arm, middle, [0, 0, -50, 0, 0, 0], [0, 0, 0])
    print(f"{name}: tool gives {1e3 * np.linalg.norm(found.displacement_m):.2f} mm under 50 N")
    path = folder / "plan.toml"
    path.write_text(plan_text(plan, "other"), encoding="utf-8")
    k = [OFF * j.stiffness.value if j.stiffness else None for j in arm.joints]
    c = [OFF * j.damping.value if j.damping else None for j in arm.joints]
    began = time.perf_counter()
    result = identify(simulate_session(1, plan=path, arm=arm, plant=plant_of_arm(arm, k, c)))
    for joint, truth in zip(result.joints, k, strict=False):
        error = joint.k_n_m_per_rad - truth
        print(
            f"{name}: {joint.joint} k {joint.k_n_m_per_rad:.0f}, off by "
            f"{100 * error / truth:+.2f} %, {error / joint.k_std:+.1f} std"
        )
    print(f"{name}: measured and identified in {time.perf_counter() - began:.1f} s")


def main() -> None:
    robots = data_folder()
    if robots is None:
        print("example-robot-data is not installed: pip install example-robot-data")
        return
    for name, urdf in URDFS.items():
        with tempfile.TemporaryDirectory() as folder:
            try_arm(name, robots / urdf, Path(folder))


if __name__ == "__main__":
    main()
