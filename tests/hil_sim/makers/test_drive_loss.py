"""Drives of the frame: a dashpot and Maxwell elements."""

import numpy as np
import pytest

from armodal.hil_sim.makers.frame.drive_loss import LOSS_AT_HZ, DriveLoss

LOSS = DriveLoss(factor=0.06, relaxing=((0.25, 5.0), (0.1, 60.0)))
K = 2e4


def test_it_loses_what_it_says_where_it_says():
    at = LOSS.law(K)(2j * np.pi * np.array([LOSS_AT_HZ]))[0]
    assert at.imag == pytest.approx(0.06 * K, rel=1e-12)
    assert LOSS.law(K, 1.5)(2j * np.pi * np.array([LOSS_AT_HZ]))[0] == pytest.approx(1.5 * at)


def test_at_rest_it_adds_nothing_and_is_stiffer_the_faster_it_moves():
    assert LOSS.law(K)(np.array([0j])) == pytest.approx(0.0)
    law = LOSS.law(K)(2j * np.pi * np.geomspace(0.1, 500.0, 30))
    assert np.all(np.diff(law.real) > 0.0)
    assert np.all(law.imag > 0.0)


def test_no_power_of_frequency_is_its_loss():
    f_hz = np.geomspace(1.0, 200.0, 40)
    lost = LOSS.law(K)(2j * np.pi * f_hz).imag
    power = np.diff(np.log(lost)) / np.diff(np.log(f_hz))
    assert np.ptp(power) > 0.1
