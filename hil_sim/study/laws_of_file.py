"""Laws of joints and a gravity compensator that an arm file holds, as effects of the simulated arm.

The file counts a law by the swing of a hit of the middle level (`docs/theory-gap.md`); here are its
torques. Softening has a form of the laboratory's own, alike in its slope for small swings and in
what large ones lose.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import AddedEffect, Joint

__all__ = ["LAWS", "Unlike", "compensator"]

Array = npt.NDArray[np.float64]
Tables = dict[str, Any]
Sizes = Mapping[str, float]

_SLIDERS = 8  # of a seat that slips little by little
_EYE_M = 0.2  # of the shorter lever of a cylinder; its stiffness goes with it
_CREEPS = 1.0  # 1/s: less is none within the second that a hit rings


class Unlike(Exception):  # noqa: N818 - it is told as a reason, and never raised further
    """What a law of the file has and the laboratory has not."""


def _friction(effect: AddedEffect, sizes: Sizes, joint: Joint) -> Tables:
    """A slider behind a spring (Jenkins)."""
    _swing(effect)
    if sizes.get("creep", 0.0) > _CREEPS:
        raise Unlike("friction that creeps")
    return {
        "kind": "friction",
        "joint": joint.name,
        "limit_n_m": sizes["limit"],
        "stiffness_n_m_per_rad": float(np.exp(sizes["ln_presliding"])) * _spring(joint),
    }


def _microslip(effect: AddedEffect, sizes: Sizes, joint: Joint) -> Tables:
    """Sliders that slip one after the other, evenly up to a turn (Iwan 1966)."""
    k = sizes["seat"] * _spring(joint)
    turn = _swing(effect) * float(np.exp(sizes["ln_seat_slips"]))
    return {
        "kind": "friction",
        "joint": joint.name,
        "limit_n_m": 0.5 * k * turn,
        "stiffness_n_m_per_rad": k,
        "elements": _SLIDERS,
    }


def _softening(effect: AddedEffect, sizes: Sizes, joint: Joint) -> Tables:
    """Of p x³/(x² + a²) less: x - a' tanh(x/a') has its slope if a' = a/sqrt(3)."""
    bend = float(np.exp(sizes["ln_bend"]))
    part = sizes["softer"] * (1.0 + bend**2)
    if not 0.0 < part < 1.0:
        raise Unlike("joint that hardens, or loses more than its spring")
    return {
        "kind": "softening",
        "joint": joint.name,
        "part": part,
        "at_rad": bend * _swing(effect) / float(np.sqrt(3.0)),
    }


def _backlash(effect: AddedEffect, sizes: Sizes, joint: Joint) -> Tables:
    """A part of the spring holds nothing over a play; the weight lays it to one side."""
    return {
        "kind": "backlash",
        "joint": joint.name,
        "half_rad": _swing(effect) * float(np.exp(sizes["ln_half_play"])),
        "part": min(sizes["play"], 1.0),
    }


def compensator(sizes: Sizes, joint: Joint, axis: Array) -> Tables:
    """A cylinder without tension that is as stiff about the joint in every posture.

    The file has its stiffness where it is square to the shorter lever, over the joint's; the
    levers' ratio; and the angle between them while the joint stands at zero.

    Parameters
    ----------
    axis : (3,) unit
        Of the joint, in the frames of both links at zero angles.
    """
    ratio, angle = float(np.exp(sizes["compensator_ln_ratio"])), sizes["compensator_angle"]
    eye_m = _EYE_M / min(1.0, ratio)
    across = np.linalg.svd(axis[None])[2][1]
    turned = np.cos(angle) * across - np.sin(angle) * np.cross(axis, across)
    k = sizes["compensator_stiffness"] * _spring(joint) / _EYE_M**2
    return {
        "kind": "gravity_compensator",
        "joint": joint.name,
        "anchor_m": tuple(ratio * eye_m * turned),
        "eye_m": tuple(eye_m * across),
        "tension_n": 0.0,
        "stiffness_n_per_m": k,
        "damping_n_s_per_m": sizes.get("compensator_loss", 0.0) * k,
    }


def _spring(joint: Joint) -> float:
    if joint.stiffness is None:
        raise Unlike("law at a rigid joint")
    return joint.stiffness.value


def _swing(effect: AddedEffect) -> float:
    """Of a law; springs by the hits' level have none."""
    swing = effect.description.get("swing_rad")
    if not isinstance(swing, float):
        raise Unlike("springs by the hits' level without a law; fit the session again")
    return swing


LAWS: dict[str, Callable[[AddedEffect, Sizes, Joint], Tables]] = {
    "backlash": _backlash,
    "friction": _friction,
    "microslip": _microslip,
    "softening": _softening,
}
