"""A new arm from a robot description: everything that its files will hold, nothing written yet."""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from armodal.analyzer.own_arm.arm_text import arm_text, urdf_text
from armodal.analyzer.own_arm.bodies import ArmBody, arm_bodies, reach_m, say_missing_files
from armodal.analyzer.own_arm.collisions import Collisions
from armodal.analyzer.own_arm.drives import Drive, guessed_drives
from armodal.analyzer.own_arm.floor import floor_below
from armodal.analyzer.own_arm.guess import BelievedLinks, believed_links
from armodal.analyzer.own_arm.plausible import Doubts, doubted
from armodal.analyzer.own_arm.points import FoundPoint, body_points
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.chain import CutChain, cut_chain
from armodal.protocols.robot.read import read_robot
from armodal.protocols.robot.remarks import Remarks, refuse_faults

__all__ = ["GRAVITY", "Draft", "Wanted", "draft_arm", "read_description", "stl_bytes"]

G_M_S2 = 9.80665
# In the base's frame. On a wall the base's x points up.
GRAVITY = {
    "floor": (0.0, 0.0, -G_M_S2),
    "ceiling": (0.0, 0.0, G_M_S2),
    "wall": (-G_M_S2, 0.0, 0.0),
}
MESHES = "meshes"


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """What a user may say of an arm."""

    tip: str | None = None
    total_kg: float | None = None
    gravity_m_s2: tuple[float, float, float] = GRAVITY["floor"]
    keep_inertials: bool = False  # doubted ones too
    use_meshes: bool = True
    folders: tuple[Path, ...] = ()
    arguments: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """A new arm and the texts and meshes of its files."""

    arm: Arm
    chain: CutChain
    bodies: tuple[ArmBody, ...]
    believed: BelievedLinks
    points: tuple[FoundPoint, ...]
    urdf_name: str
    meshes: Mapping[str, bytes]  # by their path beside the arm file


def read_description(
    path: Path, wanted: Wanted, said: Remarks
) -> tuple[CutChain, tuple[ArmBody, ...], Doubts]:
    """The chain, its bodies and what is doubted of their inertials.

    Raises
    ------
    ArmError
        With every fault, if the description cannot be used.
    """
    robot = read_robot(path, said, folders=wanted.folders, arguments=wanted.arguments)
    chain = None if robot is None else cut_chain(robot, said, tip=wanted.tip)
    bodies = None
    if chain is None and robot is not None and wanted.use_meshes:
        say_missing_files(robot, said)  # so that one run tells them too
    if chain is not None:
        bodies = arm_bodies(chain, said, use_meshes=wanted.use_meshes)
    refuse_faults(path.name, said)
    if chain is None or bodies is None:  # a fault says why
        raise ArmError(f"{path.name}: cannot be used")
    return chain, bodies, doubted(bodies, said, total_kg=wanted.total_kg)


def draft_arm(path: Path, name: str, wanted: Wanted, said: Remarks, *, seed: int = 0) -> Draft:
    """Work out a new arm.

    Raises
    ------
    ArmError
        With every fault, if the description cannot be used.
    """
    chain, bodies, doubts = read_description(path, wanted, said)
    if wanted.keep_inertials:
        doubts = Doubts(mass=frozenset(), spread=frozenset())
    believed = believed_links(bodies, doubts, said, total_kg=wanted.total_kg)
    refuse_faults(path.name, said)
    if believed is None:  # a fault says why
        raise ArmError(f"{path.name}: cannot be used")
    rng = np.random.default_rng(seed)
    meshes, shapes = _meshes(bodies)
    urdf = urdf_text(chain, believed.links, shapes)
    urdf_name = f"{name}.urdf"
    lowest = min(float(shell.vertices_m[:, 2].min()) for shell in bodies[0].shells)
    floor = floor_below(reach_m(chain), lowest if bodies[0].drawn else 0.0)

    def built(drives: Sequence[Drive | None], points: Sequence[FoundPoint]) -> Arm:
        text = arm_text(
            name, urdf_name, chain, believed, drives, points, wanted.gravity_m_s2, [floor], said
        )
        return arm_from_texts(text, urdf_text=urdf, database_text=None, origin=f"{name}.toml")

    # A first arm without springs and points of its own, for what is to be found with its joints.
    here = FoundPoint(
        id="1", body=0, position_m=np.zeros(3), normal=np.eye(3)[2], x_axis=np.eye(3)[0]
    )
    bare = built([None] * len(chain.bodies), [here])
    reached = Collisions(bare, bodies, bare.keep_outs).often_free
    points = body_points(bodies, rng, said, reached)
    refuse_faults(path.name, said)
    return Draft(
        arm=built(guessed_drives(bare, rng), points),
        chain=chain,
        bodies=bodies,
        believed=believed,
        points=points,
        urdf_name=urdf_name,
        meshes=meshes,
    )


def stl_bytes(surface: Surface) -> bytes:
    """A surface as a binary STL, m."""
    corners = surface.vertices_m[surface.triangles].astype("<f4")
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    rows = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    rows["n"], rows["v"] = normal, corners
    return b"\0" * 80 + struct.pack("<I", len(rows)) + rows.tobytes()


def _meshes(bodies: Sequence[ArmBody]) -> tuple[dict[str, bytes], list[list[str]]]:
    meshes: dict[str, bytes] = {}
    shapes = []
    for number, body in enumerate(bodies):
        files = []
        if body.drawn:
            stem = f"{number}-{re.sub(r'[^A-Za-z0-9_-]', '-', body.name)[:40]}"
            files = [f"{MESHES}/{stem}.stl"]
            meshes[files[0]] = stl_bytes(body.seen)
            for i, shell in enumerate(body.shells, start=1):
                files.append(f"{MESHES}/{stem}-{i}.stl")
                meshes[files[-1]] = stl_bytes(shell)
        shapes.append(files)
    return meshes, shapes
