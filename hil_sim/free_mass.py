"""A known mass instead of the arm: hung freely, hit through its centre, the sensor on it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.front_end import FrontEnd
from armodal.hil_sim.hand import Blow
from armodal.hil_sim.ringing import force_history

__all__ = ["felt_on_mass"]

FELT_S = 5.0  # the sensors' high pass forgets a pulse within it


def felt_on_mass(
    front: FrontEnd, blow: Blow, mass_kg: float, begin_s: float, rate_hz: float
) -> npt.NDArray[np.float64]:
    """Counts (n, 4), not yet rounded, of a hit that lies along the sensor's z."""
    over_s = max(pulse.delay_s + pulse.width_s for pulse in blow.pulses)
    n_fine = int((begin_s + over_s) * front.fine_hz) + front.span + 2
    force = force_history(blow, begin_s, front.fine_hz, n_fine)
    felt = np.column_stack([force, np.outer(force, [0.0, 0.0, 1.0 / mass_kg])])
    none = np.zeros((0, 4), dtype=np.complex128)
    return front.sample(felt, none, none[:, 0], int((over_s + FELT_S) * rate_hz))
