import numpy as np
import pytest
from support.closed_form import POLES, SHAPES, S, receptance

from armodal.analyzer.checks import Fault, Outcome, homogeneity

LEVELS = np.array([1.0, 2.0, 4.0])


def hits(rng, *, softening=0.0, gain=0.0, noise=0.003, levels=LEVELS):
    """Single hits at both points; stiffness and gain change per doubling of the force."""
    found = []
    for point in SHAPES:
        own = []
        for level in levels:
            doublings = np.log2(level)
            H = S**2 * receptance(point, "a", stiffness=1.0 - softening * doublings)
            z = rng.standard_normal((2, *H.shape))
            H = H * (1.0 + gain * doublings)
            own.append(H + noise * np.sqrt(np.mean(np.abs(H) ** 2) / 2) * (z[0] + 1j * z[1]))
        found.append(np.stack(own))
    return found


def check(rng, levels=LEVELS, **change):
    single = hits(rng, levels=levels, **change)
    return homogeneity("p", S, POLES, single * 4, [levels] * len(single * 4))


def test_a_linear_structure_is_homogeneous():
    assert check(np.random.default_rng(1)).outcome is Outcome.GOOD


@pytest.mark.parametrize("change", [{"softening": 0.02}, {"gain": 0.05}, {"gain": -0.05}])
def test_a_change_with_the_level_is_named(change):
    finding = check(np.random.default_rng(2), **change)
    assert (finding.outcome, finding.fault) == (Outcome.FAULT, Fault.LEVEL_DEPENDENT)


def test_the_frequency_change_is_that_of_the_stiffness():
    # k falls by 1 % a doubling, so f by 0.5 %; to first order, hence a tolerance of a twentieth.
    finding = check(np.random.default_rng(3), softening=0.01, noise=1e-5)
    change = float(finding.text.split("frequency ")[1].split(" ")[0])
    assert change == pytest.approx(-0.5, rel=0.05)


def test_two_levels_cannot_tell():
    finding = check(np.random.default_rng(4), levels=np.array([1.0, 1.05, 2.0]))
    assert finding.outcome is Outcome.CANNOT_TELL


def test_without_modes_it_cannot_tell():
    single = hits(np.random.default_rng(5))
    finding = homogeneity("p", S, (), single, [LEVELS] * len(single))
    assert finding.outcome is Outcome.CANNOT_TELL
