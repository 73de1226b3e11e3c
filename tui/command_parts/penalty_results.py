"""`armodal identify --method eq13`: the penalty method beside the fit of the FRFs.

References
----------
Bottin et al., Appl. Sci. 10 (2020) 4619, Eq. (13).
"""

from __future__ import annotations

from enum import StrEnum
from typing import Any

import numpy as np
from rich.table import Table

from armodal.analyzer.identification.penalty_of_session import SessionPenalty, chosen_joints
from armodal.analyzer.identification.records import Identification
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import EstimateError

__all__ = ["Method", "chosen_for", "penalty_json", "penalty_tables"]


class Method(StrEnum):
    """How stiffness is found."""

    FRF = "frf"
    EQ13 = "eq13"


def chosen_for(method: Method, joints: str | None, arm: Arm) -> tuple[int, ...] | None:
    """The joints the penalty method is asked for; None where it is not.

    Raises
    ------
    EstimateError
        If joints are named without the method, or are not elastic joints of the arm.
    """
    if method is Method.FRF:
        if joints is not None:
            raise EstimateError("--joints chooses joints for --method eq13; give both or neither")
        return None
    wanted = [joint.name for joint in arm.joints if joint.stiffness is not None]
    if joints is not None:
        wanted = [part.strip() for part in joints.split(",")]
    return chosen_joints(arm, wanted)


def penalty_json(found: SessionPenalty, result: Identification) -> dict[str, Any]:
    """Chosen joints and paired modes as plain values."""
    fit = found.fit
    whole = {row.joint: row for row in result.joints}
    std = dict(zip(fit.chosen, fit.k_std.tolist(), strict=True))
    return {
        "equation": "Bottin et al., Appl. Sci. 10 (2020) 4619, Eq. (13)",
        "penalty_hz2": fit.penalty_hz2,
        "modes_left_out": fit.left_out,
        "doubted_axes": [
            {
                "link": own.link,
                "rms_with_hz": own.rms_with_hz,
                "rms_without_hz": own.rms_without_hz,
            }
            for own in found.doubted
        ],
        "joints": [
            {
                "joint": name,
                "chosen": i in fit.chosen,
                "start_n_m_per_rad": found.start_n_m_per_rad[i],
                "start_from": found.start_from[i],
                "k_n_m_per_rad": float(fit.structure.stiffness_n_m_per_rad[i]),
                "k_std": std[i] if i in std and np.isfinite(std[i]) else None,
                "c_n_m_s_per_rad": float(fit.structure.damping_n_m_s_per_rad[i]),
                "k_whole_frfs_n_m_per_rad": whole[name].k_alone_n_m_per_rad,
            }
            for i, name in enumerate(found.joints)
        ],
        "pairs": [
            {
                "posture": found.postures[pair.posture],
                "measured_hz": pair.measured_hz,
                "predicted_hz": pair.predicted_hz,
                "measured_damping": pair.measured_damping,
                "predicted_damping": pair.predicted_damping,
                "mac": pair.mac,
            }
            for pair in fit.pairs
        ],
    }


def penalty_tables(found: SessionPenalty, result: Identification) -> list[Table]:
    """Chosen joints and paired modes as tables for people."""
    value = penalty_json(found, result)
    joints = Table(title="Penalty method (Bottin et al. 2020, Eq. 13): k in N m/rad, c by Eq. 6")
    for column in ("joint", "start", "from", "k Eq. 13", "±", "c", "k whole FRFs"):
        joints.add_column(column, justify="right")
    for row in value["joints"]:
        joints.add_row(
            row["joint"],
            f"{row['start_n_m_per_rad']:.0f}",
            row["start_from"],
            f"{row['k_n_m_per_rad']:.0f}" if row["chosen"] else "kept",
            "" if row["k_std"] is None else f"{row['k_std']:.0f}",
            f"{row['c_n_m_s_per_rad']:.3g}",
            f"{row['k_whole_frfs_n_m_per_rad']:.0f}",
        )
    pairs = Table(
        title=f"Modes paired by shape: sum of squares {found.fit.penalty_hz2:.4g} Hz², "
        f"{found.fit.left_out} measured mode(s) of no model shape"
    )
    for column in ("posture", "measured Hz", "model Hz", "measured ζ %", "model ζ %", "MAC"):
        pairs.add_column(column, justify="right")
    for row in value["pairs"]:
        pairs.add_row(
            row["posture"],
            f"{row['measured_hz']:.3f}",
            f"{row['predicted_hz']:.3f}",
            f"{100 * row['measured_damping']:.2f}",
            f"{100 * row['predicted_damping']:.2f}",
            f"{row['mac']:.3f}",
        )
    if found.doubted:
        pairs.caption = " ".join(
            f"Without the arm file's axis in {own.link} the frequencies are met to "
            f"{own.rms_without_hz:.3g} Hz rms, with it to {own.rms_with_hz:.3g}: it may not be "
            "there, and the joints come out too stiff. Give the session's arm without it."
            for own in found.doubted
        )
    return [joints, pairs]
