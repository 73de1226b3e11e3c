"""The plant file: the truth about the simulated arm and its sensors, read strictly.

Only the simulated laboratory reads it. The format is explained in `docs/simulated-plant.md`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
import tomlkit
from pydantic import Field, ValidationError, model_validator

from armodal.hil_sim.effects import Effect
from armodal.hil_sim.truth import Interval, NotNegative, Positive, Probability, Truth, Vector
from armodal.protocols.errors import PlantError
from armodal.protocols.printable import printable
from armodal.protocols.toml_reader import parse_toml, read_text

__all__ = [
    "AccelerometerTruth",
    "BoardTruth",
    "HammerTruth",
    "HandTruth",
    "HiddenAxisTruth",
    "LinkTruth",
    "PlantFile",
    "PointTruth",
    "load_plant_file",
    "plant_text",
]

_LIMIT = 512 * 1024  # bytes of a plant file


class LinkTruth(Truth):
    """A link with the joint that moves it; a joint without stiffness is rigid when held."""

    name: str
    joint: str
    origin_m: Vector  # joint frame in the link before
    axis: Vector
    range_deg: Interval
    mass_kg: NotNegative
    center_m: Vector
    inertia_kg_m2: Annotated[tuple[float, ...], Field(strict=False, min_length=6, max_length=6)]
    stiffness_n_m_per_rad: Positive | None = None
    damping_n_m_s_per_rad: NotNegative | None = None

    @model_validator(mode="after")
    def _is_physical(self) -> Self:
        if abs(np.linalg.norm(self.axis) - 1.0) > 1e-9:
            raise ValueError("axis must have length 1")
        if self.range_deg[0] >= self.range_deg[1]:
            raise ValueError("range_deg must be [lower, upper] with lower < upper")
        if (self.stiffness_n_m_per_rad is None) != (self.damping_n_m_s_per_rad is None):
            raise ValueError("give both stiffness and damping, or neither for a rigid joint")
        moments = np.linalg.eigvalsh(self.inertia_matrix())
        if moments[0] <= 0.0 or moments[0] + moments[1] < moments[2]:
            raise ValueError(
                "inertia_kg_m2 [xx, xy, xz, yy, yz, zz] must be that of a body: principal moments "
                "positive, none above the sum of the other two"
            )
        return self

    def inertia_matrix(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """(3, 3) inertia about the center, link axes, kg m^2."""
        xx, xy, xz, yy, yz, zz = self.inertia_kg_m2
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class HiddenAxisTruth(Truth):
    """A compliance axis between a joint and all the mass of its link, in the link's frame."""

    link: str
    point_m: Vector
    direction: Vector
    stiffness_n_m_per_rad: Positive
    damping_n_m_s_per_rad: NotNegative

    @model_validator(mode="after")
    def _has_direction(self) -> Self:
        if np.linalg.norm(self.direction) == 0.0:
            raise ValueError("direction must not be zero")
        return self


class PointTruth(Truth):
    """A test point; `normal` is the outward normal (sensor z), `x_axis` the sensor's x."""

    id: str
    link: str
    position_m: Vector
    normal: Vector
    x_axis: Vector

    @model_validator(mode="after")
    def _is_orthonormal(self) -> Self:
        lengths = np.linalg.norm([self.normal, self.x_axis], axis=1)
        if np.any(np.abs(lengths - 1.0) > 1e-6) or abs(np.dot(self.normal, self.x_axis)) > 1e-6:
            raise ValueError("normal and x_axis must be of length 1 and at right angles")
        return self


class HammerTruth(Truth):
    """The instrumented hammer."""

    serial_number: str
    calibration_date: str
    sensitivity_v_per_n: Positive  # as certified
    gain_error: float  # true sensitivity / certified - 1
    highpass_hz: Positive
    noise_n: NotNegative  # standard deviation of white noise per sample
    flicker_n: NotNegative


class AccelerometerTruth(Truth):
    """The triaxial accelerometer.

    Row i of `response` is what output i truly makes of accelerations along x, y, z, as parts of
    the certified sensitivity: gain errors on the diagonal, transverse sensitivity beside it.
    """

    serial_number: str
    calibration_date: str
    mass_kg: NotNegative
    sensitivity_v_per_m_s2: Positive  # as certified, each axis
    response: Annotated[tuple[Vector, Vector, Vector], Field(strict=False)]
    mount_tilt_deg: NotNegative  # standard deviation per axis, drawn at each mounting
    highpass_hz: Positive
    noise_m_s2: NotNegative
    flicker_m_s2: NotNegative
    moving_vibration_m_s2: NotNegative  # standard deviation while the arm moves
    base_motion: NotNegative  # motion of the base / motion of the hidden axis' link


class BoardTruth(Truth):
    """The analog inputs of the acquisition board."""

    range_v: Positive  # largest magnitude of the 24-bit converter
    filter_delay_samples: Annotated[int, Field(ge=8, le=256)]
    oversampling: Annotated[int, Field(ge=8, le=256)]


class HandTruth(Truth):
    """How a person hits."""

    peak_n: Interval  # of a good hit
    width_s: Interval
    direction_std_deg: NotNegative  # about each of two axes across the wanted direction
    position_std_m: NotNegative  # along each of two axes across the wanted direction
    double_probability: Probability
    double_delay_s: Interval
    double_ratio: Interval
    soft_probability: Probability
    soft_peak_n: Interval
    overload_probability: Probability
    overload_peak_n: Interval

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        for name in ("peak_n", "width_s", "double_delay_s", "double_ratio", "soft_peak_n"):
            low, high = getattr(self, name)
            if not 0.0 < low <= high:
                raise ValueError(f"{name} must be [low, high] with 0 < low <= high")
        low, high = self.overload_peak_n
        if not 0.0 < low <= high:
            raise ValueError("overload_peak_n must be [low, high] with 0 < low <= high")
        if self.double_probability + self.soft_probability + self.overload_probability > 1.0:
            raise ValueError("the probabilities of bad hits must not exceed 1 together")
        return self


class PlantFile(Truth):
    """All of a plant file."""

    name: str
    source: str
    gravity_m_s2: Vector
    links: Annotated[tuple[LinkTruth, ...], Field(strict=False, min_length=1)]
    hidden_axis: HiddenAxisTruth | None = None
    effects: Annotated[tuple[Effect, ...], Field(strict=False)] = ()
    points: Annotated[tuple[PointTruth, ...], Field(strict=False)]
    hammer: HammerTruth
    accelerometer: AccelerometerTruth
    board: BoardTruth
    hand: HandTruth

    @model_validator(mode="after")
    def _names_agree(self) -> Self:
        links = [link.name for link in self.links]
        if len(set(links)) != len(links) or "base" in links:
            raise ValueError("links must have names of their own, none of them 'base'")
        if all(link.stiffness_n_m_per_rad is None for link in self.links):
            raise ValueError("at least one joint must have a stiffness")
        if self.hidden_axis is not None and self.hidden_axis.link not in links:
            raise ValueError(f"hidden_axis.link: no link is called {self.hidden_axis.link!r}")
        ids = [point.id for point in self.points]
        if len(set(ids)) != len(ids):
            raise ValueError("points must have ids of their own")
        for point in self.points:
            if point.link not in (*links, "base"):
                raise ValueError(f"points: {point.id!r} is on {point.link!r}, which is no link")
        return self


def load_plant_file(path: Path) -> PlantFile:
    """Read a plant file.

    Raises
    ------
    PlantError
        If the file is missing, is no TOML, or has an unknown key or an impossible value; the
        message names each key's path.
    """
    text = read_text(path, what="plant file", limit_bytes=_LIMIT, error=PlantError)
    tables = parse_toml(text, origin=f"plant file {path}", error=PlantError)
    try:
        return PlantFile.model_validate(tables)
    except ValidationError as error:
        faults = "; ".join(
            f"{'.'.join(str(part) for part in fault['loc']) or 'file'}: {fault['msg']}"
            for fault in error.errors()
        )
        raise PlantError(f"plant file {path}: {printable(faults, keep='')}") from error


def plant_text(truth: PlantFile) -> str:
    """Write a plant as the text of a plant file."""
    return tomlkit.dumps(truth.model_dump(mode="json", exclude_none=True))
