"""The simulated arm: the chain of bodies, springs and test points that a plant file describes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.assembly import Assembly, Segment, Spring
from armodal.hil_sim.newton_euler import Body, Chain
from armodal.hil_sim.plant_file import HiddenAxisTruth, PlantFile, load_plant_file
from armodal.hil_sim.sensing import Sensing
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import PlantError

__all__ = ["BASE", "Plant", "PlantPoint", "build_plant", "load_plant", "shipped_plants"]

Array = npt.NDArray[np.float64]

BASE = -1  # body index of what stands on the floor
HIDDEN = "hidden axis"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantPoint:
    """A test point on a body of the chain (`BASE` for the base)."""

    id: str
    link: str
    body: int
    position_m: Array  # (3,) link frame
    R_link_sensor: Array  # (3, 3), columns are the axes of a sensor mounted without error


@dataclass(frozen=True, slots=True, kw_only=True)
class Plant:
    """The arm as it truly is.

    The chain has one hinge per joint and more for what effects release, such as the hidden axis
    just after the joint whose link it weakens. Only the hinges in `springs` give way; the others
    are rigid while held. Coordinates are these hinges, then the effects' own.
    """

    truth: PlantFile
    chain: Chain
    joints: tuple[int, ...]  # hinge of each joint, base outwards
    hidden: int | None  # hinge of the hidden axis
    springs: tuple[int, ...]  # hinges that give way
    stiffness: Array  # (n_springs,) N m / rad
    damping: Array  # (n_springs,) N m s / rad
    points: dict[str, PlantPoint]
    bodies: dict[str, int]  # hinge name -> body; a joint's hinge is called as the joint
    carrier: dict[str, str]  # link -> name of its far end's hinge
    coordinates: tuple[str, ...]  # hinges that give way, then degrees of freedom of effects
    sensing: Sensing

    def hinge_angles(self, joints_rad: npt.ArrayLike) -> Array:
        """Hinge angles (n,) of a posture as the encoders read it (n_joints,), springs at rest."""
        joints = np.asarray(joints_rad, dtype=np.float64)
        if joints.shape != (len(self.joints),) or not np.all(np.isfinite(joints)):
            raise PlantError(
                f"a posture of {self.truth.name} is {len(self.joints)} finite joint angles in rad, "
                f"got {joints_rad!r}"
            )
        q = np.zeros(self.chain.n)
        offsets = self.sensing.encoder_rad
        q[list(self.joints)] = joints - [offsets.get(link.joint, 0.0) for link in self.truth.links]
        return q

    def point(self, point_id: str) -> PlantPoint:
        """Return the test point called `point_id`."""
        try:
            return self.points[point_id]
        except KeyError:
            known = ", ".join(self.points)
            raise PlantError(
                f"no test point {point_id!r} on {self.truth.name}; it has {known}"
            ) from None


PLANTS_DIRECTORY = Path(__file__).parent / "plants"


def shipped_plants() -> tuple[str, ...]:
    """Return the names of the plants that come with armodal."""
    return tuple(sorted(path.stem for path in PLANTS_DIRECTORY.glob("*.toml")))


def load_plant(name_or_path: str | Path) -> Plant:
    """Build the plant from a file, or from a shipped one by name such as "rv4frl".

    Raises
    ------
    PlantError
        If the file cannot be used; the message names the key.
    """
    path = Path(name_or_path)
    if isinstance(name_or_path, str) and "/" not in name_or_path and path.suffix != ".toml":
        if name_or_path not in shipped_plants():
            raise PlantError(
                f"plant {name_or_path!r}: wanted a path to a plant file or one of the shipped "
                f"plants {', '.join(shipped_plants())}; an arm file is simulated with "
                "armodal sim --arm"
            )
        path = PLANTS_DIRECTORY / f"{name_or_path}.toml"
    return build_plant(load_plant_file(path))


def build_plant(truth: PlantFile) -> Plant:
    """Build the plant that a plant file describes.

    Raises
    ------
    PlantError
        If an effect names a link, joint or point that the arm has not.
    """
    assembly = _hidden(_bare(truth), truth.hidden_axis)
    sensing = Sensing()
    for effect in truth.effects:
        assembly = effect.assemble(assembly)
        sensing = effect.sense(sensing)
    _check_names(truth, assembly, sensing)
    carrier = dict(assembly.carrier)
    bodies = {segment.label: i for i, segment in enumerate(assembly.segments)}
    springs = [
        (i, segment.spring)
        for i, segment in enumerate(assembly.segments)
        if segment.spring is not None
    ]
    own = tuple(name for effect in truth.effects for name in effect.coordinates())
    coordinates = (*(assembly.segments[i].label for i, _ in springs), *own)
    if len(set(coordinates)) != len(coordinates):
        raise PlantError(
            f"effects: the degrees of freedom {', '.join(coordinates)} must all differ; put one "
            "effect of a kind at a place"
        )
    points = {
        point.id: PlantPoint(
            id=point.id,
            link=point.link,
            body=bodies.get(assembly.perch.get(point.id) or carrier.get(point.link, ""), BASE),
            position_m=frozen_array(
                np.array(point.position_m) + sensing.moved.get(point.id, 0.0), np.float64
            ),
            R_link_sensor=frozen_array(
                np.column_stack((point.x_axis, np.cross(point.normal, point.x_axis), point.normal)),
                np.float64,
            ),
        )
        for point in truth.points
    }
    return Plant(
        truth=truth,
        chain=Chain(
            bodies=tuple(segment.body for segment in assembly.segments),
            gravity_m_s2=np.array(truth.gravity_m_s2),
        ),
        joints=tuple(bodies[link.joint] for link in truth.links),
        hidden=bodies.get(HIDDEN),
        springs=tuple(hinge for hinge, _ in springs),
        stiffness=frozen_array([spring.k for _, spring in springs], np.float64),
        damping=frozen_array([spring.c for _, spring in springs], np.float64),
        points=points,
        bodies=bodies,
        carrier=carrier,
        coordinates=coordinates,
        sensing=sensing,
    )


def _bare(truth: PlantFile) -> Assembly:
    """Joints and links alone."""
    segments = []
    for link in truth.links:
        k, c = link.stiffness_n_m_per_rad, link.damping_n_m_s_per_rad
        body = Body(
            name=link.name,
            origin_m=np.array(link.origin_m),
            R_parent_body=np.eye(3),
            hinge_m=np.zeros(3),
            axis=np.array(link.axis),
            mass_kg=link.mass_kg,
            center_m=np.array(link.center_m),
            inertia_kg_m2=link.inertia_matrix(),
        )
        spring = None if k is None or c is None else Spring(k=k, c=c)
        segments.append(Segment(label=link.joint, body=body, spring=spring, is_joint=True))
    return Assembly(
        segments=tuple(segments),
        carrier={link.name: link.joint for link in truth.links},
        points={point.id: (point.link, np.array(point.position_m)) for point in truth.points},
    )


def _hidden(assembly: Assembly, weak: HiddenAxisTruth | None) -> Assembly:
    """All the mass of the weakened link behind the hidden axis."""
    if weak is None:
        return assembly
    return assembly.split(
        assembly.carrier_of(weak.link).label,
        HIDDEN,
        hinge_m=np.array(weak.point_m),
        axis=np.array(weak.direction),
        spring=Spring(k=weak.stiffness_n_m_per_rad, c=weak.damping_n_m_s_per_rad),
    )


def _check_names(truth: PlantFile, assembly: Assembly, sensing: Sensing) -> None:
    joints = [link.joint for link in truth.links]
    named = (*sensing.at_point, *sensing.moved, *sensing.stands_at, *assembly.perch)
    for point in named:
        if point not in assembly.points:
            raise PlantError(
                f"effects: no test point is called {point!r}; wanted one of "
                f"{', '.join(assembly.points)}; correct the plant file"
            )
    for joint in sensing.encoder_rad:
        if joint not in joints:
            raise PlantError(
                f"effects: no joint is called {joint!r}; wanted one of {', '.join(joints)}; "
                "correct the plant file"
            )
