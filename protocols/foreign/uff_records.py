"""What a universal file holds, dataset by dataset, in the file's own units and node numbers.

The numbers are those of the file; what they mean (form, units, directions) is worked out in
`protocols.foreign.units` and `protocols.foreign.frf_matrix`.

References
----------
Universal file datasets 15, 55, 58, 82, 151, 164, 2411, 2412 and 2420: SDRC I-DEAS, as kept by the
University of Cincinnati, https://www.ceas3.uc.edu/sdrluff/.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
import numpy.typing as npt

__all__ = [
    "DataKind",
    "FunctionKind",
    "UffFile",
    "UffFunction",
    "UffHeader",
    "UffNodes",
    "UffShape",
    "UffTraceLine",
    "UffUnits",
]


class FunctionKind(IntEnum):
    """Dataset 58, record 6, field 1: the function types read here."""

    GENERAL = 0
    TIME_RESPONSE = 1
    FREQUENCY_RESPONSE = 4
    COHERENCE = 6


class DataKind(IntEnum):
    """Specific data types of datasets 55 and 58 that matter to a hammer test."""

    UNKNOWN = 0
    GENERAL = 1
    DISPLACEMENT = 8
    REACTION_FORCE = 9
    VELOCITY = 11
    ACCELERATION = 12
    EXCITATION_FORCE = 13
    TIME = 17
    FREQUENCY = 18


@dataclass(frozen=True, slots=True, kw_only=True)
class UffHeader:
    """Dataset 151: who wrote the file."""

    model: str
    description: str
    program: str


@dataclass(frozen=True, slots=True, kw_only=True)
class UffUnits:
    """Dataset 164: the file's numbers divided by these factors are SI."""

    code: int
    description: str
    length: float
    force: float
    temperature: float = 1.0
    temperature_offset: float = 273.15


@dataclass(frozen=True, slots=True, kw_only=True)
class UffNodes:
    """Datasets 15 and 2411: nodes and their positions in the file's length unit."""

    number: npt.NDArray[np.int64]  # (n,)
    position: npt.NDArray[np.float64]  # (n, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class UffTraceLine:
    """Dataset 82, or an element of 2412: nodes to join by a line; 0 lifts the pen."""

    number: int
    name: str
    nodes: npt.NDArray[np.int64]  # (n,)


@dataclass(frozen=True, slots=True, kw_only=True)
class UffFunction:
    """Dataset 58: one function of time or frequency at a node and direction.

    Directions are +-1, +-2, +-3 for +-X, +-Y, +-Z, 4 to 6 for rotations, 0 where not told.
    """

    kind: int  # FunctionKind, or another number of the format
    response_node: int
    response_direction: int
    reference_node: int
    reference_direction: int
    abscissa: npt.NDArray[np.float64]  # (n,)
    values: npt.NDArray[np.float64] | npt.NDArray[np.complex128]  # (n,)
    even: bool
    numerator: int  # DataKind
    denominator: int
    numerator_unit: str = ""  # the file's label, empty where there is none
    denominator_unit: str = ""
    abscissa_kind: int = DataKind.UNKNOWN
    version: int = 0
    identification: tuple[str, ...] = field(default=("", "", "", "", ""))


@dataclass(frozen=True, slots=True, kw_only=True)
class UffShape:
    """Dataset 55: a mode shape; translations X, Y, Z at nodes.

    `pole_rad_s` is given for complex modes, `f_hz`, `damping_ratio` and `modal_mass` for real ones.
    """

    mode: int
    node: npt.NDArray[np.int64]  # (n,)
    shape: npt.NDArray[np.float64] | npt.NDArray[np.complex128]  # (n, 3)
    f_hz: float
    damping_ratio: float
    pole_rad_s: complex | None = None
    modal_mass: float = 0.0
    modal_a: complex = 0.0
    identification: tuple[str, ...] = field(default=("", "", "", "", ""))


@dataclass(frozen=True, slots=True, kw_only=True)
class UffFile:
    """A whole file; `skipped` tells the types of datasets that were passed over."""

    header: UffHeader | None = None
    units: UffUnits | None = None
    nodes: UffNodes | None = None
    trace_lines: tuple[UffTraceLine, ...] = ()
    functions: tuple[UffFunction, ...] = ()
    shapes: tuple[UffShape, ...] = ()
    skipped: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()  # cosmetic faults
