"""Torques of joints' own laws over a harmonic swing: closed forms."""

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import microslip
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import Bent, Play, Sliders, over_a_swing
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.arm.files import load_arm


def row(*values):
    return np.array([values])


def test_over_a_swing_a_slider_dissipates_four_times_its_limit_and_swing():
    k, limit, swing = 50.0, 2.0, 0.3
    _, loss = over_a_swing(
        Sliders(stiffness=row(k), limit=row(limit), creep_per_s=np.zeros(1)), swing, 1.0
    )
    # Of a Jenkins element, 4 T (A - T / k) a round; pi A^2 times the damping term.
    energy = np.pi * swing**2 * loss
    # A round of 256 steps: the corners fall between two.
    assert energy == pytest.approx(4.0 * limit * (swing - limit / k), rel=0.01)


def test_a_slider_that_creeps_before_it_slips_is_a_damper_in_series_with_its_spring():
    k, creep, rate, swing = 50.0, 30.0, 20.0, 0.01
    element = Sliders(stiffness=row(k), limit=row(1e3), creep_per_s=np.array([creep]))
    stiffness, loss = over_a_swing(element, swing, rate)
    want = k * 1j * rate / (1j * rate + creep)  # Maxwell's element
    # What it began with has died out by exp(-3 pi) the second time around; 256 steps.
    assert complex(stiffness, loss) == pytest.approx(want, rel=0.02)


def test_over_a_swing_a_play_takes_what_its_describing_function_says():
    k, half, swing = 3.0, 0.2, 0.5
    element = Play(stiffness=np.array([k]), half=np.array([half]), rest=np.zeros(1))
    stiffness, loss = over_a_swing(element, swing, 1.0)
    z = half / swing
    want = -k * (2.0 / np.pi) * (np.arcsin(z) + z * np.sqrt(1.0 - z**2))
    assert stiffness == pytest.approx(want, rel=1e-3)
    assert loss == pytest.approx(0.0, abs=1e-9)


def test_over_a_small_swing_a_bent_spring_is_three_quarters_of_its_cube():
    part, bend, swing = 4.0, 1.0, 0.01
    element = Bent(part=np.array([part]), bend=np.array([bend]))
    stiffness, _ = over_a_swing(element, swing, 1.0)
    # The next term is of the fourth power of the swing over the bend.
    assert stiffness == pytest.approx(0.75 * part * swing**2 / bend**2, rel=1e-3)


@pytest.mark.parametrize("part", [0.03, 0.1, 0.4, 0.9])
def test_a_seats_staircase_is_the_smooth_law_it_stands_for(part):
    """Limits evenly apart up to a turn X: k a (1 - a / 2 X), by Masing 2 k a^3 / 3 X a cycle."""
    plain = Hypothesis(ordinary=Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",)))
    values = plain.space().values(plain.space().start())
    (seat,) = microslip.laws(plain.ordinary, "joint_2", 1e-4, 100.0)
    held, reach, spread = (parameter.name for parameter in seat.parameters)
    own = values | {held: np.log(2.0), reach: np.log(2.0), spread: 0.0}  # k of the joint, X 1e-4
    k, swing = np.exp(values["ln k joint_2"]), 1e-4 * part
    stiffness, loss = over_a_swing(seat.law.element(own, 0.0), swing, 1.0)
    # The mean slope of the law over a cycle: its first harmonic has less than 2 % of another.
    assert stiffness == pytest.approx(k * (1.0 - part / 2.0), rel=0.03)
    assert loss == pytest.approx(2.0 * k * part / (3.0 * np.pi), rel=0.1)
