"""A drive whose losses grow with the torque it carries at rest."""

from __future__ import annotations

from typing import Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

__all__ = ["OF_FILE", "LoadDamping"]


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


OF_FILE = {"load_damping": _of_file}
