"""Drives of the frame: a dashpot, and relaxations over a band."""

import numpy as np
import pytest

from armodal.hil_sim.makers.arms import arm_table
from armodal.hil_sim.makers.case import CaseSpec
from armodal.hil_sim.makers.frame.drive_loss import LOSS_AT_HZ, DriveLoss
from armodal.hil_sim.makers.frame.maker import made
from armodal.protocols.arm.reference import STIFFNESS_AT_HZ

LOSS = DriveLoss(factor=0.06, stiffer=0.08, band_hz=(5.0, 60.0))
K = 2e4


def test_its_dashpot_loses_what_it_says_where_it_says():
    s = 2j * np.pi * np.array([LOSS_AT_HZ])
    dashpot = DriveLoss(factor=0.06).law(K)(s)
    assert dashpot == pytest.approx(0.06j * K, rel=1e-12)
    assert LOSS.law(K, 1.5)(s) - LOSS.law(K)(s) == pytest.approx(0.5 * dashpot, rel=1e-12)


def test_it_is_a_sum_of_relaxations_that_are_as_many_in_every_part_of_an_octave():
    s = 2j * np.pi * np.geomspace(0.5, 400.0, 25)
    edges = 2.0 * np.pi * np.geomspace(5.0, 60.0, 2001)
    rates = np.sqrt(edges[1:] * edges[:-1])
    each = 0.08 * K / len(rates)
    relaxed = np.sum(each * s[:, None] / (s[:, None] + rates), axis=1)
    dashpot = 0.06 * K * s / (2.0 * np.pi * LOSS_AT_HZ)
    # Two thousand steps of a sum for an integral: their error falls with the square.
    assert LOSS.law(K)(s) == pytest.approx(dashpot + relaxed, rel=1e-6)


def test_at_rest_it_adds_nothing_and_fast_what_it_says():
    assert LOSS.law(K)(np.array([0j])) == pytest.approx(0.0)
    law = LOSS.law(K)(2j * np.pi * np.geomspace(0.1, 1e5, 30))
    assert np.all(np.diff(law.real) > 0.0)
    assert np.all(law.imag > 0.0)
    # At 1e5 Hz 60 Hz are slow: what is left falls with the square of their ratio.
    assert law.real[-1] == pytest.approx(0.08 * K, rel=1e-6)


def test_no_power_of_frequency_is_its_loss():
    f_hz = np.geomspace(1.0, 200.0, 40)
    lost = LOSS.law(K)(2j * np.pi * f_hz).imag
    power = np.diff(np.log(lost)) / np.diff(np.log(f_hz))
    assert np.ptp(power) > 0.1


@pytest.mark.parametrize("kind", [None, "hysteretic", "servo"])
def test_the_stiffness_that_is_told_is_that_of_the_joint_s_own_law(kind):
    """Of a law that an effect gives every drive; not of a servo behind one."""
    kinds = () if kind is None else (kind,)
    spec = CaseSpec(
        maker="frame", seed=3, arm="ur10e", wrist="elastic", kinds=kinds, size_class="clear"
    )
    found = made(arm_table("ur10e"), spec)
    s = 2j * np.pi * np.array([STIFFNESS_AT_HZ])
    parts, plain = found.shop.parts, found.shop.drawn.parts
    for name, told in found.truth["joints"].items():
        law = parts.drives[name].law if kind == "hysteretic" else plain.drives[name].law
        k = plain.drives[name].stiffness + law(s)[0].real
        assert told["stiffness_n_m_per_rad"] == pytest.approx(k, rel=1e-12)
