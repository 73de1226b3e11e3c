"""Sealed cases with few postures and points: the whole workflow judges them in seconds."""

import re
from functools import cached_property

import numpy as np

from armodal.hil_sim.study.cases import CaseSpec, SealedCase
from armodal.protocols.plan import plan_from_text


def small_plan(plan, arm, *, postures=3, points=6):
    """The first postures of a plan and its last, which is for validation, with points between."""
    head, *blocks = plan.text.split("[[postures]]")
    every = plan.postures[0].points
    kept = [every[round(i)] for i in np.linspace(0, len(every) - 1, points)]
    listed = ", ".join(f'"{point}"' for point in kept)
    few = [
        re.sub(r"points = \[[^\]]*\]", f"points = [{listed}]", block)
        for block in (*blocks[: postures - 1], blocks[-1])
    ]
    return plan_from_text("[[postures]]".join([head, *few]), arm, origin="small plan")


class SmallCase(SealedCase):
    """A case of a few postures, six points each."""

    n_postures, n_points = 3, 6

    @cached_property
    def plan(self):
        return small_plan(super().plan, self.arm, postures=self.n_postures, points=self.n_points)


class SmallestCase(SmallCase):
    """One posture to learn from and one to foretell, five points each."""

    n_postures, n_points = 2, 5


class FourPostures(SmallCase):
    """Three to learn from and one to foretell."""

    n_postures = 4


def small_case(seed, arm, effect=None, magnitude="clear", *, ladder=False, of=SmallCase):
    """Close a small case; arguments as those of `make_case`."""
    kinds = () if effect is None else (effect,) if isinstance(effect, str) else effect
    return of(
        CaseSpec(number=1, arm=arm, seed=seed, kinds=kinds, magnitude=magnitude, ladder=ladder)
    )
