"""The demo over seeds, each a whole test over pseudo-terminals; figures against their limits.

Usage: python bench/bench_demo.py [number of seeds]
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
K_LIMIT, AXIS_K_LIMIT, SIGMAS = 0.02, 0.05, 3.0
ANGLE_LIMIT_DEG, DISTANCE_LIMIT_MM = 3.0, 15.0


def demo(seed: int, folder: Path) -> dict[str, Any] | None:
    command = [sys.executable, "-c", "from armodal.tui.cli import main; main()", "demo", "--json"]
    command += ["--seed", str(seed), "--out", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    if done.returncode:
        print(f"seed {seed}: exit code {done.returncode}: {done.stderr[-500:]}")
        return None
    return dict(json.loads(done.stdout))


def failures(found: dict[str, Any]) -> list[str]:
    """What a demo missed of the figures to reach."""
    missed = []
    rows = [(row, K_LIMIT) for row in found["joints"]]
    axes = [row for row in found["structural"] if "truth_k_n_m_per_rad" in row]
    if len(found["joints"]) != 3 or len(axes) != 1:
        missed.append(f"{len(found['joints'])} joints, {len(axes)} axes at the true link")
    for row, limit in rows + [(row, AXIS_K_LIMIT) for row in axes]:
        error = row["k_n_m_per_rad"] - row["truth_k_n_m_per_rad"]
        name = row.get("joint", "axis")
        if abs(error) > limit * row["truth_k_n_m_per_rad"]:
            missed.append(f"{name} k off by {error:.0f}")
        if abs(error) > SIGMAS * row["k_std"]:
            missed.append(f"{name} k off by {error / row['k_std']:.1f} std")
    for row in axes:
        if row["axis_angle_error_deg"] > ANGLE_LIMIT_DEG:
            missed.append(f"axis off by {row['axis_angle_error_deg']:.1f} deg")
        if row["axis_distance_error_mm"] > DISTANCE_LIMIT_MM:
            missed.append(f"axis off by {row['axis_distance_error_mm']:.1f} mm")
    return missed


def main() -> None:
    n_seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    failed = 0
    for seed in range(1, n_seeds + 1):
        with tempfile.TemporaryDirectory() as folder:
            found = demo(seed, Path(folder))
        missed = ["did not run"] if found is None else failures(found)
        failed += bool(missed)
        if found is not None:
            rows = [*found["joints"], *found["structural"]]
            z = [
                (row["k_n_m_per_rad"] - row["truth_k_n_m_per_rad"]) / row["k_std"]
                for row in rows
                if "truth_k_n_m_per_rad" in row
            ]
            print(
                f"seed {seed}: {found['hits']['accepted']} accepted, "
                f"{found['hits']['rejected']} rejected, {found['wall_s']:.0f} s, "
                f"k off by {', '.join(f'{value:+.1f}' for value in z)} std",
                flush=True,
            )
        if missed:
            print(f"seed {seed} MISSED: {'; '.join(missed)}", flush=True)
    print(f"{n_seeds - failed} of {n_seeds} demos within every limit")


if __name__ == "__main__":
    main()
