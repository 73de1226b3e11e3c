"""A drive that is only soft hides in its joint's stiffness: the range of k leaves room for it."""

from dataclasses import replace

import numpy as np
import pytest
from support.bench_effects import JOINTS, instance_of, start_of

from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.hidden_size import HiddenSize
from armodal.analyzer.gap.search.scan import scan_instances
from armodal.analyzer.gap.stiffness_ranges import hidden_sizes, largest_size, stiffness_ranges

JOINT = "axis_2"
PART = 0.15  # of the joint's own compliance


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p", "q"))


@pytest.fixture(scope="module")
def servo(ordinary):
    return instance_of(ordinary, "servo", JOINT)


def measured(superset, lines, hidden, values):
    """Two postures of an arm, as the model itself has it, without noise."""
    s = 2 * np.pi * (2.0 + 1j * np.geomspace(6.0, 60.0, 24))
    found = []
    for name, joints in (("p", JOINTS), ("q", 0.5 * JOINTS)):
        own = replace(lines, name=name, joints_rad=joints, s_rad_s=s)
        y = PosedModel(superset, joints).values(hidden, own, values)
        variance = np.full(y.shape, 1e-6 * np.mean(abs(y) ** 2))
        found.append(replace(own, values=y, variance=variance))
    return Stage(superset, found, Discrepancy())


def told(stage, ordinary, servo):
    """Its range of k, the limit of the drive's compliance, and what a linear look says of that."""
    present = fit_hypothesis(stage, Hypothesis(ordinary=ordinary), max_iterations=28)
    (candidate,) = scan_instances(stage, present, [servo])
    sizes = hidden_sizes(stage, present, [candidate], 1.0)
    ranges = stiffness_ranges([present], sizes, 1.0, settled=True)
    own = next(row for row in ranges if row.joint == JOINT)
    return own, sizes[0].at_most, largest_size(candidate, 1.0)


@pytest.mark.long
def test_a_drive_whose_rotor_is_beyond_the_lines_is_within_the_range_of_k(
    superset, ordinary, lines, servo
):
    hidden = Hypothesis(ordinary=ordinary, instances=(servo,))
    values = start_of(hidden)
    k = float(np.exp(values[f"ln k {JOINT}"]))
    typical = next(p.mean for p in servo.parameters if p.name == f"servo rotor {JOINT}")
    values |= {
        f"servo compliance {JOINT}": PART / k,
        f"servo rotor {JOINT}": 0.02 * typical,
        f"servo loss {JOINT}": 0.0,
    }
    own, at_most, linear = told(measured(superset, lines, hidden, values), ordinary, servo)
    assert own.k_n_m_per_rad < 0.95 * k  # the drive's compliance is taken for the joint's
    assert own.low < k < own.high
    assert linear < PART / k < at_most


@pytest.mark.long
def test_a_drive_that_would_bring_its_rotor_s_resonance_does_not_widen_the_range(
    superset, ordinary, lines, servo
):
    plain = Hypothesis(ordinary=ordinary)
    values = start_of(plain)
    own, at_most, _ = told(measured(superset, lines, plain, values), ordinary, servo)
    believed = next(p.std for p in servo.parameters if p.name == servo.size)
    assert own.low < np.exp(values[f"ln k {JOINT}"]) < own.high
    assert at_most < believed


def test_what_may_go_either_way_is_held_against_the_data_on_both_sides(superset, ordinary, lines):
    plain = Hypothesis(ordinary=ordinary)
    stage = measured(superset, lines, plain, start_of(plain))
    coupling = instance_of(ordinary, "coupling")
    present = fit_hypothesis(stage, plain, max_iterations=28)
    (candidate,) = scan_instances(stage, present, [coupling])
    limits = [20.0 * largest_size(candidate, 1.0), -20.0 * largest_size(candidate, 1.0)]
    sizes = [HiddenSize(stage, present, candidate, limit, 1.0) for limit in limits]
    for hidden in sizes:
        hidden.hold_against_data(abs(hidden.limit) / 100.0)
    # Twenty times what a linear look leaves room for is more than the data do.
    assert 0.0 < sizes[0].at_most < limits[0]
    assert limits[1] < sizes[1].at_most < 0.0
