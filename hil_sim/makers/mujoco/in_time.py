"""Hits simulated step by step: whatever is not linear comes out as MuJoCo has it."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import mujoco.rollout
import numpy as np

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.makers.mujoco.compiled import Compiled
from armodal.protocols.errors import PlantError

__all__ = ["ring_in_time"]

THREADS = 2
AT_ONCE = 8  # hits; the loads and states of all steps of more need much memory


def ring_in_time(
    runs: Sequence[Compiled], loads: Sequence[Array], forces_n: Sequence[Array]
) -> list[Array]:
    """Readings of all sensors, (samples, 3 n_sensors), for every run.

    Parameters
    ----------
    runs
        Models of one size, at rest.
    loads
        (nv,) generalised force per newton.
    forces_n
        (samples,) on the model's own steps.

    Raises
    ------
    PlantError
        If the simulation does not stay finite.
    """
    spec = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
    hands = [mujoco.MjData(runs[0].model) for _ in range(THREADS)]
    readings: list[Array] = []
    for first in range(0, len(runs), AT_ONCE):
        some = runs[first : first + AT_ONCE]
        start = np.zeros((len(some), mujoco.mj_stateSize(some[0].model, spec)))
        for i, run in enumerate(some):
            mujoco.mj_getState(run.model, run.data, start[i], spec)
        pushes = zip(forces_n[first : first + AT_ONCE], loads[first:], strict=False)
        _, rung = mujoco.rollout.rollout(
            [run.model for run in some],
            hands,
            start,
            np.array([np.outer(force, load) for force, load in pushes]),
            control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED),
        )
        readings += list(rung)
    if not all(np.all(np.isfinite(reading)) for reading in readings):
        raise PlantError(
            "the simulation in time did not stay finite: an effect of this size is stiffer or "
            "lighter than its steps can follow"
        )
    return readings
