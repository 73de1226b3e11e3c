"""Other people's arms through `armodal arm new` and `armodal plan`: loaded, or refused for what?

    python bench/bench_own_arm.py DIR [--inertials | --measure] [--only REGEX]
                                      [--tests N] [--minutes M] [--seeds S]

DIR is searched for robot descriptions (URDF, xacro that makes a robot, MJCF) with their packages,
as their makers publish them; nothing is downloaded. Of each: seconds of processor time, joints,
links guessed or doubted, points, postures planned, and how many of these collide when the visual
and collision triangles themselves are checked without a margin. `--inertials` instead guesses the
inertials of arms that have believable ones, the mass of their moving links known, and tells by how
much a guess is off: each link's mass, and M_jj of every joint over random postures, to which a
stiffness is proportional. `--measure` goes on from the plan: an arm whose springs are 1.3 times as
stiff as its file says is measured in the simulated laboratory by that plan, and identified; and
where the description's inertials are believed, identified once more by somebody who has none and
guesses them, the mass of the moving links known. Told is how far each k is off, and how many k of
all arms lie within their stated 95 % intervals, the inertias' tolerance in them. `--seeds S` does
so S times, each with springs and noise of its own.
"""

import argparse
import re
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.offline_lab import simulate_session

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.model_error import STEP, moved_arms
from armodal.analyzer.own_arm.bodies import arm_bodies
from armodal.analyzer.own_arm.draft import Wanted, draft_arm
from armodal.analyzer.own_arm.guess import DATA_SHEET, believed_links
from armodal.analyzer.own_arm.plausible import Doubts, doubted
from armodal.analyzer.own_arm.solids import touches, triangle_solid
from armodal.analyzer.planning.made import made_plan
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.postures import random_postures
from armodal.hil_sim.study.plant_of_arm import plant_of_arm
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.robot.chain import cut_chain
from armodal.protocols.robot.read import read_robot
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.sensors_file import CATALOGUE

Array = npt.NDArray[np.float64]

OFF = 1.3  # truth over belief
SPREAD = 0.2  # of its logarithm, from the second seed on
N_STATED = 100  # postures that a stated deviation is the mean of
WITHIN = 1.96  # standard deviations, on either side, that hold 95 % of a normal distribution
KINDS = (".urdf", ".xacro", ".xml")
PART = re.compile(
    r"macro|common|material|colou?r|gazebo|transmission|ros2_control|moveit|inc/|test"
)
MAKES_A_ROBOT = re.compile(r"<joint\b|<xacro:[a-z_0-9]+[^>]*\b(?:prefix|arm_id)|<mujoco\b")


def descriptions(folder: Path) -> list[Path]:
    found = []
    for path in sorted(folder.rglob("*")):
        if path.suffix not in KINDS or PART.search(path.relative_to(folder).as_posix()):
            continue
        text = path.read_text("utf-8", "replace")
        if ("<robot" in text or "<mujoco" in text) and MAKES_A_ROBOT.search(text):
            found.append(path)
    # A xacro file and the URDF made from it are one arm.
    stems = {path.name.split(".")[0] for path in found if path.suffix == ".xacro"}
    return [p for p in found if p.suffix == ".xacro" or p.name.split(".")[0] not in stems]


def colliding(draft, postures) -> int:
    """Postures in which any two bodies that are no neighbours meet, by all their triangles."""
    surfaces = [(body.seen, *body.shells) for body in draft.bodies]
    solids = [[triangle_solid(surface) for surface in each] for each in surfaces]
    pairs = [(i, j) for i in range(len(solids)) for j in range(i + 2, len(solids))]
    low, high = np.array([joint.range_rad for joint in draft.arm.joints]).T

    def met(q):
        poses = [np.eye(4), *(link_pose(draft.arm, j.link.name, q) for j in draft.arm.joints)]
        return {
            (i, j)
            for i, j in pairs
            if any(
                touches(a, b, np.linalg.inv(poses[i]) @ poses[j])
                for a in solids[i]
                for b in solids[j]
            )
        }

    # What meets in every posture touches by its making.
    anyway = set(pairs)
    for q in np.random.default_rng(7).uniform(low, high, size=(40, len(low))):
        anyway &= met(q)
    return sum(bool(met(q) - anyway) for q in postures)


def guessed_arm(draft):
    """The arm as one believes it who has no inertial but the mass of the moving links, or None."""
    nothing = Doubts(mass=frozenset(), spread=frozenset())
    if draft.believed.guessed or not all(body.drawn for body in draft.bodies):
        return None
    bare = [replace(body, inertial=None) for body in draft.bodies]
    total = sum(link.mass_kg for link in draft.believed.links)
    # The base takes its share of a total: the total that leaves the moving links their mass.
    share = believed_links(bare, nothing, Remarks(), total_kg=total)
    total *= total / sum(link.mass_kg for link in share.links)
    guess = believed_links(bare, nothing, Remarks(), total_kg=total)
    return replace(
        draft.arm,
        joints=tuple(
            replace(joint, link=link, inertial_std=std)
            for joint, link, std in zip(draft.arm.joints, guess.links, guess.stds, strict=True)
        ),
        tolerances=replace(draft.arm.tolerances, moving_mass=guess.moving_mass),
    )


def measured(draft, plan_text: str, pulls: dict[str, list[float]], seed: int) -> str:
    """How far each k is off the hidden truth, after a session by the plan."""
    arm = draft.arm
    spread = SPREAD if seed > 1 else 0.0
    drawn = np.random.default_rng(seed).normal(0.0, spread, len(arm.joints))
    times = OFF * np.exp(drawn)
    joints = list(zip(times, arm.joints, strict=True))
    k = [t * j.stiffness.value if j.stiffness else None for t, j in joints]
    c = [t * j.damping.value if j.damping else None for t, j in joints]
    truth = [value for value in k if value is not None]
    began = time.process_time()
    plan = plan_from_text(plan_text, arm)
    plant = plant_of_arm(arm, k, c, sensor_kg=plan.sensor.mass_kg)
    session = simulate_session(seed, plan=plan, arm=arm, plant=plant)
    rows = []
    for how, believed in (("true", arm), ("guessed", guessed_arm(draft))):
        if believed is None:
            continue
        try:
            result = identify(replace(session, header=replace(session.header, arm=believed)))
        except ArmodalError as problem:
            rows.append(f"{how} inertias: not identified, {problem}")
            continue
        off = [j.k_n_m_per_rad - t for j, t in zip(result.joints, truth, strict=True)]
        std = [np.hypot(j.k_std, j.k_std_model) for j in result.joints]
        pulls[how] += [e / s for e, s in zip(off, std, strict=True)]
        each = " ".join(
            f"{100 * e / t:+.2f} ± {100 * s / t:.0f}"
            for e, s, t in zip(off, std, truth, strict=True)
        )
        rows.append(f"{how} inertias: k off by {each} %")
    return f"{'; '.join(rows)}; {time.process_time() - began:.0f} s"


def try_arm(
    path: Path, folders: tuple[Path, ...], given: argparse.Namespace, pulls: dict[str, list[float]]
) -> str:
    said, began = Remarks(), time.process_time()
    try:
        draft = draft_arm(path, "bench", Wanted(folders=folders), said)
    except ArmodalError as problem:
        return f"refused {time.process_time() - began:.1f} s: " + " | ".join(
            line.strip() for line in str(problem).splitlines()
        )
    new_s = time.process_time() - began
    row = (
        f"{len(draft.arm.joints)} joints, tip {draft.chain.tip}, {len(draft.believed.guessed)} "
        f"guessed, {len(said.of('doubt'))} doubts, {len(draft.points)} points, new {new_s:.1f} s"
    )
    began = time.process_time()
    try:
        made = made_plan(
            draft.arm,
            np.random.default_rng(0),
            name="bench",
            bodies=draft.bodies,
            floor_m=None,
            equipment=CATALOGUE,
            n_tests=given.tests,
            minutes=given.minutes,
        )
    except ArmodalError as problem:
        return f"{row}; no plan: {problem}"
    plan_s = time.process_time() - began
    plan = plan_from_text(made.text, draft.arm)
    collisions = colliding(draft, [posture.joints_rad for posture in plan.postures])
    lost = sum(leg.stops_rad is None for leg in made.legs)
    chosen = made.equipment
    return (
        f"{row}, plan {plan_s:.1f} s: {len(plan.postures)} postures, {collisions} collide, "
        f"{lost} ways not found, {chosen.hammer.head_kg:g} kg hammer {chosen.told_peak_n} N, "
        f"{made.minutes:.0f} min"
        + "".join(
            f"; {measured(draft, made.text, pulls, seed)}"
            for seed in range(1, given.measure * given.seeds + 1)
        )
    )


def stated_std(arm: Arm, q: Array) -> Array:
    """What the tolerances leave of M_jj in postures q, relative, the mean of each joint's."""
    joints = np.arange(len(arm.joints))
    own = ArmBatch(arm).mass(q)[joints, joints]
    square = np.zeros_like(own)
    for moved, _ in moved_arms(arm):
        square += ((ArmBatch(moved).mass(q)[joints, joints] - own) / own / STEP) ** 2
    return np.asarray(np.sqrt(square).mean(axis=1))


def try_guess(
    path: Path, folders: tuple[Path, ...]
) -> tuple[str, list[float], list[float], list[float]] | None:
    """How far guesses are off, with the total mass known, where there is something to compare."""
    said = Remarks()
    try:
        robot = read_robot(path, said, folders=folders)
        chain = None if robot is None else cut_chain(robot, said)
        bodies = None if chain is None else arm_bodies(chain, said)
        if bodies is None or doubted(bodies, said).spread:
            return None
        nothing = Doubts(mass=frozenset(), spread=frozenset())
        true = believed_links(bodies, nothing, Remarks())
        if true is None or true.guessed or not all(body.drawn for body in bodies):
            return None
        bare = [replace(body, inertial=None) for body in bodies]
        guess = believed_links(bare, nothing, Remarks())
        scale = sum(link.mass_kg for link in true.links) / sum(link.mass_kg for link in guess.links)
        guessed = [
            replace(link, mass_kg=scale * link.mass_kg, inertia_kg_m2=scale * link.inertia_kg_m2)
            for link in guess.links
        ]
        arm = draft_arm(path, "bench", Wanted(folders=folders), Remarks()).arm
    except ArmodalError:
        return None
    q = random_postures(arm, 500, np.random.default_rng(1))
    own = [
        np.array([matrix[j, j] for j in range(len(arm.joints))])
        for matrix in (ArmBatch(arm).with_links(each).mass(q) for each in (guessed, true.links))
    ]
    joints = list(np.exp(np.log(own[0] / own[1]).mean(axis=1)) - 1.0)
    links = [a.mass_kg / b.mass_kg - 1.0 for a, b in zip(guessed, true.links, strict=True)]
    believed = replace(
        arm,
        joints=tuple(
            replace(joint, link=link, inertial_std=std)
            for joint, link, std in zip(
                arm.joints,
                guessed,
                believed_links(bare, nothing, said, total_kg=1.0).stds,
                strict=True,
            )
        ),
        tolerances=replace(arm.tolerances, encoder_offset_rad=0.0, moving_mass=DATA_SHEET),
    )
    std = stated_std(believed, q[:N_STATED])
    # As `identify` states it, in parts of the k found: both are proportional to the M_jj guessed.
    pulls = list((1.0 - 1.0 / (1.0 + np.array(joints))) / std)
    row = (
        f"masses {' '.join(f'{100 * e:+.0f}' for e in links)} %, M_jj "
        f"{' '.join(f'{100 * e:+.0f} ± {100 * s:.0f}' for e, s in zip(joints, std, strict=True))} %"
    )
    return row, links, joints, pulls


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--inertials", action="store_true")
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--only", default="", help="regular expression of paths")
    parser.add_argument("--tests", type=int, default=6)
    parser.add_argument("--minutes", type=float, help="as `armodal plan --minutes`")
    parser.add_argument("--seeds", type=int, default=1)
    given = parser.parse_args()
    folders = tuple(
        sorted({path.parent.parent for path in given.folder.rglob("package.xml")} | {given.folder})
    )
    pulls: dict[str, list[float]] = {"true": [], "guessed": [], "M_jj of guessed": []}
    masses: list[float] = []
    moments: list[float] = []
    for path in descriptions(given.folder):
        name = path.relative_to(given.folder).as_posix()
        if not re.search(given.only, name):
            continue
        if given.inertials:
            found = try_guess(path, folders)
            if found is not None:
                print(f"{name}: {found[0]}", flush=True)
                masses += found[1]
                moments += found[2]
                pulls["M_jj of guessed"] += found[3]
        else:
            print(f"{name}: {try_arm(path, folders, given, pulls)}", flush=True)
    for how, each in pulls.items():
        if each:
            within = int(np.sum(np.abs(each) <= WITHIN))
            print(f"{how} inertias: {within} of {len(each)} within their 95 % interval")
    if masses:
        for what, errors in (("masses", masses), ("M_jj", moments)):
            within = np.mean(np.abs(errors) <= 0.25)
            print(f"{what}: {100 * within:.0f} % within 25 %, rms {100 * np.std(errors):.0f} %")


if __name__ == "__main__":
    sys.exit(main())
