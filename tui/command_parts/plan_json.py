"""`armodal plan`: which postures, hits and points to measure, as plain values."""

from __future__ import annotations

from typing import Any

import numpy as np

from armodal.analyzer.planning.compared_plan import ComparedPlan
from armodal.analyzer.planning.made import MadePlan
from armodal.analyzer.planning.selective import SelectivePlan

__all__ = ["made_json", "plan_json"]


def plan_json(plan: SelectivePlan, beside: ComparedPlan | None = None) -> dict[str, Any]:
    """The tests as plain values."""
    arm, elastic = plan.arm, plan.elastic
    names = [joint.name for joint in arm.joints]
    return {
        "arm": arm.name,
        "needed": plan.n_needed,
        "not_isolated": [names[joint] for joint in plan.not_isolated],
        "most_selective": [
            {
                "joint": names[joint],
                "posture_deg": np.rad2deg(posture).tolist(),
                "worst_coupling": float(coupling),
            }
            for joint, posture, coupling in zip(
                elastic.joints, plan.most_selective, plan.least_coupling, strict=True
            )
        ],
        "beside": None
        if beside is None
        else {
            "plan": beside.name,
            "joints": [
                {"joint": names[joint], "posture": posture, "worst_coupling": float(coupling)}
                for joint, posture, coupling in zip(
                    elastic.joints, beside.postures, beside.least_coupling, strict=True
                )
            ],
        },
        "hit_point": plan.hit_point,
        "tests": [
            {
                "posture_deg": np.rad2deg(test.joints_rad).tolist(),
                "validation": number > plan.n_fitted,
                "target": names[test.target],
                "serves": [names[joint] for joint in test.serves],
                "separable_set": [names[joint] for joint in test.separable],
                "coupling": {
                    names[joint]: float(value)
                    for joint, value in zip(elastic.joints, test.coupling, strict=True)
                    if joint != test.target
                },
                "hit_point": test.hit.point,
                "hit_direction": test.hit.direction_base.tolist(),
                "hit_along_normal": test.hit.along_normal,
                "hit_purity": test.hit.purity,
                "points": list(test.points),
                "modes": [
                    {
                        "f_hz": float(f),
                        "damping_ratio": float(damping),
                        "joint_share": {
                            names[joint]: float(share)
                            for joint, share in zip(
                                elastic.joints, test.modes.joint_share[:, i], strict=True
                            )
                        },
                    }
                    for i, (f, damping) in enumerate(
                        zip(test.modes.f_hz, test.modes.damping_ratio, strict=True)
                    )
                ],
                "gravity_torque_n_m": test.gravity.torque_n_m.tolist(),
                "gravity_stiffness_n_m_per_rad": test.gravity.stiffness_n_m_per_rad.tolist(),
                "gravity_part_of_spring": test.gravity.part_of_spring.tolist(),
                "expected_k_std_relative": [
                    float(std) if np.isfinite(std) else None
                    for std in plan.expected_std[min(number, plan.n_fitted) - 1]
                ],
            }
            for number, test in enumerate(plan.tests, start=1)
        ],
    }


def made_json(made: MadePlan) -> dict[str, Any]:
    """What is to be known before the plan is run, as plain values."""
    chosen = made.equipment
    names = [made.plan.arm.joints[joint].name for joint in made.plan.elastic.joints]
    return {
        "equipment": {
            "hammer": chosen.hammer.name,
            "head_kg": chosen.hammer.head_kg,
            "pulse_s": chosen.pulse_s,
            "peak_n": chosen.peak_n,
            "trigger_n": chosen.trigger_n,
            "accelerometer": chosen.accelerometer.name,
            "sensor_kg": chosen.accelerometer.mass_kg,
            "mass_met_kg": chosen.mass_met_kg,
            "source": chosen.source,
        },
        "minutes": made.minutes,
        "mountings": made.mountings,
        "k_std_of_inertias": dict(zip(names, made.inertia_std.tolist(), strict=True)),
        "by_capsules": made.by_capsules,
        "not_checked": list(made.touching),
        "ways": [
            None if leg.stops_rad is None else [np.rad2deg(stop).tolist() for stop in leg.stops_rad]
            for leg in made.legs
        ],
    }
