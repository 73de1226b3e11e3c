"""Rates of wrong verdicts, small version of bench/bench_hit_judge.py."""

from __future__ import annotations

import os
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from support.channels import channel
from support.judged import LEVEL_N, block_of_counts, judge_force, sees_two
from support.strikes import draw_strike, force_record, gap_of, second_strike

from armodal.daq.judge import judge_record
from armodal.protocols.plan_records import Sampling, Trigger

PRETRIGGER = 100
RATES_HZ = (1000.0, 1652.0, 2048.0, 5120.0, 10240.0, 25600.0, 51200.0)
MEASURED = Path(os.environ.get("ARMODAL_DATA", Path(__file__).parents[3] / "shared" / "data"))


def drawn(rng, narrowest=2.0, widest_s=10e-3):
    rate_hz = float(rng.choice(RATES_HZ))
    shortest_s = max(0.2e-3, narrowest / rate_hz)
    width_s = float(np.exp(rng.uniform(np.log(shortest_s), np.log(widest_s))))
    return draw_strike(rng, rate_hz=rate_hz, width_s=width_s)


def verdict_of(strike, rng):
    n = 1024 if strike.rate_hz < 6000.0 else 4096
    force = force_record(strike, rng, n=n, pretrigger=PRETRIGGER, level_n=LEVEL_N)
    return judge_force(force, strike.rate_hz, PRETRIGGER, strike.highpass_hz)


def test_good_single_pulses_of_any_width_and_rate_are_accepted():
    rng = np.random.default_rng(31)
    rejected = [v for v in (verdict_of(drawn(rng), rng) for _ in range(150)) if not v.accepted]
    # None in 2000 is wanted of the judge, so none in 150.
    assert rejected == []


@pytest.mark.long
def test_at_most_one_double_in_a_hundred_is_missed():
    rng = np.random.default_rng(32)
    n = 200
    missed = 0
    for _ in range(n):
        strike = drawn(rng)
        second = float(np.exp(rng.uniform(np.log(0.15), 0.0)))
        gap_s = gap_of(rng, strike.rate_hz, 0.04)
        missed += not sees_two(
            verdict_of(second_strike(strike, rng, second=second, gap_s=gap_s), rng)
        )
    # More than this of n at a rate of 1 % has a probability below 1 in 10 000.
    assert missed <= stats.binom.ppf(0.9999, n, 0.01)


@pytest.mark.parametrize(
    "rate_hz", [1652.0, *(pytest.param(f, marks=pytest.mark.long) for f in (1000.0, 5120.0))]
)
def test_pulses_of_two_samples_with_the_least_gap_are_told_apart(rate_hz):
    rng = np.random.default_rng(33)
    n, width_s = 60, 2.0 / rate_hz
    missed = 0
    for _ in range(n):
        strike = draw_strike(rng, rate_hz=rate_hz, width_s=width_s)
        gap_s = max(3e-3, 3.0 / rate_hz)
        missed += not sees_two(
            verdict_of(second_strike(strike, rng, second=0.15, gap_s=gap_s), rng)
        )
    # As above: the rate of the worst corner is held to 1 % too.
    assert missed <= stats.binom.ppf(0.9999, n, 0.01)


def test_a_pulse_shorter_than_two_samples_is_accepted_with_a_note():
    rng = np.random.default_rng(34)
    for width in np.geomspace(0.2, 1.9, 60):
        strike = draw_strike(rng, rate_hz=1000.0, width_s=width / 1000.0)
        # Without a filter such a pulse may fall between two samples and leave no record.
        kind = "chebyshev" if strike.filter_kind == "none" else strike.filter_kind
        # Noise and hum are relative to a peak of which the filter leaves a fifth.
        strike = replace(strike, filter_kind=kind, noise=5e-4, hum=1e-3)
        force = force_record(strike, rng, n=1024, pretrigger=PRETRIGGER, level_n=1.0)
        force *= 10.0 * LEVEL_N / force.max()
        verdict = judge_force(force, 1000.0, int(force.argmax()), 0.5)
        assert verdict.accepted, verdict
        assert any("cannot tell" in note for note in verdict.notes), (strike, verdict)


@pytest.mark.skipif(not MEASURED.is_dir(), reason="ARMODAL_DATA names no measured data")
@pytest.mark.parametrize("number", range(1, 6))
def test_measured_hits_of_a_hard_tip_are_accepted(number):
    _, force, response = np.load(MEASURED / "hammer_hits_5" / f"m{number}.npy")
    trigger = int(np.argmax(force >= LEVEL_N))
    channels = (
        channel("hammer", "force", 2e-5),
        channel("acc", "acceleration", 2e-4),
    )
    scales = np.array([c.scale for c in channels])
    counts = np.round(np.stack([force, response], axis=1) / scales).astype(np.int32)
    verdict = judge_record(
        block_of_counts(counts, trigger),
        channels,
        Sampling(rate_hz=Fraction(25600), samples=len(counts), pretrigger=trigger),
        Trigger(level_n=LEVEL_N, rising=True),
    )
    assert verdict.accepted, verdict
    assert verdict.peak_n == pytest.approx(force.max(), rel=2e-3)  # the baseline's offset
