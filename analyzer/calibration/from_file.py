"""A calibration as a targets file describes it."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.calibration.bodies import BelievedBody
from armodal.analyzer.calibration.calibrate import Calibration, calibrate_inertia
from armodal.analyzer.calibration.targets import (
    FrequencyTarget,
    MomentTarget,
    Target,
    TotalMassTarget,
    ZeroTarget,
)
from armodal.analyzer.workspace.spectrum import elastic_joints
from armodal.protocols.arm.records import Arm
from armodal.protocols.inertia_targets import InertiaTargetsFile, ModesTable

__all__ = ["calibrate_from_file", "modes_target"]


def calibrate_from_file(arm: Arm, file: InertiaTargetsFile) -> Calibration:
    """Calibrate an arm's inertias to the figures of a targets file.

    Raises
    ------
    EstimateError
        If no plausible bodies meet the figures.
    """
    total = file.total_mass.value_kg
    bodies = [
        BelievedBody(
            name=link.name,
            mass_kg=link.volume_share * total,
            center_m=np.array(link.center_m),
            box_m=np.array(link.box_m),
            mass_std=file.mass_std,
            center_std=file.center_std,
            spread_std=file.spread_std,
        )
        for link in file.links
    ]
    number = {joint.name: i for i, joint in enumerate(arm.joints)}
    targets: list[Target] = [
        TotalMassTarget(
            n_joints=len(arm.joints),
            value_kg=total,
            margin_kg=file.total_mass.margin_kg,
            source=file.total_mass.source,
        )
    ]
    targets += [
        MomentTarget(
            joint=number[table.joint],
            joints_rad=np.deg2rad(table.posture_deg),
            value_kg_m2=table.value_kg_m2,
            margin_kg_m2=table.margin_kg_m2,
            source=table.source,
        )
        for table in file.moments
    ]
    targets += [
        ZeroTarget(
            pair=(number[table.joints[0]], number[table.joints[1]]),
            swept=number[table.swept],
            joints_rad=np.deg2rad(table.posture_deg),
            margin_rad=float(np.deg2rad(table.margin_deg)),
            source=table.source,
        )
        for table in file.zeros
    ]
    targets += [modes_target(arm, table) for table in file.modes]
    return calibrate_inertia(
        arm,
        bodies,
        targets,
        base_mass_kg=file.base.volume_share * total,
        base_mass_std=file.mass_std,
    )


def modes_target(arm: Arm, table: ModesTable) -> FrequencyTarget:
    """Return the target a table of modes describes."""
    damping = table.damping_percent or [np.nan] * len(table.f_hz)
    return FrequencyTarget(
        elastic=elastic_joints(arm),
        joints_rad=np.deg2rad(table.posture_deg),
        f_hz=np.array(table.f_hz),
        f_margin_hz=table.f_margin_hz,
        damping_ratio=np.array(damping) / 100,
        damping_margin=(table.damping_margin_percent or 1.0) / 100,
        source=table.source,
    )
