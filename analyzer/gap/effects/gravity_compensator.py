"""A spring cylinder beside a joint that carries a part of the weight.

Its ends are r_a and r_b from the joint's axis, h apart along it and an angle phi = q + phi_0 about
it. Its energy's second derivative is its stiffness about the joint, with L its length, k its
stiffness, F its tension and ' = d/dq:

    K = k L'^2 + F L'',    L^2 = r_a^2 + r_b^2 + h^2 - 2 r_a r_b cos phi,
    L L' = r_a r_b sin phi,    L L'' = r_a r_b cos phi - L'^2 .

A spring's tension grows by k with its length, one on a supply of gas or of oil has the same in
every posture, and a closed valve begins anew in each: F / k = s_0 L_0 + g (L - L_0), where L_0 is
the length at a right angle, s_0 the stretch there and g from 0 to 1.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.interface import loss_parameter
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["STD", "WORDS", "instances", "lifting_joints", "names_at", "shares"]

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
    remedy="use the new arm file, which has it; check the cylinder, its supply and its valve",
)
STD = 0.4  # of the joint's stiffness, where it is square to its lever
_MATERIAL = 0.03
_RATIO, _LN_RATIO_STD = 1.3, 0.4
_ASIDE_STD = 0.5  # of h^2 over that of the turning arm
_STRETCH_STD = 0.15  # of springs and gas; those that push have a negative one
_GROWTH, _GROWTH_STD = 0.5, 0.5
_ANY_ANGLE = 3.0
_POINT = 1e-9  # of a squared length, where both ends meet
_STEP = 1e-5  # for slopes


def shares(
    angle_rad: npt.ArrayLike,
    ratio: npt.ArrayLike,
    aside: npt.ArrayLike = 0.0,
    stretch: npt.ArrayLike = 0.0,
    growth: npt.ArrayLike = 0.0,
) -> tuple[Array, Array]:
    """Stiffness about the joint over its own times the shorter arm squared; that of its line alone.

    The second is its damping's too: what the tension brings loses nothing.

    Parameters
    ----------
    angle_rad
        Between both arms.
    ratio
        Of the fixed arm to the turning one.
    aside
        Square of the distance of both ends along the axis, over that of the turning arm.
    stretch
        Tension over stiffness and length, at a right angle.
    growth
        Of the tension with length, over the stiffness.
    """
    phi, ratio = np.asarray(angle_rad, dtype=np.float64), np.asarray(ratio, dtype=np.float64)
    right = 1.0 + ratio**2 + np.asarray(aside)
    across = ratio * np.cos(phi)
    squared = right - 2.0 * across + _POINT
    by_length = (ratio * np.sin(phi)) ** 2 / squared
    length, middle = np.sqrt(squared), np.sqrt(right)
    tension = np.asarray(stretch) * middle + np.asarray(growth) * (length - middle)
    stiffness = by_length + tension / length * (across - by_length)
    shorter = np.minimum(1.0, ratio) ** 2
    return np.asarray(stiffness / shorter), np.asarray(by_length / shorter)


def lifting_joints(ordinary: Ordinary) -> tuple[int, ...]:
    """Return the joints that such a cylinder may stand beside: the first two that weight loads.

    Further ones have no room.
    """
    return ordinary.loaded[:2]


def names_at(joint: str) -> tuple[str, str, str, str, str, str, str]:
    """Return the names of stiffness, loss, and what `shares` takes (of the ratio its ln)."""
    return (
        f"compensator stiffness {joint}",
        f"compensator loss {joint}",
        f"compensator angle {joint}",
        f"compensator ln ratio {joint}",
        f"compensator aside {joint}",
        f"compensator stretch {joint}",
        f"compensator growth {joint}",
    )


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each joint that lifts; a scan of angles tells where to begin."""
    return tuple(_beside(ordinary, i) for i in lifting_joints(ordinary))


def _beside(ordinary: Ordinary, i: int) -> Instance:
    joint = ordinary.arm.joints[i]
    stiff, loss, *shapes = names_at(joint.name)
    angle, ratio, aside, stretch, growth = shapes
    k = 1.0 if joint.stiffness is None else joint.stiffness.value

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        here = np.array([values[name] for name in shapes])
        here[0] += float(assembly.lines.joints_rad[i])
        beside = np.vstack([here, here + _STEP * np.eye(len(here))]).T
        stiffens, damps = k * np.array(shares(beside[0], np.exp(beside[1]), *beside[2:]))
        at, tau, size = assembly.names[joint.name], values[loss], values[stiff]
        for matrix, (part, *moved) in (("stiffness", stiffens), ("damping", tau * damps)):
            assembly.add_term(matrix, at, at, size * part, parameter=stiff, slope=part)
            for name, other in zip(shapes, moved, strict=True):
                slope = size * (other - part) / _STEP
                assembly.terms_of.setdefault(name, []).append((matrix, at, at, slope))
        assembly.terms_of.setdefault(loss, []).append(("damping", at, at, size * damps[0]))

    return Instance(
        effect=WORDS,
        place=joint.name,
        parameters=(
            Parameter(name=stiff, unit="", mean=0.0, std=STD, low=0.0),
            loss_parameter(loss),
            Parameter(name=angle, unit="rad", mean=0.0, std=_ANY_ANGLE),
            Parameter(name=ratio, unit="", mean=float(np.log(_RATIO)), std=_LN_RATIO_STD),
            Parameter(name=aside, unit="", mean=0.0, std=_ASIDE_STD, low=0.0, untold=0.0),
            Parameter(name=stretch, unit="", mean=0.0, std=_STRETCH_STD, untold=0.0),
            Parameter(
                name=growth,
                unit="",
                mean=_GROWTH,
                std=_GROWTH_STD,
                low=0.0,
                high=1.0,
                untold=0.0,
            ),
        ),
        builder=build,
        size=stiff,
        words={stiff: "its stiffness at the shorter lever, over the joint's in the arm file"},
        shapes=tuple(shapes),
        details=(aside, stretch, growth),
        material=_MATERIAL,
    )
