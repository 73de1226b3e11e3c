"""Coverage of the stated 95 % intervals over seeds, sessions made in process.

Pools k and c of three joints and of the axis, and the validation frequencies.
"""

import sys
from pathlib import Path

import numpy as np
from scipy import stats

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.offline_lab import simulate_session

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.scatter import half_width_95
from armodal.hil_sim.plant import load_plant

SEEDS = range(20)


def main() -> None:
    truth = load_plant("rv4frl").truth
    springs = [link for link in truth.links if link.stiffness_n_m_per_rad] + [truth.hidden_axis]
    inside, worst, most_std = [], 0.0, 0.0
    for seed in SEEDS:
        result = identify(simulate_session(seed))
        for found, true in zip([*result.joints, *result.axes], springs, strict=True):
            error = found.k_n_m_per_rad - true.stiffness_n_m_per_rad
            worst = max(worst, abs(error) / true.stiffness_n_m_per_rad)
            most_std = max(most_std, abs(error) / found.k_std)
            inside.append(abs(error) <= half_width_95(found.k_std, found.k_dof))
            error = found.c_n_m_s_per_rad - true.damping_n_m_s_per_rad
            inside.append(abs(error) <= half_width_95(found.c_std, found.c_dof))
        for row in result.validation:
            if row.measured_hz is not None:
                width = np.hypot(
                    half_width_95(row.predicted_std_hz, row.predicted_dof),
                    stats.t.ppf(0.975, row.measured_dof) * row.measured_std_hz,
                )
                inside.append(abs(row.predicted_hz - row.measured_hz) <= width)
        print(f"seed {seed}: {sum(inside)} of {len(inside)} inside", flush=True)
    print(f"coverage {100 * np.mean(inside):.1f} % of {len(inside)}, 88 to 99 % wanted")
    print(f"largest error of k {100 * worst:.2f} %, {most_std:.1f} std")


if __name__ == "__main__":
    main()
