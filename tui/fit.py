"""Modes of every posture of a session, for `armodal fit`."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.table import Table

from analyzer.arm.superset import Superset
from analyzer.identification.identify import estimate_frfs
from analyzer.identification.mode_fit import MeasuredModes
from analyzer.identification.structural import STRUCTURAL_SHARE, joint_share
from analyzer.modal import ModalModel, Stabilisation, fit_modes
from protocols.session.records import Session

__all__ = ["fit_session", "stable_poles"]

SAME_F, SAME_DAMPING = 0.01, 0.05  # relative, between consecutive orders: the usual criterion


def fit_session(
    session: Session, *, band_hz: tuple[float, float] | None = None
) -> tuple[dict[str, Any], Table]:
    """Fit the modes of every posture; return them as plain values and as a table."""
    superset = Superset(session.header.arm)
    table = Table(title="Modes")
    for column in ("posture", "f Hz", "±", "damping %", "±", "MPC", "joint share", ""):
        table.add_column(column, justify="right")
    modes: list[dict[str, Any]] = []
    errors: dict[str, float] = {}
    stabilisation: dict[str, Any] = {}
    for frf in estimate_frfs(session, superset):
        model = fit_modes(frf, band_hz=band_hz)
        errors[frf.posture] = model.synthesis_error
        stabilisation[frf.posture] = _stabilisation(model)
        if frf.joints_rad is None:
            continue
        measured = MeasuredModes.of(superset, superset.posture(frf.joints_rad), model)
        for mode, shape in zip(model.modes, measured.shapes.T, strict=True):
            # Without an arm there are no joints to share a mode with.
            share = joint_share(superset, measured, shape) if superset.n_joints else None
            structural = share is not None and share < STRUCTURAL_SHARE
            modes.append(
                {
                    "posture": frf.posture,
                    "f_hz": mode.f_hz,
                    "f_std_hz": mode.f_std_hz,
                    "damping_ratio": mode.damping_ratio,
                    "damping_std": mode.damping_std,
                    "mpc": mode.mpc,
                    "mpd_deg": mode.mpd_deg,
                    "structural": structural,
                    "joint_share": share,
                }
            )
            table.add_row(
                frf.posture,
                f"{mode.f_hz:.3f}",
                f"{mode.f_std_hz:.3f}",
                f"{100 * mode.damping_ratio:.2f}",
                f"{100 * mode.damping_std:.2f}",
                f"{mode.mpc:.3f}",
                "-" if share is None else f"{share:.2f}",
                "structural" if structural else "",
            )
    value = {
        "modes": modes,
        "synthesis_error": errors,
        "stabilisation": stabilisation,
        "warnings": list(session.warnings),
    }
    return value, table


def _stabilisation(model: ModalModel) -> dict[str, Any]:
    """Poles over model orders, as plain values."""
    found = model.stabilisation
    f_hz, damping, stable = found.f_hz, found.damping_ratio, stable_poles(found)
    return {
        "band_hz": list(model.band_hz),
        "orders": list(found.orders),
        "poles": [
            {
                "order": int(order),
                "f_hz": float(f),
                "damping_ratio": float(ratio),
                "stable": bool(same),
            }
            for order, f, ratio, same in zip(found.order, f_hz, damping, stable, strict=True)
        ],
    }


def stable_poles(found: Stabilisation) -> npt.NDArray[np.bool_]:
    """Return which poles (n_poles,) the order before has too, by frequency and damping."""
    f_hz, damping = found.f_hz, found.damping_ratio
    stable = np.zeros(len(f_hz), dtype=bool)
    for before, order in pairwise(found.orders):
        new, old = found.order == order, found.order == before
        near_f = np.abs(f_hz[new][:, None] - f_hz[old]) <= SAME_F * f_hz[new][:, None]
        near_damping = (
            np.abs(damping[new][:, None] - damping[old])
            <= SAME_DAMPING * np.abs(damping[new])[:, None]
        )
        stable[new] = (near_f & near_damping).any(axis=1)
    return stable
