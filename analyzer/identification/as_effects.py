"""What was identified, in an arm: structural axes are effects, in the gap workflow's words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.analyzer.arm.structure import Axis
from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.identification.records import AxisResult, Identification
from armodal.analyzer.screws import line_sense
from armodal.protocols.arm.records import (
    AddedEffect,
    Arm,
    EffectEvidence,
    EffectParameter,
    Estimate,
)

__all__ = ["identified_arm"]


def identified_arm(
    arm: Arm, result: Identification, *, source: str, session_sha256: str, created: str
) -> Arm:
    """Return a session's arm with what was identified; its text is still the old one.

    Joints have the stiffness and damping that a model of joints and axes alone needs: nothing else
    gives way in it. Effects that were held stay; a structural axis
    takes the place of the one that the arm had in that link.

    Parameters
    ----------
    source
        Of the values.
    created
        ISO 8601 time with its zone. An identification weighs no models against others: the
        evidence of an axis has neither a gain nor a confidence.
    """
    by_name = {row.joint: row for row in result.joints}
    axes = _axes_as_effects(result, session_sha256=session_sha256, created=created)
    fitted = {(effect.name, effect.place) for effect in axes}
    kept = [effect for effect in arm.effects if (effect.name, effect.place) not in fitted]
    joints = tuple(
        joint
        if (row := by_name.get(joint.name)) is None
        else replace(
            joint,
            stiffness=Estimate(
                value=row.k_alone_n_m_per_rad,
                std=float(np.hypot(row.k_std, row.k_alone_std_model)),
                source=source,
            ),
            damping=Estimate(value=row.c_n_m_s_per_rad, std=row.c_std, source=source),
        )
        for joint in arm.joints
    )
    return replace(arm, joints=joints, effects=(*kept, *axes))


def _axes_as_effects(
    result: Identification, *, session_sha256: str, created: str
) -> tuple[AddedEffect, ...]:
    evidence = EffectEvidence(
        gain_nats=None,
        held_out_gain_nats=None,
        confidence=None,
        session_sha256=session_sha256,
        created=created,
    )
    lines = result.fit.state.structure.axes
    return tuple(
        _as_effect(axis, line, evidence) for axis, line in zip(result.axes, lines, strict=True)
    )


def _as_effect(axis: AxisResult, line: Axis, evidence: EffectEvidence) -> AddedEffect:
    k, c = axis.k_alone_n_m_per_rad, axis.c_n_m_s_per_rad
    k_std = float(np.hypot(axis.k_std, axis.k_alone_std_model))
    loss = c / k
    loss_std = loss * float(np.hypot(axis.c_std / c, axis.k_std / k)) if c > 0.0 else 0.0
    return AddedEffect(
        name=link_axis.WORDS.name,
        place=axis.link,
        parameters=(
            _parameter("axis_compliance", "rad/(N m)", 1.0 / k, k_std / k**2),
            _parameter("axis_loss", "s", loss, loss_std),
        ),
        description={
            "link": axis.link,
            "direction": tuple(line_sense(line.direction).tolist()),
            "point_m": tuple(line.point_m.tolist()),
        },
        evidence=evidence,
    )


def _parameter(name: str, unit: str, value: float, std: float) -> EffectParameter:
    reach = TWO_SIDED_95 * std
    return EffectParameter(
        name=name, unit=unit, value=value, std=std, low=max(value - reach, 0.0), high=value + reach
    )
