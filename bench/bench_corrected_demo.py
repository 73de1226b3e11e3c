"""The demo's corrected arm in ten postures that were not tested, beside the simulated laboratory.

Wanted: frequencies within 1 %, damping ratios within 15 %; the plain arm must be worse. The
laboratory's own equations are asked, which share nothing with the estimator.
"""

import argparse

import numpy as np
import scipy.optimize

from armodal.analyzer.corrected.prediction import predict_arm
from armodal.hil_sim.plant import load_plant
from armodal.hil_sim.small_motion import linearise
from armodal.protocols.arm.files import load_arm

POSTURES, SEED, BELOW_HZ = 10, 5, 150.0


def errors(arm, plant, postures) -> tuple[float, float]:
    """Largest relative difference of a frequency and of a damping ratio."""
    worst = np.zeros(2)
    for found, q in zip(predict_arm(arm, np.rad2deg(postures)), postures, strict=True):
        poles = linearise(plant, q, None).poles
        poles = poles[poles.imag > 0]
        f, damping = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
        keep = f < BELOW_HZ
        apart = np.abs(np.log(found.modes.f_hz[:, None] / f[keep][None]))
        own, other = scipy.optimize.linear_sum_assignment(apart)
        worst = np.maximum(
            worst,
            [
                np.abs(found.modes.f_hz[own] / f[keep][other] - 1).max(),
                np.abs(found.modes.damping_ratio[own] / damping[keep][other] - 1).max(),
            ],
        )
    return float(worst[0]), float(worst[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arm", help="demo.arm.toml of a demo")
    given = parser.parse_args()
    plant, plain = load_plant("rv4frl"), load_arm("rv4frl")
    low, high = np.array([joint.range_rad for joint in plain.joints]).T
    room = np.random.default_rng(SEED).uniform(0.15, 0.85, (POSTURES, len(low)))
    postures = low + (high - low) * room
    for name, arm in (("plain", plain), ("corrected", load_arm(given.arm))):
        f, damping = errors(arm, plant, postures)
        within = f"frequency within {100 * f:.2f} %, damping ratio within {100 * damping:.1f} %"
        print(f"{name}: {within}")


if __name__ == "__main__":
    main()
