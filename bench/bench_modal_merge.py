"""A soft and a hard hammer merged: is the deviation honest, and who is said to disagree?

Pairs of sessions on one structure, with known modes. Counted are errors inside of nominal 95 % of
either hammer and of both merged, the lines where the merged variance is above the least, and the
pairs that are said to differ although they do not.

Noise is a complex normal error: 95 % of squared errors are below 3 variances. An aim that scatters
multiplies all lines of a point by one real number, whose variance n hits tell with n - 1 degrees of
freedom: squared errors of 95 % are below the square of Student's t. The mean of squared errors over
variances is 1 in both cases, but for what few degrees of freedom make of a mean of ratios.
"""

import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.stats import t as student

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support import hammer
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.modal import posture_frf
from armodal.analyzer.modal.merge import merge_frfs
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

PAIRS = range(60)
POLES = poles_of([11.0, 38.0, 79.0], [0.03, 0.025, 0.02])
N_POINTS = 2
HAMMERS = {"soft": (12e-3, (3.0, 120.0)), "hard": (4e-3, (5.0, 150.0))}  # width s, band Hz
CASES = ((0.0, 3), (0.0, 5), (0.0, 10), (0.02, 5), (0.02, 10))  # aim scatter, hits


def measured(
    name: str, seed: int, aim: float, hits: int, residues: np.ndarray
) -> FrequencyResponse:
    """FRFs of one hammer; white noise of 0.05 N and m/s^2."""
    width_s, band_hz = HAMMERS[name]
    session = hammer.session(
        POLES,
        residues,
        rng=np.random.default_rng(seed),
        widths_s=(width_s, width_s),
        hits=hits,
        noise=0.05,
        aim=aim,
        exponential_end=0.001,
        anti_alias=True,
    )
    return posture_frf(session, "p", lambda _: np.eye(3), band_hz=band_hz)


def relative(frf: FrequencyResponse, residues: np.ndarray) -> np.ndarray:
    """Squared errors over the stated variance."""
    truth = modal_frf(
        POLES, residues.reshape(3, -1, 1), frf.freq_hz, FrfForm.ACCELERANCE, frf.decay_rad_s
    )
    return np.abs(frf.values - truth) ** 2 / frf.variance


def worse(merged: FrequencyResponse, frfs: list[FrequencyResponse]) -> int:
    """Lines of FRFs whose merged variance is above that of one that has the line."""
    count = 0
    for frf in frfs:
        at = np.searchsorted(merged.freq_hz, frf.freq_hz - 1e-6)
        count += int(np.count_nonzero(merged.variance[..., at] > frf.variance))
    return count


def main() -> None:
    rng = np.random.default_rng(4)
    residues = 0.3 * rng.standard_normal((3, N_POINTS, 3)) / (2j * POLES.imag[:, None, None])
    for aim, hits in CASES:
        reach = student.ppf(0.975, hits - 1) ** 2 if aim else -np.log(0.05)
        shares: dict[str, list[np.ndarray]] = {"soft": [], "hard": [], "merged": []}
        differ = above = 0
        for pair in PAIRS:
            frfs = [
                measured(name, 2 * pair + k, aim, hits, residues) for k, name in enumerate(HAMMERS)
            ]
            merged = merge_frfs(frfs)
            differ += bool(merged.disagreements)
            above += 0 if merged.disagreements else worse(merged.frf, frfs)
            for name, frf in zip(shares, [*frfs, merged.frf], strict=True):
                shares[name].append(relative(frf, residues))
        told = ", ".join(
            f"{name} {100 * np.mean(np.array(found) < reach):.1f} % (mean {np.mean(found):.2f})"
            for name, found in shares.items()
        )
        print(
            f"aim {aim:.0%}, {hits} hits: inside {told}, 90 to 98 wanted; "
            f"{differ} of {len(PAIRS)} pairs said to differ; {above} lines worse than one "
            "hammer's, 0 wanted",
            flush=True,
        )


if __name__ == "__main__":
    main()
