"""What a session's fit becomes in an arm file, so that the file's own model has its modes."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

from armodal.analyzer.corrected.condense import condense
from armodal.analyzer.corrected.correction import Correction, correction_of
from armodal.analyzer.gap.add import file_key
from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.protocols.arm.records import AddedEffect, Arm, EffectParameter, Estimate

__all__ = ["SCALED_UNITS", "Filed", "arm_with", "as_correction", "filed"]

SCALED_UNITS = ("rad/(N m)", "rad/(N m²)", "m/N", "s", "kg m²", "kg", "N s/m")


@dataclass(frozen=True, slots=True, kw_only=True)
class Filed:
    """What goes into the arm file."""

    effects: tuple[AddedEffect, ...]  # all of the arm's
    stiffness: dict[str, Estimate]  # N m/rad by joint
    damping: dict[str, Estimate]  # N m s/rad by joint


def filed(
    final: Fit, arm: Arm, added: Collection[tuple[str, str]], source: str, *, top_hz: float
) -> Filed:
    """Return the values of an arm file whose model has a fit's modes.

    Parameters
    ----------
    arm
        With the effects as they were named and stiffnesses with their uncertainty.
    added
        Names and places of the effects that this fit sized; others keep what the file had.
    source
        Of the values.
    top_hz
        Up to which the session was fitted.

    Raises
    ------
    EstimateError
        If no mode of the fitted model can be told.
    """
    own = correction_of(arm)
    scaled = tuple(
        parameter.name
        for instance in own.hypothesis.instances
        if (instance.effect.name, instance.place or "whole arm") in added
        for parameter in (*instance.parameters, *instance.relaxes.values())
        if parameter.unit in SCALED_UNITS and own.values[parameter.name] > 0.0
    )
    found = condense(as_correction(final), own, scaled, top_hz=top_hz)
    before = {joint.name: joint.stiffness for joint in arm.joints if joint.stiffness is not None}
    logs = intervals(final, [f"ln c {joint}" for joint in before], 1.0)
    return Filed(
        effects=tuple(_scaled(effect, own, found.factors) for effect in arm.effects),
        stiffness={
            joint: Estimate(value=found.stiffness[joint], std=old.std, source=source)
            for joint, old in before.items()
        },
        damping={
            joint: Estimate(
                value=c, std=c * max(logs[f"ln c {joint}"].std, found.damping_error), source=source
            )
            for joint, c in found.damping.items()
        },
    )


def arm_with(arm: Arm, effects: Collection[AddedEffect], stiffness: Mapping[str, Estimate]) -> Arm:
    """Return an arm with other effects and stiffnesses."""
    joints = tuple(
        replace(joint, stiffness=stiffness.get(joint.name, joint.stiffness)) for joint in arm.joints
    )
    return replace(arm, joints=joints, effects=tuple(effects))


def as_correction(final: Fit) -> Correction:
    """Return what a fit believes of the arm, its ordinary errors included."""
    instances = tuple(i for i in final.hypothesis.instances if not i.effect.of_the_test)
    return Correction(
        hypothesis=replace(final.hypothesis, instances=instances),
        values=final.values,
        plain={},
        names=(),
        notes=(),
    )


def _scaled(effect: AddedEffect, own: Correction, factors: Mapping[str, float]) -> AddedEffect:
    """The effect with its sizes as the file's model needs them, its interval with them."""
    by_key = {
        file_key(name, instance.place): factors[name]
        for instance in own.hypothesis.instances
        if effect.name == instance.effect.name and effect.place == (instance.place or "whole arm")
        for name in instance.owned
        if name in factors
    }
    return replace(
        effect,
        parameters=tuple(_times(p, by_key.get(p.name, 1.0)) for p in effect.parameters),
    )


def _times(p: EffectParameter, factor: float) -> EffectParameter:
    return replace(
        p, value=p.value * factor, std=p.std * factor, low=p.low * factor, high=p.high * factor
    )
