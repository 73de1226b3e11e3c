"""The simulated arm: the chain of bodies, springs and test points that a plant file describes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil_sim.newton_euler import Body, Chain
from hil_sim.plant_file import LinkTruth, PlantFile, load_plant_file
from protocols.arrays import frozen_array
from protocols.errors import PlantError

__all__ = ["BASE", "Plant", "PlantPoint", "load_plant"]

Array = npt.NDArray[np.float64]

BASE = -1  # body index of what stands on the floor


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

    The chain has one hinge per joint and one more for the hidden axis, just after the joint whose
    link it weakens. Only the hinges in `springs` give way; the others are rigid while held.
    """

    truth: PlantFile
    chain: Chain
    joints: tuple[int, ...]  # hinge of each joint, base outwards
    hidden: int | None  # hinge of the hidden axis
    springs: tuple[int, ...]  # hinges that give way
    stiffness: Array  # (n_springs,) N m / rad
    damping: Array  # (n_springs,) N m s / rad
    points: dict[str, PlantPoint]

    def hinge_angles(self, joints_rad: npt.ArrayLike) -> Array:
        """Hinge angles (n,) of a posture given as joint angles (n_joints,), springs at rest."""
        joints = np.asarray(joints_rad, dtype=np.float64)
        if joints.shape != (len(self.joints),) or not np.all(np.isfinite(joints)):
            raise PlantError(
                f"a posture of {self.truth.name} is {len(self.joints)} finite joint angles in rad, "
                f"got {joints_rad!r}"
            )
        q = np.zeros(self.chain.n)
        q[list(self.joints)] = joints
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


def load_plant(name_or_path: str | Path) -> Plant:
    """Build the plant from a file, or from a shipped one by name such as "rv4frl".

    Raises
    ------
    PlantError
        If the file cannot be used; the message names the key.
    """
    shipped = Path(__file__).parent / "plants" / f"{name_or_path}.toml"
    is_name = isinstance(name_or_path, str) and "/" not in name_or_path
    path = shipped if is_name and shipped.is_file() else Path(name_or_path)
    return build_plant(load_plant_file(path))


def build_plant(truth: PlantFile) -> Plant:
    """Build the plant that a plant file describes."""
    bodies: list[Body] = []
    joints: list[int] = []
    springs: list[tuple[int, float, float]] = []
    carrier: dict[str, int] = {"base": BASE}
    hidden: int | None = None
    weak = truth.hidden_axis
    for link in truth.links:
        joints.append(len(bodies))
        if link.stiffness_n_m_per_rad is not None and link.damping_n_m_s_per_rad is not None:
            springs.append((len(bodies), link.stiffness_n_m_per_rad, link.damping_n_m_s_per_rad))
        if weak is not None and weak.link == link.name:
            bodies.append(_massless(link))
            hidden = len(bodies)
            springs.append((hidden, weak.stiffness_n_m_per_rad, weak.damping_n_m_s_per_rad))
            direction = np.array(weak.direction)
            bodies.append(
                _body(
                    link,
                    name=f"{link.name} beyond the hidden axis",
                    origin_m=np.zeros(3),
                    hinge_m=np.array(weak.point_m),
                    axis=direction / np.linalg.norm(direction),
                )
            )
        else:
            bodies.append(
                _body(
                    link,
                    name=link.name,
                    origin_m=np.array(link.origin_m),
                    hinge_m=np.zeros(3),
                    axis=np.array(link.axis),
                )
            )
        carrier[link.name] = len(bodies) - 1
    points = {
        point.id: PlantPoint(
            id=point.id,
            link=point.link,
            body=carrier[point.link],
            position_m=frozen_array(point.position_m, np.float64),
            R_link_sensor=frozen_array(
                np.column_stack((point.x_axis, np.cross(point.normal, point.x_axis), point.normal)),
                np.float64,
            ),
        )
        for point in truth.points
    }
    return Plant(
        truth=truth,
        chain=Chain(bodies=tuple(bodies), gravity_m_s2=np.array(truth.gravity_m_s2)),
        joints=tuple(joints),
        hidden=hidden,
        springs=tuple(hinge for hinge, _, _ in springs),
        stiffness=frozen_array([k for _, k, _ in springs], np.float64),
        damping=frozen_array([c for _, _, c in springs], np.float64),
        points=points,
    )


def _body(link: LinkTruth, *, name: str, origin_m: Array, hinge_m: Array, axis: Array) -> Body:
    """The link's mass behind a hinge."""
    return Body(
        name=name,
        origin_m=origin_m,
        R_parent_body=np.eye(3),
        hinge_m=hinge_m,
        axis=axis,
        mass_kg=link.mass_kg,
        center_m=np.array(link.center_m),
        inertia_kg_m2=link.inertia_matrix(),
    )


def _massless(link: LinkTruth) -> Body:
    """The joint's side of a link that a hidden axis divides: it carries no mass."""
    return Body(
        name=link.name,
        origin_m=np.array(link.origin_m),
        R_parent_body=np.eye(3),
        hinge_m=np.zeros(3),
        axis=np.array(link.axis),
        mass_kg=0.0,
        center_m=np.zeros(3),
        inertia_kg_m2=np.zeros((3, 3)),
    )
