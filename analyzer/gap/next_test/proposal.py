"""The one further test that would tell most: of rivals that stand, or of what could hide.

For data that one rival would give in a new test, the log density under each rival integrates over
what its fit left open (as in `inference.left_out`). The difference is the evidence that the test is
expected to bring for the true one; a test is as good as its worst pair of rivals, whichever is
true.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.fit import Fit, Stage, best_starting_point, fit_hypothesis
from armodal.analyzer.gap.model.assembly import BASE
from armodal.analyzer.gap.model.columns import Columns
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.model.weigh import Discrepancy, Weighing
from armodal.analyzer.gap.model.weighed_sums import summed
from armodal.analyzer.gap.next_test.possible_tests import Doable, Test, possible_tests
from armodal.analyzer.gap.search.scan import Candidate

__all__ = [
    "evidence_brought",
    "expected_evidence",
    "hidden_rival",
    "proposed",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]
# Of lines and rows, predictions and their derivatives, as `fit.Stage.once` has them.
_Answer = tuple[list[tuple[int, int]], ComplexArray, ComplexArray]

NAME = "next"
_PLENTY = 100.0  # nats that no better test is looked for: they tell already
_BETTER = 1.1  # times the evidence: for less nothing more is asked of the laboratory
_NO_BETTER = 0.5  # nats
_ROUNDS = 4
_AT_ONCE = 4  # tests whose postures are solved together
_LINES = 25  # that are enough to tell which test is best
_PINNED = 0.02  # of a hidden size: how firmly it is held
_STEPS, _STEPS_AGAIN = 6, 12


def proposed(
    stage: Stage,
    rivals: Sequence[Fit],
    *,
    rng: np.random.Generator,
    tell: Callable[[str], None] = lambda _: None,
) -> tuple[Test, float] | None:
    """The test of most evidence between rivals, and how much in nats; None where there is one.

    The best of all kinds, then changed in one choice at a time while that brings clearly more.
    """
    if len(rivals) < 2:
        return None
    tell("the next test")
    can = Doable.of(stage, rivals[0])
    tests = possible_tests(stage, rivals[0], rng=rng)
    best, gain = _best(stage, rivals, tests)
    for _ in range(_ROUNDS):
        if gain > _PLENTY:
            break
        other, more = _best(stage, rivals, list(can.beside(best, rng)))
        if more < max(_BETTER * gain, gain + _NO_BETTER):
            break
        best, gain = other, more
    return best, gain


def _best(stage: Stage, rivals: Sequence[Fit], tests: Sequence[Test]) -> tuple[Test, float]:
    """The best on some of the lines, and its evidence on all."""
    every = max(round(stage.lines[0].s_rad_s.size / _LINES), 1)
    gains = expected_evidence(stage, rivals, tests, every=every)
    best = tests[int(np.argmax(gains))]
    if every == 1:
        return best, float(np.max(gains))
    return best, float(expected_evidence(stage, rivals, [best])[0])


def expected_evidence(
    stage: Stage, rivals: Sequence[Fit], tests: Sequence[Test], *, every: int = 1
) -> Array:
    """Least evidence, over which rival is true and against which, that tests are expected to bring.

    Parameters
    ----------
    rivals
        Two at least.
    stage
        The sharp lines; scatter and points are taken to be as in its first posture.
    every
        Only one of so many lines: less evidence, in nearly the same order of tests.

    Returns
    -------
    (n_tests,) nats
    """
    superset = rivals[0].hypothesis.ordinary.superset
    ready = [_Ready.of(rival) for rival in rivals]
    found = np.empty(len(tests))
    for at_once in _alike(tests):
        lines = [_lines(stage, superset.point_index, tests[t], every) for t in at_once]
        posed = [PosedModel(superset, tests[t].joints_rad) for t in at_once]
        of_tests = Stage(
            superset,
            [blank for blanks, _ in lines for blank in blanks],
            Discrepancy(),
            models=[model for model, (blanks, _) in zip(posed, lines, strict=True) for _ in blanks],
        )
        answers = [_answers(of_tests, own) for own in ready]
        first = 0
        for t, (blanks, floors) in zip(at_once, lines, strict=True):
            rows = range(first, first + len(blanks))
            own = [_of_rows(answer, rows) for answer in answers]
            found[t] = _least_evidence(blanks, floors, ready, own, superset)
            first += len(blanks)
    return found


def _alike(tests: Sequence[Test]) -> Iterator[list[int]]:
    """Tests with the same mountings and brakes, a few at a time, to be solved at once."""
    alike: dict[tuple[object, ...], list[int]] = {}
    for t, test in enumerate(tests):
        alike.setdefault((test.more_points, test.brakes), []).append(t)
    for own in alike.values():
        for i in range(0, len(own), _AT_ONCE):
            yield own[i : i + _AT_ONCE]


def _answers(of_tests: Stage, ready: _Ready) -> list[_Answer]:
    """What a rival would give, soft and hard hits at once."""
    every = range(len(of_tests.lines))
    return [
        (rows, *together.derivatives(ready.hypothesis, ready.space, ready.values))
        for rows, together in of_tests.once(ready.hypothesis, every)
    ]


def _of_rows(answers: Sequence[_Answer], rows: range) -> list[_Answer]:
    """Answers of some lines alone, counted from the first."""
    found: list[_Answer] = []
    for pairs, y, dy in answers:
        own = [(p - rows.start, i) for p, i in pairs if p in rows]
        at = list(dict.fromkeys(i for _, i in own))
        if own:
            found.append(([(p, at.index(i)) for p, i in own], y[at], dy[:, at]))
    return found


def _least_evidence(
    blanks: Sequence[PostureLines],
    floors: Sequence[Array],
    ready: Sequence[_Ready],
    answers: Sequence[Sequence[_Answer]],
    superset: Superset,
) -> float:
    """Of one test: its lines, and what each rival gives."""
    least = np.inf
    for true in range(len(ready)):
        would = {p: y[i] for pairs, y, _ in answers[true] for p, i in pairs}
        by_hit_direction = {
            p: own
            for pairs, _, dy in answers[true]
            for p, own in ready[true].by_hit_direction(pairs, dy)
        }
        weighings = [
            _weighing(blank, floor, would[p], by_hit_direction[p], superset)
            for p, (blank, floor) in enumerate(zip(blanks, floors, strict=True))
        ]
        surprises = [_surprise(weighings, own, of) for own, of in zip(ready, answers, strict=True)]
        others = (s for other, s in enumerate(surprises) if other != true)
        least = min(least, min(others) - surprises[true])
    return float(least)


def _weighing(
    blank: PostureLines,
    floor: Array,
    would: ComplexArray,
    by_hit_direction: Array,
    superset: Superset,
) -> Weighing:
    """Of what a rival would give: scatter, the blank's, goes with the answer, noise does not.

    Where hits hardly move a mode, scatter is what their aim makes of it: more than goes with it.
    """
    size = float(np.mean(np.abs(would) ** 2) / np.mean(np.abs(blank.values) ** 2))
    variance = floor + np.maximum(blank.variance * size, by_hit_direction)
    lines = replace(blank, values=would, variance=variance)
    on_base = np.array(superset.point_link)[lines.sensor_point] == BASE
    return Weighing(lines, superset.arm.tolerances, Discrepancy(), on_base=on_base)


def evidence_brought(one: Fit, other: Fit, stage: Stage) -> float:
    """Evidence for one hypothesis against another that further lines brought, both fitted again.

    Parameters
    ----------
    stage
        The lines both were fitted to, and those of a further test.
    """
    brought = []
    for fit in (one, other):
        postures = tuple(dict.fromkeys(lines.name for lines in stage.lines))
        ordinary = replace(fit.hypothesis.ordinary, postures=postures)
        more = replace(fit.hypothesis, ordinary=ordinary)
        again = fit_hypothesis(stage, more, start=fit.values, max_iterations=_STEPS_AGAIN)
        brought.append(again.evidence - fit.evidence)
    return brought[1] - brought[0]


def hidden_rival(stage: Stage, final: Fit, candidate: Candidate, change: float) -> Fit:
    """The final model with an effect that could hide in it, held at a size it could have.

    Parameters
    ----------
    change
        Of the size, from what the final model has of it.
    """
    instance, present = candidate.instance, final.hypothesis
    name = instance.size
    size = final.values.get(name, 0.0) + change

    def firm(p: Parameter) -> Parameter:
        return replace(p, mean=size, std=_PINNED * abs(change), start=size)

    begin = {n: final.values[n] + per * change for n, per in candidate.follow.items()}
    begin = {**final.values, **{n: v for n, v in begin.items() if n in final.values}, name: size}
    if name in instance.relaxes:
        relaxes = {n: firm(p) if n == name else p for n, p in instance.relaxes.items()}
        pinned = replace(instance, relaxes=relaxes)
    else:
        parameters = [firm(p) if p.name == name else p for p in instance.parameters]
        pinned = replace(instance, parameters=tuple(parameters))
        begin = {**{p.name: p.first for p in parameters}, **begin}
    wider = Hypothesis(ordinary=present.ordinary, instances=(*present.instances, pinned))
    start = best_starting_point(stage, wider, [begin, {**final.values, name: size}])
    return fit_hypothesis(stage, wider, start=start, max_iterations=_STEPS)


@dataclass(frozen=True, slots=True)
class _Ready:
    """A rival with the new posture among its own."""

    hypothesis: Hypothesis
    space: Space
    values: Mapping[str, float]
    curvature: Array  # of what its fit knows, priors included; of what is free
    log_det: float  # of that
    free: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, fit: Fit) -> _Ready:
        ordinary = fit.hypothesis.ordinary
        more = replace(ordinary, postures=(*ordinary.postures, NAME))
        hypothesis = replace(fit.hypothesis, ordinary=more)
        space = hypothesis.space()
        values = space.values(space.start(fit.values))
        A = np.eye(len(space))
        at = np.array([space.index[name] for name in fit.space.index])
        A[np.ix_(at, at)] += fit.curvature
        free = np.ones(len(space), dtype=bool)
        free[at] = fit.free
        A = A[np.ix_(free, free)]
        log_det = float(np.linalg.slogdet(A)[1])
        return cls(hypothesis, space, values, A, log_det, free)

    def by_hit_direction(
        self, rows: Sequence[tuple[int, int]], dy: ComplexArray
    ) -> Iterator[tuple[int, Array]]:
        """Variance of each row's answer, (m, 3, L), if its mounting's hits have their own aim."""
        sides = [self.space.index[f"aim {side} {NAME}"] for side in "ab"]
        for p, i in rows:
            yield p, np.sum(np.abs(dy[sides, i]) ** 2, axis=0)


def _lines(
    stage: Stage, index: Mapping[str, int], test: Test, every: int
) -> tuple[list[PostureLines], list[Array]]:
    """Lines as the test's would be; of soft and hard hits where the session's are apart.

    Their variance is the scatter alone, what is above the noise; and the noise of each line, (L,),
    for which the quietest channel stands: a hit half as hard has four times as much.
    """
    first = stage.lines[0].name
    found: list[PostureLines] = []
    floors: list[Array] = []
    for number, like in enumerate(own for own in stage.lines if own.name == first):
        hit_point = like.hit_point[:1]
        if test.hit_point is not None:
            hit_point = np.array([index[test.hit_point]])
        # A point that the session left out scatters as its first does.
        rows = [*range(len(like.sensor_point)), *(0 for _ in test.more_points)]
        more = [index[name] for name in test.more_points]
        level = like.level
        floor = np.min(like.variance, axis=(0, 1))[::every]
        scatter = like.variance[rows, :, ::every] - floor
        if test.peaks_n:
            peak_n = (test.peaks_n[0], test.peaks_n[-1])[number]
            level += float(np.log(peak_n / like.peak_n))
            floor = floor * (like.peak_n / peak_n) ** 2
        floors.append(floor)
        found.append(
            replace(
                like,
                name=NAME,
                joints_rad=test.joints_rad,
                hit_direction=test.hit_direction[None],
                hit_point=hit_point,
                sensor_point=np.array([*like.sensor_point, *more]),
                hit=np.zeros(len(rows), dtype=np.int64),
                s_rad_s=like.s_rad_s[::every],
                values=like.values[rows, :, ::every],
                variance=scatter,
                brakes=test.brakes,
                known_mass=test.known_mass,
                level=level,
            )
        )
    return found, floors


def _surprise(weighings: Sequence[Weighing], ready: _Ready, answers: Sequence[_Answer]) -> float:
    """-ln p of the lines, integrated over what the rival leaves open; up to a constant."""
    parts = [
        summed([weighings[p] for p, _ in rows], y, Columns.of(dy), [i for _, i in rows])[0]
        for rows, y, dy in answers
    ]
    f = ready.free
    both = ready.curvature + sum(part.curvature[np.ix_(f, f)] for part in parts)
    g = np.sum([part.gradient[f] for part in parts], axis=0)
    log_dets = np.linalg.slogdet(both)[1] - ready.log_det
    cost = sum(part.cost for part in parts)
    return float(cost - 0.5 * g @ np.linalg.solve(both, g) + 0.5 * log_dets)
