"""How a study's verdicts compare with the truth: counts, rates with their intervals, errors.

A name is wrong when it is not true.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from armodal.analyzer.gap.effects import channel_gain, link_axis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.records import EffectFound, GapResult, Verdict

__all__ = [
    "Marked",
    "Rate",
    "instance_of_truth",
    "mark",
    "ordinary_beside",
    "rate",
    "size_found",
    "size_of_truth",
]

OUTCOMES = ("right", "ambiguous with the truth", "unsure", "missed", "outside", "wrong name")


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """k of n with its 95 % Clopper-Pearson interval."""

    k: int
    n: int
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Marked:
    """One case, marked."""

    outcome: str  # one of OUTCOMES
    named: tuple[str, ...]
    true: tuple[str, ...]
    n_true_named: int
    standing: tuple[str, ...]
    place_right: bool | None  # of a single effect named right


def rate(k: int, n: int) -> Rate:
    """A rate with its exact interval (Clopper and Pearson, Biometrika 26 (1934) 404)."""
    low = 0.0 if k == 0 else float(scipy.special.betaincinv(k, n - k + 1, 0.025))
    high = 1.0 if k == n else float(scipy.special.betaincinv(k + 1, n - k, 0.975))
    return Rate(k=k, n=n, low=low, high=high)


def mark(truth: Mapping[str, Any], result: GapResult) -> Marked:
    """Mark a verdict.

    Parameters
    ----------
    truth
        `verdict` and `effects`, a list of `{name, place, parameters}`.
    """
    true = _true_names(truth)
    named = [effect.name for effect in result.effects]
    counted = named if result.verdict is Verdict.NAMED else []
    standing = tuple(r.name for r in result.rivals if r.standing)
    hits, wrong = [], list(counted)
    for t in true:  # each for itself: a true name said twice is once too often
        if t in wrong:
            hits.append(t)
            wrong.remove(t)
    is_outside = truth["verdict"] == "outside_library"
    if wrong:
        outcome = "wrong name"
    elif result.verdict is Verdict.OUTSIDE_LIBRARY:
        outcome = "right" if is_outside else "outside"
    elif result.verdict is Verdict.AMBIGUOUS:
        inside = any(t in standing for t in true)
        outcome = "ambiguous with the truth" if inside else "unsure"
    elif not counted:
        outcome = "missed" if true else "right"
    else:
        outcome = "right" if len(hits) == len(true) else "missed"
    place = None
    if outcome == "right" and len(true) == 1 and counted:
        first = next(e for e in result.effects if e.name == true[0])
        place = _same_place(truth["effects"][0]["place"], first.place)
    return Marked(
        outcome=outcome,
        named=tuple(counted),
        true=tuple(true),
        n_true_named=len(hits),
        standing=standing,
        place_right=place,
    )


def _true_names(truth: Mapping[str, Any]) -> list[str]:
    """Names of the true effects as the library tells them.

    Gears that couple two joints with springs are a coupling: the same terms of K.
    """
    same = {"wrist_coupling": "coupling"} if truth.get("wrist") == "elastic" else {}
    return [same.get(effect["name"], effect["name"]) for effect in truth["effects"]]


def _same_place(true: Any, ours: str) -> bool:
    """Whether our words hold the place; effects of the whole lab have none."""
    whole = {"all", "hammer", "accelerometer", "base"}
    places = true if isinstance(true, list) else [true]
    return all(p in ours or p in whole for p in places) or not ours


def instance_of_truth(ordinary: Ordinary, effect: Mapping[str, Any]) -> Instance | None:
    """The library's instance of a true effect; None where only a search could place it."""
    name, place = effect["name"], effect["place"]
    if name == "link_axis":
        links = [joint.link.name for joint in ordinary.arm.joints]
        p = effect["parameters"]
        direction, point = np.asarray(p["direction"]), np.asarray(p["point_m"])
        before = tuple(p.get("points_before", ()))
        return link_axis.at_axis(ordinary, links.index(place), direction, point, before=before)
    places = [place] if isinstance(place, str) else place
    if name == "channel_gain" and place != "all" and len(place) == 1:
        return channel_gain.at_point(ordinary, effect["parameters"]["axis"], place[0])
    if name == "channel_gain":
        places = [f"axis {effect['parameters']['axis']}"] if place == "all" else places
    fitting = [i for i in all_instances(ordinary) if i.effect.name == name]
    found = [i for i in fitting if not i.place or set(i.place.split(" and ")) == set(places)]
    return found[0] if len(found) == 1 or (found and not found[0].place) else None


def size_of_truth(
    effect: Mapping[str, Any],
    stiffness: Mapping[str, float],
    told: Mapping[str, object] | None = None,
) -> float | None:
    """The true value of what an effect's size parameter measures; None where they differ in kind.

    Parameters
    ----------
    effect
        The true one.
    stiffness
        Believed stiffness of each joint: a coupling is counted in their geometric mean, a
        compensator in its joint's.
    told
        How the effect found describes itself: a base's size is about a level line of its own, a
        soft link's by the length of its own.
    """
    p, place = effect["parameters"], effect["place"]

    def coupling() -> float:
        mean = float(np.sqrt(np.prod([stiffness[j] for j in place])))
        return float(p["cross_stiffness_n_m_per_rad"]) / mean

    def compensator() -> float:
        # Where it stands square to the shorter of its levers: at home the eye's.
        lever_m = p.get("shorter_lever_m", np.linalg.norm(p["eye_m"]))
        return float(p["stiffness_n_per_m"] * lever_m**2) / stiffness[place]

    def base() -> float:
        cross = p.get("rock_xy_n_m_per_rad", 0.0)
        rocking = np.array([[p["rock_x_n_m_per_rad"], cross], [cross, p["rock_y_n_m_per_rad"]]])
        line = np.asarray((told or {}).get("rock_x_about", (1.0, 0.0)), dtype=np.float64)[:2]
        return float(line @ np.linalg.solve(rocking, line))

    def soft_link(stiffness: str) -> float:
        """Per length of the line found: of a hinge both sides' turn is told, and no length."""
        if told is None or "hinge_n_m_per_rad" not in p:
            return 1.0 / float(p[stiffness])
        start, end = (np.asarray(told[at], dtype=np.float64) for at in ("from_m", "to_m"))
        return 1.0 / float(p["hinge_n_m_per_rad"] * np.linalg.norm(end - start))

    sizes: dict[str, Callable[[], float]] = {
        "released_joint": lambda: 1.0 / p["stiffness_n_m_per_rad"],
        "absorber": lambda: p["mass_kg"],
        "bearing": lambda: p["compliance_rad_per_n_m"],
        "link_axis": lambda: p["compliance_rad_per_n_m"],
        "base": base,
        "coupling": coupling,
        "servo": lambda: 1.0 / p["servo_stiffness_n_m_per_rad"],
        "channel_gain": lambda: np.log(p["factor"]),
        "hammer_gain": lambda: np.log(p["factor"]),
        "encoder_offset": lambda: -np.deg2rad(p["offset_deg"]),
        "delay": lambda: p["delay_s"] * (-1.0 if place == "hammer" else 1.0),
        "payload": lambda: p["mass_kg"],
        "rotor": lambda: p["inertia_kg_m2"],
        "hysteretic": lambda: p["loss_factor"],
        "sensor_mass": lambda: p["extra_kg"],
        "link_bending": lambda: soft_link("bending_stiffness_n_m2"),
        "link_torsion": lambda: soft_link("torsional_stiffness_n_m2"),
        "wrist_coupling": lambda: p["ratio"],
        "gravity_compensator": compensator,
        "nonproportional": lambda: p["damping_n_s_per_m"],
        "load_damping": lambda: 1.0 / p["load_n_m"],
        "hit_direction": lambda: np.deg2rad(p["turn_deg"][0]),
        "friction": lambda: p["limit_n_m"],
        "microslip": lambda: p["stiffness_n_m_per_rad"] / p["beside_n_m_per_rad"],
        "backlash": lambda: p["part"],
    }
    if "by_m" in p:
        sizes["wrong_point"] = lambda: p["by_m"][0]
    found = sizes.get(effect["name"])
    if "size" in effect:  # its maker tells it
        return float(effect["size"])
    try:
        return None if found is None else float(found())
    except KeyError:  # of another maker, which tells another quantity
        return None


def ordinary_beside(effect: Mapping[str, Any], truth: Mapping[str, Any]) -> float:
    """What a true arm has of the same kind anyway: nobody can tell it from what was hidden.

    Parameters
    ----------
    truth
        Of the case: of the simulator at home with the plant's tables, what was hidden in their
        effects.
    """
    if "plant" not in truth:
        offsets = truth["encoder_offsets_rad"]
        return -float(offsets[effect["place"]]) if effect["name"] == "encoder_offset" else 0.0
    plant = truth["plant"]
    p, place, name = effect["parameters"], effect["place"], effect["name"]
    same = [e for e in plant["effects"] if e["kind"] == name]
    if name == "encoder_offset":
        total = sum(e["offset_deg"] for e in same if e["joint"] == place)
        return -float(np.deg2rad(total - p["offset_deg"]))
    if name == "delay":
        total = sum(e["delay_s"] * (-1.0 if "hammer" in e["channels"] else 1.0) for e in same)
        return float(total - p["delay_s"] * (-1.0 if place == "hammer" else 1.0))
    if name == "hammer_gain":
        return float(np.log1p(plant["hammer"]["gain_error"]))
    if name == "channel_gain" and place == "all":
        axis = "xyz".index(p["axis"])
        return float(np.log(plant["accelerometer"]["response"][axis][axis]))
    return 0.0


def size_found(effect: EffectFound) -> tuple[float, float, float]:
    """Value and 95 % interval of the parameter that says how large an effect is."""
    interval = effect.parameters[effect.size]
    return interval.value, interval.low, interval.high
