"""Where fits of an effect begin: what is of no size, or of another shape, promises nothing."""

from dataclasses import replace

import numpy as np
import pytest
from support.bench_effects import JOINTS, instance_of, start_of

from armodal.analyzer.gap.effects import absorber
from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.beginnings import promising_beginnings
from armodal.analyzer.gap.search.first_steps import first_steps
from armodal.analyzer.gap.search.race import MOST_STEPS, Race
from armodal.analyzer.gap.search.scan import scan_instances

TRUE = "axis_2"


def true_values(servo, values):
    """A servo twice as stiff as its joint, its rotor about as fast as the lines go."""
    gamma = float(np.exp(-values[f"ln k {TRUE}"]))
    rotor = next(p.std for p in servo.parameters if p.name == f"servo rotor {TRUE}")
    return values | {f"servo compliance {TRUE}": 0.5 * gamma, f"servo rotor {TRUE}": rotor}


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p", "q"))


def measured_stage(superset, lines, hidden, values, noise=1e-6):
    """Two postures of an arm, as a model has it, without noise."""
    s = 2 * np.pi * (2.0 + 1j * np.geomspace(6.0, 60.0, 24))
    measured = []
    for name, joints in (("p", JOINTS), ("q", 0.5 * JOINTS)):
        own = replace(lines, name=name, joints_rad=joints, s_rad_s=s)
        y = PosedModel(superset, joints).values(hidden, own, values)
        measured.append(
            replace(own, values=y, variance=np.full(y.shape, noise * np.mean(abs(y) ** 2)))
        )
    return Stage(superset, measured, Discrepancy())


@pytest.fixture(scope="module")
def stage(superset, ordinary, lines):
    """Of an arm with such a servo."""
    servo = instance_of(ordinary, "servo", TRUE)
    hidden = Hypothesis(ordinary=ordinary, instances=(servo,))
    return measured_stage(superset, lines, hidden, true_values(servo, start_of(hidden)))


def test_what_broad_lines_do_not_see_is_begun_with_the_shape_that_sharp_ones_promise(
    superset, ordinary, lines
):
    """A fit of no size, at 20 Hz where 9 Hz is looked for, promised nothing and ended."""
    line = np.array([0.6, 0.0, 0.8]), np.array([0.0, 0.1, 0.05])
    swings = absorber.at_line(ordinary, 4, *line)
    size, ln_hz = (p.name for p in swings.parameters[:2])
    hidden = Hypothesis(ordinary=ordinary, instances=(swings,))
    values = start_of(hidden) | {size: 0.8, ln_hz: np.log(9.0)}
    sharp = measured_stage(superset, lines, hidden, values, noise=1e-3)
    blind = measured_stage(superset, lines, hidden, values | {size: 0.0}, noise=1e-3)
    about = fit_hypothesis(sharp, Hypothesis(ordinary=ordinary))
    looked = absorber.linear_candidates(sharp, about, ())[0]
    begun = first_steps(Race(sharp), about, looked, about.values, choose_on=blind)
    # A linear look overlooks how a mode splits: half of what it promises is there.
    assert about.cost - begun.cost > 0.5 * looked.gain > 10.0
    assert begun.values[looked.instance.size] > 0.0


def test_the_joint_of_a_servo_promises_most_from_its_beginnings_and_nothing_of_no_size(
    ordinary, stage
):
    servos = [i for i in all_instances(ordinary) if i.effect.name == "servo"]
    assert len(servos) > 2
    about = fit_hypothesis(stage, Hypothesis(ordinary=ordinary), max_iterations=28)
    blind = {c.instance.place: c.gain for c in scan_instances(stage, about, servos)}
    looked = promising_beginnings(stage, about, servos)
    instance, beginnings = looked[0]
    assert instance.place == TRUE
    assert max(blind, key=lambda place: blind[place]) != TRUE
    assert beginnings[0][0] > blind[TRUE] + 100.0  # nats: the data tell it beyond doubt
    # What it promises can be had: from one of the two best, as a search tries them.
    richer = replace(about.hypothesis, instances=(instance,))
    ends = [
        fit_hypothesis(stage, richer, start=begin, max_iterations=MOST_STEPS)
        for _, begin in beginnings[:2]
    ]
    assert about.cost - min(end.cost for end in ends) > 0.5 * beginnings[0][0]


def test_effects_without_beginnings_of_their_own_and_laws_are_left_out(ordinary, stage):
    about = fit_hypothesis(stage, Hypothesis(ordinary=ordinary), max_iterations=0)
    others = [i for i in all_instances(ordinary) if i.initial_values is None]
    assert others
    assert promising_beginnings(stage, about, others) == []


def test_a_linear_look_promises_no_size_below_zero(superset, ordinary, stage):
    """Nor where a gain and a phase of each posture's own pull the sizes the wrong way."""
    rng = np.random.default_rng(1)
    pulled = [
        replace(own, values=own.values * np.exp(0.2j * rng.normal()) * (1.0 + 0.3 * rng.normal()))
        for own in stage.lines
    ]
    disturbed = Stage(superset, pulled, Discrepancy())
    about = fit_hypothesis(disturbed, Hypothesis(ordinary=ordinary), max_iterations=0)
    sizes = [
        candidate.begin[parameter.name]
        for candidate in scan_instances(disturbed, about, all_instances(ordinary))
        for parameter in candidate.instance.parameters
        if parameter.name in (candidate.instance.size, *candidate.instance.sizes)
        if parameter.low >= 0.0 and not candidate.instance.relaxes
    ]
    # Some are pulled up, some down.
    assert sum(size > 1e-12 for size in sizes) > 5
    assert sum(size < 1e-12 for size in sizes) > 5
    # Of a size of zero by its mean and its deviation rounding leaves the last digit.
    assert min(sizes) > -1e-12
