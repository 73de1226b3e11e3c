"""Soft and hard hits kept apart: in further tests, solved once, looked at, asked for."""

from dataclasses import replace

import numpy as np
import pytest
from support.made_calibration import made_calibration
from support.small_case import small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.decision.verdict import verdict_of
from armodal.analyzer.gap.effects.level import any_change
from armodal.analyzer.gap.effects.point_candidates import channel_candidates
from armodal.analyzer.gap.inference.annealing import annealing_stages, with_test
from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.model.hit_levels import middle_level
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.next_test.possible_tests import Doable, possible_tests
from armodal.analyzer.gap.next_test.proposal import expected_evidence
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.search.levels import changes_with_level, fit_with
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


def test_soft_hits_with_shorter_records_are_set_beside_hard_ones_on_the_same_lines(linear):
    """A third of the ring is cut off the soft hits of a posture, and ten samples of their lead."""
    name = linear.header.plan.postures[0].name
    peaks = sorted(hit.verdict.peak_n for hit in linear.hits)

    def shortened(hit):
        counts = hit.counts[10 : -len(hit.counts) // 3]
        return replace(hit, counts=counts, first_sample=hit.first_sample + 10)

    cut = [
        shortened(hit)
        if hit.posture == name and hit.verdict.peak_n < peaks[len(peaks) // 2]
        else hit
        for hit in linear.hits
    ]
    assert sum(a is not b for a, b in zip(cut, linear.hits, strict=True)) > 5
    superset = Superset(linear.header.arm)
    session = replace(linear, hits=tuple(cut))
    stages = annealing_stages(
        superset, session, estimate_frfs(session, superset), level_about=middle_level(linear)
    )
    for stage in stages:
        soft, hard = (own for own in stage.lines if own.name == name)
        np.testing.assert_array_equal(soft.s_rad_s, hard.s_rad_s)


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


@pytest.mark.parametrize("kinds", [(), (lambda o: any_change(o)[0],)])
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


@pytest.mark.parametrize(("kinds", "solved"), [((), 1), ((lambda o: any_change(o)[0],), 2)])
def test_soft_and_hard_hits_of_a_posture_are_solved_once_where_nothing_follows_the_level(
    apart, kinds, solved
):
    hypothesis = of_session(apart, *kinds)
    for stage in apart:
        rows = [own for own, _ in stage.once(hypothesis, range(len(stage.lines)))]
        n_solved = sum(len({i for _, i in own}) for own in rows)
        assert n_solved == solved * len(stage.lines) // 2


CHANGING = 1  # which elastic joint


@pytest.fixture(scope="module")
def changing(apart):
    """The widest lines as the arm would answer were a joint softer by a fifth a unit of level."""
    stage = apart[0]
    truth = of_session(apart, lambda o: any_change(o)[CHANGING])
    space = truth.space()
    values = space.values(space.start()) | {truth.instances[0].size: -0.2}
    lines = [
        replace(own, values=model.values(truth, own, values))
        for model, own in zip(stage.models, stage.lines, strict=True)
    ]
    return Stage(truth.ordinary.superset, lines, Discrepancy(), models=stage.models)


def test_the_joint_that_changes_with_the_level_promises_most(apart, changing):
    null = of_session(apart)
    fit = fit_hypothesis(changing, null, max_iterations=4)
    found = changes_with_level(changing, fit)
    assert len(found) == len(null.ordinary.elastic)
    assert found[0].instance.key == any_change(null.ordinary)[CHANGING].key
    # A linear look leaves out the square of a fifth.
    assert found[0].size == pytest.approx(-0.2, rel=0.04)
    gains = [candidate.gain for candidate in found]
    assert gains == sorted(gains, reverse=True)
    # Of such a change a fit keeps what the look promises: it is off by a square of that fifth.
    kept = fit.evidence - fit_with(changing, fit, found[0].instance).evidence
    assert kept == pytest.approx(gains[0], rel=0.1)
    plain = changes_with_level(apart[0], fit_hypothesis(apart[0], null, max_iterations=4))
    assert plain[0].gain < 0.1 * gains[0]


@pytest.mark.parametrize(("by_k", "by_c"), [(0.02, 0.0), (0.0, 0.1)])
def test_a_change_with_the_level_is_worth_a_word_by_what_it_is_from_soft_hits_to_hard(
    apart, by_k, by_c
):
    """By k or by c: a hundredth more of it is, a hundredth less not, whatever levels were hit."""
    ordinary = of_session(apart).ordinary
    for span in (ordinary.level_span, 3.0 * ordinary.level_span):
        change = any_change(replace(ordinary, level_span=span))[0]
        names = [p.name for p in change.parameters]
        for part, matters in ((1.01, True), (0.99, False)):
            slopes = (part * by_k / (2.0 * span), part * by_c / (2.0 * span))
            assert change.is_material(dict(zip(names, slopes, strict=True))) is matters


def test_beside_an_effect_of_the_level_no_change_with_it_is_left_to_be_told(apart, changing):
    follows = of_session(apart, lambda o: any_change(o)[0])
    assert changes_with_level(changing, fit_hypothesis(changing, follows, max_iterations=0)) == []


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize(
    ("kinds", "is_followed"), [((), False), ((lambda o: any_change(o)[CHANGING],), True)]
)
def test_what_the_level_tells_and_no_effect_follows_is_outside_the_library(
    apart, changing, kinds, is_followed, named
):
    final = fit_hypothesis(changing, of_session(apart, *kinds), max_iterations=4)
    nothing = Judged(named=None, standing=(), phi=1.0, calibration=made_calibration())
    verdict, why = verdict_of(
        changing,
        final,
        Rivals(present=final, rivals=()),
        nothing,
        named=named,
        leaves=lambda _: 1e9,  # whatever is left: by the misfit nothing is outside
    )
    said = "the response depends on the hits' level, and nothing that was named does"
    assert (said in why) == (not is_followed)
    assert (verdict is Verdict.OUTSIDE_LIBRARY) == (not is_followed)


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
        apart[0], of_session(apart, lambda o: any_change(o)[0]), max_iterations=2
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
