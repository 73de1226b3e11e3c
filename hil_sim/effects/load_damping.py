"""A drive whose losses grow with the torque it carries at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "LoadDamping"]

LOAD_DAMPING = 2.0  # more damping at the largest load of the postures


class LoadDamping(BaseEffect):
    """Damping c (1 + |gravity torque| / `load_n_m`): the joint's own where it carries nothing."""

    kind: Literal["load_damping"]
    joint: str
    load_n_m: Positive

    def act(self, terms: LinearTerms) -> None:
        """Add what the posture's load brings."""
        row = terms.stretch_of(self.joint)
        c = terms.springs[self.joint].c * abs(terms.load[self.joint]) / self.load_n_m
        terms.C = terms.C + c * np.outer(row, row)


def _of_file(own: FileEffect) -> Twin:
    load = 1.0 / own.sizes["damping_per_load"]
    return Twin(tables=[{"kind": "load_damping", "joint": own.effect.place, "load_n_m": load}])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Losses that grow with the weight a joint carries."""
    loads = {joint: places.loads(joint) for joint in places.elastic[1:3] or places.elastic}
    joint = str(rng.choice(list(loads)))
    largest = max(abs(load) for load in loads[joint])
    load = largest / (LOAD_DAMPING * magnitude * about(rng))
    table = {"kind": "load_damping", "joint": joint, "load_n_m": load}
    return hidden("load_damping", joint, table, load_n_m=load)


def _per_load(true: TrueEffect) -> float:
    return float(1.0 / true.parameters["load_n_m"])


OF_FILE = {"load_damping": _of_file}
COMPARED = {"load_damping": Compared(size=_per_load)}
HIDES = {"load_damping": Hides(hide=hide, since=2, sized=True)}
