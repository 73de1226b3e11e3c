"""The linear response of the simulated arm, mode by mode: what its elements are held against."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.ringing import modal_amplitudes, modal_states
from armodal.hil_sim.small_motion import SmallMotion

Array = npt.NDArray[np.float64]


def modal_response(motion: SmallMotion, torque: Array, force: Array, fine_hz: float) -> Array:
    """Specific force (n, 3) at the sensor from a force history, mode by mode, from rest."""
    amplitudes, direct = modal_amplitudes(motion, torque)
    states = modal_states(motion, force, fine_hz)
    response: Array = np.outer(force, direct) + (states.T @ amplitudes).real
    return response
