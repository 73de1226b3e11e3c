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
    models = [run.model for run in runs]
    spec = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.zeros((len(runs), mujoco.mj_stateSize(models[0], spec)))
    for i, run in enumerate(runs):
        mujoco.mj_getState(run.model, run.data, start[i], spec)
    control = np.array([np.outer(f, load) for f, load in zip(forces_n, loads, strict=True)])
    _, readings = mujoco.rollout.rollout(
        models,
        [mujoco.MjData(models[0]) for _ in range(THREADS)],
        start,
        control,
        control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED),
    )
    if not np.all(np.isfinite(readings)):
        raise PlantError(
            "the simulation in time did not stay finite: an effect of this size is stiffer or "
            "lighter than its steps can follow"
        )
    return list(readings)
