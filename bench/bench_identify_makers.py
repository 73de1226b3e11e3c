"""`identify` on other makers' cases: k of all joints beside the truth, and axes that are not there.

    python bench/bench_identify_makers.py frame 7 20 [N_EFFECTS]

Cases are drawn from a seed: nulls, and with a fourth number that many effects of the library.
"""

import json
import sys
import time

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.scatter import stated_half_width_95
from armodal.hil_sim.makers import draw_cases
from armodal.study.cases import case_of


def main() -> None:
    maker, seed, n_nulls, *more = sys.argv[1:]
    n_effects = int(more[0]) if more else 1
    inside, errors, axes, judged = [], [], 0, 0
    for spec in draw_cases(maker, int(seed), nulls=int(n_nulls), effects=n_effects):
        if spec.kinds and not more:
            continue
        case = case_of(spec)
        session = case.session()
        began = time.process_time()
        found = identify(session)
        spent = time.process_time() - began
        truth = json.loads(case.open_truth())["joints"]
        rows = []
        for row in found.joints:
            k = truth[row.joint]["stiffness_n_m_per_rad"]
            error, half = row.k_n_m_per_rad / k - 1.0, stated_half_width_95(row) / k
            rows.append(f"{100 * error:+.1f}±{100 * half:.1f}")
            inside.append(abs(error) <= half)
            errors.append(abs(error))
        judged += 1
        axes += bool(found.axes)
        what = "+".join(spec.kinds) or "null"
        print(
            f"{spec.number:4} {spec.arm:12} {what:18} {found.explained_by.value:24.24} "
            f"{spent:5.1f} s, axes {len(found.axes)}, k off by % {' '.join(rows)}",
            flush=True,
        )
    errors.sort()
    print(
        f"{judged} sessions: k off by {100 * errors[len(errors) // 2]:.2f} % in the median, "
        f"{100 * errors[-1]:.1f} % at most; inside 95 % intervals {sum(inside)} of {len(inside)}; "
        f"with an axis {axes}"
    )


if __name__ == "__main__":
    main()
