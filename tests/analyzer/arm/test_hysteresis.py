"""How losses go with frequency, and what stiffness causality gives them."""

import numpy as np
import pytest

from armodal.analyzer.arm.hysteresis import (
    REFERENCE_RAD_S,
    hysteresis,
    lost_by_power,
    lost_by_power_slope,
    lost_by_power_slope_of_line,
    relaxed,
    relaxed_slope,
    relaxed_slope_of_line,
)

S = (-3.0 + 2j * np.pi * np.geomspace(2.0, 150.0, 9))[None]
POWERS = (0.02, 0.3, 0.5, 0.9, 1.0)


@pytest.mark.parametrize("power", [0.0, *POWERS])
def test_a_unit_loss_factor_is_one_at_the_reference_and_no_stiffness_there(power):
    at = lost_by_power(np.array([[1j * REFERENCE_RAD_S]]), np.array([power]))
    assert at == pytest.approx(1j, abs=1e-12)  # rounding over the power


@pytest.mark.parametrize("power", POWERS)
def test_the_loss_grows_with_the_power_of_frequency(power):
    s = 1j * np.abs(S)
    lost = lost_by_power(s, np.array([power])).imag[0]
    slope = np.diff(np.log(lost)) / np.diff(np.log(np.abs(s[0])))
    assert slope == pytest.approx(power, rel=1e-9)


def test_its_ends_are_the_constant_loss_and_a_dashpot():
    assert lost_by_power(S, np.array([1.0])) == pytest.approx(S / REFERENCE_RAD_S, rel=1e-12)
    # A power of 1e-4 stands for none: off by that times the logarithm of three octaves and more.
    assert lost_by_power(S, np.array([0.0])) == pytest.approx(hysteresis(S), rel=1e-3)


@pytest.mark.parametrize("power", POWERS[:-1])
def test_slopes_are_those_of_differences(power):
    at, step = np.array([power]), 1e-5
    by_power = (lost_by_power(S, at + step) - lost_by_power(S, at - step)) / (2.0 * step)
    assert lost_by_power_slope(S, at) == pytest.approx(by_power, rel=1e-5)  # step over the least
    near = 1e-3
    by_line = (lost_by_power(S + near, at) - lost_by_power(S - near, at)) / (2.0 * near)
    assert lost_by_power_slope_of_line(S, at) == pytest.approx(by_line, rel=1e-6)


def test_a_loss_by_power_stiffens_as_causality_wants():
    """Kramers and Kronig between two frequencies, by quadrature over twelve decades."""
    power = np.array([0.6])
    low, high = 0.5 * REFERENCE_RAD_S, 2.0 * REFERENCE_RAD_S
    u = np.geomspace(1e-8, 1e8, 400_001) * REFERENCE_RAD_S
    lost = lost_by_power(1j * u[None], power).imag[0]

    def kernel(w):
        own = float(lost_by_power(np.array([[1j * w]]), power).imag[0, 0])
        # What is singular taken off. With e^(i w t) nothing before the hit is w^2 - u^2.
        return (u * lost - w * own) / (w**2 - u**2)

    inside = (kernel(high) - kernel(low)) * u
    stiffer = 2.0 / np.pi * np.trapezoid(inside, np.log(u))
    real = lost_by_power(1j * np.array([[low, high]]), power).real[0]
    assert stiffer == pytest.approx(np.diff(real)[0], rel=1e-3)


RATES = np.array([0.1, 0.7, 1.0, 5.0]) * REFERENCE_RAD_S


@pytest.mark.parametrize("rate", RATES)
def test_what_relaxes_loses_most_at_its_rate_and_adds_two_in_all(rate):
    s = 1j * rate * np.array([[0.5, 1.0, 2.0]])
    assert np.argmax(relaxed(s, np.array([rate])).imag) == 1
    assert relaxed(s, np.array([rate])).imag[0, 1] == pytest.approx(1.0, rel=1e-12)
    still, fast = relaxed(np.array([[0j, 1e9j * rate]]), np.array([rate]))[0]
    assert (fast - still).real == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize("rate", RATES)
def test_what_relaxes_adds_no_stiffness_at_the_reference(rate):
    there = relaxed(np.array([[1j * REFERENCE_RAD_S]]), np.array([rate]))
    assert there.real == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("rate", RATES)
def test_slopes_of_what_relaxes_are_those_of_differences(rate):
    at, step = np.array([rate]), 1e-5
    ends = (relaxed(S, at * np.exp(own)) for own in (step, -step))
    by_rate = np.subtract(*ends) / (2.0 * step)
    # A step's square, and rounding over the step.
    assert relaxed_slope(S, at) == pytest.approx(by_rate, rel=1e-8, abs=1e-10)
    near = 1e-3
    by_line = (relaxed(S + near, at) - relaxed(S - near, at)) / (2.0 * near)
    assert relaxed_slope_of_line(S, at) == pytest.approx(by_line, rel=1e-8, abs=1e-11)
