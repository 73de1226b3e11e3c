"""How clear the study's clear cases are: held-out error without the effect over the true model's.

The best model without the effect and the true model are both fitted with every ordinary error. What
is printed is what an analysis would see; no verdict is asked for.

    python bench/bench_clear_sizes.py ur5:payload:clear:7101 bench57:rotor:clear:7102

Without arguments those of the effects whose sizes were found by it.
"""

from __future__ import annotations

import argparse
import json
import sys

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.annealing import annealing_stages
from armodal.analyzer.gap.inference.compare import posture_gap
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.inference.held_out import held_out
from armodal.analyzer.gap.inference.misfit import misfit_per_line
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.hil_sim.study import CaseSpec, sealed
from armodal.hil_sim.study.true_effects import size_of_truth
from armodal.study.score import instance_of_truth

CASES = [
    f"{arm}:{kind}:clear:{seed}"
    for kind in ("payload", "rotor", "released_joint", "coupling")
    for arm in ("bench57", "ur5")
    for seed in (7101, 7102)
]


def measured(arm: str, kind: str, magnitude: str, seed: int) -> dict[str, object]:
    """Ratio, both errors, both misfits of one case; the effect's size as fitted and true."""
    case = sealed(
        CaseSpec(number=seed, arm=arm, seed=seed, kinds=(kind,), magnitude=magnitude, ladder=False)
    )
    session, truth = case.session(), json.loads(case.open_truth())
    superset = Superset(session.header.arm)
    stages = annealing_stages(superset, session, estimate_frfs(session, superset))
    ordinary = Ordinary(superset=superset, postures=tuple(p.name for p in stages[-1].lines))
    effect = truth["effects"][0]
    instance = instance_of_truth(ordinary, effect)
    found: dict[str, object] = {"case": f"{arm} {kind} {magnitude} {seed}"}
    if instance is None:
        return found | {"note": "the library has no model of it before a search places it"}
    believed = {j.name: j.stiffness.value for j in case.arm.joints if j.stiffness is not None}
    size = size_of_truth(effect, believed)
    test = [i for i, posture in enumerate(session.header.plan.postures) if posture.validation]
    without = _annealed(stages, Hypothesis(ordinary=ordinary), {})
    begin = {} if size is None else {instance.size: size}
    with_it = _annealed(stages, Hypothesis(ordinary=ordinary, instances=(instance,)), begin)
    errors = [_error(stages[-1], fit, test) for fit in (without, with_it)]
    return found | {
        "ratio": errors[0] / errors[1],
        "error_without": errors[0],
        "error_with": errors[1],
        "misfit_without": misfit_per_line(stages[-1], without),
        "misfit_with": misfit_per_line(stages[-1], with_it),
        "size": with_it.values.get(instance.size),
        "true_size": size,
    }


def _annealed(stages: tuple[Stage, ...], hypothesis: Hypothesis, start: dict[str, float]) -> Fit:
    fit = fit_hypothesis(stages[0], hypothesis, start=start, max_iterations=20)
    for stage in stages[1:]:
        fit = fit_hypothesis(stage, hypothesis, start=fit.values, max_iterations=24)
    return fit


def _error(stage: Stage, fit: Fit, test: list[int]) -> float:
    right = held_out(stage, fit, test).training
    errors = [posture_gap(stage, right, p, held_out=True).frf_error for p in test]
    return float(np.linalg.norm(errors))


def main() -> int:
    """Print one line of JSON a case."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="*", default=CASES, metavar="ARM:EFFECT:MAGNITUDE:SEED")
    for text in parser.parse_args().cases:
        arm, kind, magnitude, seed = text.split(":")
        print(json.dumps(measured(arm, kind, magnitude, int(seed))), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
