"""Confusion table of the rigid-link check over seeds of simulated sessions.

Good sessions first (no fault may be named), then faults at one point drawn at random among those on
moving links, and faults of the roving sensor. `named` wants the right name and the right place.
"""

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.offline_lab import simulate_session
from support.sensor_faults import (
    FLIP_X,
    FLIP_Z,
    SWAP_XY,
    TURN_Z90,
    exchanged,
    gains,
    misplaced,
    mixed,
)

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks import Fault, Outcome, check_links, sensor_verdict
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.modal import fit_modes, hit_frfs, hit_spectra

GOOD_SEEDS = 40
FAULT_SEEDS = 12


def link_results(session, superset):
    found = []
    for frf in estimate_frfs(session, superset):
        hits = session.accepted(frf.posture)
        half = float(frf.freq_hz[1] - frf.freq_hz[0]) / 2.0
        band = (frf.freq_hz[0] - half, frf.freq_hz[-1] + half)
        single = hit_frfs(hit_spectra(session, hits, band_hz=band))
        at = np.array([hit.sensor_point for hit in hits])
        poles = [mode.pole_rad_s for mode in fit_modes(frf).modes]
        by_point = {p: single[at == p] for p in dict.fromkeys(at.tolist())}
        found.append(check_links(frf, by_point, poles, superset))
    return found


def words(results):
    return [*(r.finding for r in results), sensor_verdict(results)]


def faulty(session, other, rng):
    """Name -> (session, fault, points or None for the roving sensor)."""
    points = [p.id for p in session.header.arm.points if p.link != "base"]
    p, q = (str(i) for i in rng.choice(points, 2, replace=False))
    at = (p,)
    one = {
        "x, y swapped": (SWAP_XY, Fault.AXIS_SWAPPED),
        "turned 90° about z": (TURN_Z90, Fault.AXIS_SWAPPED),
        "x flipped": (FLIP_X, Fault.SIGN_FLIPPED),
        "z flipped": (FLIP_Z, Fault.SIGN_FLIPPED),
        "gain of z 1.1": (gains(z=1.1), Fault.GAIN),
        "gain of x 0.8": (gains(x=0.8), Fault.GAIN),
        "gain of all 1.2": (gains(1.2, 1.2, 1.2), Fault.GAIN),
    }
    everywhere = {
        "x, y swapped": (SWAP_XY, Fault.AXIS_SWAPPED),
        "turned 90° about z": (TURN_Z90, Fault.AXIS_SWAPPED),
        "x flipped": (FLIP_X, Fault.SIGN_FLIPPED),
        "z flipped": (FLIP_Z, Fault.SIGN_FLIPPED),
        "gain of z 1.1": (gains(z=1.1), Fault.GAIN),
        "gain of x 0.9": (gains(x=0.9), Fault.GAIN),
        "gain of all 1.2": (gains(1.2, 1.2, 1.2), Fault.GAIN),
    }
    cases = {f"one point: {k}": (mixed(session, m, at), f, {p}) for k, (m, f) in one.items()}
    cases |= {f"sensor: {k}": (mixed(session, m), f, None) for k, (m, f) in everywhere.items()}
    cases["one point: was at another"] = (misplaced(session, other, p, q), Fault.WRONG_POINT, {p})
    cases["two points exchanged"] = (exchanged(session, p, q), Fault.WRONG_POINT, {p, q})
    return cases


def word(finding, fault, points):
    if finding.outcome is not Outcome.FAULT:
        return finding.outcome.value
    place = (
        finding.everywhere
        if points is None
        else bool(finding.points) and set(finding.points) <= points
    )
    if finding.fault is fault and place:
        return "named"
    return "right place" if place else "wrong"


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--good", type=int, default=GOOD_SEEDS)
    parser.add_argument("--faults", type=int, default=FAULT_SEEDS)
    parser.add_argument("--first", type=int, default=100)
    options = parser.parse_args()
    table, begin = {}, time.perf_counter()

    def count(name, findings, fault, points):
        for finding in findings:
            kind = "validation" if finding.posture.startswith("validation") else "test"
            kind = "session" if finding.check == "sensor" else kind
            said = word(finding, fault, points)
            table.setdefault((name, kind), Counter())[said] += 1
            if said == "wrong" or (fault is None and said != "good"):
                print(f"  {name}, {points}, {finding.posture}: {finding.text}", flush=True)

    for seed in range(options.first, options.first + options.good):
        session = simulate_session(seed)
        superset = Superset(session.header.arm)
        found = link_results(session, superset)
        count("good", words(found), None, set())
        if seed - options.first < options.faults:
            other = simulate_session(seed + 10_000)
            cases = faulty(session, other, np.random.default_rng(seed))
            for name, (broken, fault, points) in cases.items():
                found = link_results(broken, superset)
                count(name, words(found), fault, points)
    columns = ("named", "right place", "wrong", "good", "cannot tell")
    for kind in ("session", "test", "validation"):
        print(f"\n| {kind} | " + " | ".join(columns) + " |")
        for name in dict.fromkeys(name for name, _ in table):
            row = table.get((name, kind), Counter())
            print(f"| {name} | " + " | ".join(str(row[c]) for c in columns) + " |")
    print(f"{time.perf_counter() - begin:.0f} s")


if __name__ == "__main__":
    main()
