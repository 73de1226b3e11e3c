"""What every hypothesis holds: the arm as believed, and every ordinary error with its prior.

A model without these is refuted by any real arm, and then any effect that bends it a little looks
like a discovery. So the null has them all, as wide as the arm file's tolerances say and no wider:
masses, centres and inertias of links, encoder offsets, the aim of the hits and their place, places
and gains of sensors, a small delay, a little hysteresis, and whatever gives way beside the drives.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.assembly import (
    Assembly,
    rate_name,
    relaxing_name,
    spatial_inertia,
)
from armodal.analyzer.gap.model.base_body import add_base_body, base_body_parameters
from armodal.analyzer.gap.model.geometry import PostureGeometry, across, skew
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.priors import (
    BEARING_LIMIT,
    DELAY_STD_S,
    FARTHEST,
    FLOOR_LIMIT,
    JOINT_LOSS_LIMIT,
    JOINT_LOSS_MEAN,
    JOINT_LOSS_STD,
    LEAST_LN_C_STD,
    LEAST_LN_K_STD,
    LOSS_POWER_MEAN,
    LOSS_POWER_STD,
    PLACE_STD_M,
    RELAXING_MOST_LN_RATE,
    RELAXING_STD_LN_RATE,
)
from armodal.analyzer.gap.model.scales import compliance, doubt, scale
from armodal.analyzer.gap.model.soft_parts import add_soft_parts, base_lever_m, soft_part_parameters
from armodal.analyzer.gap.model.space import Parameter
from armodal.protocols.arm.records import Arm, Estimate

__all__ = ["LOSS_POWER", "Ordinary"]

LOSS_POWER = "power of losses"  # of all drives: an arm's are alike

Array = npt.NDArray[np.float64]

_UPRIGHT = 0.99  # cosine between an axis and gravity


@dataclass(frozen=True, slots=True, kw_only=True)
class Ordinary:
    """The arm as believed, with its ordinary errors."""

    superset: Superset
    # The arm with its drives as a first fit has them: ordinary compliances are parts of theirs.
    fitted: Superset | None = None
    postures: tuple[str, ...]
    hit_points: tuple[str, ...] = ()  # those that are hit
    one_is_hit: bool = False  # in a posture, while the sensor goes round
    levels_hit: bool = False  # whether every point was hit softly and hard
    hits_between: bool = False  # likewise, and once between in some session
    # ln of hard over soft hits' force, halved, where they are told apart; else zero.
    level_span: float = 0.0
    # Of each joint, where they are: turn under a hit of the middle level, rad; rate over it, rad/s.
    swings: tuple[tuple[str, float, float], ...] = ()

    @property
    def arm(self) -> Arm:
        """Return the arm."""
        return self.superset.arm

    @property
    def elastic(self) -> tuple[int, ...]:
        """Return the joints with a spring, 0-based."""
        return tuple(i for i, joint in enumerate(self.arm.joints) if joint.stiffness is not None)

    @property
    def compliance(self) -> float:
        """Return the arm's own compliance, rad/(N m) (`scales.compliance`)."""
        return compliance(self.sized)

    def scale(self, joint: int) -> float:
        """Return what a joint's drive gives way by, or would, rad/(N m) (`scales.scale`)."""
        return scale(self.sized, joint)

    def drives(self, joint: int | None = None) -> tuple[tuple[str, float], ...]:
        """Return ln k, name and value, of the drives that `scale` is of, or `compliance`."""
        told = self.elastic
        if joint is None:
            told = told[:3]
        elif joint in told:
            told = (joint,)
        own = [(self.sized.arm.joints[i].name, scale(self.sized, i)) for i in told]
        return tuple((f"ln k {name}", -float(np.log(yields))) for name, yields in own)

    def beside_drives(self, values: Mapping[str, float]) -> Ordinary:
        """Return it with what gives way beside the drives as parts of what those are.

        A data sheet's stiffness is off by a third or by a factor, and a sound bearing goes with the
        drive that is built in.

        Parameters
        ----------
        values
            Of a fit: ln k of every elastic joint.
        """
        joints = tuple(
            joint
            if joint.stiffness is None
            else replace(
                joint,
                stiffness=replace(
                    joint.stiffness, value=float(np.exp(values[f"ln k {joint.name}"]))
                ),
            )
            for joint in self.arm.joints
        )
        return replace(self, fitted=Superset(replace(self.arm, joints=joints)))

    def stiffness(self, joint: str) -> float:
        """Return the stiffness of an elastic joint as `scale` has it, N m/rad."""
        found = next(own.stiffness for own in self.sized.arm.joints if own.name == joint)
        if found is None:
            raise ValueError(f"wanted an elastic joint, got '{joint}'")
        return found.value

    def bearing_limit(self, joint: int) -> float:
        """Return the largest transverse compliance of a sound joint, rad/(N m)."""
        return doubt(self.sized, joint) * BEARING_LIMIT * self.scale(joint)

    @property
    def floor_limit(self) -> float:
        """Return the largest rocking compliance of a base that stands firm, rad/(N m)."""
        return FLOOR_LIMIT * self.compliance

    @property
    def base_lever_m(self) -> float:
        """Return the root of how much a base rocks over how much it shifts under unit loads."""
        return base_lever_m(self.superset)

    @property
    def sized(self) -> Superset:
        """Return the arm whose drives ordinary compliances are parts of."""
        return self.fitted or self.superset

    def parameters(self) -> tuple[Parameter, ...]:
        """Return every parameter with its prior."""
        return _parameters(self)

    def encoder(self, values: Mapping[str, float]) -> Array:
        """Return (n_joints,) what the arm's angles are beyond what was read."""
        return np.array([values[f"encoder {joint.name}"] for joint in self.arm.joints])

    def link_inertias(self, links: Sequence[int], z: Array) -> tuple[Array, Array]:
        """Return (k, 6, 6) inertias and (k, 4) masses with first moments of k links.

        `z` (k, 10): ln of the relative mass, shift of the centre in m, six relative entries of the
        tensor. As a logarithm, because FRFs tell masses, stiffnesses and damping only up to one
        factor, a gain's: in logarithms all of that is one straight line, along which a fit can go.
        """
        bodies = [self.arm.joints[link].link for link in links]
        relative = np.exp(z[:, 0])
        mass = np.array([body.mass_kg for body in bodies]) * relative
        center = np.array([body.center_m for body in bodies]) + z[:, 1:4]
        own = np.array([body.inertia_kg_m2 for body in bodies])
        diagonal = own.diagonal(axis1=1, axis2=2)
        size = np.sqrt(diagonal[:, :, None] * diagonal[:, None, :])
        inertia = (own + size * z[:, 4:][:, _FULL]) * relative[:, None, None]
        moments = mass[:, None] * np.concatenate([np.ones((len(z), 1)), center], axis=1)
        return spatial_inertia(mass, center, inertia), moments

    @property
    def loaded(self) -> tuple[int, ...]:
        """Return the elastic joints that weight can load: all from the first not upright."""
        gravity = self.arm.gravity_m_s2
        R, upright = np.eye(3), 0
        for joint in self.arm.joints:
            R = R @ joint.T_parent_joint[:3, :3]
            if abs(gravity @ R @ joint.axis) <= _UPRIGHT * np.linalg.norm(gravity):
                break
            upright += 1
        return tuple(i for i in self.elastic if i >= upright and gravity.any())

    def inertia_names(self, link: int) -> tuple[str, ...]:
        """Return the names of a link's ten inertial parameters."""
        return tuple(f"{what} {self.arm.joints[link].link.name}" for what in _INERTIAL)

    def sensor(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return the sensor's gains (3,) and what its axes see of its mount's (3, 3)."""
        gains = np.exp([values[f"ln gain {a}"] for a in "xyz"])
        return gains, np.eye(3) + skew(np.array([values[f"tilt {a}"] for a in "xyz"]))

    def place_names(self, point: str) -> tuple[str, ...]:
        """Return the names by which a point's sensor stands off along its axes."""
        return tuple(f"place {axis} {point}" for axis in "xyz")

    def hit_place_names(self, point: str) -> tuple[str, ...]:
        """Return the names by which hits at a point fall off it, all alike."""
        return tuple(f"hit place {axis} {point}" for axis in "xyz")

    def _places(self, values: Mapping[str, float]) -> Array:
        names = [self.place_names(point.id) for point in self.arm.points]
        return np.array([[values[name] for name in of_point] for of_point in names])

    def assemblies(
        self,
        geometries: Sequence[PostureGeometry],
        lines: Sequence[PostureLines],
        values: Mapping[str, float],
    ) -> list[Assembly]:
        """Begin the equations of postures."""
        alike = self._alike(geometries[0], lines[0], values)
        return [
            self._posed(alike, geometry, own, values)
            for geometry, own in zip(geometries, lines, strict=True)
        ]

    def _alike(
        self, geometry: PostureGeometry, lines: PostureLines, values: Mapping[str, float]
    ) -> Assembly:
        """What is the same in every posture."""
        assembly = Assembly(geometry=geometry, lines=lines)
        arm, superset = self.arm, self.superset
        every = range(len(arm.joints))
        z = np.array([[values[name] for name in self.inertia_names(i)] for i in every])
        inertias, moments = self.link_inertias(every, z)
        assembly.link_inertia += list(inertias)
        assembly.link_moments += list(moments)
        for i, joint in enumerate(arm.joints):
            column = assembly.unit(superset.joint_column(i))
            if joint.stiffness is not None:
                k, c = (float(np.exp(values[f"ln {what} {joint.name}"])) for what in "kc")
                assembly.add_drive(joint.name, column, k, c, values)
        assembly.loss_power = values[LOSS_POWER]
        add_soft_parts(assembly, superset, values)
        add_base_body(assembly, superset, values)
        assembly.log_scale = -values["ln hammer"]
        assembly.delay_s = values["delay"]
        return assembly

    def _posed(
        self,
        alike: Assembly,
        geometry: PostureGeometry,
        lines: PostureLines,
        values: Mapping[str, float],
    ) -> Assembly:
        """What every posture has, and what this one has of its own."""
        assembly = alike.copied()
        assembly.geometry, assembly.lines = geometry, lines
        if lines.known_mass is not None:
            body = lines.known_mass
            link = [joint.link.name for joint in self.arm.joints].index(body.link)
            assembly.add_body(link, body.mass_kg, body.center_m, np.zeros((3, 3)))
        assembly.place_m = self._places(values)[lines.sensor_point]
        gains, turned = self.sensor(values)
        assembly.mix = np.broadcast_to(gains[:, None] * turned, (len(lines.sensor_point), 3, 3))
        # A test that is only thought of may hit points that no session did.
        hit = [self.hit_place_names(self.arm.points[at].id) for at in lines.hit_point]
        places = [[values.get(name, 0.0) for name in names] for names in hit]
        assembly.hit_place_m = np.array(places).reshape(-1, 3)
        if len(lines.hit_point) == 1:
            aim = np.array([values[f"aim {side} {lines.name}"] for side in "ab"])
            direction = lines.hit_direction[0]
            assembly.force = (direction + across(direction) @ aim)[None]
        return assembly


_FULL = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])  # of xx, xy, xz, yy, yz, zz
_CENTER = ("cx", "cy", "cz")
_INERTIAL = ("ln mass", *_CENTER, "ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@lru_cache(maxsize=16)  # asked for with every fit
def _parameters(ordinary: Ordinary) -> tuple[Parameter, ...]:
    arm, tolerances = ordinary.arm, ordinary.arm.tolerances
    found: list[Parameter] = []
    for i in ordinary.elastic:
        joint = arm.joints[i]
        found.append(_log(f"ln k {joint.name}", joint.stiffness, LEAST_LN_K_STD))
        found.append(_log(f"ln c {joint.name}", joint.damping, LEAST_LN_C_STD))
    loss = Parameter(
        name="",
        unit="",
        mean=JOINT_LOSS_MEAN,
        std=JOINT_LOSS_STD,
        low=0.0,
        high=JOINT_LOSS_LIMIT,
    )
    elastic = [arm.joints[i].name for i in ordinary.elastic]
    found += [replace(loss, name=f"loss {joint}") for joint in elastic]
    found += [replace(loss, name=relaxing_name(joint)) for joint in elastic]
    found += [
        Parameter(
            name=rate_name(joint),
            unit="",
            mean=0.0,
            std=RELAXING_STD_LN_RATE,
            low=-RELAXING_MOST_LN_RATE,
            high=RELAXING_MOST_LN_RATE,
        )
        for joint in elastic
    ]
    found.append(
        Parameter(
            name=LOSS_POWER,
            unit="",
            mean=LOSS_POWER_MEAN,
            std=LOSS_POWER_STD,
            low=0.0,
            high=1.0,
        )
    )
    found += soft_part_parameters(ordinary.sized)
    # The lever is the plate's radius over root 2.
    found += base_body_parameters(ordinary.superset, float(np.sqrt(2.0)) * ordinary.base_lever_m)
    for joint in arm.joints:
        link = joint.link.name
        own = arm.inertial_std(joint)
        std = (own.mass, *(own.center_m,) * 3, *(own.inertia,) * 6)
        found += [
            Parameter(name=f"{what} {link}", unit="m" if what in _CENTER else "", mean=0.0, std=s)
            for what, s in zip(_INERTIAL, std, strict=True)
        ]
        found.append(
            Parameter(
                name=f"encoder {joint.name}",
                unit="rad",
                mean=0.0,
                std=tolerances.encoder_offset_rad,
            )
        )
    found += [
        Parameter(name=f"ln gain {a}", unit="", mean=0.0, std=tolerances.sensor_gain) for a in "xyz"
    ]
    # Of the sensor in its mount, at every point alike; each mounting has its own beside.
    found += [
        Parameter(name=f"tilt {a}", unit="rad", mean=0.0, std=tolerances.sensor_tilt_rad)
        for a in "xyz"
    ]
    found.append(Parameter(name="ln hammer", unit="", mean=0.0, std=tolerances.hammer_gain))
    found.append(Parameter(name="delay", unit="s", mean=0.0, std=DELAY_STD_S))
    found += [
        Parameter(name=name, unit="m", mean=0.0, std=PLACE_STD_M)
        for point in arm.points
        for name in ordinary.place_names(point.id)
    ]
    found += [
        Parameter(name=name, unit="m", mean=0.0, std=PLACE_STD_M)
        for point in ordinary.hit_points
        for name in ordinary.hit_place_names(point)
    ]
    for name in ordinary.postures:
        found += [
            Parameter(
                name=f"aim {side} {name}",
                unit="rad",
                mean=0.0,
                std=tolerances.hit_direction_rad,
            )
            for side in "ab"
        ]
    # An error that nobody would call ordinary any more is not tried: it only misleads.
    return tuple(replace(p, farthest=FARTHEST) for p in found)


def _log(name: str, believed: Estimate | None, least: float) -> Parameter:
    """A positive quantity as its logarithm; the file's own uncertainty, but not below `least`."""
    value = 1.0 if believed is None or believed.value <= 0.0 else believed.value
    relative = 1.0 if believed is None else believed.std / value
    return Parameter(name=name, unit="", mean=float(np.log(value)), std=max(relative, least))
