"""Effects that an arm file holds, as effects of the simulated arm.

An arm file gives an effect's sizes with deviations, lines and points in link frames
(`docs/arm-file.md`). The simulated arm has the twins of `hil_sim.effects`, drawn from those
deviations; each module there reads its own (`hil_sim/effects/from_file.py`). What a file does not
tell of them is the laboratory's own: a rotor's gear ratio, a base's radii, what a bearing loses,
how a link's mass is cut where it bends.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from armodal.hil_sim.effects import modules_with
from armodal.hil_sim.effects.from_file import FileEffect, Twin, Unlike, of_the_test
from armodal.hil_sim.streams import stream
from armodal.hil_sim.study.model_error import INTERFACE_LOSS_S, Tables
from armodal.hil_sim.study.plant_of_arm import rotations
from armodal.protocols.arm.records import AddedEffect, Arm
from armodal.protocols.errors import PlantError

__all__ = ["OF_THE_TEST", "with_file_effects"]

_TWINS: dict[str, Callable[[FileEffect], Twin]] = {
    name: read
    for module in modules_with("OF_FILE").values()
    for name, read in module.OF_FILE.items()
}
# Of a session, not of the arm: the laboratory has sensors and a hand of its own.
OF_THE_TEST = frozenset(name for name, read in _TWINS.items() if read is of_the_test)


def with_file_effects(tables: Tables, arm: Arm, seed: int) -> Tables:
    """Return a plant's tables with the effects of an arm file in them.

    Raises
    ------
    PlantError
        If an effect has no twin, or lacks a size; all are named.
    """
    twins, faults = [], []
    for effect in arm.effects:
        read = _TWINS.get(effect.name)
        if read is None:
            faults.append(f"{effect.name} ({effect.place}), of which it has none")
            continue
        try:
            twins.append(read(_drawn(arm, effect, seed)))
        except KeyError as missing:
            faults.append(f"{effect.name} ({effect.place}), which lacks {missing.args[0]}")
        except Unlike as what:
            faults.append(f"{effect.name} ({effect.place}): it has no {what}")
    if faults:
        raise PlantError(
            f"arm '{arm.name}': wanted effects that the simulated laboratory has too, got "
            f"{'; '.join(faults)}; give the arm file without them"
        )
    replaced = {place for twin in twins for place in twin.replaces}
    damping = {joint: c for twin in twins for joint, c in twin.damping.items()}
    kept = [
        table
        for table in tables["effects"]
        if (table["kind"], table.get("joint", "")) not in replaced
    ]
    links = [
        link | {"damping_n_m_s_per_rad": damping[link["joint"]]}
        if link["joint"] in damping
        else link
        for link in tables["links"]
    ]
    added = [table for twin in twins for table in twin.tables]
    return tables | {"links": links, "effects": [*kept, *added]}


def _drawn(arm: Arm, effect: AddedEffect, seed: int) -> FileEffect:
    """With true sizes: what is positive by its logarithm, none beyond two deviations."""
    rng_of = partial(stream, seed, "file effect", effect.name, effect.place)
    low, high = np.log(INTERFACE_LOSS_S)
    sizes = {}
    for own in effect.parameters:
        off = float(np.clip(rng_of(own.name).standard_normal(), -2.0, 2.0)) * own.std
        positive = own.value > 0.0
        sizes[own.name] = own.value * np.exp(off / own.value) if positive else own.value + off
    return FileEffect(
        arm=arm,
        effect=effect,
        sizes=sizes,
        loss_s=float(np.exp(rng_of("loss").uniform(low, high))),
        turned=rotations(arm),
    )
