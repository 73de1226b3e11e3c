"""Soft and hard hits kept apart: in further tests, solved once, looked at, asked for."""

from dataclasses import replace

import numpy as np
import pytest
from support.made_calibration import made_calibration
from support.small_case import small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.decision.judge import Judged, Thresholds, follows_no_level
from armodal.analyzer.gap.decision.verdict import verdict_of
from armodal.analyzer.gap.effects import friction
from armodal.analyzer.gap.effects.point_candidates import channel_candidates
from armodal.analyzer.gap.inference.annealing import annealing_stages, with_test
from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.hit_levels import middle_level
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.next_test.possible_tests import Doable, possible_tests
from armodal.analyzer.gap.next_test.proposal import expected_evidence
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.search.rivals import Rivals
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError


@pytest.fixture(scope="module")
def linear():
    """A session of a plain arm, every point hit at three levels."""
    return small_case(3001, "rv4frl", ladder=True).session()


@pytest.fixture(scope="module")
def apart(linear):
    """Stages of soft and hard hits, with the same session as a further test."""
    superset = Superset(linear.header.arm)
    frfs = estimate_frfs(linear, superset)
    about = middle_level(linear)
    stages = annealing_stages(superset, linear, frfs, level_about=about)
    return with_test(stages, superset, linear, 2, level_about=about)


def test_a_further_test_of_an_arm_with_other_points_is_refused(linear):
    superset = Superset(linear.header.arm)
    stages = annealing_stages(superset, linear, estimate_frfs(linear, superset))
    arm = linear.header.arm
    more = replace(arm, points=(*arm.points, replace(arm.points[0], id="new")))
    other = replace(linear, header=replace(linear.header, arm=more))
    with pytest.raises(ArmError, match=r"wanted the points .* new; give"):
        with_test(stages, superset, other, 2)
    moved = replace(arm.points[0], position_m=arm.points[0].position_m + 0.01)
    beside = replace(arm, points=(moved, *arm.points[1:]))
    other = replace(linear, header=replace(linear.header, arm=beside))
    with pytest.raises(ArmError, match="is not where the session measured it"):
        with_test(stages, superset, other, 2)


def of_session(apart, *instances):
    lines = apart[0].lines
    names = tuple(dict.fromkeys(own.name for own in lines))
    superset = Superset(load_arm("rv4frl"))
    ordinary = Ordinary(superset=superset, postures=names, level_span=lines[1].level)
    return Hypothesis(ordinary=ordinary, instances=tuple(make(ordinary) for make in instances))


def test_a_further_test_s_soft_and_hard_hits_stay_apart(apart):
    for stage in apart:
        names = [lines.name for lines in stage.lines]
        first = names[: len(names) // 2]
        assert names == [*first, *(f"{name} (test 2)" for name in first)]
        levels = [lines.level for lines in stage.lines]
        assert levels[: len(first)] == levels[len(first) :]
        assert all(a < 0.0 < b for a, b in zip(levels[::2], levels[1::2], strict=True))


@pytest.mark.parametrize("kinds", [(), (lambda o: friction.instances(o)[0],)])
def test_soft_and_hard_hits_solved_once_weigh_as_if_solved_each(apart, kinds):
    hypothesis = of_session(apart, *kinds)
    stage, space = apart[0], hypothesis.space()
    values = space.values(space.start() + 0.02)
    alone = [
        Stage(hypothesis.ordinary.superset, [lines], Discrepancy(), models=[model]).quadratics(
            hypothesis, space, values, [0]
        )[0]
        for lines, model in zip(stage.lines, stage.models, strict=True)
    ]
    together = stage.quadratics(hypothesis, space, values, range(len(stage.lines)))
    for one, other in zip(alone, together, strict=True):
        assert other.cost == pytest.approx(one.cost, rel=1e-9)
        np.testing.assert_allclose(
            other.curvature, one.curvature, rtol=1e-7, atol=1e-7 * np.abs(one.curvature).max()
        )
    whole, costs = stage.whole_quadratic(hypothesis, space, values, range(len(stage.lines)))
    np.testing.assert_allclose(costs, [one.cost for one in alone], rtol=1e-9)
    # Single precision: of derivatives times the root of both weights, not times each.
    for name in ("gradient", "curvature"):
        want = np.sum([getattr(one, name) for one in alone], axis=0)
        size = np.max([np.abs(getattr(one, name)).max() for one in alone])
        np.testing.assert_allclose(getattr(whole, name), want, rtol=0, atol=1e-6 * size)


@pytest.mark.parametrize(("kinds", "solved"), [((), 1), ((lambda o: friction.instances(o)[0],), 2)])
def test_soft_and_hard_hits_of_a_posture_are_solved_once_where_nothing_follows_the_level(
    apart, kinds, solved
):
    hypothesis = of_session(apart, *kinds)
    for stage in apart:
        rows = [own for own, _ in stage.once(hypothesis, range(len(stage.lines)))]
        n_solved = sum(len({i for _, i in own}) for own in rows)
        assert n_solved == solved * len(stage.lines) // 2


def test_names_that_follow_no_level_leave_out_what_soft_and_hard_hits_showed(apart):
    def surely(hypothesis, gain=70.0):
        return replace(hypothesis, ordinary=replace(hypothesis.ordinary, level_gain=gain))

    assert follows_no_level(surely(of_session(apart)))
    assert not follows_no_level(surely(of_session(apart), 13.0))  # chance opens them with as much
    assert not follows_no_level(surely(of_session(apart, lambda o: friction.instances(o)[0])))


@pytest.mark.parametrize(
    ("kinds", "misfit", "named", "verdict"),
    [
        ((), 0.70, True, Verdict.NAMED),
        ((), 0.78, True, Verdict.OUTSIDE_LIBRARY),
        # By chance a null's hits are apart.
        ((), 0.70, False, Verdict.NOTHING_DETECTABLE),
        pytest.param(
            (lambda o: friction.instances(o)[0],),
            0.70,
            True,
            Verdict.NAMED,
            marks=pytest.mark.long,
        ),
    ],
)
def test_a_name_that_leaves_much_where_the_level_tells_must_follow_it(
    apart, kinds, misfit, named, verdict
):
    stage = apart[0]
    fit = fit_hypothesis(stage, of_session(apart, *kinds), max_iterations=2)
    final = replace(fit, cost=misfit * sum(w.n for w in stage.weighings) / 2.0)
    nothing = Judged(named=None, standing=(), phi=1.0, calibration=made_calibration())
    found, why = verdict_of(
        stage,
        final,
        Rivals(present=final, rivals=()),
        nothing,
        named=named,
        leaves=lambda _: 0.75,
        limits=Thresholds(),
    )
    assert found is verdict
    assert bool(why) == (verdict is Verdict.OUTSIDE_LIBRARY)


@pytest.mark.parametrize(
    ("nats", "named", "verdict"),
    [
        (300.0, True, Verdict.OUTSIDE_LIBRARY),
        (200.0, True, Verdict.NAMED),
        (300.0, False, Verdict.NOTHING_DETECTABLE),
    ],
)
def test_much_that_is_told_beside_a_name_and_has_none_is_outside(apart, nats, named, verdict):
    stage = apart[0]
    fit = fit_hypothesis(stage, of_session(apart), max_iterations=2)
    final = replace(fit, cost=0.3 * sum(w.n for w in stage.weighings) / 2.0)
    told = all_instances(final.hypothesis.ordinary)[0]
    beside = replace(final.hypothesis, instances=(told,))
    found = Rivals(
        present=final, rivals=(replace(final, hypothesis=beside, cost=final.cost - nats),)
    )
    nothing = Judged(named=None, standing=(), phi=1.0, calibration=made_calibration())
    assert (
        verdict_of(
            stage, final, found, nothing, named=named, leaves=lambda _: 0.75, limits=Thresholds()
        )[0]
        is verdict
    )


def test_the_look_at_places_knows_postures_hit_at_two_levels(apart):
    hypothesis = of_session(apart)
    space = hypothesis.space()
    found = channel_candidates(apart[0], hypothesis, space.values(space.start()))
    places = [c.instance.place for c in found if c.instance.effect.name == "wrong_point"]
    known = hypothesis.ordinary.postures
    assert places
    assert all(p.split(" in posture ")[1] in known for p in places if " in posture " in p)


def test_the_next_test_may_hit_softer_and_harder_where_both_are_apart(apart):
    null = fit_hypothesis(apart[0], of_session(apart), max_iterations=2)
    tests = possible_tests(apart[0], null, rng=np.random.default_rng(1))
    soft, hard = (lines.peak_n for lines in apart[0].lines[:2])
    wider = [test for test in tests if test.peaks_n]
    assert wider
    for test in wider:
        assert test.peaks_n[0] < soft < test.peaks_n[1] < hard < test.peaks_n[2]
        assert "hits of about" in test.words
    beside = list(Doable.of(apart[0], null).beside(wider[0], np.random.default_rng(1)))
    (softest,) = {test.peaks_n for test in beside} - {wider[0].peaks_n}
    assert softest[0] < wider[0].peaks_n[0]
    assert softest[2] == wider[0].peaks_n[2]  # harder may overdrive the sensor
    # Softer and harder tell a joint that follows the level from one that does not: more than the
    # session's own levels would in the same posture.
    rival = fit_hypothesis(
        apart[0], of_session(apart, lambda o: friction.instances(o)[0]), max_iterations=2
    )
    size = rival.hypothesis.instances[0].size
    falls = replace(rival, u=_at(rival, size, 0.3))
    plain = replace(wider[0], peaks_n=())
    by_wider, by_plain = expected_evidence(apart[0], [null, falls], [wider[0], plain])
    assert by_wider > by_plain


def _at(fit, name, value):
    u = fit.u.copy()
    i = fit.space.index[name]
    u[i] = value / fit.space.std[i]
    return u
