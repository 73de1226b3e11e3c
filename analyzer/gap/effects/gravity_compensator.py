"""A spring cylinder beside a joint that carries a part of the weight.

Its ends are r_a and r_b from the joint's axis, an angle phi = q + phi_0 apart. With rho = r_a / r_b
and L its length, its stiffness about the joint is k L'^2, L' = dL/dq:

    k L'^2 = k r_b^2 rho^2 sin^2 phi / (1 + rho^2 - 2 rho cos phi) .

It is k times the shorter arm squared where the cylinder stands square to that arm. The tension's
own part, F L'', is below a hundredth of it for cylinders that are stiff enough to be seen.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.compliance import loss_parameter
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["STD", "WORDS", "instances", "lifting_joints", "names_at", "share"]

Array = npt.NDArray[np.float64]

WORDS = EffectWords(
    name="gravity_compensator",
    title="Gravity compensator stiffens a joint",
    changes="stiffness and damping beside a joint's own, by an angle that turns with the joint",
    signature="a joint stiffer in some postures than in others, by its own angle alone",
    confused_with=("coupling", "servo", "encoder_offset"),
    covers=("gravity_compensator",),  # an arm has one; what its law leaves looks like another
    told_by="three postures that differ in that joint's angle alone; or the cylinder taken off",
    own_candidates=True,
    separate_minima=True,
    remedy="put the cylinder's ends and stiffness into the model, or test with its valve open",
)
STD = 0.4  # of the joint's stiffness, where it is square to its lever
_MATERIAL = 0.03
_RATIO, _LN_RATIO_STD = 1.3, 0.4
_ANY_ANGLE = 3.0
_STEP = 1e-5  # for slopes


def share(angle_rad: npt.ArrayLike, ratio: npt.ArrayLike) -> Array:
    """Stiffness about the joint over what it is where the cylinder is square to the shorter arm.

    Parameters
    ----------
    angle_rad
        Between both arms.
    ratio
        Of the fixed arm to the turning one.
    """
    phi, ratio = np.asarray(angle_rad, dtype=np.float64), np.asarray(ratio, dtype=np.float64)
    square = (ratio * np.sin(phi)) ** 2 / (1.0 + ratio**2 - 2.0 * ratio * np.cos(phi) + 1e-9)
    return np.asarray(square / np.minimum(1.0, ratio) ** 2)


def lifting_joints(ordinary: Ordinary) -> tuple[int, ...]:
    """Return the joints that such a cylinder may stand beside: the first two that weight loads.

    Further ones have no room.
    """
    return ordinary.loaded[:2]


def names_at(joint: str) -> tuple[str, str, str, str]:
    """Return the names of stiffness, loss, angle and ratio."""
    return (
        f"compensator stiffness {joint}",
        f"compensator loss {joint}",
        f"compensator angle {joint}",
        f"compensator ln ratio {joint}",
    )


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each joint that lifts; a scan of angles tells where to begin."""
    return tuple(_beside(ordinary, i) for i in lifting_joints(ordinary))


def _beside(ordinary: Ordinary, i: int) -> Instance:
    joint = ordinary.arm.joints[i]
    stiff, loss, angle, ratio = names_at(joint.name)
    k = 1.0 if joint.stiffness is None else joint.stiffness.value

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        phi, log_ratio = float(assembly.lines.joints_rad[i]) + values[angle], values[ratio]
        beside = (phi, phi + _STEP, phi), (log_ratio, log_ratio, log_ratio + _STEP)
        part, *moved = k * share(beside[0], np.exp(beside[1]))
        at, tau, size = assembly.names[joint.name], values[loss], values[stiff]
        assembly.add_term("stiffness", at, at, size * part, parameter=stiff, slope=part)
        c = size * part * tau
        assembly.add_term("damping", at, at, c, parameter=stiff, slope=part * tau)
        assembly.terms_of.setdefault(loss, []).append(("damping", at, at, size * part))
        for name, other in zip((angle, ratio), moved, strict=True):
            slope = size * (other - part) / _STEP
            assembly.terms_of[name] = [
                ("stiffness", at, at, slope),
                ("damping", at, at, slope * tau),
            ]

    return Instance(
        effect=WORDS,
        place=joint.name,
        parameters=(
            Parameter(name=stiff, unit="", mean=0.0, std=STD, low=0.0),
            loss_parameter(loss),
            Parameter(name=angle, unit="rad", mean=0.0, std=_ANY_ANGLE),
            Parameter(name=ratio, unit="", mean=float(np.log(_RATIO)), std=_LN_RATIO_STD),
        ),
        builder=build,
        size=stiff,
        shapes=(angle, ratio),
        material=_MATERIAL,
    )
