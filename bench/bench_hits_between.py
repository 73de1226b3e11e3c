"""What hits between soft and hard tell of joints that soften, slip or stick: slope and bow of ln c.

One line of JSON a sealed case: the constants of `analyzer.gap.effects.slips_or_softens` were set on
seeds 26 to 28 and 31 to 34. The bow is measured at the joint that was named or stands, whichever it
is.

    python bench/bench_hits_between.py --seeds 26 27 --kinds softening microslip
"""

from __future__ import annotations

import argparse
import json
import sys

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects.slips_or_softens import bow_of, told_by_bow
from armodal.analyzer.gap.inference.annealing import at_three_levels
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.study import LIBRARY, CaseSpec, draw_study, sealed


def measured(spec: CaseSpec) -> dict[str, object]:
    """Verdict and bow of one case; no bow where nothing follows the level at one joint."""
    session = sealed(spec).session()
    outcome = find_gap(session, gates=False, modes=False, advice=False)
    found: dict[str, object] = {
        "case": f"{spec.arm} {spec.kinds[0]} {spec.magnitude} {spec.seed}",
        "verdict": outcome.result.verdict.value,
        "named": [effect.name for effect in outcome.result.effects],
    }
    fit = next(iter(outcome.standing), outcome.final)
    fit = outcome.final if outcome.result.effects else fit
    if not fit.hypothesis.instances or not fit.hypothesis.instances[-1].level_dependent:
        return found
    joint = fit.hypothesis.instances[-1].place
    superset = Superset(session.header.arm)
    stage = at_three_levels(superset, (session,), outcome.stages[-1])
    if stage is None:
        return found
    bow = bow_of(stage, fit, joint, outcome.scale)
    return found | {
        "joint": joint,
        "slope": bow.slope,
        "bow": bow.bow,
        "std": np.sqrt(np.diag(bow.covariance)).tolist(),
        "told": told_by_bow(bow),
    }


def main() -> int:
    """Print one line of JSON a case."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", nargs="+", type=int, default=[31])
    parser.add_argument("--kinds", nargs="+", default=["softening", "microslip", "friction"])
    wanted = parser.parse_args()
    for seed in wanted.seeds:
        for spec in draw_study(
            seed,
            nulls=150,
            effects=174,
            pairs=20,
            outside=34,
            library=tuple(LIBRARY),
            ladder=True,
        ):
            if len(spec.kinds) == 1 and spec.kinds[0] in wanted.kinds:
                print(json.dumps(measured(spec)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
