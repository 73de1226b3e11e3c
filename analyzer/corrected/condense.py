"""A session's model in the words of an arm file: the same modes without the session's own errors.

A fit has every ordinary error free: masses, bearings, loss factors. An arm file has none of them,
and a joint's stiffness from that fit, put beside the masses of the file, gives other modes. So the
springs, the dampers and the effects' sizes that go into the file are those with which the model
*of the file* has the modes of the model that was fitted, in postures over the whole range.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.corrected.correction import Correction
from armodal.analyzer.corrected.modes import CorrectedModes, corrected_modes
from armodal.analyzer.corrected.posture import Stand, corrected_posture, stand
from armodal.analyzer.identification.mode_fit import pair_by_shape

__all__ = ["Condensed", "condense"]

Array = npt.NDArray[np.float64]

_POSTURES = 6
_INSIDE = 0.1  # of each joint's range, kept from both ends
_SEED = 0  # of the postures, which decide nothing else
_PRIOR = 1e-3  # of a unit of ln: holds what no mode tells where it was, and moves nothing else
_BEYOND = 1.5  # times the highest mode compared: its partner may be higher
_CLOSE, _STEPS = 1e-4, 8
_DAMPING = 0.1  # weight of ln damping ratio beside ln frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class Condensed:
    """Values for an arm file."""

    stiffness: Mapping[str, float]  # N m/rad by elastic joint
    damping: Mapping[str, float]  # N m s/rad
    factors: Mapping[str, float]  # by parameter of an effect: what its value is multiplied by
    f_error: float  # largest relative difference of a frequency that is left, in these postures
    damping_error: float  # likewise of a damping ratio


def condense(
    fitted: Correction, filed: Correction, scaled: tuple[str, ...], *, top_hz: float
) -> Condensed:
    """Find values with which the filed model has the fitted one's modes.

    Parameters
    ----------
    fitted
        With the values of the session's fit.
    filed
        Of the arm file: its ordinary errors are none.
    scaled
        Parameters of its effects that may be scaled; their values are not zero.
    top_hz
        Modes above are not compared.
    """
    ordinary = filed.ordinary
    joints = [ordinary.arm.joints[i].name for i in ordinary.elastic]
    low, high = np.array([joint.range_rad for joint in ordinary.arm.joints]).T
    room = np.random.default_rng(_SEED).uniform(_INSIDE, 1.0 - _INSIDE, (_POSTURES, len(low)))
    postures = low + (high - low) * room
    wanted = [_modes(fitted, stand(fitted, q), top_hz) for q in postures]
    places = [stand(filed, q) for q in postures]
    start = {
        f"ln {what} {joint}": fitted.values[f"ln {what} {joint}"]
        for what in "kc"
        for joint in joints
    }
    names = (*start, *scaled)

    def at(u: Array) -> Correction:
        step = dict(zip(names, u.tolist(), strict=True))
        values = {name: value + step[name] for name, value in start.items()}
        values |= {name: filed.values[name] * float(np.exp(step[name])) for name in scaled}
        return replace(filed, values={**filed.values, **values})

    def differences(u: Array) -> tuple[Array, Array]:
        own = at(u)
        rows = [
            _difference(one, _modes(own, place, _BEYOND * top_hz))
            for one, place in zip(wanted, places, strict=True)
        ]
        f, damping = np.concatenate(rows, axis=1)
        return f, damping

    def residual(u: Array) -> Array:
        f, damping = differences(u)
        return np.concatenate([f, _DAMPING * damping, _PRIOR * u])

    found = scipy.optimize.least_squares(
        residual, np.zeros(len(names)), xtol=_CLOSE, ftol=_CLOSE, max_nfev=_STEPS
    )
    f, damping = differences(found.x)
    values = at(found.x).values
    return Condensed(
        stiffness={joint: float(np.exp(values[f"ln k {joint}"])) for joint in joints},
        damping={joint: float(np.exp(values[f"ln c {joint}"])) for joint in joints},
        factors={name: values[name] / filed.values[name] for name in scaled},
        f_error=float(np.abs(np.expm1(f)).max(initial=0.0)),
        damping_error=float(np.abs(np.expm1(damping)).max(initial=0.0)),
    )


_Moved = tuple[CorrectedModes, npt.NDArray[np.complex128]]


def _modes(correction: Correction, at: Stand, below_hz: float) -> _Moved:
    posture = corrected_posture(correction, at)
    modes = corrected_modes(posture, below_hz=below_hz)
    return modes, np.asarray(posture.point_linear.reshape(-1, len(posture.mass)) @ modes.shape)


def _difference(wanted: _Moved, own: _Moved) -> Array:
    """(2, n) of ln frequency and ln damping ratio, modes of one motion side by side.

    A pair weighs with its MAC squared, as in `fit_to_frequencies`.
    """
    modes, shapes = wanted
    pairs = pair_by_shape(shapes, own[1])
    return np.array(
        [
            mac**2
            * np.log(
                [own[0].f_hz[j] / modes.f_hz[i], own[0].damping_ratio[j] / modes.damping_ratio[i]]
            )
            for i, j, mac in pairs
        ]
    ).T
