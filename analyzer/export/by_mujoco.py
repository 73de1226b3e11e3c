"""What MuJoCo makes of an exported arm: natural frequencies of its elastic joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg

from armodal.analyzer.corrected.correction import Correction
from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.analyzer.export.tree import Tree
from armodal.protocols.errors import EstimateError, MissingPackageError

__all__ = ["Compared", "compare_frequencies", "load_mujoco", "simulator_frequencies"]

Array = npt.NDArray[np.float64]

_STEP = 1e-6  # rad or m, for the slope of forces: a millionth bends nothing
_INSIDE = 0.05  # of each joint's range, kept from both ends
_SEED = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """Natural frequencies without damping of the arm file and of a simulator, posture by posture.

    Of the modes below 2 kHz; beyond are those of what gives way next to nothing.
    """

    joints_rad: Array  # (n, n_joints)
    largest: float  # relative difference
    largest_hz: float  # of the mode that has it
    n_modes: int  # compared in every posture


def load_mujoco() -> ModuleType:
    """Return the package.

    Raises
    ------
    MissingPackageError
        If it is not installed.
    """
    try:
        return import_module("mujoco")
    except ImportError as error:
        raise MissingPackageError(
            "wanted the package mujoco to read and check MJCF, it is not installed. Install it: "
            "`pip install 'armodal[simulators]'`"
        ) from error


def simulator_frequencies(
    mujoco: Any, model: Any, elastic: tuple[str, ...], joints_rad: Mapping[str, float]
) -> Array:
    """Natural frequencies in Hz of the elastic joints, driven ones held, lowest first.

    Eigenvalues of M^-1 K with the simulator's own mass matrix, and K the slope of its own forces.

    Raises
    ------
    EstimateError
        If a spring does not hold the arm.
    """
    data = mujoco.MjData(model)
    for name, angle in joints_rad.items():
        data.qpos[model.joint(name).qposadr[0]] = angle
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    at = [int(model.joint(name).dofadr[0]) for name in elastic]
    places = [int(model.joint(name).qposadr[0]) for name in elastic]
    rest = data.qpos.copy()

    def forces(place: int, step: float) -> Array:
        data.qpos[:] = rest
        data.qpos[place] += step
        mujoco.mj_forward(model, data)
        return np.asarray((data.qfrc_bias - data.qfrc_passive)[at])

    columns = [(forces(p, _STEP) - forces(p, -_STEP)) / (2.0 * _STEP) for p in places]
    K = np.stack(columns, axis=1)
    square = scipy.linalg.eigvalsh((K + K.T) / 2.0, mass[np.ix_(at, at)])
    if square[0] <= 0.0:
        raise EstimateError("the exported springs do not hold the arm in the simulator")
    return np.asarray(np.sqrt(square) / (2.0 * np.pi))


def compare_frequencies(
    correction: Correction, tree: Tree, mujoco: Any, model: Any, *, n_postures: int, below_hz: float
) -> Compared:
    """Set a simulator's frequencies beside the arm file's own in random postures."""
    arm = correction.ordinary.arm
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    room = np.random.default_rng(_SEED).uniform(_INSIDE, 1.0 - _INSIDE, (n_postures, len(low)))
    postures = low + (high - low) * room
    offset = correction.ordinary.encoder(correction.values)
    worst, worst_hz, fewest = 0.0, 0.0, len(tree.elastic)
    for q in postures:
        own = corrected_posture(correction, stand(correction, q))
        square = scipy.linalg.eigvalsh(own.stiffness, own.mass)
        wanted = np.sqrt(square[square > 0.0]) / (2.0 * np.pi)
        angles = dict(zip((j.name for j in arm.joints), (q + offset).tolist(), strict=True))
        found = simulator_frequencies(mujoco, model, tree.elastic, angles)
        heard = wanted < below_hz
        fewest = min(fewest, int(heard.sum()))
        off = np.abs(found[: len(wanted)][heard] / wanted[heard] - 1.0)
        if off.max() > worst:
            worst, worst_hz = float(off.max()), float(wanted[heard][off.argmax()])
    return Compared(joints_rad=postures, largest=worst, largest_hz=worst_hz, n_modes=fewest)
