"""What a hit makes of the four channels, before noise: counts, not yet rounded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.hil_sim.front_end import FrontEnd
from armodal.hil_sim.hand import Blow
from armodal.hil_sim.nonlinear_motion import Drive, nonlinear_response
from armodal.hil_sim.small_motion import SmallMotion

__all__ = ["Strike", "force_history", "modal_amplitudes", "modal_states", "ring"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

RING_DOWN = 1e-6  # a response is followed until it has decayed to this part
STEPPED_RING_DOWN = 1e-4  # the same where it is stepped finely to the end: below noise


@dataclass(frozen=True, slots=True, kw_only=True)
class Strike:
    """A blow on the arm with its sensor, beginning `begin_s` after the first sample."""

    motion: SmallMotion
    torque: Array  # (n,) per newton
    blow: Blow
    begin_s: float

    @property
    def over_s(self) -> float:
        """When the hammer has left, after the beginning."""
        return max(pulse.delay_s + pulse.width_s for pulse in self.blow.pulses)

    @property
    def slowest_rad_s(self) -> float:
        """Decay rate that lasts longest."""
        return float(np.min(-self.motion.poles.real))


def force_history(blow: Blow, begin_s: float, fine_hz: float, n: int) -> Array:
    """Force (n,) in N of a blow that begins at `begin_s`, on a grid of `fine_hz` from 0."""
    t = np.arange(n) / fine_hz
    force = np.zeros(n)
    for pulse in blow.pulses:
        phase = (t - begin_s - pulse.delay_s) / pulse.width_s
        inside = (phase > 0.0) & (phase < 1.0)
        force[inside] += pulse.peak_n * np.sin(np.pi * phase[inside])
    return force


def modal_states(motion: SmallMotion, force: Array, fine_hz: float) -> ComplexArray:
    """States (n_modes, n) of the modes above the real axis under a unit drive, from rest.

    Each first-order mode x' = p x + f is advanced exactly for a force that is linear between
    grid points.
    """
    poles = motion.poles[motion.poles.imag >= 0.0]
    T = 1.0 / fine_hz
    a = poles * T
    ramp, step = (np.exp(a) - 1.0 - a) / a**2, (np.exp(a) - 1.0) / a
    states: ComplexArray = np.stack(
        [
            scipy.signal.lfilter([T * r, T * (s - r)], [1.0, -np.exp(z)], force)
            for r, s, z in zip(ramp, step, a, strict=True)
        ]
    )
    return states


def modal_amplitudes(motion: SmallMotion, torque: Array) -> tuple[ComplexArray, Array]:
    """Residues (n_modes, 3) of the modes above the real axis, conjugates counted in; direct part.

    The specific force is the real part of the states times these, plus force times the direct.
    """
    residues, direct = motion.residues(torque)
    upper = motion.poles.imag >= 0.0
    twice = np.where(motion.poles[upper].imag > 0.0, 2.0, 1.0)
    return residues[:, upper].T * twice[:, None], direct


def ring(
    front: FrontEnd,
    strikes: Sequence[Strike],
    delay_s: tuple[float, float, float, float],
    samples: int | None = None,
) -> list[Array]:
    """Counts (n, 4) of each strike, every channel as late as it is.

    Parameters
    ----------
    samples
        Length wanted; None follows each response until it has decayed.
    """
    late = sorted(set(delay_s[1:]))
    runs = {}
    for delay in late:
        if strikes and strikes[0].motion.elements:
            runs[delay] = _stepped(front, strikes, delay, samples)
        else:
            runs[delay] = [_modal(front, strike, delay, samples) for strike in strikes]
    result = []
    for i, strike in enumerate(strikes):
        counts = runs[delay_s[1]][i].copy()
        for channel in (2, 3):
            counts[:, channel] = runs[delay_s[channel]][i][: len(counts), channel]
        if delay_s[0] != delay_s[1]:
            counts[:, 0] = _hammer(front, strike, delay_s[0], len(counts))
        result.append(counts)
    return result


def _hammer(front: FrontEnd, strike: Strike, delay_s: float, n: int) -> Array:
    """Counts (n,) of the hammer alone."""
    begin_s = strike.begin_s + delay_s
    n_fine = int((begin_s + strike.over_s) * front.fine_hz) + front.span + 2
    fine = np.zeros((n_fine, 4))
    fine[:, 0] = force_history(strike.blow, begin_s, front.fine_hz, n_fine)
    none = np.zeros((0, 4), dtype=np.complex128)
    counts: Array = front.sample(fine, none, np.zeros(0, dtype=np.complex128), n)[:n, 0]
    return np.concatenate([counts, np.zeros(n - len(counts))])


def _modal(front: FrontEnd, strike: Strike, delay_s: float, samples: int | None) -> Array:
    """Fine samples while the hammer touches, and one filter length more; then free decay."""
    motion, begin_s = strike.motion, strike.begin_s + delay_s
    n_fine = int((begin_s + strike.over_s) * front.fine_hz) + front.span + 2
    force = force_history(strike.blow, begin_s, front.fine_hz, n_fine)
    amplitudes, direct = modal_amplitudes(motion, strike.torque)
    states = modal_states(motion, force, front.fine_hz)
    felt = np.outer(force, direct) + (states.T @ amplitudes).real
    free = np.zeros((len(amplitudes), 4), dtype=np.complex128)
    free[:, 1:] = states[:, -1:] * amplitudes
    ratio = np.exp(motion.poles[motion.poles.imag >= 0.0] / front.fine_hz)
    lasting_s = np.log(1.0 / RING_DOWN) / strike.slowest_rad_s + strike.over_s
    n = samples or int(lasting_s * front.fine_hz / front.oversampling)
    return front.sample(np.column_stack([force, felt]), free, ratio, n)[:n]


def _stepped(
    front: FrontEnd, strikes: Sequence[Strike], delay_s: float, samples: int | None
) -> list[Array]:
    """All strikes in step on the fine grid, to the end."""
    drives = []
    n = 0
    for strike in strikes:
        begin_s = strike.begin_s + delay_s
        n_force = int((begin_s + strike.over_s) * front.fine_hz) + 2
        force = force_history(strike.blow, begin_s, front.fine_hz, n_force)
        drives.append(Drive(motion=strike.motion, torque=strike.torque, force=force))
        lasting = int(np.log(1.0 / STEPPED_RING_DOWN) / strike.slowest_rad_s * front.fine_hz)
        n = max(n, n_force + lasting)
    if samples is not None:
        n = samples * front.oversampling
    felt = nonlinear_response(drives, front.fine_hz, n)
    result = []
    for drive, accelerations in zip(drives, felt, strict=True):
        force = np.zeros((n, 1))
        used = drive.force[:n]
        force[: len(used), 0] = used
        result.append(front.sample_all(np.hstack([force, accelerations])))
    return result
