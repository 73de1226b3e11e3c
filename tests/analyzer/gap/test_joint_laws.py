"""Joints' own laws: the joint followed in time, the linear model."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate
from support.added import added
from support.quick import few_quick
from support.small_case import SmallCase, small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import file_key, instances_of_file
from armodal.analyzer.gap.effects import backlash, friction, microslip, softening
from armodal.analyzer.gap.effects.level import any_change
from armodal.analyzer.gap.inference.fit import Stage, best_starting_point, cost_at, fit_hypothesis
from armodal.analyzer.gap.model.hit_levels import middle_level
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import Bent, Play, Sliders
from armodal.analyzer.gap.model.joint_turns import holding_back
from armodal.analyzer.gap.model.largest_swings import swings_of
from armodal.analyzer.gap.model.linearised import linearised
from armodal.analyzer.gap.model.lines import Annealing, own_lines
from armodal.analyzer.gap.model.march import march
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import Postures
from armodal.analyzer.gap.model.steps import STEPS
from armodal.analyzer.gap.model.swings import pulse
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter
from armodal.protocols.errors import ArmError

LAWS = (backlash, friction, microslip, softening)
STIFFEST = 15  # of the starting points of a friction: 300 times its joint, and often stuck


def steps_of_a_mass(mass, k, c):
    """How a mass on a spring turns by a torque in steps, (n_steps, parts, parts)."""
    s = STEPS.s_rad_s
    return STEPS.of(1.0 / (mass * s**2 + c * s + k))


def made(kind, mass, k, c, force):
    """A mass on a spring, a damper and an element, integrated by SciPy with tight steps."""

    def rate(t, y):
        x, v = y
        torque = kind.resist(np.array([x]), np.zeros((1, 0)))[0][0]
        return [v, (force(t) - k * x - c * v - torque) / mass]

    t = STEPS.seconds
    return integrate.solve_ivp(rate, (0.0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-14).y[0]


@pytest.mark.parametrize(
    "element",
    [
        pytest.param(
            Play(stiffness=np.array([900.0]), half=np.array([1e-3]), rest=np.zeros(1)),
            marks=pytest.mark.long,
        ),
        Play(stiffness=np.array([600.0]), half=np.array([1e-3]), rest=np.array([5e-4])),
        Bent(part=np.array([-600.0]), bend=np.array([2e-3])),
        pytest.param(Bent(part=np.array([4000.0]), bend=np.array([9e-3])), marks=pytest.mark.long),
    ],
)
def test_a_joint_followed_in_time_is_where_an_integrator_says(element):
    mass, k, c, peak, width = 0.1, 1000.0, 0.2, 60.0, 2e-3
    length = 1.5 * width

    def force(t):
        return peak * np.sin(np.pi * t / length) if t < length else 0.0

    t = STEPS.seconds
    w = np.sqrt(k / mass - (c / mass / 2) ** 2)
    impulse = np.exp(-c / mass / 2 * t) * np.sin(w * t) / (mass * w)
    fine = 1e-5 * np.arange(round(length / 1e-5))
    free = np.sum(
        [
            force(u) * 1e-5 * np.where(t > u, np.interp(t - u, t, impulse, left=0.0), 0.0)
            for u in fine
        ],
        axis=0,
    )
    ((turn,), _) = march(
        steps_of_a_mass(mass, k, c)[None], np.zeros(1, dtype=int), free[None], element
    )
    want = made(element, mass, k, c, force)
    assert np.abs(free - want).max() > 0.2 * np.abs(want).max()  # the element matters
    # Three parts of 1.5 ms, weighed as the finest lines do.
    late = np.exp(-4.0 * np.pi * t)
    assert np.abs((turn - want) * late).max() < 0.01 * np.abs(want).max()


@pytest.mark.parametrize("before", [3e1, 3e2, 3e3, 3e5])
def test_dry_friction_takes_as_much_of_every_swing_and_then_holds(before):
    # A mass on a spring that is let go: 2 L / k less at every turn (Den Hartog, Mechanical
    # Vibrations, 1956, 8.3), until the spring can move it no more.
    mass, k, limit, start = 0.1, 1000.0, 1.3, 0.01
    t = STEPS.seconds
    free = start * np.cos(np.sqrt(k / mass) * t)
    slider = Sliders(
        stiffness=np.array([[before * k]]), limit=np.array([[limit]]), creep_per_s=np.zeros(1)
    )
    ((turn,), (torque,)) = march(
        steps_of_a_mass(mass, k, 0.0)[None], np.zeros(1, dtype=int), (free - start)[None], slider
    )
    turn = turn + start
    n_turns = int((start / (limit / k) - 1.0) / 2.0) + 1
    turns = np.arange(n_turns + 1)
    at = np.searchsorted(t, np.pi * turns / np.sqrt(k / mass))
    want = (start - 2.0 * limit / k * turns) * (-1.0) ** turns
    # It gives way by 2 L / before / k before it slips the other way.
    slack = 2.0 * limit / k / before
    np.testing.assert_allclose(turn[at], want, atol=0.01 * start + n_turns * slack)
    assert np.ptp(turn[at[-1] + 10 :]) < 0.01 * start + slack
    assert np.abs(torque).max() == pytest.approx(limit)


def test_a_pulse_has_the_transform_of_a_half_sine():
    s, peak, width = 12.0 + 300.0j, 40.0, 2e-3
    t = np.linspace(0.0, 1.5 * width, 20001)
    want = np.trapezoid(peak * np.sin(np.pi * t / t[-1]) * np.exp(-s * t), t)
    assert pulse(np.array([s]), peak, width)[0] == pytest.approx(want, rel=1e-6)


class TwoPostures(SmallCase):
    n_postures = 2


def levelled(kind=None):
    """Sharp lines of soft and hard hits of a few postures, and the arm as believed."""
    session = small_case(3001, "rv4frl", kind, ladder=True, of=TwoPostures).session()
    superset = Superset(session.header.arm)
    annealing = Annealing(sigma_rad_s=4.0 * np.pi, step_hz=8.0, band_hz=(8.0, 120.0))
    lines = own_lines(superset, session, annealing, level_about=middle_level(session))
    stage = Stage(superset, lines, Discrepancy())
    names = tuple(dict.fromkeys(own.name for own in lines))
    ordinary = Ordinary(superset=superset, postures=names, level_span=lines[1].level)
    return stage, Hypothesis(ordinary=ordinary)


@pytest.fixture(scope="module")
def arm():
    stage, plain = levelled()
    space = plain.space()
    values = space.values(space.start())
    return stage, plain, values, swings_of(plain, stage.models, stage.lines, values)


def with_law(plain, kind, joint, swings):
    swing, rate = next(own[1:] for own in swings if own[0] == joint)
    return replace(plain, instances=kind.laws(plain.ordinary, joint, swing, rate)[-1:])


def test_every_elastic_joint_swings(arm):
    _, plain, _, swings = arm
    joints = plain.ordinary.arm.joints
    assert [own[0] for own in swings] == [joints[i].name for i in plain.ordinary.elastic]
    assert all(turn > 0.0 for _, turn, _ in swings)
    # The modes of this arm that joints make are between these; noise is beyond.
    assert all(2.0 * np.pi * 5.0 < rate < 2.0 * np.pi * 60.0 for _, _, rate in swings)


def answers(stage, hypothesis, values):
    return [
        model.values(hypothesis, lines, values)
        for model, lines in zip(stage.models, stage.lines, strict=True)
    ]


@pytest.mark.parametrize("kind", few_quick(LAWS, friction, softening))
def test_a_law_of_no_size_changes_nothing(kind, arm):
    stage, plain, values, swings = arm
    hypothesis = with_law(plain, kind, "joint_2", swings)
    space = hypothesis.space()
    start = space.values(space.start()) | {hypothesis.instances[0].size: 0.0}
    about = linearised(hypothesis, stage.models, stage.lines, start)
    for one, other in zip(answers(stage, about, start), answers(stage, plain, values), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-9 * np.abs(other).max())


@pytest.mark.parametrize(
    "kind",
    [
        backlash,
        *(pytest.param(k, marks=pytest.mark.long) for k in (friction, microslip, softening)),
    ],
)
def test_near_its_point_a_law_is_as_linear_as_it_is_taken_to_be(kind, arm):
    stage, plain, _, swings = arm
    hypothesis = with_law(plain, kind, "joint_2", swings)
    (instance,) = hypothesis.instances
    space = hypothesis.space()
    start = space.values(space.start())
    start |= instance.initial_values(start)[2]
    about = linearised(hypothesis, stage.models, stage.lines, start)
    before = answers(stage, about, start)
    for parameter in instance.parameters:
        moved = start | {parameter.name: start[parameter.name] + 0.01 * parameter.std}
        exact = linearised(hypothesis, stage.models, stage.lines, moved)
        near, there = (np.concatenate(answers(stage, h, moved)) for h in (about, exact))
        change = np.linalg.norm(there - np.concatenate(before))
        # Within the step its slopes are of; corners of a law move with it.
        assert np.linalg.norm(there - near) < 0.3 * change


# Of the change: a law's corners move with the turn, a stiff slider's furthest.
@pytest.mark.parametrize(
    ("kind", "start_at", "allowed"),
    [
        (softening, 2, 0.02),
        pytest.param(friction, 2, 0.05, marks=pytest.mark.long),
        (friction, STIFFEST, 0.25),
        pytest.param(microslip, 2, 0.02, marks=pytest.mark.long),
        pytest.param(backlash, 2, 0.1, marks=pytest.mark.long),
    ],
)
def test_near_its_point_a_law_follows_every_parameter_of_the_model(kind, start_at, allowed, arm):
    stage, plain, _, swings = arm
    hypothesis = with_law(plain, kind, "joint_2", swings)
    space = hypothesis.space()
    start = space.values(space.start())
    start |= hypothesis.instances[0].initial_values(start)[start_at]
    about = linearised(hypothesis, stage.models, stage.lines, start)
    before = np.concatenate(answers(stage, about, start))
    own_spring = ("ln k joint_2", "ln c joint_2", "loss joint_2")
    others = ("ln k joint_3", "ln mass forearm", "bearing a joint_1", "encoder joint_2")
    for name in (*own_spring, *others, "aim a test 1", "ln gain x"):
        moved = start | {name: start[name] + 0.02 * space.std[space.index[name]]}
        exact = linearised(hypothesis, stage.models, stage.lines, moved, slopes=False)
        near, there = (np.concatenate(answers(stage, h, moved)) for h in (about, exact))
        change = np.linalg.norm(there - before)
        assert change > 0.0, name
        assert np.linalg.norm(there - near) < allowed * change, name


def test_what_data_tell_as_a_sum_its_slopes_leave_alike(arm):
    """A seat that hardly slips and the spring beside it: their sum stays, and little changes."""
    stage, plain, _, swings = arm
    hypothesis = with_law(plain, microslip, "joint_2", swings)
    (seat,) = hypothesis.instances
    space = hypothesis.space()
    start = space.values(space.start()) | {seat.size: 0.6, seat.shapes[0]: 1.5, seat.shapes[1]: 0.0}
    about = linearised(hypothesis, stage.models, stage.lines, start)
    before = np.concatenate(answers(stage, about, start))
    changes = []
    for back in (0.0, 5e-4):
        moved = start | {seat.size: start[seat.size] + 5e-4}
        moved["ln k joint_2"] -= back
        exact = linearised(hypothesis, stage.models, stage.lines, moved, slopes=False)
        near, there = (np.concatenate(answers(stage, h, moved)) for h in (about, exact))
        changes.append((np.linalg.norm(there - before), np.linalg.norm(there - near)))
    (alone, _), (both, wrong) = changes
    assert both < 0.02 * alone
    # A slope is a secant over a part of its parameter's deviation, for the sake of laws' corners.
    assert wrong < 0.6 * both


def test_a_torque_held_back_is_what_a_unit_torque_takes_off(arm):
    stage, plain, values, _ = arm
    together = Postures(stage.models[:1], stage.lines[:1])
    assembly = together.assembled(plain, values)[0]
    row = np.zeros(len(assembly.columns))
    row[: assembly.joint_row("joint_2").size] = assembly.joint_row("joint_2")
    response = together.response(plain, values)
    shape = response.values.shape[:2] + response.values.shape[3:]
    torque = np.exp(1j * np.arange(float(np.prod(shape)))).reshape(shape)
    held = holding_back(response, row[None], torque)
    want = response.values - response.under_a_torque(row[None]) * torque[:, :, None]
    np.testing.assert_allclose(held.values, want, rtol=1e-9, atol=1e-12 * np.abs(want).max())


def test_where_nothing_was_hit_a_law_is_the_spring_of_swings_of_the_level(arm):
    stage, plain, _, swings = arm
    hypothesis = with_law(plain, softening, "joint_2", swings)
    (instance,) = hypothesis.instances
    space = hypothesis.space()
    start = space.values(space.start()) | {instance.size: 0.3}
    stiffer = [
        answers(stage, hypothesis, start | {instance.size: size})[0] for size in (0.0, 0.3, 0.6)
    ]
    below = np.abs([own[..., 0] for own in stiffer]).sum(axis=(1, 2))
    assert below[0] < below[1] < below[2]  # below resonance a softer joint answers more


def test_a_fit_of_a_law_ends_nearer_to_the_data_than_it_began(arm):
    """Of a softening that is not there: its size is to become small."""
    stage, plain, _, swings = arm
    hypothesis = with_law(plain, softening, "joint_2", swings)
    (instance,) = hypothesis.instances
    space = hypothesis.space()
    begin = space.values(space.start())
    starts = [begin | {instance.size: size} for size in (0.3, 0.2)]
    start = best_starting_point(stage, hypothesis, starts)
    assert start == starts[1]
    found = fit_hypothesis(stage, hypothesis, start=start, max_iterations=8)
    assert found.cost < cost_at(stage, hypothesis, start) / 2.0
    assert abs(found.values[instance.size]) < 0.1


@pytest.mark.long
@pytest.mark.parametrize(("kind", "module"), [("softening", softening), ("friction", friction)])
def test_a_joint_s_own_law_explains_more_than_a_spring_of_each_level(kind, module):
    stage, plain = levelled(kind)
    first = fit_hypothesis(stage, plain, max_iterations=8)
    joint = json.loads(small_case(3001, "rv4frl", kind, ladder=True).open_truth())["effects"][0][
        "place"
    ]
    by_level = next(look for look in any_change(plain.ordinary) if look.place == joint)
    springs = fit_hypothesis(
        stage, replace(plain, instances=(by_level,)), start=first.values, max_iterations=12
    )
    swings = swings_of(plain, stage.models, stage.lines, first.values)
    hypothesis = with_law(plain, module, joint, swings)
    starting_points = hypothesis.instances[0].initial_values(springs.values)
    law = fit_hypothesis(
        stage,
        hypothesis,
        start=best_starting_point(stage, hypothesis, starting_points),
        max_iterations=6,
    )
    assert law.cost < springs.cost


@pytest.mark.parametrize("kind", LAWS)
def test_a_law_in_an_arm_file_comes_back_as_that_law(kind, arm):
    _, plain, values, swings = arm
    (instance,) = with_law(plain, kind, "joint_2", swings).instances
    evidence = EffectEvidence(
        gain_nats=50.0,
        held_out_gain_nats=10.0,
        confidence=1.0,
        session_sha256="0" * 64,
        created="2026-01-31T12:00:00+00:00",
    )
    own = {parameter.name: 0.5 * parameter.high for parameter in instance.parameters}
    effect = AddedEffect(
        name=instance.effect.name,
        place=instance.place,
        parameters=tuple(
            EffectParameter(
                name=file_key(p.name, instance.place),
                unit=p.unit,
                value=own[p.name],
                std=0.0,
                low=own[p.name],
                high=own[p.name],
            )
            for p in instance.parameters
        ),
        description=instance.describe(values),
        evidence=evidence,
    )
    superset = Superset(replace(plain.ordinary.arm, effects=(effect,)))
    (back,), start = instances_of_file(Ordinary(superset=superset, postures=("p",)))
    assert back.key == instance.key
    assert back.owned == instance.owned
    assert back.law.swing_rad == instance.law.swing_rad
    assert start == own


def test_an_effect_of_the_level_without_a_swing_is_none_that_a_file_can_hold(arm):
    """A law is counted by its joint's swing: without that its sizes mean nothing."""
    _, plain, _, swings = arm
    (instance,) = with_law(plain, softening, "joint_2", swings).instances
    without = added("softening", "joint_2", **{file_key(instance.size, "joint_2"): 0.3})
    superset = Superset(replace(plain.ordinary.arm, effects=(without,)))
    with pytest.raises(ArmError, match=r"'softening' at 'joint_2' is not one the library has"):
        instances_of_file(Ordinary(superset=superset, postures=("p",)))


def test_a_law_whose_swings_do_not_stay_finite_costs_beyond_all_others(arm):
    stage, plain, _, swings = arm
    hypothesis = with_law(plain, softening, "joint_2", swings)
    (instance,) = hypothesis.instances

    def falls_apart(values, load):
        return Bent(part=np.array([np.inf]), bend=np.array([1e-6]))

    law = replace(instance.law, element=falls_apart)
    broken = replace(hypothesis, instances=(replace(instance, law=law),))
    with np.errstate(all="ignore"):
        assert cost_at(stage, broken, {}) == np.inf
        assert np.isfinite(cost_at(stage, hypothesis, {}))


def test_a_fit_cannot_begin_where_rounding_alone_would_be_its_cost(arm):
    """A law so large that its linear stand-in lies on a pole: predictions are off by all orders."""
    stage, plain, _, swings = arm
    hypothesis = with_law(plain, softening, "joint_2", swings)
    size = hypothesis.instances[0].parameters[0].name
    assert cost_at(stage, hypothesis, {size: 0.6}) == np.inf
    with pytest.raises(np.linalg.LinAlgError):
        fit_hypothesis(stage, hypothesis, start={size: 0.6}, max_iterations=0)
