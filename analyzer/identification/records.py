"""What an identification says."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from armodal.analyzer.identification.frf_fit import FrfFit
from armodal.analyzer.identification.model_error import ModelMove
from armodal.analyzer.identification.triplets import TripletAxes
from armodal.analyzer.modal import ModalModel
from armodal.protocols.frf_records import FrequencyResponse

__all__ = [
    "AxisResult",
    "Explained",
    "Identification",
    "JointResult",
    "LineReading",
    "ModeResult",
    "MozziOfMode",
    "ValidationResult",
]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointResult:
    """One joint: from the fit of the whole model, and from one mode alone."""

    joint: str
    k_n_m_per_rad: float
    k_std: float  # from measurement scatter, of a Student t with k_dof degrees of freedom
    k_dof: float
    k_std_model: float  # by what the model leaves open: tolerances, and what gives way beside
    k_alone_n_m_per_rad: float  # that a model of joints alone needs, whose freedoms are no others
    k_alone_std_model: float  # by the tolerance of the inertias, to which it is proportional
    c_n_m_s_per_rad: float
    c_std: float
    c_dof: float
    believed_k_n_m_per_rad: float
    k_one_joint_n_m_per_rad: float | None  # None where no mode is this joint's own
    c_one_joint_n_m_s_per_rad: float | None
    one_joint_posture: str | None
    one_joint_f_hz: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LineReading:
    """A line read from a mode, in the link's frame, beside the fitted compliance axis."""

    direction_link: Array  # (3,) unit, the sense of the compliance axis
    point_link_m: Array  # (3,), nearest the link frame's origin
    off_deg: float
    off_mm: float  # from the compliance axis, at its point nearest the next joint's origin


@dataclass(frozen=True, slots=True, kw_only=True)
class MozziOfMode:
    """The Mozzi axis of a structural mode, and k of file 000, Eq. (1), with their bias.

    The bias is what the fitted model predicts for the same computation on its own mode. Its
    distance is perpendicular, from the point of the fitted axis nearest the next joint's origin.
    """

    posture: str
    f_hz: float
    direction_base: Array  # (3,)
    point_base_m: Array  # (3,)
    pitch_m_per_rad: float
    inertia_kg_m2: float
    k_eq1_n_m_per_rad: float
    c_eq2_n_m_s_per_rad: float
    line: LineReading  # from all points
    predicted_bias_deg: float
    predicted_bias_mm: float
    predicted_bias_k: float  # relative
    triplets: TripletAxes | None  # in base; None where fewer than two triplets tell an axis
    triplet_line: LineReading | None  # their average


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisResult:
    """A structural compliance axis, from the model with the axis released."""

    link: str
    direction_link: Array  # (3,) unit, link frame, its largest part positive: `line_sense`
    point_link_m: Array  # (3,), nearest the link frame's origin
    direction_std_deg: float
    point_std_m: float
    f_hz: float  # of the fitted mode that strains the axis most
    posture: str  # where that is
    k_n_m_per_rad: float
    k_std: float
    k_dof: float
    k_std_model: float
    k_alone_n_m_per_rad: float  # as of a joint
    k_alone_std_model: float
    c_n_m_s_per_rad: float
    c_std: float
    c_dof: float
    mozzi: tuple[MozziOfMode, ...]
    doubts: tuple[str, ...]  # what could be mistaken for this axis, and what the points cannot tell


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeResult:
    """One measured mode and what moves in it."""

    posture: str
    f_hz: float
    f_std_hz: float
    damping_ratio: float
    damping_std: float
    mpc: float
    joint_share: float  # of the squared motion, explained by joint rotations
    structural: bool
    model_f_hz: float | None  # of the fitted model, paired by shape
    mac: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidationResult:
    """A mode predicted for a posture the fit has not seen, and what was then measured."""

    posture: str
    mode: int
    predicted_hz: float
    predicted_std_hz: float
    predicted_dof: float
    predicted_damping: float
    predicted_damping_std: float
    measured_hz: float | None  # None where no measured mode has this shape
    measured_std_hz: float | None
    measured_dof: float | None
    measured_damping: float | None
    measured_damping_std: float | None
    mac: float | None


class Explained(StrEnum):
    """What explains the measured motion."""

    JOINTS = "joints"  # and axes, alone
    ORDINARY = "joints beside bearings, links and base"  # that give way as in any sound arm
    NOTHING = "nothing that identification knows"


@dataclass(frozen=True, slots=True, kw_only=True)
class Identification:
    """Everything the identification found.

    Attributes
    ----------
    joints : tuple of JointResult
        k (N m/rad) and c (N m s/rad) of each elastic joint, with deviations.
    axes : tuple of AxisResult
        Structural compliance axes inside links, in the link's frame.
    modes : tuple of ModeResult
        Measured modes and what moves in each.
    explained_by : Explained
        What explains the motion, and what their k is beside of.
    validation : tuple of ValidationResult
        Modes predicted for postures that were not fitted, beside those measured.
    rivals : tuple of (str, float)
        Where an axis was tried, and the cost of the fit, half the weighted sum of squares.
    fit : FrfFit
        The fit of the whole model to the FRFs.
    model_moves : tuple of ModelMove
        What the arm's tolerances do to the fit.
    modal_models : tuple of ModalModel
        One a posture.
    frfs : tuple of FrequencyResponse
        What was fitted, one a posture.
    notes : tuple of str
        What a person must know beside.
    """

    joints: tuple[JointResult, ...]
    axes: tuple[AxisResult, ...]
    modes: tuple[ModeResult, ...]
    explained_by: Explained
    validation: tuple[ValidationResult, ...]
    rivals: tuple[tuple[str, float], ...]
    fit: FrfFit
    model_moves: tuple[ModelMove, ...]
    modal_models: tuple[ModalModel, ...]
    frfs: tuple[FrequencyResponse, ...]
    notes: tuple[str, ...]
