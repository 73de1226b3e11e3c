"""Joint stiffnesses from deflections that others measured and published, read in place.

    bench_published_statics.py FOLDER [--tool X,Y,Z]

FOLDER is a copy of the data of Liu et al. 2026 (analyzer/reproduce/fanuc_2026.py):
joint_angles.csv, forces.csv and deltaX.csv, rad, N and m. `--tool` is where the tool was pulled
at, in the flange's frame, m; without it the drill's tip.
"""

import argparse
from pathlib import Path

import numpy as np

from armodal.analyzer.reproduce.fanuc_2026 import TIP_M, K, model_angles
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm

# As theirs: a row is left out whose misfit over its deflection is more than the mean and 1.5
# standard deviations over the rows that move by more than 0.2 mm.
MANY, MOVES_M = 1.5, 2e-4


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--tool", default=",".join(map(str, TIP_M)))
    given = parser.parse_args()
    tool = [float(part) for part in given.tool.split(",")]
    pendant, force, moved = (
        np.loadtxt(given.folder / f"{name}.csv", delimiter=",", skiprows=1)
        for name in ("joint_angles", "forces", "deltaX")
    )
    batch = ArmBatch(load_arm(ARMS_DIRECTORY.parent / "targets" / "fanuc_r2000ic.toml"))
    J = batch.unit_motions(model_angles(pendant), tool)[0][:3]  # (3, 6, n)
    parts = J * np.einsum("ijn,ni->jn", J, force)
    rows = parts.transpose(2, 0, 1)  # (n, 3, 6): deflection by a unit of every compliance

    def fitted(kept: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(rows[kept].reshape(-1, 6), moved[kept].ravel(), rcond=None)[0]

    size = np.linalg.norm(moved, axis=1)
    off = np.linalg.norm(moved - rows @ fitted(size > 0.0), axis=1) / size
    large = off[size > MOVES_M]
    kept = off <= large.mean() + MANY * large.std()
    compliance = fitted(kept)
    print(f"{kept.sum()} of {len(size)} rows kept")
    for number, (ours, theirs) in enumerate(zip(1.0 / compliance, K, strict=True), start=1):
        print(
            f"joint {number}: {ours:.3g} N m/rad, published {theirs:.3g}: {ours / theirs - 1:+.0%}"
        )
    for what, c in (("ours", compliance), ("the published", 1.0 / np.array(K))):
        rest = np.linalg.norm(moved - rows @ c) / np.linalg.norm(moved)
        print(f"{what}: {100 * rest:.0f} % of the deflections left")


if __name__ == "__main__":
    main()
