"""Records of the arm description: what the one arm file says.

Frames: a link's frame is its URDF frame (the frame of the joint that moves it); base is the
frame of the first link. Lengths m, angles rad here; files carry degrees where their key says so.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

__all__ = [
    "AddedEffect",
    "Arm",
    "CanMapping",
    "DriveStateSignal",
    "EffectEvidence",
    "EffectParameter",
    "Estimate",
    "InertialLink",
    "Joint",
    "JointSignal",
    "KeepOut",
    "PastSession",
    "Point",
    "Tolerances",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A believed value with its standard uncertainty and where it comes from."""

    value: float
    std: float
    source: str


@dataclass(frozen=True, slots=True, kw_only=True)
class InertialLink:
    """A rigid link: the body that its joint moves, in the link's own frame."""

    name: str
    mass_kg: float
    center_m: npt.NDArray[np.float64]  # (3,) in the link frame
    inertia_kg_m2: npt.NDArray[np.float64]  # (3, 3) about the center, link axes


@dataclass(frozen=True, slots=True, kw_only=True)
class InertialStd:
    """One standard deviation of what is believed of a link's inertial."""

    mass: float  # relative
    inertia: float  # relative, of the principal moments
    center_m: float  # along each axis
    guessed: bool = False  # the inertial comes from the link's shape, from no description


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A revolute joint, from the base outwards, and what is believed of its drive.

    `stiffness` is None for a joint believed rigid while it is held.
    """

    name: str
    T_parent_joint: npt.NDArray[np.float64]  # (4, 4) joint frame in the parent link at q = 0
    axis: npt.NDArray[np.float64]  # (3,) unit, joint frame
    range_rad: tuple[float, float]
    link: InertialLink  # the link it moves
    stiffness: Estimate | None  # N m / rad
    damping: Estimate | None  # N m s / rad
    inertial_std: InertialStd | None = None  # of its link; None: as the arm's tolerances


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """A test point: where a sensor or the hammer goes.

    The columns of `R_link_sensor` are the sensor's x, y, z axes in the link's frame; sensor z is
    the outward normal of the surface, so that a roving hammer hits along minus z.
    """

    id: str
    link: str  # link name, or "base"
    position_m: npt.NDArray[np.float64]  # (3,) link frame
    R_link_sensor: npt.NDArray[np.float64]  # (3, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepOut:
    """A box that the arm has to stay out of, along the base's axes."""

    name: str
    low_m: npt.NDArray[np.float64]  # (3,) base frame
    high_m: npt.NDArray[np.float64]  # (3,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerances:
    """One standard deviation of what is only roughly known."""

    mass: float  # relative
    inertia: float  # relative, of the principal moments
    center_m: float
    encoder_offset_rad: float
    sensor_tilt_rad: float
    sensor_gain: float  # relative
    hammer_gain: float  # relative
    hit_direction_rad: float
    moving_mass: float | None = None  # relative, of all moving links together; None: not weighed
    # Keys that the arm file left out: usual values stand in their place.
    usual: tuple[str, ...] = field(default=(), compare=False)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Return the sentence that every result carries where the file left some out."""
        if not self.usual:
            return ()
        said = (
            f"the arm file tells no tolerance of {', '.join(self.usual)}: usual values were taken, "
            "and results are as uncertain as these; put the arm's own under [tolerances]"
        )
        return (said,)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSignal:
    """Where a joint's angle is found: q = sign * scale_rad * value + offset_rad."""

    joint: str
    message: str
    signal: str
    scale_rad: float
    sign: int
    offset_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveStateSignal:
    """Where the drive state is found and which of its values mean the arm is held by its servos."""

    message: str
    signal: str
    held_values: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CanMapping:
    """How the controller's frames map to joints."""

    database: str  # file name of a DBC shipped in protocols/dbc, or a path beside the arm file
    database_text: str  # its text, read with the arm file
    bitrate: int
    rate_hz: float
    stale_after_s: float
    joints: tuple[JointSignal, ...]
    drive_state: DriveStateSignal | None
    counter: tuple[str, str] | None  # (message, signal), or None


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectParameter:
    """A parameter of an effect: value, one std, 95 % interval."""

    name: str
    unit: str  # empty for a pure number, and where a file does not say
    value: float
    std: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectEvidence:
    """What an effect of the arm stands on."""

    gain_nats: float | None  # of log evidence over the model without it; None: not weighed
    held_out_gain_nats: float | None  # of log density on postures it was not fitted to
    confidence: float | None  # that it is this and no other effect of the library, 0 to 1
    session_sha256: str  # of the session file it was found in
    created: str  # ISO 8601, with zone


@dataclass(frozen=True, slots=True, kw_only=True)
class PastSession:
    """A session that changed an arm file."""

    session_sha256: str  # of the session file
    by: str  # the command
    created: str  # ISO 8601, with zone


@dataclass(frozen=True, slots=True, kw_only=True)
class AddedEffect:
    """What the plain model of links and joints lacks, as a gap analysis named it."""

    name: str  # of the library of effects
    place: str  # joint, link, channel, or what else it is of
    parameters: tuple[EffectParameter, ...]
    description: Mapping[str, str | float | tuple[float, ...]]  # link, direction, point_m, ...
    evidence: EffectEvidence


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """A serial arm of revolute joints, as the user believes it to be.

    Attributes
    ----------
    name : str
        As sessions and plans refer to it.
    source : str
        Where the description comes from.
    joints : tuple of Joint
        From the base outwards, each with its link, range, stiffness and damping.
    gravity_m_s2 : (3,) array
        Acceleration of free fall, m/s², base frame.
    points : tuple of Point
        Test points, in the frames of their links.
    groups : dict
        Ids of points by the name of their group.
    tolerances : Tolerances
        One standard deviation of what is only roughly known.
    can : CanMapping or None
        Where the bus has the joint angles; None: the arm has no bus.
    text : str
        The arm file as read.
    urdf_text : str or None
        The URDF that it names, as read.
    sha256 : str
        Over both texts and the database of the bus.
    effects : tuple of AddedEffect
        What the plain model of links and joints lacks.
    history : tuple of PastSession
        Sessions that changed the file, oldest first.
    keep_outs : tuple of KeepOut
        Boxes that the arm stays out of, base frame.
    """

    name: str
    source: str
    joints: tuple[Joint, ...]
    gravity_m_s2: npt.NDArray[np.float64]
    points: tuple[Point, ...]
    groups: dict[str, tuple[str, ...]]
    tolerances: Tolerances
    can: CanMapping | None
    text: str
    urdf_text: str | None
    sha256: str
    effects: tuple[AddedEffect, ...] = ()
    history: tuple[PastSession, ...] = ()
    keep_outs: tuple[KeepOut, ...] = ()

    def inertial_std(self, joint: Joint) -> InertialStd:
        """Return what the link of a joint is believed to."""
        own = self.tolerances
        return joint.inertial_std or InertialStd(
            mass=own.mass, inertia=own.inertia, center_m=own.center_m
        )

    def point(self, point_id: str) -> Point:
        """Return the test point called `point_id`, or raise KeyError."""
        for point in self.points:
            if point.id == point_id:
                return point
        raise KeyError(point_id)
