"""The bodies of a cut chain with their surfaces and what the description says of their mass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.capsules import capsule_between
from armodal.analyzer.own_arm.meshes import shape_triangles
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.chain import Body, CutChain
from armodal.protocols.robot.records import Inertial, Robot, Shape
from armodal.protocols.robot.remarks import Remarks

__all__ = ["ArmBody", "arm_bodies", "joined", "reach_m", "say_missing_files"]

Array = npt.NDArray[np.float64]

# In parts of the arm's length. A shape beyond is in other units, mm are 1000 and inches 39 times
# too large, or has parts far off. The base may stand on a tall frame.
_TOO_LARGE, _TOO_LARGE_BASE = 2.0, 10.0
_TOO_SMALL = 1e-3
_ARM_M = (0.02, 30.0)  # from a toy to the longest boom


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmBody:
    """A body of the arm: what its joint moves, or the base."""

    name: str
    cut: Body
    seen: Surface  # of meshes to look at, where there are any
    shells: tuple[Surface, ...]  # of what may be run into, one for each shape
    drawn: bool  # whether the surface is the description's, not a capsule put in
    inertial: Inertial | None  # of all its parts; None where none has any


def arm_bodies(
    chain: CutChain, said: Remarks, *, use_meshes: bool = True
) -> tuple[ArmBody, ...] | None:
    """Base first, then the moving bodies; None after a fault that leaves no surfaces.

    Parameters
    ----------
    use_meshes
        Whether to read the shapes at all; else capsules between the joints stand for them.
    """
    reach = reach_m(chain)
    low, high = _ARM_M
    if not low <= reach <= high:
        said.fault(
            "joints",
            f"wanted an arm of {low:g} to {high:g} m, got joints {reach:.4g} m from end to end; "
            "lengths in a URDF are m",
        )
        return None
    bodies = []
    cuts = (chain.base, *chain.bodies)
    for number, cut in enumerate(cuts):
        follower = cuts[number + 1] if number + 1 < len(cuts) else None
        odd: list[tuple[str, str]] = []
        shells = _shells(cut, "collision", reach, odd, said) if use_meshes else []
        seen = _shells(cut, "visual", reach, odd, said) if use_meshes else []
        for where, why in odd:
            if shells or seen:
                said.note(where, f"{why}; the link's other shapes serve")
            else:
                said.fault(where, f'{why}; a mesh in mm needs scale="0.001 0.001 0.001"')
        _say_missing(cut, bool(shells or seen), use_meshes, said)
        drawn = bool(shells or seen)
        opened = sum(bool(shell.open_edges) for shell in (*seen, *shells))
        if opened:
            said.note(
                f"link {cut.name}",
                f"{opened} of its {len(seen) + len(shells)} shapes are not closed, or their edges "
                "have more than two triangles: convex hulls serve for volume and collisions",
            )
        if not drawn:
            shells = [capsule_between(follower, reach)]
            if use_meshes:
                said.guess(
                    f"link {cut.name}", "has no shape: a capsule between its joints stands for it"
                )
        bodies.append(
            ArmBody(
                name=cut.name,
                cut=cut,
                seen=_together(seen or shells),
                shells=tuple(shells or seen),
                drawn=drawn,
                inertial=_inertial(cut),
            )
        )
    return None if said.of("fault") else tuple(bodies)


def reach_m(chain: CutChain) -> float:
    """Sum of the distances from joint to joint, m."""
    return float(
        sum(np.linalg.norm(body.T_parent_joint[:3, 3]) for body in chain.bodies[1:])
        + _tip_distance(chain)
    )


def joined(inertials: list[Inertial]) -> Inertial:
    """Bodies that move as one, all in one frame."""
    mass = sum(part.mass_kg for part in inertials)
    moment = sum((part.mass_kg * part.center_m for part in inertials), start=np.zeros(3))
    center = moment / mass if mass else np.zeros(3)
    inertia = np.zeros((3, 3))
    for part in inertials:
        d = part.center_m - center
        inertia += part.inertia_kg_m2 + part.mass_kg * (d @ d * np.eye(3) - np.outer(d, d))
    return Inertial(mass_kg=mass, center_m=center, inertia_kg_m2=inertia)


def _tip_distance(chain: CutChain) -> float:
    for part in chain.bodies[-1].parts:
        if part.link.name == chain.tip:
            return float(np.linalg.norm(part.T_body_link[:3, 3]))
    return 0.0


def _inertial(cut: Body) -> Inertial | None:
    parts = []
    for part in cut.parts:
        own, T = part.link.inertial, part.T_body_link
        if own is None or (own.mass_kg == 0.0 and not own.inertia_kg_m2.any()):
            continue
        R = T[:3, :3]
        parts.append(
            Inertial(
                mass_kg=own.mass_kg,
                center_m=R @ own.center_m + T[:3, 3],
                inertia_kg_m2=R @ own.inertia_kg_m2 @ R.T,
            )
        )
    return joined(parts) if parts else None


def _shells(
    cut: Body, kind: str, reach: float, odd: list[tuple[str, str]], said: Remarks
) -> list[Surface]:
    """The shapes of a kind; what is not of the arm's size goes to `odd`, with why."""
    found = []
    largest = reach * (_TOO_LARGE_BASE if cut.joint is None else _TOO_LARGE)
    for part in cut.parts:
        shapes: tuple[Shape, ...] = getattr(part.link, kind)
        for shape in shapes:
            if shape.kind == "mesh" and shape.file is None:
                continue  # said where it was looked for
            where = f"link {part.link.name}: {kind} {shape.named or shape.kind}"
            try:
                vertices, triangles = shape_triangles(shape)
            except ArmError as problem:
                said.fault(f"link {part.link.name}: {kind}", str(problem))
                continue
            size = float(np.ptp(vertices, axis=0).max())
            if not _TOO_SMALL * reach <= size <= largest:
                odd.append(
                    (where, f"wanted a shape of the arm's size, {reach:.3g} m, got {size:.4g} m")
                )
                continue
            T = part.T_body_link
            surface = Surface(vertices @ T[:3, :3].T + T[:3, 3], triangles)
            try:
                _ = surface.hull  # flat ones are refused here
            except ArmError as problem:
                said.note(where, f"{problem}; it is passed over")
                continue
            found.append(surface)
    return found


def say_missing_files(robot: Robot, said: Remarks) -> None:
    """Say a fault for every mesh of a description that is not there, whatever its chain is."""
    for link in robot.links.values():
        for shape in (*link.visual, *link.collision):
            if shape.kind == "mesh" and shape.file is None:
                said.fault(
                    f"link {link.name}", f"wanted the mesh {shape.named!r}, found no such file"
                )


def _say_missing(cut: Body, others: bool, use_meshes: bool, said: Remarks) -> None:
    """Meshes that are named and not there: a fault where nothing else shows the body."""
    missing = [
        (part.link.name, shape.named)
        for part in cut.parts
        for shape in (*part.link.visual, *part.link.collision)
        if shape.kind == "mesh" and shape.file is None
    ]
    for link, named in dict.fromkeys(missing):
        text = f"wanted the mesh {named!r}, found no such file"
        if others:
            said.note(f"link {link}", f"{text}; its other shapes serve")
        elif use_meshes:
            said.fault(f"link {link}", f"{text}; give its folder with --packages, or --no-meshes")


def _together(shells: list[Surface]) -> Surface:
    if len(shells) == 1:
        return shells[0]
    offsets = np.cumsum([0, *(len(shell.vertices_m) for shell in shells)])
    return Surface(
        np.concatenate([shell.vertices_m for shell in shells]),
        np.concatenate(
            [shell.triangles + int(off) for shell, off in zip(shells, offsets[:-1], strict=True)]
        ),
    )
