"""Miss and false-reject rates of the hit judge over width, gap, second hit, rate and noise.

OPENBLAS_NUM_THREADS=1 .venv/bin/python bench/bench_hit_judge.py [trials a cell, default 20]

Exit code 1 if one of 2000 good pulses is rejected, or more than 1 % of 4000 doubles with a gap of
at least 3 ms and 3 samples and a second hit of at least 15 % are missed. Every record draws its
shape (half-sine, haversine, skewed), anti-alias filter and cut-off, coupling corner, noise, hum
and drift anew (tests/support/strikes.py); the second pulse is 0.8 to 1.4 times as wide as the
first, and two samples at least.
"""

from __future__ import annotations

import sys
import time
from collections import defaultdict
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
from scipy import stats

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.judged import LEVEL_N, judge_force, sees_two
from support.strikes import Strike, draw_strike, force_record, gap_of, second_strike

from armodal.protocols.session.records import Verdict

RATES_HZ = (1000.0, 1652.0, 5120.0, 25600.0, 51200.0)
WIDTHS_S = (0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3)
GAPS_S = (1e-3, 2e-3, 3e-3, 5e-3, 10e-3, 30e-3)
SECONDS = (0.07, 0.10, 0.15, 0.30, 1.0)
NOISES = (0.001, 0.005, 0.01, 0.02, 0.03, 0.05)
HUMS = (0.0, 0.01, 0.03, 0.1, 0.3)
PRETRIGGER = 100
N_GOOD, N_DOUBLE = 2000, 4000
WORST_MISS = 0.01
Tally = dict[tuple[object, ...], list[bool]]


def verdict(strike: Strike, rng: np.random.Generator) -> Verdict:
    n = 1024 if strike.rate_hz < 6000.0 else 4096
    force = force_record(strike, rng, n=n, pretrigger=PRETRIGGER, level_n=LEVEL_N)
    return judge_force(force, strike.rate_hz, PRETRIGGER, strike.highpass_hz)


def any_strike(rng: np.random.Generator) -> Strike:
    """Any rate of the table, any width from two samples (0.2 ms at least) to 10 ms."""
    rate_hz = float(rng.choice(RATES_HZ))
    shortest = max(0.2e-3, 2.0 / rate_hz)
    width_s = float(np.exp(rng.uniform(np.log(shortest), np.log(10e-3))))
    return draw_strike(rng, rate_hz=rate_hz, width_s=width_s)


def any_double(strike: Strike, rng: np.random.Generator) -> Strike:
    second = float(np.exp(rng.uniform(np.log(0.15), 0.0)))
    return second_strike(strike, rng, second=second, gap_s=gap_of(rng, strike.rate_hz, 0.04))


def at_most(hits: int, trials: int) -> float:
    """Upper 95 % limit of a rate (Clopper and Pearson, Biometrika 26 (1934) 404)."""
    return float(stats.beta.ppf(0.95, hits + 1, trials - hits)) if hits < trials else 1.0


def headline(rng: np.random.Generator) -> bool:
    rejected = sum(not verdict(any_strike(rng), rng).accepted for _ in range(N_GOOD))
    missed = sum(
        not sees_two(verdict(any_double(any_strike(rng), rng), rng)) for _ in range(N_DOUBLE)
    )
    closest = 0
    for _ in range(N_GOOD):
        strike = any_strike(rng)
        gap_s = max(3e-3, 3.0 / strike.rate_hz)
        double = second_strike(strike, rng, second=0.15, gap_s=gap_s)
        closest += not sees_two(verdict(double, rng))
    print(f"good pulses rejected: {rejected} of {N_GOOD} (wanted 0)")
    print(
        f"doubles missed, gap >= 3 ms and 3 samples, second >= 15 %: {missed} of {N_DOUBLE}, "
        f"at most {100 * at_most(missed, N_DOUBLE):.2f} % (wanted 1 %)"
    )
    print(f"the same at the least gap and 15 % sharp: {closest} of {N_GOOD}")
    return rejected == 0 and missed <= WORST_MISS * N_DOUBLE


def table(title: str, rows: tuple[str, tuple], columns: tuple[str, tuple], tally: Tally) -> None:
    """Print percentages of `tally`, keyed by (row, column), as a table."""
    heads = [f"{rows[0]} \\ {columns[0]}", *(f"{c:g}" for c in columns[1])]
    print(f"\n{title}\n\n| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
    for row in rows[1]:
        cells = [tally.get((row, c)) for c in columns[1]]
        shown = [f"{100 * np.mean(c):.1f}" if c else "" for c in cells]
        print(f"| {row:g} | {' | '.join(shown)} |")


def singles(rng: np.random.Generator, trials: int) -> None:
    rejected: Tally = defaultdict(list)
    untold: Tally = defaultdict(list)
    for rate_hz, width_s, _ in product(RATES_HZ, WIDTHS_S, range(5 * trials)):
        said = verdict(draw_strike(rng, rate_hz=rate_hz, width_s=width_s), rng)
        # A pulse shorter than a sample may lose its height to the filter, to below two trigger
        # levels or into the noise: then rejecting it is right.
        if {"soft", "noise"}.isdisjoint(said.reasons):
            rejected[rate_hz, width_s * 1e3].append(not said.accepted)
        untold[rate_hz, width_s * 1e3].append(any("cannot tell" in n for n in said.notes))
    rows, columns = ("rate Hz", RATES_HZ), ("width ms", tuple(w * 1e3 for w in WIDTHS_S))
    table("single pulses rejected, %", rows, columns, rejected)
    table("single pulses noted as 'cannot tell', %", rows, columns, untold)


def doubles(rng: np.random.Generator, trials: int) -> None:
    by_gap_second: Tally = defaultdict(list)
    by_rate_gap: Tally = defaultdict(list)
    by_width_gap: Tally = defaultdict(list)
    by_rate_width: Tally = defaultdict(list)
    for rate_hz, width_s, gap_s, second in product(RATES_HZ, WIDTHS_S, GAPS_S, SECONDS):
        if width_s * rate_hz < 2.0:
            continue
        for _ in range(trials):
            strike = draw_strike(rng, rate_hz=rate_hz, width_s=width_s)
            double = second_strike(strike, rng, second=second, gap_s=gap_s)
            missed = not sees_two(verdict(double, rng))
            by_gap_second[second, gap_s * 1e3].append(missed)
            if second == 0.15:
                by_rate_gap[rate_hz, gap_s * 1e3].append(missed)
                by_width_gap[width_s * 1e3, gap_s * 1e3].append(missed)
            if second >= 0.15 and gap_s >= max(3e-3, 3.0 / rate_hz):
                by_rate_width[rate_hz, width_s * 1e3].append(missed)
    gaps = ("gap ms", tuple(g * 1e3 for g in GAPS_S))
    widths = tuple(w * 1e3 for w in WIDTHS_S)
    table("doubles missed, %, all rates and widths", ("second", SECONDS), gaps, by_gap_second)
    table("doubles missed, %, second 0.15", ("rate Hz", RATES_HZ), gaps, by_rate_gap)
    table("doubles missed, %, second 0.15", ("width ms", widths), gaps, by_width_gap)
    table(
        "doubles missed, %, second >= 0.15, gap >= 3 ms and 3 samples",
        ("rate Hz", RATES_HZ),
        ("width ms", widths),
        by_rate_width,
    )


def disturbed(rng: np.random.Generator, trials: int) -> None:
    for name, levels in (("noise", NOISES), ("hum", HUMS)):
        rejected: Tally = defaultdict(list)
        missed: Tally = defaultdict(list)
        for level, second, _ in product(levels, SECONDS, range(5 * trials)):
            strike = replace(any_strike(rng), **{name: level})
            rejected[0.0, level].append(not verdict(strike, rng).accepted)
            gap_s = gap_of(rng, strike.rate_hz, 0.04)
            double = second_strike(strike, rng, second=second, gap_s=gap_s)
            missed[second, level].append(not sees_two(verdict(double, rng)))
        columns = (f"{name} over peak", levels)
        table(
            "single pulses rejected, %, any rate and width", ("second", (0.0,)), columns, rejected
        )
        table("doubles missed, %, gap >= 3 ms and 3 samples", ("second", SECONDS), columns, missed)


def main() -> int:
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    started = time.perf_counter()
    rng = np.random.default_rng(20)
    reached = headline(rng)
    singles(rng, trials)
    doubles(rng, trials)
    disturbed(rng, trials)
    print(f"\n{time.perf_counter() - started:.0f} s")
    return 0 if reached else 1


if __name__ == "__main__":
    sys.exit(main())
