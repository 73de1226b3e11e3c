"""Which cases of a maker a study has: drawn from its seed, in an order that tells nothing."""

from __future__ import annotations

import itertools
from functools import partial

from armodal.hil_sim.makers.arms import ARMS, WRISTS
from armodal.hil_sim.makers.case import SIZES, CaseSpec
from armodal.hil_sim.makers.making import arms_of, effects_of, wrists_of
from armodal.hil_sim.streams import stream

__all__ = ["draw_cases"]


def draw_cases(
    maker: str, seed: int, *, nulls: int, effects: int, version: int | None = None
) -> tuple[CaseSpec, ...]:
    """Draw the cases of a study on arms of one maker.

    Nulls go round arms and wrists; effects go round the maker's, each with another size, arm and
    wrist every round. Each choice has a stream of its own: more cases, or another effect, leave the
    others as they are, and a seed of one `version` of the maker's library is drawn alike for ever.

    Raises
    ------
    PlantError
        If there is no such maker, or a package it needs is not installed.
    """
    streams = partial(stream, seed, "study", maker)
    names = sorted(
        effects_of(maker, version), key=lambda name: float(streams("round", name).random())
    )
    wanted: list[tuple[tuple[str, ...], str, str, str, int]] = []
    homes = list(itertools.product(ARMS, WRISTS))
    turn = streams("nulls").permutation(len(homes))
    for i in range(nulls):
        arm, wrist = homes[turn[i % len(homes)]]
        wanted.append(((), "clear", arm, wrist, i))
    for i in range(effects):
        name = names[i % len(names)]
        ways = list(itertools.product(SIZES, arms_of(maker, name), wrists_of(maker, name)))
        order = streams("order", name).permutation(len(ways))
        n = i // len(names)
        wanted.append(((name,), *ways[order[n % len(ways)]], n))
    drawn = []
    for case in wanted:
        rng = streams("case", *case[0], *case[1:])
        drawn.append((float(rng.random()), int(rng.integers(1 << 62)), case))
    return tuple(
        CaseSpec(
            maker=maker,
            seed=case_seed,
            arm=arm,
            wrist=wrist,
            kinds=kinds,
            size_class=size,
            number=number,
        )
        for number, (_, case_seed, (kinds, size, arm, wrist, _)) in enumerate(sorted(drawn), 1)
    )
