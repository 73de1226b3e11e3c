"""Springs and dampers that change with the hits' level: the look at each joint, and the lines."""

from dataclasses import replace

import numpy as np
import pytest
from support.bench_effects import JOINTS
from support.small_case import SmallestCase, small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import backlash, friction, microslip, softening
from armodal.analyzer.gap.effects.level import any_change
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.library import all_instances, described, names_of_laws
from armodal.analyzer.gap.model.hit_levels import has_levels, middle_level, weight_factors
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import Annealing, own_lines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.candidates import goes_with
from armodal.analyzer.gap.search.levels import told_apart

LAWS = (backlash, friction, microslip, softening)
SWING_RAD, RATE_RAD_S = 3e-5, 100.0  # of a joint under a hit


@pytest.fixture(scope="module")
def hard(lines):
    return replace(lines, level=1.1)


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p",), level_span=1.1)


@pytest.fixture(scope="module")
def posed(superset):
    return PosedModel(superset, JOINTS)


def test_every_elastic_joint_is_looked_at_where_soft_and_hard_hits_are_apart(ordinary):
    joints = [ordinary.arm.joints[i].name for i in ordinary.elastic]
    assert [look.place for look in any_change(ordinary)] == joints
    assert any_change(replace(ordinary, level_span=0.0)) == ()


def test_the_library_has_no_effect_of_the_level_but_laws(ordinary):
    assert not [i.title for i in all_instances(ordinary) if i.level_dependent or i.law is not None]
    laws = [law for kind in LAWS for law in law_of(kind, ordinary)]
    assert {law.effect.name for law in laws} == set(names_of_laws())
    assert all(law.level_dependent for law in laws)


def law_of(kind, ordinary):
    joint = ordinary.arm.joints[ordinary.elastic[0]].name
    return kind.laws(ordinary, joint, SWING_RAD, RATE_RAD_S)


def test_it_is_the_plain_arm_with_another_spring_and_damper_at_that_level(ordinary, hard, posed):
    look = any_change(ordinary)[1]
    joint = look.place
    plain, changed = (Hypothesis(ordinary=ordinary, instances=own) for own in ((), (look,)))
    space = changed.space()
    values = space.values(space.start())
    by_k, by_c = (p.name for p in look.parameters)
    values |= {by_k: -0.1, by_c: 0.06}
    other = values | {
        f"ln k {joint}": values[f"ln k {joint}"] - 0.1 * hard.level,
        f"ln c {joint}": values[f"ln c {joint}"] + 0.06 * hard.level,
    }
    # The same equations solved twice.
    np.testing.assert_allclose(
        posed.values(changed, hard, values), posed.values(plain, hard, other), rtol=1e-9
    )


def test_derivatives_are_those_of_differences(ordinary, hard, posed):
    look = any_change(ordinary)[2]
    hypothesis = Hypothesis(ordinary=ordinary, instances=(look,))
    space = hypothesis.space()
    u = np.clip(space.start() + 0.3, space.low, space.high)
    _, dy = posed.derivatives(hypothesis, hard, space, space.values(u))
    joint = [f"ln {what} {look.place}" for what in "kc"]
    for i in (space.index[name] for name in (*look.owned, *joint, f"loss {look.place}")):
        ends = []
        for side in (1e-5, -1e-5):
            moved = u.copy()
            moved[i] += side
            ends.append(posed.values(hypothesis, hard, space.values(moved)))
        want = (ends[0] - ends[1]) / 2e-5
        # Analytic against central differences: rounding over the step.
        np.testing.assert_allclose(dy[i], want, atol=1e-5 * np.abs(want).max())


@pytest.fixture(scope="module")
def linear():
    """A session of a plain arm, every point hit at three levels."""
    return small_case(3001, "rv4frl", ladder=True).session()


def told(session, *instances):
    """Stages of soft and of hard hits, or None, from the two broader of them."""
    superset = Superset(session.header.arm)
    stages = []
    for sigma_hz, step_hz in ((16.0, 12.0), (6.0, 8.0)):
        stage = Annealing(sigma_rad_s=2 * np.pi * sigma_hz, step_hz=step_hz, band_hz=(8.0, 120.0))
        lines = own_lines(superset, session, stage, level_about=middle_level(session))
        stages.append(Stage(superset, lines, Discrepancy()))
    names = tuple(dict.fromkeys(lines.name for lines in stages[0].lines))
    levelled = Ordinary(superset=superset, postures=names, level_span=stages[0].lines[1].level)
    present = Hypothesis(ordinary=levelled, instances=instances)
    stage_of = {1: stages[0], 2: stages[1], 3: stages[1]}.__getitem__
    return told_apart(superset, stage_of, present, {}, Discrepancy())


def test_a_plain_arm_s_soft_and_hard_hits_are_not_told_apart(linear):
    assert told(linear) is None


def test_with_a_law_of_the_arm_file_they_are_told_apart_though_they_are_alike(linear):
    joint = linear.header.arm.joints[1].name
    known = {"joint": joint, "swing_rad": SWING_RAD, "rate_rad_s": RATE_RAD_S}
    plain = Ordinary(superset=Superset(linear.header.arm), postures=())
    of_file = described(plain, "softening", known)
    found = told(linear, of_file)
    assert found is not None
    assert np.isinf(found.gain)  # no look at a change of level is taken beside a law


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


def test_what_changes_with_the_motion_covers_what_changes_with_the_posture(ordinary):
    every = all_instances(ordinary)
    for kind in LAWS:
        (law, *_) = law_of(kind, ordinary)
        present = Hypothesis(ordinary=ordinary, instances=(law,))
        beside = {i.effect.name for i in every if goes_with(i, present)}
        assert not beside & {"gravity_compensator", "load_damping", "nonproportional"}
        joints = {i.place for i in every if i.effect.name == "servo" and goes_with(i, present)}
        assert law.place not in joints
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
