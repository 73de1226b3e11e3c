"""Equations of motion of a hypothesis in one posture, put together coordinate by coordinate.

A coordinate is a motion of the superset. One on a *spring* has its stiffness on the diagonal of K;
one with a *compliance* gamma has its equation multiplied by gamma,

    gamma (s^2 M + s C + K) x + (1 + tau s) x = gamma b ,

so that gamma = 0 locks it exactly and the response is smooth there: rigid is a value, not another
model. Frames: superset, linear first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, fields
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import REFERENCE_RAD_S
from armodal.analyzer.gap.model.geometry import PostureGeometry, skew
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.stretch import Stretch

__all__ = [
    "BASE",
    "Assembly",
    "Inside",
    "rate_name",
    "relaxing_name",
    "spatial_inertia",
]

Array = npt.NDArray[np.float64]

BASE = -1  # where a link is asked for


def relaxing_name(joint: str) -> str:
    """Return the name of the loss of a drive's part that relaxes, where it is most."""
    return f"loss relaxing {joint}"


def rate_name(joint: str) -> str:
    """Return the name of the logarithm of where that is, over the reference."""
    return f"ln rate relaxing {joint}"


def spatial_inertia(mass_kg: float | Array, center_m: Array, inertia_kg_m2: Array) -> Array:
    """(..., 6, 6) inertia of bodies about the origin of their frame, linear first.

    Featherstone, Rigid Body Dynamics Algorithms (2008), Eq. (2.63), halves exchanged. Masses
    (...), centres (..., 3) and tensors (..., 3, 3) about the centre.
    """
    cross = skew(center_m)
    mass = np.asarray(mass_kg)[..., None, None]
    result = np.empty((*cross.shape[:-2], 6, 6))
    result[..., :3, :3] = mass * np.eye(3)
    result[..., :3, 3:] = -mass * cross
    result[..., 3:, :3] = mass * cross
    result[..., 3:, 3:] = inertia_kg_m2 - mass * cross @ cross
    return result


@dataclass(frozen=True, slots=True, kw_only=True)
class Inside:
    """How a coordinate inside a link moves what is on that link; what is beyond moves whole."""

    link: int
    points: npt.NDArray[np.int64]  # (k,) that do not move whole
    part: Array  # (k,) of it that each turns by
    shift_m: Array  # (k, 3) to where each turns about, as the hinge is from there; sensor axes
    # Where pieces move in part, as points do; None: the first of them stay, the others move whole.
    stretch: Stretch | None = None
    before: int = 0  # how many stay
    # Parameters that change both, and by what a unit, (q, k) and (q, k, 3); the stretch's own.
    by: tuple[str, ...] = ()
    part_slopes: Array = field(default_factory=lambda: np.zeros((0, 0)))
    shift_slopes_m: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))

    def moved(self, motion: Array, shares: Array) -> Array:
        """Return (..., P, 6) of pieces with shares (P,), by the motion (..., 6) of the link whole.

        In the link's frame.
        """
        if self.stretch is None:
            goes = np.arange(len(shares)) >= self.before
            return np.asarray(np.where(goes[:, None], motion[..., None, :], 0.0))
        part, lever_m, _, _ = self.stretch.of_pieces(shares)
        return self.stretch.turned_about(motion, part, lever_m)

    def moved_slope(self, motion: Array, shares: Array, by: str) -> Array:
        """Return (..., P, 6), by what that changes a unit of a parameter, the motion as it is."""
        if self.stretch is None or by not in self.by:
            return np.zeros((*motion.shape[:-1], len(shares), 6))
        _, _, by_part, by_lever = self.stretch.of_pieces(shares)
        q = self.by.index(by)
        return self.stretch.turned_about(motion, by_part[q], by_lever[q])


@dataclass
class Assembly:
    """A posture being put together; effects add to it.

    What a parameter does a unit, where it stands, is told for most: `compliance_of`,
    `compliance_slopes`, `loss_of`, `loss_factor_of`, `terms_of`, `stretches_of`, `inertia_of` and
    `sensor_mass_of` of terms, `log_slopes` of a joint's spring, `motion_of` of coordinates that
    move otherwise with it, `turns_of` of stretches that do. Those derivatives are known; of
    inertias but for gravity's part, a thousandth.
    """

    geometry: PostureGeometry
    lines: PostureLines
    columns: list[Array] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    compliance: list[float] = field(default_factory=list)
    compliance_loss_s: list[float] = field(default_factory=list)
    compliance_loss_factor: list[float] = field(default_factory=list)
    # By parameter: its coordinates, and which part of its compliance each has.
    compliance_of: dict[str, list[tuple[int, float]]] = field(default_factory=dict)
    loss_of: dict[str, list[int]] = field(default_factory=dict)
    loss_factor_of: dict[str, list[int]] = field(default_factory=dict)
    # By parameter: coordinates, and by what the compliance of each changes a unit.
    compliance_slopes: dict[str, list[tuple[int, float]]] = field(default_factory=dict)
    # By parameter: coordinates, and by what (N,) the motion of each changes a unit.
    motion_of: dict[str, list[tuple[int, Array]]] = field(default_factory=dict)
    # Joints whose spring stretches by the difference to another coordinate.
    stretched_by: dict[str, int] = field(default_factory=dict)
    terms: list[tuple[str, int, int, float]] = field(default_factory=list)
    terms_of: dict[str, list[tuple[str, int, int, float]]] = field(default_factory=dict)
    stretches: list[tuple[str, Array, float]] = field(default_factory=list)
    stretches_of: dict[str, list[tuple[str, Array, float]]] = field(default_factory=dict)
    # By parameter: of stretches kind and row, and what the value times the row changes a unit.
    turns_of: dict[str, list[tuple[str, Array, Array]]] = field(default_factory=dict)
    # Links in pieces, shares (P,) and offsets of centres (P, 3), by effects and where none does
    # it; and coordinates inside links.
    pieces: dict[int, tuple[Array, Array]] = field(default_factory=dict)
    ordinary_pieces: dict[int, tuple[Array, Array]] = field(default_factory=dict)
    inside: dict[int, Inside] = field(default_factory=dict)
    # What a joint's stiffness and damping are multiplied by beside their parameters, and what a
    # parameter adds to the logarithms of both.
    factors: dict[str, tuple[float, float]] = field(default_factory=dict)
    log_slopes: dict[str, tuple[str, float, float]] = field(default_factory=dict)
    link_inertia: list[Array] = field(default_factory=list)  # (6, 6) each
    # By parameter: a link or the base, and by what (6, 6) its spatial inertia changes a unit.
    inertia_of: dict[str, tuple[int, Array]] = field(default_factory=dict)
    link_moments: list[Array] = field(default_factory=list)  # (4,): mass, first moments
    base_inertia: Array = field(default_factory=lambda: np.zeros((6, 6)))
    mix: Array | None = None
    place_m: Array | None = None  # (m, 3), small: taken to first order
    force: Array | None = None
    hit_turn: Array = field(default_factory=lambda: np.eye(3))  # of every force, base axes
    sensor_mass_kg: float = 0.0  # beside what the file gives
    sensor_mass_of: list[str] = field(default_factory=list)  # parameters that are added to it
    loss_power: float = 0.0  # by which losses of springs grow
    loss_power_is_free: bool = True  # it is the ordinary parameter's; else an effect holds it
    relaxing_rad_s: dict[str, float] = field(default_factory=dict)  # by kind of term, of each drive
    log_scale: float = 0.0
    delay_s: float = 0.0
    decay_rad_s: float = 0.0
    # (m,) point where each mounting truly was; None: as recorded.
    sensor_point: npt.NDArray[np.int64] | None = None
    # (n_hits,) point that each hit truly struck; None: as recorded.
    hit_point: npt.NDArray[np.int64] | None = None
    shifts_m: dict[int, Array] = field(default_factory=dict)  # of points, along sensor axes there
    # (n_hits, 3) by which hits fall off their points, along the axes a sensor has there; None: not.
    hit_place_m: Array | None = None

    def copied(self) -> Assembly:
        """Return equations that can be added to without changing these."""
        found = copy(self)
        for name in _CONTAINERS:
            value = getattr(self, name)
            if isinstance(value, dict):
                own = {k: v.copy() if isinstance(v, list) else v for k, v in value.items()}
                setattr(found, name, own)
            else:
                setattr(found, name, value.copy())
        return found

    def add_drive(
        self, joint: str, column: Array, k: float, c: float, values: Mapping[str, float]
    ) -> int:
        """Add a coordinate on a joint's spring and damper."""
        at = self._add(joint, column, np.nan, 0.0)
        self.relaxing_rad_s[relaxing_name(joint)] = REFERENCE_RAD_S * float(
            np.exp(values[rate_name(joint)])
        )
        for kind, value in self.drive_terms(joint, k, c, values):
            self.add_term(kind, at, at, value)
        return at

    def add_compliance(
        self,
        column: Array,
        compliance: float,
        loss_s: float,
        parameter: str,
        loss_parameter: str | None = None,
        *,
        part: float = 1.0,
        part_slopes: Mapping[str, float] = MappingProxyType({}),
    ) -> int:
        """Add a coordinate, named as its parameter, that gives way by a part of its value.

        `part_slopes`: by what other parameters change that part a unit.
        """
        at = self._add(parameter, column, part * compliance, loss_s)
        self.compliance_of.setdefault(parameter, []).append((at, part))
        for name, slope in part_slopes.items():
            self.compliance_slopes.setdefault(name, []).append((at, slope * compliance))
        if loss_parameter is not None:
            self.loss_of.setdefault(loss_parameter, []).append(at)
        return at

    def add_loss_factor(self, coordinates: Sequence[int], factor: float, parameter: str) -> None:
        """Let compliances lose by a factor beside what they lose, the same at all frequencies."""
        for at in coordinates:
            self.compliance_loss_factor[at] += factor
            self.loss_factor_of.setdefault(parameter, []).append(at)

    def multiply_spring(
        self, joint: str, values: Mapping[str, float], log_k: float, log_c: float
    ) -> None:
        """Multiply a joint's stiffness, its loss with it, and its damping."""
        k, c = (float(np.exp(values[f"ln {what} {joint}"])) for what in "kc")
        old_k, old_c = self.factors.get(joint, (1.0, 1.0))
        new_k, new_c = old_k * float(np.exp(log_k)), old_c * float(np.exp(log_c))
        self.factors[joint] = new_k, new_c
        link, rotor = self.names[joint], self.stretched_by.get(joint)
        more_k, more_c = k * (new_k - old_k), c * (new_c - old_c)
        for kind, more in self.drive_terms(joint, more_k, more_c, values):
            self.add_term(kind, link, link, more)
            if rotor is not None:
                self.add_term(kind, rotor, rotor, more)
                self.add_term(kind, rotor, link, -more)

    def drive_terms(
        self, joint: str, k: float, c: float, values: Mapping[str, float]
    ) -> list[tuple[str, float]]:
        """Return kinds of terms and values of a drive's spring and damper, with what k loses."""
        found = [("stiffness", k), ("damping", c), ("loss", k * values[f"loss {joint}"])]
        part = values[relaxing_name(joint)]
        if part:
            found.append((relaxing_name(joint), k * part))
        return found

    def add_term(
        self,
        kind: str,
        i: int,
        j: int,
        value: float,
        *,
        parameter: str | None = None,
        slope: float = 1.0,
    ) -> None:
        """Add to "mass", "damping", "stiffness", "loss" or what relaxes, between two, both ways.

        A `parameter` changes it by `slope` a unit.
        """
        for a, b in {(i, j), (j, i)}:
            self.terms.append((kind, a, b, value))
            if parameter is not None:
                self.terms_of.setdefault(parameter, []).append((kind, a, b, slope))

    def add_stretch(
        self,
        kind: str,
        row: Array,
        value: float,
        *,
        parameter: str,
        slope: float,
        turns: Mapping[str, Array] | None = None,
    ) -> None:
        """Add a spring or damper that stretches by row (n so far,) times the coordinates.

        Parameters of `turns` change the row by as much a unit.
        """
        self.stretches.append((kind, row, value))
        self.stretches_of.setdefault(parameter, []).append((kind, row, slope))
        for name, change in (turns or {}).items():
            self.turns_of.setdefault(name, []).append((kind, row, value * change))

    def joint_row(self, joint: str) -> Array:
        """Return (n so far,) what stretches a joint's spring."""
        row = np.zeros(len(self.columns))
        row[self.names[joint]] = 1.0
        if joint in self.stretched_by:
            row[self.stretched_by[joint]] = -1.0
        return row

    @property
    def still(self) -> Array:
        """The superset motion of a coordinate that moves no part of the arm."""
        return np.zeros(self.geometry.link_jacobian.shape[-1])

    def unit(self, column: int) -> Array:
        """Return the superset motion of one of its columns."""
        result = self.still
        result[column] = 1.0
        return result

    def add_body(self, link: int, mass_kg: float, center_m: Array, inertia_kg_m2: Array) -> None:
        """Bolt a body to a link (its frame)."""
        inertia = spatial_inertia(mass_kg, center_m, inertia_kg_m2)
        self.add_inertia(link, inertia, mass_kg * np.append(1.0, center_m))

    def add_inertia(self, link: int, inertia: Array, moments: Array) -> None:
        """Bolt a body to a link: its inertia (6, 6), mass and first moments (4,) in that frame."""
        self.link_inertia[link] = self.link_inertia[link] + inertia
        self.link_moments[link] = self.link_moments[link] + moments

    def _add(self, name: str, column: Array, compliance: float, loss_s: float) -> int:
        self.names[name] = len(self.columns)
        self.columns.append(column)
        self.compliance.append(compliance)
        self.compliance_loss_s.append(loss_s)
        self.compliance_loss_factor.append(0.0)
        return len(self.columns) - 1

    def motion_of_pieces(self, link: int, motion: Array, coordinates: Sequence[int]) -> Array:
        """Return (..., P, 6, k): a piece stays where a hinge beyond it turns.

        `motion` (..., 6, k) of the link, each column by one of the coordinates.
        """
        shares, _ = self.all_pieces[link]
        found = np.repeat(motion[..., None, :, :], len(shares), axis=-3)
        for column, coordinate in enumerate(coordinates):
            here = self.inside.get(coordinate)
            if here is not None and here.link == link:
                found[..., column] = here.moved(motion[..., column], shares)
        return found

    @property
    def all_pieces(self) -> dict[int, tuple[Array, Array]]:
        """Return every link that is in pieces."""
        return self.ordinary_pieces | self.pieces

    @property
    def where(self) -> npt.NDArray[np.int64]:
        """Return (m,) the point where each mounting is taken to stand."""
        return self.lines.sensor_point if self.sensor_point is None else self.sensor_point

    @property
    def struck(self) -> npt.NDArray[np.int64]:
        """Return (n_hits,) the point that each hit is taken to strike."""
        return self.lines.hit_point if self.hit_point is None else self.hit_point

    @property
    def forces(self) -> Array:
        """Return (n_hits, 3) directions of the hits, base frame."""
        return self.lines.hit_direction if self.force is None else self.force


_CONTAINERS = tuple(f.name for f in fields(Assembly) if f.default_factory in (dict, list))
