"""File 002, section 3, Figs. 3 and 5: the mass matrix over postures, and its couplings."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.reproduce.file_002_tables import PAPER, TESTS_DEG
from armodal.analyzer.reproduce.records import Figure, Status, compared, statement
from armodal.analyzer.workspace.coupling import sweep_coupling
from armodal.analyzer.workspace.spectrum import elastic_joints
from armodal.analyzer.workspace.study import study_workspace
from armodal.protocols.arm.records import Arm

__all__ = ["couplings", "figure_3", "gravity"]

ZEROS_DEG = (-38.0, 293.0)


def couplings(arm: Arm) -> list[Figure]:
    """Zeros of M23 over joint 3, and where the coupling is large (Fig. 5)."""
    sweep = sweep_coupling(
        arm, (1, 2), joint=2, limits_rad=(float(np.deg2rad(-66)), float(np.deg2rad(294)))
    )
    figures = [
        compared(
            PAPER,
            "Fig. 5",
            f"zero of M23 near q3 = {published:g}°",
            "deg",
            published=published,
            ours=float(np.rad2deg(zero)),
            margin=1.0,
            status=Status.CALIBRATED_TO,
            why="the print gives whole degrees",
        )
        for published, zero in zip(ZEROS_DEG, sweep.zeros_rad, strict=True)
    ]
    aligned = int(np.argmax(np.abs(sweep.to_second)))
    angle = float(np.rad2deg(sweep.angle_rad[aligned]))
    figures.append(
        statement(
            PAPER,
            "section 3",
            "coupling of joints 2 and 3 falls as the links come to overlap",
            holds=abs(angle - 90) < 60 and bool(np.abs(sweep.to_second[0]) < 0.2),
            status=Status.PREDICTED,
            number=f"|M23|/M33 is largest at q3 = {angle:.0f}°, near the stretched arm (90°), "
            f"{np.abs(sweep.to_second).max():.2f} there, and zero at both ends",
        )
    )
    return figures


def figure_3(arm: Arm, n_postures: int) -> list[Figure]:
    """Statements (a) to (f) on the mass matrix over random postures (Fig. 3)."""
    study = study_workspace(arm, elastic_joints(arm), n_postures)
    mean, std = study.mass.mean, study.mass.std
    direct, wrist = np.diag(mean)[:3], np.diag(mean)[3:5]
    spread = np.diag(std)[:5]
    first_three = [mean[0, 1], mean[0, 2]]
    to_wrist = mean[:3, 3:5]

    def said(item: str, holds: bool, number: str) -> Figure:
        return statement(
            PAPER,
            "section 3, Fig. 3",
            item,
            holds=holds,
            status=Status.PREDICTED,
            number=f"{number} ({n_postures:,} postures)",
        )

    return [
        said(
            "(a) direct terms of joints 1-3 far larger than the wrist's; joint 2's the largest",
            bool(direct.min() > 10 * wrist.max() and direct[1] > direct[0] > direct[2]),
            f"M11, M22, M33 = {direct[0]:.3f}, {direct[1]:.3f}, {direct[2]:.3f}; "
            f"M44, M55 = {wrist[0]:.5f}, {wrist[1]:.5f} kg m²",
        ),
        said(
            "(b) standard deviations of the direct terms fall from joint 1 to joint 5",
            bool((np.diff(spread) <= 1e-12).all()),
            "standard deviations " + ", ".join(f"{value:.2g}" for value in spread) + " kg m²",
        ),
        said(
            "(c) couplings among joints 1-3 much smaller than direct terms, except M23 near M33",
            bool(max(first_three) < 0.25 * direct.min() and mean[1, 2] > 0.5 * direct[2]),
            f"M12, M13, M23 = {mean[0, 1]:.3f}, {mean[0, 2]:.4f}, {mean[1, 2]:.3f}; "
            f"M33 = {direct[2]:.3f} kg m²",
        ),
        said(
            "(d) M23 varies much, so that some postures hardly couple joints 2 and 3",
            bool(std[1, 2] > 0.3 * mean[1, 2] and study.mass.lowest[1, 2] < 0.1 * mean[1, 2]),
            f"mean {mean[1, 2]:.3f}, standard deviation {std[1, 2]:.3f}, "
            f"least {study.mass.lowest[1, 2]:.4f} kg m²",
        ),
        said(
            "(e) arm-to-wrist couplings tiny beside joints 1-3, not beside the wrist's own",
            bool(to_wrist.max() < 0.05 * direct.min() and to_wrist.max() > 0.3 * wrist.min()),
            f"largest mean coupling {to_wrist.max():.4f} kg m²",
        ),
        said(
            "(f) wrist joints 4 and 5 hardly coupled",
            bool(mean[3, 4] < 0.05 * wrist.min()),
            f"M45 = {mean[3, 4]:.2g} against M55 = {wrist[1]:.2g} kg m²",
        ),
    ]


def gravity(arm: Arm) -> list[Figure]:
    """Gravity beside the springs in the five tests (end of section 3)."""
    superset, elastic = Superset(arm), elastic_joints(arm)
    part = max(
        float(
            np.abs(
                np.diag(superset.posture(np.deg2rad(test)).gravity_stiffness)[
                    [superset.joint_column(joint) for joint in elastic.joints]
                ]
                / elastic.stiffness_n_m_per_rad
            ).max()
        )
        for test in TESTS_DEG
    )
    return [
        statement(
            PAPER,
            "section 3",
            "gravity's restoring torques are much smaller than the springs' in the five tests",
            holds=part < 0.01,
            status=Status.PREDICTED,
            number=f"at most {100 * part:.2f} % of a spring's stiffness",
        )
    ]
