"""Effects as an arm file holds them."""

from dataclasses import replace

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import file_key
from armodal.analyzer.gap.library import all_instances, hooks
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter

EVIDENCE = EffectEvidence(
    gain_nats=200.0,
    held_out_gain_nats=20.0,
    confidence=0.99,
    session_sha256="0" * 64,
    created="2026-01-01T00:00:00+00:00",
)

AXIS_DIRECTION, AXIS_POINT = (0.6, 0.0, 0.8), (0.04, 0.02, -0.03)

SWING_RAD, RATE_RAD_S = 3e-5, 100.0  # of a joint with a law of its own, under a hit

KNOWN = {}  # by an arm's identity: the arm itself, and all that is ordinary about it


def added(name, place, description=None, /, *, std=0.1, **values):
    """An effect with these values by their keys in the file."""
    return AddedEffect(
        name=name,
        place=place,
        parameters=tuple(
            EffectParameter(
                name=key, unit="", value=v, std=std * abs(v), low=v - abs(v), high=v + abs(v)
            )
            for key, v in values.items()
        ),
        description=description or {},
        evidence=EVIDENCE,
    )


def axis(link, compliance=1e-5, loss=1e-4, **more):
    """A skew axis inside a link."""
    where = {"link": link, "direction": AXIS_DIRECTION, "point_m": AXIS_POINT, **more}
    return added("link_axis", link, where, axis_compliance=compliance, axis_loss=loss)


def with_effects(arm, *effects):
    """An arm, or a shipped one, with effects."""
    return replace(load_arm(arm) if isinstance(arm, str) else arm, effects=effects)


def _ordinary(arm):
    if id(arm) not in KNOWN:
        KNOWN[id(arm)] = arm, Ordinary(superset=Superset(arm), postures=())
    return KNOWN[id(arm)][1]


def _instances(arm):
    """The library at every place of an arm, and every law of every elastic joint."""
    ordinary = _ordinary(arm)
    yield from all_instances(ordinary)  # which keeps those of an arm
    for i in ordinary.elastic:
        for laws in hooks("laws"):
            yield from laws(ordinary, arm.joints[i].name, SWING_RAD, RATE_RAD_S)


def any_of(arm, name, place=None, factor=1.0):
    """An effect of the library as large as its prior's deviations, at its first place."""
    instance = next(
        i for i in _instances(arm) if i.effect.name == name and place in (None, i.place)
    )
    every = (*instance.parameters, *instance.relaxes.values())
    sizes = {p.name: p.mean + 0.5 * factor * p.std for p in every}
    told = None if instance.describe is None or instance.relaxes else instance.describe(sizes)
    told = {k: tuple(v) if isinstance(v, list) else v for k, v in (told or {}).items()}  # as read
    values = {file_key(key, instance.place): value for key, value in sizes.items()}
    return added(name, instance.place or "whole arm", told, **values)
