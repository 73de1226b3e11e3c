"""Which cases a study has: drawn from its seed, in an order that tells nothing."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

from armodal.hil_sim.streams import Streams, stream
from armodal.hil_sim.study.catalogue import LIBRARY, MAGNITUDES, OUTSIDE, stand_apart
from armodal.hil_sim.study.hiding import CaseSpec

__all__ = ["draw_study"]


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

    Effects go round the library; each has another magnitude and arm every round, so that as many
    rounds as there are of both together show it in all of them. Pairs and outside cases are clear.
    With `ladder` every case is hit at several levels, so that the plan tells nothing.

    Every choice is drawn by what is chosen: more cases, or another name in the library, leave the
    seeds and the order of the others as they are.
    """
    streams = partial(stream, seed, "study")
    wanted = [_Wanted((), "none", arms[i % len(arms)]) for i in range(nulls)]
    wanted += _rounds(effects, library, tuple(MAGNITUDES), arms, streams)
    for i in range(pairs):
        pair = _pair(_shuffled(library, partial(streams, "pair", i)))
        wanted.append(_Wanted(pair, "clear", arms[i % len(arms)]))
    wanted += _rounds(outside, tuple(OUTSIDE), ("clear",), arms, streams)
    drawn = sorted(_drawn(wanted, streams))
    return tuple(
        CaseSpec(
            number=number,
            arm=case.arm,
            seed=case_seed,
            kinds=case.kinds,
            magnitude=case.magnitude,
            ladder=ladder,
        )
        for number, (_, case_seed, case) in enumerate(drawn, 1)
    )


class _Wanted(NamedTuple):
    kinds: tuple[str, ...]
    magnitude: str
    arm: str


def _drawn(wanted: Iterable[_Wanted], streams: Streams) -> Iterator[tuple[float, int, _Wanted]]:
    """Place in the study, seed and case of each; cases alike are told apart by their number."""
    before: Counter[_Wanted] = Counter()
    for case in wanted:
        rng = streams("case", case.arm, case.magnitude, *case.kinds, before[case])
        before[case] += 1
        yield float(rng.random()), int(rng.integers(1 << 62)), case


def _rounds(
    n: int,
    names: Sequence[str],
    magnitudes: Sequence[str],
    arms: Sequence[str],
    streams: Streams,
) -> Iterator[_Wanted]:
    """Round after round of all names, the last one of some of them."""
    every = list(itertools.product(magnitudes, arms))
    order = {name: streams("order", name).permutation(len(every)) for name in names}
    shuffled = _shuffled(names, partial(streams, "rounds"))
    for i in range(n):
        turn, name = i // len(names), shuffled[i % len(names)]
        magnitude, arm = every[order[name][turn % len(every)]]
        yield _Wanted((name,), magnitude, arm)


def _shuffled(names: Sequence[str], streams: Streams) -> list[str]:
    """Names by lot: another name among them leaves the order of the others."""
    return sorted(names, key=lambda name: float(streams(name).random()))


def _pair(names: Sequence[str]) -> tuple[str, str]:
    """The first name and the first after it that may stand beside it."""
    first, *others = names
    beside = (name for name in others if not stand_apart(first, name))
    return first, next(beside)
