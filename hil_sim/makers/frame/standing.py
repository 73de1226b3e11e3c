"""An arm of beams in a posture."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from armodal.hil_sim.makers.arm_table import Array, Inertial, LinkRow, rotation
from armodal.hil_sim.makers.frame.beams import Section
from armodal.hil_sim.makers.frame.parts import Hinge, Parts
from armodal.hil_sim.makers.frame.structure import Spot, Structure
from armodal.hil_sim.makers.shell_points import along, shell_points

__all__ = ["Standing", "stand"]

PIECES = 6  # beams on each straight piece of a shell: points and lumps go with the nearest node
BEAM_PART = 0.7  # of a link's mass at most, that lies in its shell
RIGID = 3e3  # times as stiff as the drive: what a hinge does not let give way


@dataclass(slots=True, kw_only=True)
class Standing:
    """The structure in a posture, and where everything is."""

    parts: Parts
    structure: Structure = field(default_factory=Structure)
    poses: dict[str, Array] = field(default_factory=dict)  # (4, 4) of links, world
    chains: dict[str, list[int]] = field(default_factory=dict)  # nodes of a link, outwards
    hubs: dict[str, tuple[Spot, Spot, Array]] = field(default_factory=dict)  # by joint, with axis

    def nearest(self, link: str, place: Array) -> int:
        """Return the node of a link that is nearest to a place."""
        nodes = self.chains[link]
        gaps = [np.linalg.norm(self.structure.nodes[n] - place) for n in nodes]
        return nodes[int(np.argmin(gaps))]

    def place(self, link: str, at_m: Array) -> Array:
        """Return a place of a link's frame in the world; of the ground for the link ""."""
        if not link:
            return np.asarray(at_m)
        T = self.poses[link]
        return np.asarray(T[:3, :3] @ at_m + T[:3, 3])

    def spot(self, link: str, at_m: Array) -> Spot:
        """Return the spot of a place in a link's frame."""
        if not link:
            return Spot(node=-1, arm_m=np.zeros(3))
        place = self.place(link, at_m)
        return self.structure.spot_at(self.nearest(link, place), place)

    def point(self, point: str) -> tuple[Spot, Array]:
        """Return the spot of a point, and the axes of a sensor there, world."""
        found = next(p for p in shell_points(self.parts.table) if p.id == point)
        at = self.parts.position_m.get(point, found.position_m)
        return self.spot(found.link, at), self.poses[found.link][:3, :3] @ found.R_link_sensor

    def turns_before(self, joint: str, law: float) -> Array:
        """Return the (3, 3) turning compliance of what a joint stands on, world axes.

        `law`: what a unit loss factor adds to a unit stiffness.
        """
        stiffness, lost = self.structure.stiffness()
        before, _, _ = self.hubs[joint]
        T = self.structure.motion(before)[3:]
        return np.asarray(T @ np.linalg.solve(stiffness + law * lost, T.T))

    def turn(self, joint: str) -> Array:
        """Return the (n,) vector of a joint's relative turn."""
        first, second, axis = self.hubs[joint]
        rows, B = self.structure.between(first, second)
        vector = np.zeros(self.structure.size)
        vector[rows] = axis @ B[3:]
        return vector


def stand(parts: Parts, joints_rad: Array) -> Standing:
    """Build the structure where the controller tells `joints_rad`."""
    made = Standing(parts=parts)
    structure = made.structure
    plate = structure.node(np.zeros(3))
    ground = Spot(node=-1, arm_m=np.zeros(3))
    structure.spring(ground, structure.spot_at(plate, np.zeros(3)), parts.plate, parts.plate_loss)
    made.poses["base"] = np.eye(4)
    base = np.array(parts.table.base_shell.path)
    _shell(made, "base", base, parts.sections["base"], np.eye(4), plate)
    structure.lump(plate, parts.table.base, np.eye(3), np.zeros(3))
    T, before = np.eye(4), "base"
    for row, body, told in zip(parts.table.links, parts.bodies, joints_rad, strict=True):
        frame, turn = np.eye(4), np.eye(4)
        frame[:3, :3], frame[:3, 3] = rotation(row.rpy_rad), row.xyz_m
        angle = float(told) + parts.offsets_rad.get(row.joint, 0.0)
        turn[:3, :3] = rotation((0.0, 0.0, angle))
        T = T @ frame @ turn
        made.poses[row.link] = T
        _link(made, row, body, made.chains[before][-1])
        before = row.link
    for link, extra in parts.added:
        pose, place = made.poses[link], made.place(link, np.array(extra.center_m))
        structure.lump(made.nearest(link, place), extra, pose[:3, :3], pose[:3, 3])
    for span in parts.last:
        span(made)
    for joint, drive in parts.drives.items():
        vector = made.turn(joint)
        law = drive.law if drive.braked_law is None or not parts.braked else drive.braked_law
        structure.laws.append((vector, law))
        if drive.rotor_kg_m2:
            structure.turning.append((vector, drive.rotor_kg_m2))
    return made


def _link(made: Standing, row: LinkRow, body: Inertial, before: int) -> None:
    """Joint, shell and remaining mass of a link."""
    parts, structure, T = made.parts, made.structure, made.poses[row.link]
    drive = parts.drives[row.joint]
    path = np.array(row.shell.path)
    hub = T[:3, :3] @ path[0] + T[:3, 3]
    first = structure.node(hub, before, jointed=True)
    ends = structure.spot_at(before, hub), structure.spot_at(first, hub)
    made.hubs[row.joint] = (*ends, T[:3, 2])
    R = np.kron(np.eye(2), T[:3, :3])
    shift = [drive.shift_n_per_m] * 3
    across = R @ np.diag([*shift, *drive.tilt, 0.0]) @ R.T
    structure.spring(*ends, across, drive.tilt_loss)
    turning = R @ np.diag([0.0, 0.0, 0.0, 0.0, 0.0, drive.stiffness]) @ R.T
    structure.spring(*ends, turning)
    section, left = _parted(parts.sections[row.link], row, body)
    hinge = parts.hinges.get(row.link)
    _shell(made, row.link, path, section, T, first, hinge)
    center = made.place(row.link, np.array(left.center_m))
    structure.lump(made.nearest(row.link, center), left, T[:3, :3], T[:3, 3])


def _shell(
    made: Standing,
    link: str,
    path: Array,
    section: Section,
    T: Array,
    first: int,
    hinge: Hinge | None = None,
) -> None:
    """Beams along a shell, with a hinge in it where there is one."""
    structure, chain = made.structure, [first]
    made.chains[link] = chain
    x, y, z = (T[:3, :3] @ section.width).tolist()
    section = replace(section, width=(x, y, z))
    places = _places(path, None if hinge is None else hinge.part)
    for before, place in pairwise(places):
        at = T[:3, :3] @ place + T[:3, 3]
        if hinge is not None and np.allclose(place, before):
            second = structure.node(at, chain[-1], jointed=True)
            _give(made, chain[-1], second, hinge, T)
        else:
            second = structure.node(at, chain[-1])
            structure.beam(section, chain[-1], second, made.parts.beam_loss)
        chain.append(second)


def _places(path: Array, part: float | None) -> list[Array]:
    """Nodes along a path; one twice over where a hinge is."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    marks = [a + (b - a) * i / PIECES for a, b in pairwise(ends) for i in range(PIECES)]
    marks.append(ends[-1])
    if part is not None:
        nearest = int(np.argmin(np.abs(np.array(marks[1:-1]) - part * ends[-1]))) + 1
        marks.insert(nearest, marks[nearest])
    xyz = [np.interp(marks, ends, path[:, i]) for i in range(3)]
    return list(np.column_stack(xyz))


def _give(made: Standing, first: int, second: int, hinge: Hinge, T: Array) -> None:
    """A six-way spring about the hinge's point, soft about its direction alone."""
    structure, R = made.structure, T[:3, :3]
    point, direction = R @ hinge.point_m + T[:3, 3], R @ hinge.direction
    held = RIGID / hinge.compliance / 10.0
    along_it = np.outer(direction, direction)
    stiffness = np.zeros((6, 6))
    stiffness[:3, :3] = held / 0.01 * np.eye(3)  # a tenth of a metre of lever
    stiffness[3:, 3:] = held * (np.eye(3) - along_it) + along_it / hinge.compliance
    ends = structure.spot_at(first, point), structure.spot_at(second, point)
    structure.spring(*ends, stiffness, hinge.loss)


def _parted(section: Section, row: LinkRow, body: Inertial) -> tuple[Section, Inertial]:
    """The shell with as much of the mass as a body can give up, and the rest as a lump."""
    whole, center = body.matrix(), np.array(body.center_m)
    path = np.array(row.shell.path)
    weight = section.density_kg_m3 * section.area_m2
    length = float(np.sum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    part = min(1.0, BEAM_PART * body.mass_kg / (weight * length))
    for _ in range(20):
        lighter = replace(section, density_kg_m3=section.density_kg_m3 * part)
        mass, first, second = _moments(path, lighter)
        left = body.mass_kg - mass
        # Second moments of mass about the frame's origin add up.
        own = 0.5 * np.trace(whole) * np.eye(3) - whole
        rest = own + body.mass_kg * np.outer(center, center) - second
        at = (body.mass_kg * center - first) / left
        rest = rest - left * np.outer(at, at)
        if np.linalg.eigvalsh(rest)[0] > 0.0:
            return lighter, Inertial.of(left, at, np.trace(rest) * np.eye(3) - rest)
        part *= 0.6
    none = replace(section, density_kg_m3=0.0)
    return none, body


def _moments(path: Array, section: Section) -> tuple[float, Array, Array]:
    """Mass of a shell, and its first and second moments about the frame's origin."""
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for a, b in pairwise(path):
        L = float(np.linalg.norm(b - a))
        x = (b - a) / L
        m = section.density_kg_m3 * section.area_m2 * L
        middle = 0.5 * (a + b)
        mass += m
        first += m * middle
        second += m * (np.outer(middle, middle) + L**2 / 12.0 * np.outer(x, x))
        ring = 0.5 * section.torsion_m4 / section.area_m2  # turning inertia alone, about x
        second += m * ring * (np.eye(3) - np.outer(x, x))
    return mass, first, second


def middle_of(row: LinkRow, part: float) -> Array:
    """Return a place on a link's shell line, link frame."""
    return along(row.shell, part)[0]
