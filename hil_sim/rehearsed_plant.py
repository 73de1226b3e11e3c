"""Any arm's truth, drawn by seed: every ordinary error, and what is to be hidden."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import ValidationError

from armodal.hil_sim.plant import Plant, build_plant, load_plant, shipped_plants
from armodal.hil_sim.plant_file import PlantFile
from armodal.hil_sim.rehearsal import Rehearsal
from armodal.hil_sim.study.any_arm import study_of
from armodal.hil_sim.study.catalogue import LIBRARY, MAGNITUDES, OUTSIDE
from armodal.hil_sim.study.hiding import CaseSpec, hide_in
from armodal.hil_sim.study.plant_of_arm import plant_file_of_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan_records import Plan

__all__ = ["NOT_LIVE", "draw_plant", "parse_hidden"]

NOT_LIVE = frozenset({"exponential_window"})  # of sessions made block by block alone
SAME = 1e-6  # m, kg, kg m²: a shipped plant's file has this many digits


def parse_hidden(texts: Sequence[str]) -> tuple[tuple[str, str | float], ...]:
    """Read effects to be hidden, each "EFFECT" or "EFFECT:SIZE".

    Raises
    ------
    PlantError
        With every text that names no effect, or no size.

    >>> parse_hidden(["bearing", "payload:faint", "backlash:0.3"])
    (('bearing', 'medium'), ('payload', 'faint'), ('backlash', 0.3))
    """
    known = [name for name in (*LIBRARY, *OUTSIDE) if name not in NOT_LIVE]
    found: list[tuple[str, str | float]] = []
    faults: list[str] = []
    for text in texts:
        name, _, told = text.partition(":")
        size = _size(told or "medium")
        if name not in known:
            faults.append(f"{name!r} is no effect: wanted one of {', '.join(known)}")
        if size is None:
            sizes = ", ".join(MAGNITUDES)
            faults.append(f"{told!r} is no size: wanted {sizes}, or a number above 0, at most 1")
        if name in known and size is not None:
            found.append((name, size))
    if faults:
        raise PlantError(f"to hide: {'; '.join(faults)}")
    return tuple(found)


def _size(text: str) -> str | float | None:
    if text in MAGNITUDES:
        return text
    try:
        part = float(text)
    except ValueError:
        return None
    return part if 0.0 < part <= 1.0 and math.isfinite(part) else None


def draw_plant(rehearsal: Rehearsal, seed: int) -> tuple[Plant, list[dict[str, Any]]]:
    """Draw the true arm: every ordinary error, the effects of its file, and what is hidden.

    Where nothing is hidden and a shipped plant is of this very arm, it is that plant, so that a
    shipped arm is what its documents say.

    Returns
    -------
    plant, effects
        Name, place and parameters of each effect, in the arm file's frames.

    Raises
    ------
    PlantError
        If the arm has nothing that gives way, or an effect has no place on it.
    """
    arm = rehearsal.arm
    if not rehearsal.hidden and not arm.effects and arm.name in shipped_plants():
        shipped = load_plant(arm.name)
        if _same_bodies(shipped.truth, arm):
            return shipped, []
    study = study_of(arm, rehearsal.plan)
    # Effects of one size are drawn together; each draws from a stream of its own.
    sizes = {size for _, size in rehearsal.hidden}
    if len(sizes) > 1:
        raise PlantError("to hide: wanted all effects of one size; give each the same")
    spec = CaseSpec(
        number=1,
        arm=arm.name,
        seed=seed,
        kinds=tuple(name for name, _ in rehearsal.hidden),
        magnitude=sizes.pop() if sizes else "none",
    )
    tables, truth = hide_in(study, spec)
    tables = tables | {"hand": _hand(tables["hand"], study.plan.trigger.level_n, rehearsal.plan)}
    if rehearsal.plan is not None:  # what the plan is measured with
        sensor = tables["accelerometer"] | {"mass_kg": rehearsal.plan.sensor.mass_kg}
        tables = tables | {"accelerometer": sensor}
    try:
        plant = build_plant(PlantFile.model_validate(tables))
    except ValidationError as error:
        told = "; ".join(fault["msg"] for fault in error.errors())
        raise PlantError(
            f"{arm.name} cannot be simulated with {', '.join(spec.kinds) or 'its ordinary errors'}:"
            f" {told}; hide another effect, or mend the arm file"
        ) from error
    effects: list[dict[str, Any]] = truth["effects"]
    return plant, effects


def _hand(hand: dict[str, Any], level_n: float, plan: Plan | None) -> dict[str, Any]:
    """A person's hand: now and then double, soft or far too hard."""
    level_n = level_n if plan is None else plan.trigger.level_n
    usual = load_plant("rv4frl").truth.hand
    hardest = hand["peak_n"][1]
    return hand | {
        "double_probability": usual.double_probability,
        "soft_probability": usual.soft_probability,
        "overload_probability": usual.overload_probability,
        "soft_peak_n": (0.5 * level_n, 1.5 * level_n),
        "overload_peak_n": (10.0 * hardest, 15.0 * hardest),
    }


def _same_bodies(truth: PlantFile, arm: Arm) -> bool:
    """Whether a plant has the arm's joints, links and points where the arm file has them."""
    none = [None] * len(arm.joints)
    some = [1.0, *none[1:]]
    believed = plant_file_of_arm(arm, some, some, peak_n=(1.0, 2.0))
    names = [(link.name, link.joint) for link in truth.links]
    if names != [(link.name, link.joint) for link in believed.links]:
        return False
    if [(p.id, p.link) for p in truth.points] != [(p.id, p.link) for p in believed.points]:
        return False
    pairs = [
        *zip(map(_numbers, truth.links), map(_numbers, believed.links), strict=True),
        *((a.position_m, b.position_m) for a, b in zip(truth.points, believed.points, strict=True)),
        (truth.gravity_m_s2, believed.gravity_m_s2),
    ]
    return all(np.allclose(one, other, rtol=SAME, atol=SAME) for one, other in pairs)


def _numbers(link: Any) -> tuple[float, ...]:
    return (*link.origin_m, *link.axis, link.mass_kg, *link.center_m, *link.inertia_kg_m2)
