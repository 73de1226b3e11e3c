"""What a linear look at replicas leaves out: each replica fitted in full, beside it.

    python bench/bench_replica_fits.py --maker frame --seed 1 --cases 3 --replicas 12

Replicas of sessions with nothing hidden are drawn as `search/replicas.py` draws them, but as FRFs:
the fitted null's, error modes on top, and priors that lie as far from its values as ordinary
errors may. One effect of every kind is then looked at where the null ends, and fitted. Both tell
the evidence it gains. A table has, kind by kind, how much more the fit finds.
"""

from __future__ import annotations

import argparse
import copy
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.error_modes import (
    curvature_of,
    released,
    sensitivities,
    settled,
)
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.search.candidates import others_beside
from armodal.analyzer.gap.search.race import MOST_STEPS
from armodal.analyzer.gap.search.replicas import within_nature
from armodal.analyzer.gap.search.scan import scan_instances, small
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.makers import CaseSpec, case_of, draw_cases

Gain = tuple[str, float, float]  # kind; by a look, by a fit


def one_of_each_kind(fit: Fit) -> list[Instance]:
    """The first place of every effect that a linear look tells."""
    kinds: dict[str, Instance] = {}
    for instance in others_beside(fit):
        seen = instance.parameters or set(instance.relaxes) & set(fit.space.index)
        if seen and not instance.hides_in and not instance.law and not instance.level_dependent:
            kinds.setdefault(instance.effect.name, instance)
    return list(kinds.values())


def replicas(stage: Stage, fit: Fit, n: int) -> Iterator[tuple[Stage, Instance]]:
    """FRFs drawn anew, and what moves the priors' means."""
    rng = np.random.default_rng(0)
    parts = sensitivities(stage, fit.hypothesis, fit.space, fit.values)
    free = np.flatnonzero(fit.free)
    parts = settled(parts, free, curvature_of(parts)[np.ix_(free, free)], fit.u[free])
    modes = [
        np.linalg.svd(np.ascontiguousarray(e, dtype=np.float64).view(complex), full_matrices=False)
        for e in released(parts, free)
    ]
    foretold: dict[int, npt.NDArray[np.complex128]] = {}
    for rows, together in stage.once(fit.hypothesis, range(len(stage.lines))):
        y = together.response(fit.hypothesis, fit.values).values
        foretold |= {p: y[i] for p, i in rows}
    for _ in range(n):
        drawn = copy.copy(stage)
        weighings = []
        for p, (weighing, (u, size, vh)) in enumerate(zip(stage.weighings, modes, strict=True)):
            a = rng.standard_normal((2, size.size)) * np.sqrt(0.5 * len(modes))
            error = ((u * size * (a[0] + 1j * a[1])) @ vh).reshape(foretold[p].shape)
            own = copy.copy(weighing)
            own.lines = replace(own.lines, values=foretold[p] + error / own.scale)
            weighings.append(own)
        drawn.weighings = tuple(weighings)
        least, most = fit.space.least[free], fit.space.most[free]
        off = within_nature(least, most, rng.random((len(free), 1)))[:, 0]
        moved = {}
        for i, by in zip(free, off, strict=True):
            p = fit.space.parameters[i]
            moved[p.name] = replace(p, mean=fit.values[p.name] - by * p.std)
        some = others_beside(fit)[0].effect
        yield drawn, Instance(effect=some, place="priors of a replica", relaxes=moved)


def evidence(stage: Stage, hypothesis: Hypothesis, values: Mapping[str, float]) -> float:
    """Of a model whose quadratic about some values is taken to hold."""
    there = fit_hypothesis(stage, hypothesis, start=values, max_iterations=0)
    return there.evidence - there.promised


def gains_of(spec: CaseSpec, n: int) -> list[Gain]:
    """What one effect of every kind gains on replicas of one case."""
    outcome = find_gap(case_of(spec).session(), gates=False, modes=False, advice=False)
    stage, fit = outcome.stages[-1], outcome.final
    if fit.hypothesis.instances or len({own.name for own in stage.lines}) < len(stage.lines):
        return []
    found: list[Gain] = []
    for drawn, priors in replicas(stage, fit, n):
        null = replace(fit.hypothesis, instances=(priors,))
        null_look = evidence(drawn, null, fit.values)
        null_fit = fit_hypothesis(drawn, null, start=fit.values, max_iterations=MOST_STEPS)
        own: list[tuple[str, float, Fit]] = []
        for instance in one_of_each_kind(fit):
            rival = replace(null, instances=(priors, small(instance)))
            look = null_look - evidence(drawn, rival, fit.values)
            begin = scan_instances(drawn, null_fit, [instance])[0].begin
            fits = [
                fit_hypothesis(drawn, rival, start=start, max_iterations=MOST_STEPS)
                for start in (null_fit.values, begin)
                if start
            ]
            own.append((instance.effect.name, look, min(fits, key=lambda f: f.evidence)))
        # As a search does: what leads may have led the model without it out of a worse minimum.
        leads = min((best for *_, best in own), key=lambda f: f.evidence)
        anew = fit_hypothesis(drawn, null, start=leads.values, max_iterations=MOST_STEPS)
        least = min(anew.evidence, null_fit.evidence)
        found += [(kind, look, least - best.evidence) for kind, look, best in own]
    return found


def main() -> None:
    """Draw, look, fit and tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--maker", default="frame")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=3)
    parser.add_argument("--replicas", type=int, default=12)
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    specs = draw_cases(given.maker, given.seed, nulls=given.cases, effects=0)
    with ProcessPoolExecutor(given.workers, mp_context=get_context("spawn")) as pool:
        every = [
            gain for own in pool.map(gains_of, specs, [given.replicas] * len(specs)) for gain in own
        ]
    kinds = sorted({kind for kind, _, _ in every})
    print(f"{'effect':22} {'n':>4} {'look 90 %':>10} {'fit 90 %':>10} {'more, median, most':>20}")
    for kind in [*kinds, ""]:
        look, fitted = np.array([g[1:] for g in every if not kind or g[0] == kind]).T
        more = fitted - look
        print(
            f"{kind or 'all':22} {look.size:4d} {np.quantile(look, 0.9):10.2f} "
            f"{np.quantile(fitted, 0.9):10.2f} {np.median(more):10.2f} {more.max():9.2f}"
        )


if __name__ == "__main__":
    main()
