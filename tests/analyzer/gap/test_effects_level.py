"""Springs that change with the hits' level: the equations, the signs of each kind, the lines."""

from dataclasses import replace

import numpy as np
import pytest
from support.bench_effects import JOINTS
from support.small_case import SmallestCase, small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import file_key, instances_of_file
from armodal.analyzer.gap.effects import backlash, friction, microslip, softening
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.hit_levels import has_levels, middle_level, weight_factors
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import Annealing, own_lines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.candidates import goes_with
from armodal.analyzer.gap.search.levels import told_apart
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter

KINDS = (backlash, friction, microslip, softening)


@pytest.fixture(scope="module")
def hard(lines):
    return replace(lines, level=1.1)


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p",), level_span=1.1)


@pytest.fixture(scope="module")
def posed(superset):
    return PosedModel(superset, JOINTS)


def test_without_levels_there_are_no_effects_of_them(ordinary):
    names = {i.effect.name for i in all_instances(replace(ordinary, level_span=0.0))}
    assert not names & {kind.WORDS.name for kind in KINDS}


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_the_plain_arm_with_another_spring_at_that_level(kind, ordinary, hard, posed):
    instance = kind.instances(ordinary)[1]
    joint = instance.place
    plain = Hypothesis(ordinary=ordinary)
    changed = Hypothesis(ordinary=ordinary, instances=(instance,))
    space = changed.space()
    values = space.values(space.start())
    by_k, by_c = (p.name for p in instance.parameters)
    values |= {by_k: 0.1, by_c: 0.06}
    sign = {"backlash": (1, 1), "friction": (-1, -1), "microslip": (-1, 1), "softening": (-1, 1)}
    with_k = 0.4 if kind is softening else 0.0
    k_sign, c_sign = sign[kind.WORDS.name]
    ln_k = k_sign * 0.1 * hard.level
    ln_c = c_sign * (0.06 + with_k * 0.1) * hard.level
    other = values | {
        f"ln k {joint}": values[f"ln k {joint}"] + ln_k,
        f"ln c {joint}": values[f"ln c {joint}"] + ln_c,
    }
    np.testing.assert_allclose(
        posed.values(changed, hard, values),
        posed.values(plain, hard, other),
        rtol=1e-9,
    )


@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_are_those_of_differences(kind, ordinary, hard, posed):
    instance = kind.instances(ordinary)[2]
    hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
    space = hypothesis.space()
    u = np.clip(space.start() + 0.3, space.low, space.high)
    _, dy = posed.derivatives(hypothesis, hard, space, space.values(u))
    joint = [f"ln {what} {instance.place}" for what in "kc"]
    for i in (space.index[name] for name in (*instance.owned, *joint, f"loss {instance.place}")):
        ends = []
        for side in (1e-5, -1e-5):
            moved = u.copy()
            moved[i] += side
            ends.append(posed.values(hypothesis, hard, space.values(moved)))
        want = (ends[0] - ends[1]) / 2e-5
        # Analytic against central differences: rounding over the step.
        np.testing.assert_allclose(dy[i], want, atol=1e-5 * np.abs(want).max())


def swung(torque, amplitude):
    """Stiffness and damping (times frequency) of a torque over a harmonic swing, once around."""
    turn = np.linspace(0.0, 4.0 * np.pi, 8001)
    stretch = amplitude * np.cos(turn)
    t = torque(stretch)[4000:-1]  # the second time around: sliders have found their place
    way = turn[4000:-1]
    k = 2.0 * np.mean(t * np.cos(way)) / amplitude
    return k, -2.0 * np.mean(t * np.sin(way)) / amplitude


def sliders(k, limits):
    """Jenkins elements, stiffness k each."""

    def torque(stretch):
        total = np.zeros_like(stretch)
        for limit in limits:
            at = 0.0
            for i, s in enumerate(stretch):
                at = np.clip(at, s - limit / k, s + limit / k)
                total[i] += k * (s - at)
        return total

    return torque


def slopes(torque, soft, hard):
    """Change of ln k and ln c by ln level of a joint of unit stiffness, 6 % loss, plus torque."""
    ends = []
    for amplitude in (soft, hard):
        k, c = swung(torque, amplitude)
        ends.append(np.log([1.0 + k, 0.06 + c]))
    return (ends[1] - ends[0]) / np.log(hard / soft)


# What single-frequency equivalent linearisation says of the kinds, swings from 0.35 to 2.9.
@pytest.mark.parametrize(
    ("kind", "torque"),
    [
        (friction, sliders(2.0, [0.14])),
        (microslip, sliders(0.4 / 6, 0.45 * np.arange(1, 12, 2) / 36)),
        (softening, lambda s: 0.4 * (0.5 * np.tanh(s / 0.5) - s)),
        (backlash, lambda s: -np.clip(s, -0.2, 0.2)),
    ],
)
def test_the_signs_of_each_kind_are_within_its_bounds_alone(kind, torque, ordinary):
    by_k, by_c = slopes(torque, 0.35, 2.9)

    def admits(module):
        k, c = module.instances(ordinary)[0].parameters
        sense_k = 1.0 if module is backlash else -1.0
        sense_c = -1.0 if module is friction else 1.0
        own_k = sense_k * by_k
        own_c = sense_c * by_c - (0.4 * own_k if module is softening else 0.0)
        return k.low <= own_k <= k.high and c.low <= own_c <= c.high

    allowed = [module for module in KINDS if admits(module)]
    # Without a decay nothing sweeps: softening has no damping of its own then.
    if kind is softening:
        assert by_k < -0.05
        assert by_c == pytest.approx(0.0, abs=1e-6)
    else:
        assert allowed == [kind]


def test_named_in_an_arm_file_it_comes_back_without_levels_too(ordinary, superset):
    instance = microslip.instances(ordinary)[0]
    values = dict.fromkeys(instance.owned, 0.1)
    parameters = tuple(
        EffectParameter(name=file_key(n, instance.place), unit="", value=v, std=0.0, low=v, high=v)
        for n, v in values.items()
    )
    evidence = EffectEvidence(
        gain_nats=50.0,
        held_out_gain_nats=10.0,
        confidence=1.0,
        session_sha256="0" * 64,
        created="2026-01-31T12:00:00+00:00",
    )
    effect = AddedEffect(
        name="microslip",
        place=instance.place,
        parameters=parameters,
        description={},
        evidence=evidence,
    )
    arm = replace(superset.arm, effects=(effect,))
    (back,), start = instances_of_file(Ordinary(superset=Superset(arm), postures=("p",)))
    assert back.key == instance.key
    assert start == values


@pytest.fixture(scope="module")
def linear():
    """A session of a plain arm, every point hit at three levels."""
    return small_case(3001, "rv4frl", ladder=True).session()


def told(session):
    """Stages of soft and of hard hits, or None, from the two broader of them."""
    superset = Superset(session.header.arm)
    stages = []
    for sigma_hz, step_hz in ((16.0, 12.0), (6.0, 8.0)):
        stage = Annealing(sigma_rad_s=2 * np.pi * sigma_hz, step_hz=step_hz, band_hz=(8.0, 120.0))
        lines = own_lines(superset, session, stage, level_about=middle_level(session))
        stages.append(Stage(superset, lines, Discrepancy()))
    names = tuple(dict.fromkeys(lines.name for lines in stages[0].lines))
    levelled = Ordinary(superset=superset, postures=names, level_span=stages[0].lines[1].level)
    present = Hypothesis(ordinary=levelled)
    stage_of = {1: stages[0], 2: stages[1], 3: stages[1]}.__getitem__
    return told_apart(superset, stage_of, present, {}, Discrepancy())


def test_a_plain_arm_s_soft_and_hard_hits_are_not_told_apart(linear):
    assert told(linear) is None


def test_friction_s_are_and_weigh_more_once_it_is_known_what_follows_the_level():
    session = small_case(3001, "rv4frl", "friction", ladder=True, of=SmallestCase).session()
    found = told(session)
    assert found is not None
    assert found.gain > 100.0  # nats: friction of a clear size; plain arms have 12 at most
    at_first = own_lines(
        Superset(session.header.arm),
        session,
        Annealing(sigma_rad_s=2 * np.pi * 6.0, step_hz=8.0, band_hz=(8.0, 120.0)),
        level_about=middle_level(session),
    )
    for before, after in zip(at_first, found.stages[-2].lines, strict=True):
        assert np.median(after.variance / before.variance) < 1.0


def test_a_joint_s_stiffness_may_be_what_it_is_at_any_level_near(ordinary):
    for kind in KINDS:
        instance = kind.instances(ordinary)[0]
        by_k = instance.parameters[0].name
        assert instance.reaches == {f"ln k {instance.place}": (by_k, 2.5 * 1.1)}


def test_what_changes_with_the_motion_covers_what_changes_with_the_posture(ordinary):
    every = all_instances(ordinary)
    for kind in KINDS:
        present = Hypothesis(ordinary=ordinary, instances=(kind.instances(ordinary)[0],))
        beside = {i.effect.name for i in every if goes_with(i, present)}
        assert not beside & {"gravity_compensator", "load_damping", "nonproportional"}
        joints = {i.place for i in every if i.effect.name == "servo" and goes_with(i, present)}
        assert present.instances[0].place not in joints
        assert beside >= {"coupling", "hysteretic", "servo"}


def test_soft_and_hard_hits_make_lines_of_their_own(linear):
    session = linear
    superset = Superset(session.header.arm)
    stage = Annealing(sigma_rad_s=2 * np.pi * 6.0, step_hz=8.0, band_hz=(8.0, 100.0))
    assert has_levels(session)
    both = own_lines(superset, session, stage, level_about=middle_level(session))
    once = own_lines(superset, session, stage)
    assert [lines.name for lines in both] == [lines.name for lines in once for _ in range(2)]
    softly, strongly = both[:2]
    assert softly.level == pytest.approx(-strongly.level)
    # From 20 to 140 N, each hit to 10 %: ln 7 between them; hits that overdrive are made softer.
    assert 1.5 < strongly.level - softly.level < 2.2
    # A linear arm: single hits are a degree off aim, some per cent of a channel's largest.
    off = np.abs(softly.values - strongly.values).max() / np.abs(once[0].values).max()
    assert 0.0 < off < 0.1


def test_levels_are_counted_from_the_peak_that_is_given(linear):
    superset = Superset(linear.header.arm)
    stage = Annealing(sigma_rad_s=2 * np.pi * 40.0, step_hz=28.0, band_hz=(8.0, 100.0))
    about = middle_level(linear)
    own, lower = (own_lines(superset, linear, stage, level_about=a) for a in (about, about + 0.3))
    for one, other in zip(own, lower, strict=True):
        assert other.level == pytest.approx(one.level - 0.3)
        assert one.peak_n == other.peak_n == pytest.approx(np.exp(about + one.level))


def test_hits_of_one_level_have_no_levels(linear):
    alike = [replace(h, verdict=replace(h.verdict, peak_n=50.0)) for h in linear.hits]
    assert not has_levels(replace(linear, hits=tuple(alike)))


def test_a_mean_that_one_hit_rules_has_that_hit_s_error(linear):
    """Ten thousand averages of three hits with relative errors, weighted as H1 weighs them."""
    rng = np.random.default_rng(7)
    peaks = np.array([15.0, 45.0, 130.0])
    hits = [
        replace(hit, verdict=replace(hit.verdict, peak_n=float(peak)))
        for hit, peak in zip(linear.hits[:3], peaks, strict=True)
    ]
    w = peaks**2 / np.sum(peaks**2)
    errors = rng.standard_normal((10_000, 3))
    mean = errors @ w
    scatter = ((errors - mean[:, None]) ** 2 @ w) / 2
    (factor,) = weight_factors(hits).values()
    # 10 000 draws: a per cent or two each.
    assert factor == pytest.approx(np.var(mean) / np.mean(scatter), rel=0.05)
