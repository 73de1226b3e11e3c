"""Which cases a study has: drawn from its seed, in an order that tells nothing."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.hil_sim.study.cases import CaseSpec
from armodal.hil_sim.study.catalogue import LIBRARY, MAGNITUDES, OUTSIDE

__all__ = ["draw_study"]

# Stiffness that two effects both change is drawn once: these never stand together.
APART = (
    {"rotor", "servo"},
    {"flipped_axis", "swapped_axes"},
    {"flipped_axis", "channel_gain"},
    {"link_bending", "link_torsion"},
    {"link_bending", "link_axis"},
    {"link_torsion", "link_axis"},
    {"coupling", "wrist_coupling"},
    {"softening", "backlash"},
)


def draw_study(
    seed: int,
    *,
    nulls: int = 30,
    effects: int = 60,
    pairs: int = 12,
    outside: int = 12,
    arms: Sequence[str] = ("bench57", "ur5"),
    library: Sequence[str] = tuple(LIBRARY),
    ladder: bool = False,
) -> tuple[CaseSpec, ...]:
    """Draw the cases of a study.

    Effects go round the library; each has the next magnitude and arm every round, whatever the
    library's length, so that as many rounds as both have together show it in all of them. Pairs and
    outside cases are clear. With `ladder` every case is hit at several levels, so that the plan
    tells nothing.
    """
    rng = np.random.default_rng([seed, 0x6A9])
    each = itertools.cycle(arms)
    wanted: list[tuple[tuple[str, ...], str, str]]
    wanted = [((), "none", arm) for _, arm in zip(range(nulls), each, strict=False)]
    names, sizes = list(library), list(MAGNITUDES)
    start = int(rng.integers(len(names)))
    for i in range(effects):
        turn = i % len(names) + i // len(names)
        name = names[(start + i) % len(names)]
        wanted.append(((name,), sizes[turn % len(sizes)], arms[turn % len(arms)]))
    wanted += [(_pair(rng, names), "clear", next(each)) for _ in range(pairs)]
    beyond = list(OUTSIDE)
    for i in range(outside):
        turn = i % len(beyond) + i // len(beyond)
        wanted.append(((beyond[i % len(beyond)],), "clear", arms[turn % len(arms)]))
    order = rng.permutation(len(wanted))
    specs = [
        CaseSpec(
            number=0,
            arm=arm,
            seed=int(rng.integers(1 << 62)),
            kinds=kinds,
            magnitude=size,
            ladder=ladder,
        )
        for kinds, size, arm in wanted
    ]
    return tuple(replace(specs[j], number=i + 1) for i, j in enumerate(order))


def _pair(rng: np.random.Generator, names: Sequence[str]) -> tuple[str, str]:
    while True:
        first, second = (names[i] for i in rng.choice(len(names), 2, replace=False))
        if not any({first, second} <= apart for apart in APART):
            return first, second
