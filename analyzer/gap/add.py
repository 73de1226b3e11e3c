"""Named effects into an arm file, and an arm file's effects into a hypothesis."""

from __future__ import annotations

from armodal.analyzer.gap.library import described, instances_named
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.records import EffectFound, GapResult
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter, Estimate
from armodal.protocols.errors import ArmError

__all__ = [
    "added_effects",
    "file_key",
    "instances_of_file",
    "is_of_one_posture",
    "joint_estimates",
]


def file_key(name: str, place: str) -> str:
    """Return a parameter's key in an arm file: its name without the place, in one word."""
    words = name
    for part in sorted(place.replace(" and ", " ").split(), key=len, reverse=True):
        words = words.replace(part, "")
    return "_".join(words.split()).lower().replace("-", "_")


def added_effects(
    result: GapResult, *, session_sha256: str, created: str
) -> tuple[AddedEffect, ...]:
    """What a result named, as entries of an arm file.

    Parameters
    ----------
    created
        ISO 8601 time with its zone.
    """
    return tuple(
        _added(effect, session_sha256, created)
        for effect in result.effects
        if not is_of_one_posture(effect)
    )


def is_of_one_posture(effect: EffectFound) -> bool:
    """Return whether an error was made in one posture of a session: no other session has it."""
    return "posture " in effect.place


def _added(effect: EffectFound, session_sha256: str, created: str) -> AddedEffect:
    description: dict[str, str | float | tuple[float, ...]] = {}
    for key, value in effect.description.items():
        if isinstance(value, str):
            description[key] = value
        elif isinstance(value, (list, tuple)):
            description[key] = tuple(float(v) for v in value)
        elif isinstance(value, float):
            description[key] = value
    return AddedEffect(
        name=effect.name,
        place=effect.place or "whole arm",
        parameters=tuple(
            EffectParameter(
                name=file_key(name, effect.place),
                unit=p.unit,
                value=p.value,
                std=p.std,
                low=p.low,
                high=p.high,
            )
            for name, p in effect.parameters.items()
        ),
        description=description,
        evidence=EffectEvidence(
            gain_nats=effect.gain,
            held_out_gain_nats=effect.held_out_gain,
            confidence=effect.confidence,
            session_sha256=session_sha256,
            created=created,
        ),
    )


def joint_estimates(result: GapResult, source: str) -> dict[str, Estimate]:
    """Return the refitted stiffness of every joint, its whole range as the uncertainty."""
    found = {}
    for row in result.joint_stiffness_ranges:
        # The range is a union of 95 % intervals over what stands: two deviations each way.
        std = max(row.k_std, (row.high - row.low) / 4.0)
        found[row.joint] = Estimate(value=row.k_n_m_per_rad, std=std, source=source)
    return found


def instances_of_file(ordinary: Ordinary) -> tuple[tuple[Instance, ...], dict[str, float]]:
    """Return the effects an arm file holds, and the values to begin with.

    Raises
    ------
    ArmError
        If an effect is not in the library, or not at that place of the arm, or in another unit.
    """
    instances: list[Instance] = []
    values: dict[str, float] = {}
    for effect in ordinary.arm.effects:
        instance = _instance(ordinary, effect)
        known = {p.name: p.value for p in effect.parameters}
        units = {p.name: p.unit for p in effect.parameters if p.unit}
        for p in (*instance.parameters, *instance.relaxes.values()):
            name, unit, key = p.name, p.unit, file_key(p.name, instance.place)
            if units.get(key, unit) != unit:
                raise ArmError(
                    f"arm '{ordinary.arm.name}': wanted '{key}' of effect '{effect.name}' in "
                    f"'{unit}', got '{units[key]}'; correct the arm file's [[effects]]"
                )
            # What the description tells is where the instance begins.
            if key in known and name not in instance.begins_at:
                values[name] = known[key]
            elif p.untold is not None:
                values[name] = p.untold
        instances.append(instance)
    return tuple(instances), values


def _instance(ordinary: Ordinary, effect: AddedEffect) -> Instance:
    found = described(ordinary, effect.name, effect.description)
    if found is not None:
        return found
    for instance in instances_named(ordinary, effect.name):
        if effect.place in (instance.place, "whole arm"):
            return instance
    raise ArmError(
        f"arm '{ordinary.arm.name}': the effect '{effect.name}' at '{effect.place}' is not one the "
        "library has there; correct the arm file's [[effects]]"
    )
