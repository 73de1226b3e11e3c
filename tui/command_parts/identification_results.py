"""Results as JSON for machines and as tables for people."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from rich.table import Table

from armodal.analyzer.identification.records import Identification
from armodal.analyzer.identification.scatter import stated_half_width_95
from armodal.protocols.session.records import Session
from armodal.tui.command_parts.narrow_table import narrow_table
from armodal.tui.deviation import deviation

__all__ = ["identification_json", "identification_tables"]


def mode_json(result: Identification) -> list[dict[str, Any]]:
    """Return the measured modes of the fitted postures."""
    return [
        {
            "posture": mode.posture,
            "f_hz": mode.f_hz,
            "f_std_hz": mode.f_std_hz,
            "damping_ratio": mode.damping_ratio,
            "damping_std": mode.damping_std,
            "mpc": mode.mpc,
            "joint_share": mode.joint_share,
            "structural": mode.structural,
            "model_f_hz": mode.model_f_hz,
            "mac": mode.mac,
        }
        for mode in result.modes
    ]


def identification_json(session: Session, result: Identification) -> dict[str, Any]:
    """Return joints, structural axes, validation, modes and hits as plain values."""
    accepted = len(session.accepted())
    return {
        "explained_by": result.explained_by.value,
        "joints": [
            {
                "joint": joint.joint,
                "k_n_m_per_rad": joint.k_n_m_per_rad,
                "k_std": joint.k_std,
                "k_half_width_95": stated_half_width_95(joint),
                "k_std_model": joint.k_std_model,
                "k_alone_n_m_per_rad": joint.k_alone_n_m_per_rad,
                "k_alone_std_model": joint.k_alone_std_model,
                "k_one_joint_n_m_per_rad": joint.k_one_joint_n_m_per_rad,
                "c_n_m_s_per_rad": joint.c_n_m_s_per_rad,
                "c_std": joint.c_std,
            }
            for joint in result.joints
        ],
        "structural": [
            {
                "link": axis.link,
                "f_hz": axis.f_hz,
                "k_n_m_per_rad": axis.k_n_m_per_rad,
                "k_std": axis.k_std,
                "k_half_width_95": stated_half_width_95(axis),
                "k_std_model": axis.k_std_model,
                "k_alone_n_m_per_rad": axis.k_alone_n_m_per_rad,
                "k_alone_std_model": axis.k_alone_std_model,
                "c_n_m_s_per_rad": axis.c_n_m_s_per_rad,
                "c_std": axis.c_std,
                "direction_link": axis.direction_link.tolist(),
                "point_link_m": axis.point_link_m.tolist(),
                "doubts": list(axis.doubts),
                "mozzi_axes_of_modes": [
                    {
                        "posture": mozzi.posture,
                        "f_hz": mozzi.f_hz,
                        "direction_base": mozzi.direction_base.tolist(),
                        "point_base_m": mozzi.point_base_m.tolist(),
                        "k_eq1_n_m_per_rad": mozzi.k_eq1_n_m_per_rad,
                        "c_eq2_n_m_s_per_rad": mozzi.c_eq2_n_m_s_per_rad,
                        "off_deg": mozzi.line.off_deg,
                        "off_mm": mozzi.line.off_mm,
                        "predicted_bias_deg": mozzi.predicted_bias_deg,
                        "predicted_bias_mm": mozzi.predicted_bias_mm,
                        "predicted_bias_k": mozzi.predicted_bias_k,
                        "triplets": None
                        if mozzi.triplets is None or mozzi.triplet_line is None
                        else {
                            "n": mozzi.triplets.n_triplets,
                            "direction_base": mozzi.triplets.direction.tolist(),
                            "point_base_m": mozzi.triplets.point_m.tolist(),
                            "scatter_deg": mozzi.triplets.angle_rms_deg,
                            "scatter_mm": 1e3 * mozzi.triplets.distance_rms_m,
                            "off_deg": mozzi.triplet_line.off_deg,
                            "off_mm": mozzi.triplet_line.off_mm,
                        },
                    }
                    for mozzi in axis.mozzi
                ],
            }
            for axis in result.axes
        ],
        "validation": [
            {
                "posture": row.posture,
                "mode": row.mode,
                "predicted_hz": row.predicted_hz,
                "predicted_std_hz": row.predicted_std_hz,
                "measured_hz": row.measured_hz,
                "measured_std_hz": row.measured_std_hz,
                "predicted_damping": row.predicted_damping,
                "predicted_damping_std": row.predicted_damping_std,
                "measured_damping": row.measured_damping,
                "measured_damping_std": row.measured_damping_std,
                "mac": row.mac,
            }
            for row in result.validation
        ],
        "modes": mode_json(result),
        "hits": {"accepted": accepted, "rejected": len(session.hits) - accepted},
        "notes": list(result.notes),
        "warnings": list(session.warnings),
    }


def identification_tables(result: Identification) -> list[Table]:
    """Return tables of joints, axes, modes and validation."""
    beside = any(joint.k_n_m_per_rad != joint.k_alone_n_m_per_rad for joint in result.joints)
    what = "beside bearings, links and base" if beside else "of joints alone"
    joints = Table(title=f"Joints (k in N m/rad, {what}; ± of scatter, ± of what the model leaves)")
    alone = ("k alone",) if beside else ()
    for column in ("joint", "k", "± scatter", "± model", *alone, "k one-joint", "c N m s/rad", "±"):
        joints.add_column(column, justify="right")
    for joint in result.joints:
        one = joint.k_one_joint_n_m_per_rad
        joints.add_row(
            joint.joint,
            f"{joint.k_n_m_per_rad:.0f}",
            f"{joint.k_std:.0f}",
            f"{joint.k_std_model:.0f}",
            *([f"{joint.k_alone_n_m_per_rad:.0f}"] if beside else []),
            "no own mode" if one is None else f"{one:.0f}",
            f"{joint.c_n_m_s_per_rad:.2f}",
            f"{joint.c_std:.2f}",
        )
    axes = _axis_table(result)
    modes = narrow_table(
        "Measured modes",
        ("posture", "f Hz", "±", "damping\n%", "±", "joint\nshare", "", "model\nHz", "MAC"),
    )
    for mode in result.modes:
        modes.add_row(
            mode.posture,
            f"{mode.f_hz:.3f}",
            deviation(mode.f_std_hz),
            f"{100 * mode.damping_ratio:.2f}",
            deviation(100 * mode.damping_std, 2),
            f"{mode.joint_share:.2f}",
            "structural" if mode.structural else "",
            "-" if mode.model_f_hz is None else f"{mode.model_f_hz:.3f}",
            "-" if mode.mac is None else f"{mode.mac:.3f}",
        )
    tables = [joints, modes] if axes is None else [joints, axes, modes]
    if result.validation:
        checked = narrow_table(
            "Validation postures: predicted ± std, then measured",
            (
                "posture",
                "mode",
                "f Hz",
                "±",
                "found\nHz",
                "error\n%",
                "damping\n%",
                "±",
                "found\n%",
                "MAC",
            ),
        )
        for row in result.validation:
            known = row.measured_hz is not None
            checked.add_row(
                row.posture,
                str(row.mode),
                f"{row.predicted_hz:.2f}",
                deviation(row.predicted_std_hz),
                f"{row.measured_hz:.2f}" if known else "none",
                f"{100 * (row.predicted_hz / row.measured_hz - 1):+.2f}"
                if row.measured_hz
                else "-",
                f"{100 * row.predicted_damping:.2f}",
                deviation(100 * row.predicted_damping_std, 2),
                "-" if row.measured_damping is None else f"{100 * row.measured_damping:.2f}",
                "-" if row.mac is None else f"{row.mac:.3f}",
            )
        tables.append(checked)
    return tables


def _axis_table(result: Identification) -> Table | None:
    """Compliance axes beside the Mozzi axes of their modes, all in the link's frame."""
    if not result.axes:
        return None
    table = narrow_table(
        "Structural compliance (link frame): the model's axis, the modes' Mozzi axes",
        ("axis", "f Hz", "k, c", "direction", "point mm", "off deg, mm"),
    )
    for axis in result.axes:
        table.add_row(
            axis.link,
            f"{axis.f_hz:.2f}",
            f"{axis.k_n_m_per_rad:.0f}\n± {axis.k_std:.0f}\nmodel ± {axis.k_std_model:.0f}\n"
            f"c {axis.c_n_m_s_per_rad:.2f}",
            _vector(axis.direction_link, 2),
            _vector(1e3 * axis.point_link_m, 0),
        )
        for row in axis.mozzi:
            table.add_row(
                row.posture,
                f"{row.f_hz:.2f}",
                f"{row.k_eq1_n_m_per_rad:.0f}\nbias {100 * row.predicted_bias_k:+.0f} %\n"
                f"c {row.c_eq2_n_m_s_per_rad:.2f}",
                _vector(row.line.direction_link, 2),
                _vector(1e3 * row.line.point_link_m, 0),
                f"{row.line.off_deg:.1f}, {row.line.off_mm:.0f}\n"
                f"bias {row.predicted_bias_deg:.1f}, {row.predicted_bias_mm:.0f}",
            )
            if row.triplets is not None and row.triplet_line is not None:
                table.add_row(
                    f"{row.triplets.n_triplets} triplets",
                    "",
                    f"± {row.triplets.angle_rms_deg:.1f} deg\n"
                    f"± {1e3 * row.triplets.distance_rms_m:.0f} mm",
                    _vector(row.triplet_line.direction_link, 2),
                    _vector(1e3 * row.triplet_line.point_link_m, 0),
                    f"{row.triplet_line.off_deg:.1f}, {row.triplet_line.off_mm:.0f}",
                )
    table.caption = (
        "First the axis released in the model; then, by posture, the mode's Mozzi axis over all "
        "points, with k and c from the mode's frequency, damping and moment of inertia; 'off' is "
        "from the model's axis. A mode in which joints turn too has another Mozzi axis than the "
        "compliance: 'bias' is what the fitted model expects of the same computation."
    )
    return table


def _vector(values: npt.NDArray[np.float64], digits: int) -> str:
    return " ".join(f"{value:.{digits}f}" for value in values)
