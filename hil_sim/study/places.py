"""Where effects can sit on an arm, and how large an effect of the arm's own measure is."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.effects.hidden import unit
from armodal.hil_sim.newton_euler import gravity_torque, mass_matrix
from armodal.hil_sim.small_motion import force_torque, linearise
from armodal.hil_sim.study.arms import StudyArm
from armodal.hil_sim.study.model_error import Tables, plant_of_tables
from armodal.hil_sim.study.plant_of_arm import rotations
from armodal.protocols.errors import PlantError

__all__ = ["ArmPlaces"]

Array = npt.NDArray[np.float64]


@dataclass(slots=True)
class ArmPlaces:
    """The erring arm, by links and joints, in the plant's frames."""

    study: StudyArm
    tables: Tables
    links: dict[str, Tables] = field(init=False)
    joints: dict[str, Tables] = field(init=False)
    points: dict[str, list[Tables]] = field(init=False)
    rotation: dict[str, Array] = field(init=False)

    def __post_init__(self) -> None:
        self.links = {link["name"]: link for link in self.tables["links"]}
        self.joints = {link["joint"]: link for link in self.tables["links"]}
        self.points = {}
        for point in self.tables["points"]:
            self.points.setdefault(point["link"], []).append(point)
        self.rotation = rotations(self.study.arm)

    @property
    def compliance(self) -> float:
        """The arm's own measure of compliance, rad / N m."""
        return self.study.joint_compliance

    @property
    def elastic(self) -> list[str]:
        """Joints that the arm file gives a stiffness."""
        return [n for n, link in self.joints.items() if link["stiffness_n_m_per_rad"] is not None]

    @property
    def rigid(self) -> list[str]:
        """Joints that the arm file calls rigid."""
        return [name for name in self.joints if name not in self.elastic]

    def structural(self) -> list[str]:
        """Links with two points at least: what bends in them can be seen.

        Raises
        ------
        PlantError
            If no link has two points.
        """
        links = [name for name in self.links if len(self.points.get(name, ())) > 1]
        if not links:
            raise PlantError("wanted a link with two test points, got none")
        return links

    def before(self, link: str) -> str:
        """The link that carries a link's joint."""
        names = ["base", *self.links]
        return names[names.index(link) - 1]

    def main_joint(self, rng: np.random.Generator) -> str:
        """One of the first three joints that give way."""
        return str(rng.choice(self.elastic[:3]))

    def in_file(self, link: str, vector: npt.ArrayLike) -> list[float]:
        """Turn a vector of the plant's link frame into the arm file's."""
        result: list[float] = (self.rotation[link].T @ np.asarray(vector)).tolist()
        return result

    def somewhere(self, rng: np.random.Generator, link: str) -> Array:
        """A place in a link, between its joint and its centre."""
        center = np.array(self.links[link]["center_m"])
        place: Array = center * rng.uniform(0.2, 1.0) + 0.02 * unit(rng)
        return place

    def reach(self, link: str) -> Array:
        """(3,) from a link's joint to the next; of the last, to its centre."""
        names = list(self.links)
        after = names.index(link) + 1
        if after == len(names):
            return np.array(self.links[link]["center_m"])
        return np.array(self.links[names[after]]["origin_m"])

    def tube(self, link: str) -> tuple[Array, Array]:
        """(3,) root and tip of a casting, as whoever marked its points saw it.

        They are spread evenly along that axis of the link's frame along which it is long: it goes
        half a step beyond the first and the last, and lies in their middle. Its root is on the side
        of the joint before.
        """
        marked, along = self._marked(link)
        first, last = marked[:, along].min(), marked[:, along].max()
        half_step = (last - first) / (2.0 * (len(marked) - 1))
        ends = np.tile(marked.mean(axis=0), (2, 1))
        ends[:, along] = first - half_step, last + half_step
        ends = ends @ self.rotation[link].T
        root, tip = sorted(ends, key=lambda end: float(np.linalg.norm(end + self._origin(link))))
        return root, tip

    def _origin(self, link: str) -> Array:
        """(3,) from the joint before to a link's own."""
        return np.array(self.links[link]["origin_m"])

    def longer_than_wide(self, link: str) -> float:
        """By how many m the points of a casting reach farther along it than across."""
        marked, along = self._marked(link)
        spread = np.ptp(marked, axis=0)
        return float(spread[along] - np.delete(spread, along).max())

    def _marked(self, link: str) -> tuple[Array, int]:
        """(n, 3) points in the arm file's frame of the link, and the axis they reach far along."""
        points = [point["position_m"] for point in self.points[link]]
        marked: Array = np.array(points) @ self.rotation[link]
        return marked, int(np.argmax(np.ptp(marked, axis=0)))

    def carried(self, joint: str) -> float:
        """Inertia that a joint carries in the first posture, kg m^2."""
        plant = plant_of_tables(self.tables)
        q = plant.hinge_angles(self.study.plan.postures[0].joints_rad)
        hinge = plant.bodies[joint]
        return float(mass_matrix(plant.chain, q)[hinge, hinge])

    def swing(self, joint: str) -> float:
        """Largest turn of a joint's spring in rad after a hit of middle level, mean of postures."""
        plant = plant_of_tables(self.tables)
        low, high = plant.truth.hand.width_s
        impulse = np.sqrt(np.prod(self.study.peak_n)) * (low + high) / np.pi
        times = np.arange(0.0, 0.4, 1e-3)
        largest = []
        for posture in self.study.plan.postures:
            motion = linearise(plant, posture.joints_rad, None)
            point = plant.point(self.study.plan.fixed_point)
            direction = posture.hit_direction
            if direction is None:
                continue
            torque = force_torque(plant, motion.at, point.body, point.position_m, direction)
            n = len(motion.mass)
            start = np.zeros(len(motion.poles))
            start[n : 2 * n] = np.linalg.solve(motion.mass, torque) * impulse
            row = motion.modes[plant.coordinates.index(joint)] * (motion.inverse_modes @ start)
            turns = (row @ np.exp(np.outer(motion.poles, times))).real
            largest.append(float(np.max(np.abs(turns))))
        return float(np.mean(largest))

    def loads(self, joint: str) -> list[float]:
        """Gravity torque of a joint in each posture, N m."""
        plant = plant_of_tables(self.tables)
        hinge = plant.bodies[joint]
        return [
            float(gravity_torque(plant.chain, plant.hinge_angles(posture.joints_rad))[hinge])
            for posture in self.study.plan.postures
        ]
