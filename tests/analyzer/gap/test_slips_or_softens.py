"""A joint that softens and one that slips: told by the hits between soft and hard."""

from dataclasses import replace

import numpy as np
import pytest
from support.made_calibration import made_calibration
from support.made_gap_fits import made_fit
from support.small_case import small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.effects import coupling, friction, microslip, slips_or_softens, softening
from armodal.analyzer.gap.effects.level import any_bow
from armodal.analyzer.gap.effects.slips_or_softens import Bow, told_by_bow, told_by_hits_between
from armodal.analyzer.gap.inference.annealing import at_three_levels, stages_of, with_test
from armodal.analyzer.gap.model.hit_levels import at_levels, has_hits_between, middle_level
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.workflow import find_gap
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.hil_sim.study import make_case
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import plan_from_text


def hits(session, peaks_of):
    """The session's hits, each with a peak by its place among those of its point."""
    seen, found = {}, []
    for hit in session.hits:
        key = hit.posture, hit.sensor_point
        n = seen[key] = seen.get(key, -1) + 1
        found += [replace(hit, verdict=replace(hit.verdict, peak_n=p)) for p in peaks_of(n)]
    return found


@pytest.fixture(scope="module")
def linear():
    """A plain arm, every point hit at three levels."""
    return small_case(3001, "rv4frl", ladder=True).session()


@pytest.mark.parametrize(
    ("peaks_n", "n_levels"),
    [
        ((20.0, 55.0, 140.0), 3),
        ((20.0, 140.0, 55.0), 3),
        ((20.0, 25.0, 140.0), 2),  # clearly between is a quarter of the way of ln, 33 N
        ((20.0, 120.0, 140.0), 2),
    ],
)
def test_hits_between_are_a_level_where_they_are_clearly_between(linear, peaks_n, n_levels):
    own = hits(linear, lambda n: [peaks_n[n]])
    levels = at_levels(own)
    assert len(levels) == n_levels
    assert {hit.verdict.peak_n for hit in levels[0]} == {20.0}
    assert {hit.verdict.peak_n for hit in levels[-1]} == {140.0}
    assert has_hits_between(replace(linear, hits=tuple(own))) is (n_levels == 3)


def test_one_point_without_a_hit_between_leaves_two_levels(linear):
    own = hits(linear, lambda n: [(20.0, 55.0, 140.0)[n]])
    middle = next(hit for hit in own if hit.verdict.peak_n == 55.0)
    assert len(at_levels([hit for hit in own if hit is not middle])) == 2


def test_no_level_at_all_where_a_point_was_hit_once(linear):
    assert at_levels(hits(linear, lambda n: [20.0] if n == 0 else [])) == ([], [])


def test_lines_of_three_levels_are_those_of_two_and_one_between(linear):
    superset = Superset(linear.header.arm)
    about = middle_level(linear)
    *_, sharp = stages_of(superset, linear, estimate_frfs(linear, superset), level_about=about)
    three = at_three_levels(superset, (linear,), sharp)
    assert len(three.lines) == 3 * len(sharp.lines) // 2
    for i in range(len(sharp.lines) // 2):
        soft, between, hard = three.lines[3 * i : 3 * i + 3]
        old_soft, old_hard = sharp.lines[2 * i : 2 * i + 2]
        np.testing.assert_allclose(soft.values, old_soft.values, rtol=1e-12)
        np.testing.assert_allclose(hard.values, old_hard.values, rtol=1e-12)
        assert (soft.level, hard.level) == (old_soft.level, old_hard.level)
        assert soft.level < between.level < hard.level
        assert three.models[3 * i] is three.models[3 * i + 2] is sharp.models[2 * i]


def test_of_several_sessions_the_first_with_hits_between_counts_by_its_own_middle(linear):
    superset = Superset(linear.header.arm)
    two = replace(linear, hits=tuple(hits(linear, lambda n: [(20.0, 140.0)[n]] if n < 2 else [])))
    about = middle_level(two)
    stages = stages_of(superset, two, estimate_frfs(two, superset), level_about=about)
    *_, sharp = with_test(stages, superset, linear, 2, level_about=about)
    assert at_three_levels(superset, (two, two), sharp) is None
    three = at_three_levels(superset, (two, linear), sharp)
    assert {lines.name for lines in three.lines} == {
        f"{posture.name} (test 2)" for posture in linear.header.plan.postures
    }
    levels = sorted({lines.level for lines in three.lines})
    assert levels[0] == pytest.approx(-levels[-1])
    models = dict(zip((lines.name for lines in sharp.lines), sharp.models, strict=True))
    assert all(m is models[own.name] for own, m in zip(three.lines, three.models, strict=True))


@pytest.mark.parametrize("level", [-1.1, 0.1, 1.1])
def test_a_joint_that_bows_is_the_plain_arm_with_another_spring_at_that_level(linear, level):
    superset = Superset(linear.header.arm)
    ordinary = Ordinary(superset=superset, postures=("p",), level_span=1.1)
    joint = superset.arm.joints[1].name
    instance, names = any_bow(joint, 1.1)
    about = middle_level(linear)
    stages = stages_of(superset, linear, estimate_frfs(linear, superset), level_about=about)
    lines = replace(stages[0].lines[0], name="p", level=level)
    posed = PosedModel(superset, lines.joints_rad)
    bowed = Hypothesis(ordinary=ordinary, instances=(instance,))
    space = bowed.space()
    values = space.values(space.start())
    by_k, by_c, bow_c = names
    h = 1e-5
    (bow_k,) = (p.name for p in instance.parameters if p.name not in names)
    values |= {by_k: 0.1, by_c: 0.2, bow_k: 0.03, bow_c: 0.05}
    bow = 1.0 - (level / 1.1) ** 2
    other = values | {
        f"ln k {joint}": values[f"ln k {joint}"] - 0.1 * level + 0.03 * bow,
        f"ln c {joint}": values[f"ln c {joint}"] + 0.2 * level + 0.05 * bow,
    }
    plain = posed.values(Hypothesis(ordinary=ordinary), lines, other)
    np.testing.assert_allclose(posed.values(bowed, lines, values), plain, rtol=1e-9)
    _, dy = posed.derivatives(bowed, lines, space, values)
    for name in instance.owned:
        up, down = (posed.values(bowed, lines, values | {name: values[name] + d}) for d in (h, -h))
        want = (up - down) / (2.0 * h) * space.std[space.index[name]]
        # Analytic against central differences: rounding over the step.
        np.testing.assert_allclose(dy[space.index[name]], want, atol=1e-5 * np.abs(plain).max())


def swung(torque, amplitude):
    """Stiffness and damping (times frequency) of a torque over a harmonic swing, once around."""
    turn = np.linspace(0.0, 4.0 * np.pi, 8001)
    t, way = torque(amplitude * np.cos(turn))[4000:-1], turn[4000:-1]
    return (
        2.0 * np.mean(t * np.cos(way)) / amplitude,
        -2.0 * np.mean(t * np.sin(way)) / amplitude,
    )


def seat(stiffness, limit):
    """Six sliders that begin to slip one after the other (Iwan 1966)."""
    k, limits = stiffness / 6.0, limit * np.arange(1, 12, 2) / 36.0

    def torque(stretch):
        at, total = np.zeros(6), np.zeros_like(stretch)
        for i, s in enumerate(stretch):
            at = np.clip(at, s - limits / k, s + limits / k)
            total[i] = np.sum(k * (s - at))
        return total

    return torque


def bow_by_swings(torque):
    """What three swings, each three times the one before, tell of a unit joint with 6 % loss."""
    (k_1, c_1), (_, c_2), (k_3, c_3) = (
        np.log([1.0 + k, 0.06 + c]) for k, c in (swung(torque, a) for a in (1 / 3, 1.0, 3.0))
    )
    fall = (k_1 - k_3) / 2.0
    return Bow(
        slope=(c_3 - c_1) / 2.0 / fall,
        bow=(c_2 - (c_1 + c_3) / 2.0) / fall,
        covariance=np.diag([0.1, 0.1]) ** 2,
    )


# Limits for which half to all of the seat slips under the middle swing: damping is highest there,
# and soft and hard hits find about the same.
@pytest.mark.parametrize("limit", [0.12, 0.17, 0.24])
def test_a_seat_that_slips_is_told_where_its_loss_is_highest_between(limit):
    bow = bow_by_swings(seat(0.4, limit))
    assert bow.slope < 2.0
    assert told_by_bow(bow) == "microslip"


@pytest.mark.parametrize("at", [0.2, 0.5, 1.5])
def test_a_spring_that_softens_has_no_loss_of_its_own(at):
    bow = bow_by_swings(lambda s: 0.4 * (at * np.tanh(s / at) - s))
    assert (bow.slope, bow.bow) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert told_by_bow(bow) == "softening"


def test_what_is_uncertain_or_like_both_is_not_told():
    sure, unsure = np.diag([0.1, 0.1]) ** 2, np.diag([0.5, 1.0]) ** 2
    assert told_by_bow(Bow(slope=0.35, bow=1.0, covariance=sure)) is None
    assert told_by_bow(Bow(slope=0.35, bow=1.0, covariance=unsure)) is None
    assert told_by_bow(Bow(slope=0.35, bow=1.8, covariance=unsure)) is None
    assert told_by_bow(Bow(slope=0.35, bow=1.8, covariance=sure)) == "microslip"


def test_what_slides_whole_or_little_by_little_is_no_spring_that_softens():
    sure = np.diag([0.1, 0.1]) ** 2
    for slope, bow in ((-0.9, 0.5), (-4.0, 0.0), (0.0, 1.7), (3.0, 1.0)):
        assert told_by_bow(Bow(slope=slope, bow=bow, covariance=sure)) == "microslip"


SOFTENS = Bow(slope=0.35, bow=0.2, covariance=np.diag([0.1, 0.1]) ** 2)
SLIPS = replace(SOFTENS, bow=1.8)
EITHER = replace(SOFTENS, bow=1.0)


@pytest.fixture(scope="module")
def standing():
    """Fits by effect and joint, the evidence of each a nat below the one before."""
    superset = Superset(load_arm("rv4frl"))
    ordinary = Ordinary(superset=superset, postures=("p",), level_span=1.0)

    def fits(*names):
        found = []
        for cost, (name, place) in enumerate(names):
            kind = {k.WORDS.name: k for k in (coupling, friction, microslip, softening)}[name]
            every = kind.instances(ordinary)
            own = every[place]
            hypothesis = Hypothesis(ordinary=ordinary, instances=(own,))
            found.append(made_fit(hypothesis, cost=float(cost)))
        return tuple(found)

    return fits


def judged_by(bow, monkeypatch, standing):
    monkeypatch.setattr(slips_or_softens, "bow_of", lambda *_: bow)
    before = Judged(
        named=None if len(standing) > 1 else standing[0],
        standing=standing,
        phi=1.0,
        calibration=made_calibration(),
    )
    after, notes = told_by_hits_between(before, "sharp", lambda sharp: [sharp], 20.0)
    names = [fit.hypothesis.instances[-1].effect.name for fit in after.standing]
    assert after.named is (after.standing[0] if len(names) == 1 else None)
    return names, notes


BOTH = (("softening", 1), ("microslip", 1))


@pytest.mark.parametrize(
    ("names", "bow", "left"),
    [
        (BOTH, SOFTENS, ["softening"]),
        (BOTH, SLIPS, ["microslip"]),
        (BOTH, EITHER, ["softening", "microslip"]),
        (BOTH[::-1], SOFTENS, ["softening"]),
        # Friction slides too; a crack may look like all three, and is not named by the bow.
        ((*BOTH, ("friction", 1)), SOFTENS, ["softening"]),
        ((*BOTH, ("friction", 1)), SLIPS, ["softening", "microslip", "friction"]),
        ((("friction", 1), *BOTH), SOFTENS, ["softening"]),
        ((("friction", 1), *BOTH), EITHER, ["friction", "softening", "microslip"]),
        # Another joint's, and what is no change with the level, still stand beside.
        ((*BOTH, ("friction", 2)), SOFTENS, ["softening", "friction"]),
        ((*BOTH, ("coupling", 0)), SLIPS, ["microslip", "coupling"]),
    ],
)
def test_what_the_bow_speaks_against_stands_no_longer(names, bow, left, standing, monkeypatch):
    found, notes = judged_by(bow, monkeypatch, standing(*names))
    assert found == left
    assert all(note.startswith("hits between soft and hard") for note in notes)


@pytest.mark.parametrize("names", [(("friction", 1),), (("coupling", 0), *BOTH), ()])
def test_nobody_asks_where_neither_is_best(names, standing, monkeypatch):
    monkeypatch.setattr(slips_or_softens, "bow_of", lambda *_: pytest.fail("asked"))
    before = Judged(named=None, standing=standing(*names), phi=1.0, calibration=made_calibration())
    assert told_by_hits_between(before, "sharp", pytest.fail, 20.0) == (before, [])


@pytest.fixture(
    scope="module", params=[(13, "bench57", "microslip", 0.25), (11, "ur5", "softening", 1.0)]
)
def case(request):
    seed, arm, kind, size = request.param
    sealed = make_case(seed, arm, kind, size, ladder=True)
    return sealed, sealed.session(), kind


@pytest.mark.long
def test_with_hits_between_it_is_named(case):
    _, session, kind = case
    result = find_gap(session, gates=False, modes=False, advice=False).result
    assert result.verdict is Verdict.NAMED
    assert [effect.name for effect in result.effects] == [kind]


@pytest.mark.long
def test_without_hits_between_it_is_named_or_the_test_that_is_asked_for_tells(case):
    """Soft and hard hits alone may do; where they do not, none of the two is guessed."""
    sealed, session, kind = case
    soft, _, hard = at_levels(session.hits)
    without = replace(session, hits=(*soft, *hard))
    result = find_gap(without, gates=False, modes=False).result
    if result.verdict is Verdict.NAMED:
        assert [effect.name for effect in result.effects] == [kind]
        return
    assert result.verdict is Verdict.AMBIGUOUS
    assert {r.name for r in result.rivals if r.standing} >= {"microslip", "softening"}
    assert any("would tell whether" in note for note in result.notes)
    plan = plan_from_text(result.next_test.plan_toml, sealed.arm, origin="next test")
    assert len(plan.postures) == len(session.header.plan.postures)
    assert all(len(posture.peaks_n) == 3 for posture in plan.postures)
    asked = sealed.session(plan, levels_n=plan.postures[0].peaks_n, run=1)
    told = find_gap(without, more=[asked], gates=False, modes=False, advice=False).result
    # A faint slip's bow may be either's; what the levels alone tell needs no bow.
    undecided = kind == "microslip" and told.verdict is Verdict.AMBIGUOUS
    assert undecided or [effect.name for effect in told.effects] == [kind]
    assert told.verdict is Verdict.NAMED or any("bows by" in note for note in told.notes)
