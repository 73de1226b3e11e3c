import numpy as np
import pytest

from armodal.hil_sim.hand import blow
from armodal.hil_sim.plant import load_plant

N = 20_000
WANTED = np.array([0.6, 0.0, -0.8])


@pytest.fixture(scope="module")
def hand():
    return load_plant("rv4frl").truth.hand


@pytest.fixture(scope="module")
def blows(hand):
    rng = np.random.default_rng(3)
    return [blow(hand, rng, "1", 5.0 * WANTED) for _ in range(N)]


def test_every_kind_of_hit_comes_at_its_rate(hand, blows):
    wanted = {
        "double": hand.double_probability,
        "soft": hand.soft_probability,
        "overload": hand.overload_probability,
    }
    wanted["good"] = 1.0 - sum(wanted.values())
    for kind, p in wanted.items():
        # Binomial scatter; four of its deviations.
        scatter = np.sqrt(p * (1.0 - p) / N)
        rate = np.mean([b.kind == kind for b in blows])
        assert rate == pytest.approx(p, abs=4.0 * scatter)


def test_the_aim_scatters_as_stated_across_the_wanted_direction(hand, blows):
    across = np.linalg.svd(WANTED[None, :])[2][1:]
    directions = np.array([b.direction for b in blows])
    offsets = np.array([b.offset_m for b in blows])
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0, rel=1e-14)
    # Deviation of a deviation is 1/sqrt(2 N), four of it. A tangent is no angle, but at 1 deg
    # the two differ by 1e-4.
    scatter = 4.0 / np.sqrt(2.0 * N)
    tangents = directions @ across.T / (directions @ WANTED)[:, None]
    assert np.rad2deg(tangents.std(axis=0)) == pytest.approx(hand.direction_std_deg, rel=scatter)
    assert (offsets @ across.T).std(axis=0) == pytest.approx(hand.position_std_m, rel=scatter)
    # The offset lies in the surface across the direction: rounding of products of millimetres.
    assert np.abs(offsets @ WANTED).max() < 1e-15
    assert abs(np.corrcoef((offsets @ across.T).T)[0, 1]) < 4.0 / np.sqrt(N)


def test_pulses_lie_in_the_ranges_of_their_kind(hand, blows):
    ranges = {
        "good": hand.peak_n,
        "double": hand.peak_n,
        "soft": hand.soft_peak_n,
        "overload": hand.overload_peak_n,
    }
    for b in blows:
        low, high = ranges[b.kind]
        assert low <= b.pulses[0].peak_n <= high
        assert b.pulses[0].delay_s == 0.0
        assert hand.width_s[0] <= b.pulses[0].width_s <= hand.width_s[1]
        assert len(b.pulses) == (2 if b.kind == "double" else 1)


def test_good_peaks_are_even_in_their_logarithm(hand, blows):
    logs = np.log([b.pulses[0].peak_n for b in blows if b.kind == "good"])
    low, high = np.log(hand.peak_n)
    # A uniform variable's mean scatters by its width / sqrt(12 n); four of it.
    scatter = (high - low) / np.sqrt(12.0 * len(logs))
    assert logs.mean() == pytest.approx(0.5 * (low + high), abs=4.0 * scatter)


def test_a_double_strikes_again_weaker_and_after_the_first_pulse(hand, blows):
    for b in blows:
        if b.kind == "double":
            first, second = b.pulses
            pause_s = second.delay_s - first.width_s
            # Differences of times of some 10 ms: rounding of 1e-17 s.
            assert hand.double_delay_s[0] - 1e-15 <= pause_s <= hand.double_delay_s[1] + 1e-15
            low, high = hand.double_ratio
            assert low - 1e-12 <= second.peak_n / first.peak_n <= high + 1e-12


def test_the_same_generator_swings_the_same(hand):
    one = blow(hand, np.random.default_rng(9), "4", [0.0, 0.0, 1.0])
    other = blow(hand, np.random.default_rng(9), "4", [0.0, 0.0, 3.0])
    assert one.pulses == other.pulses
    assert np.array_equal(one.direction, other.direction)
    assert one.point_id == "4"
