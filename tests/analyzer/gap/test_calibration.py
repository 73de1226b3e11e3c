"""Limits of evidence read from replicas."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.made_calibration import made_calibration
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.decision import calibration
from armodal.analyzer.gap.decision.calibration import (
    Calibrations,
    Tail,
    calibrate,
    is_told_by_level,
)
from armodal.analyzer.gap.library import names_of_laws
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.priors import FARTHEST
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.search.replicas import Gains

KINDS = {"much": 40.0, "some": 12.0, "little": 8.0}  # nats, scale of what chance brings
OF_100 = SimpleNamespace(weighings=[SimpleNamespace(n=100)], lines=())  # a stage, by its residuals
NOTHING = made_fit(Hypothesis(ordinary=None), cost=100.0)


def drawn(rng, n):
    """What each kind gains: half a square of a Gaussian, two places of the last, alike in part."""
    z = rng.standard_normal((4, n))
    z[3] = 0.8 * z[2] + 0.6 * z[3]
    scales = np.array([*KINDS.values(), KINDS["little"]])
    return 0.5 * scales[:, None] * z**2


def instances():
    return tuple(
        Instance(effect=SimpleNamespace(name=name), place=place)
        for name, place in (*((k, "a") for k in KINDS), ("little", "b"))
    )


def calibrated(monkeypatch, false_name, dispersion=1.0, library=None, looks=()):
    """Limits from made gains; `looks` are in place of the first instances."""
    gains = Gains(
        instances=(*looks, *instances()[len(looks) :]),
        replicas=drawn(np.random.default_rng(0), 4000),
        dispersion=dispersion,
        error_ratio=0.5,
    )
    monkeypatch.setattr(calibration, "replica_gains", lambda *_: gains)
    monkeypatch.setattr(calibration, "others_beside", lambda _: ())
    monkeypatch.setattr(calibration, "all_instances", lambda _: library or instances())
    monkeypatch.setattr(calibration, "any_change", lambda _: looks)
    present = made_fit(Hypothesis(ordinary=None), cost=100.0)
    return calibrate(None, present, present, false_name)


@pytest.mark.parametrize("false_name", [0.01, 0.05])
def test_as_many_replicas_as_accepted_have_any_effect_beyond_its_limit(false_name, monkeypatch):
    found = calibrated(monkeypatch, false_name)
    fresh = drawn(np.random.default_rng(1), 40_000)
    limits = np.array([found.limit(i.effect.name) for i in instances()])
    rate = np.mean((fresh > limits[:, None]).any(axis=0))
    # The limit is of 4000 replicas, a rate of which has a deviation of sqrt(p / 4000): four.
    assert rate == pytest.approx(false_name, abs=4.0 * np.sqrt(false_name / 4000))
    assert limits[0] > limits[1] > limits[2]


def test_what_is_at_its_limit_is_as_likely_by_chance_as_accepted(monkeypatch):
    found = calibrated(monkeypatch, 0.01)
    for name in KINDS:
        assert found.p_value(name, found.limit(name)) == pytest.approx(0.01)
        assert found.p_value(name, 0.0) == 1.0
        # Replicas tell no less than one more than all of them would change.
        assert found.p_value(name, 10.0 * found.limit(name)) == 1.0 / (found.n_replicas + 1)


def test_what_no_linear_look_tells_has_the_limit_of_the_whole_library(monkeypatch):
    found = calibrated(monkeypatch, 0.01)
    fresh = drawn(np.random.default_rng(2), 40_000).max(axis=0)
    rate = np.mean(fresh > found.limit("swapped_axes"))
    assert rate == pytest.approx(0.01, abs=4.0 * np.sqrt(0.01 / 4000))


def test_a_law_has_the_limit_of_a_joint_s_change_with_the_level(monkeypatch):
    """No replica is followed in time: the look at its joint stands for it."""
    look = Instance(effect=SimpleNamespace(name="level"), place="a", level_dependent=True)
    found = calibrated(monkeypatch, 0.01, looks=(look,))
    assert "level" not in found.tails  # no effect, and none of a result
    assert len(names_of_laws()) > 1
    for name in names_of_laws():
        # It is in place of what gains most.
        assert found.limit(name) > found.limit("some") > found.limit("little")
        assert found.p_value(name, 0.9 * found.limit(name)) > 0.01
    # Where hits are not told apart no law is followed, and none has a limit of its own.
    none = calibrated(monkeypatch, 0.01)
    assert {none.limit(name) for name in names_of_laws()} == {none.limit_otherwise}


def test_a_model_that_follows_the_level_is_calibrated_without_a_look_at_it(monkeypatch):
    calibrated(monkeypatch, 0.01)
    given = []
    drawn_of = calibration.replica_gains
    monkeypatch.setattr(
        calibration, "replica_gains", lambda *args: given.append(args[3]) or drawn_of(*args)
    )
    look = Instance(effect=SimpleNamespace(name="level"), place="a", level_dependent=True)
    monkeypatch.setattr(calibration, "any_change", lambda _: (look,))
    law = Instance(effect=SimpleNamespace(name="softening"), place="a", level_dependent=True)
    follows = made_fit(Hypothesis(ordinary=None, instances=(law,)), cost=100.0)
    calibrate(None, follows, follows)
    assert given == [[]]


def test_what_was_found_anywhere_is_not_judged_by_its_own_place_alone(monkeypatch):
    """Replicas have a point or a line only where the search found it: the best of many."""
    sought = tuple(i for i in instances() if i.effect.name != "little")
    found = calibrated(monkeypatch, 0.01, library=sought)
    assert found.limit("little") == found.limit("swapped_axes") > found.limit("some")
    assert found.p_value("little", found.limit("some")) > 0.01


def test_errors_that_disagree_widen_what_tells_rivals_apart(monkeypatch):
    narrow, wide = (calibrated(monkeypatch, 0.01, dispersion=d) for d in (0.3, 3.0))
    assert narrow.apart == pytest.approx(np.log(100.0))  # never less than independent errors
    assert wide.apart == pytest.approx(3.0 * narrow.apart)
    assert wide.odds(wide.apart) == pytest.approx(0.01)


@pytest.mark.parametrize("n", [1, 6])
def test_any_of_several_is_beyond_its_limit_by_chance_as_seldom_as_accepted(n, monkeypatch):
    found = calibrated(monkeypatch, 0.01, dispersion=3.0)
    # What has odds of e^-g is reached by chance with such a probability.
    gains = np.random.default_rng(3).exponential(3.0, (n, 100_000))
    rate = np.mean((gains > found.apart_from(n)).any(axis=0))
    # Of n that are independent; four deviations of the rate.
    assert rate == pytest.approx(1.0 - (1.0 - 0.01 / n) ** n, abs=4.0 * np.sqrt(0.01 / 100_000))


@pytest.mark.parametrize("n", [1, 6])
def test_the_level_tells_where_a_joint_promises_more_than_chance_brings_any(n, monkeypatch):
    limits = made_calibration(apart=20.0)
    least = 20.0 * (1.0 + np.log(n) / np.log(100.0))
    less, more = 0.99 * least, 1.01 * least
    for most, kept, is_told in ((less, more, False), (more, less, False), (more, more, True)):
        promise(monkeypatch, [most, *[0.0] * (n - 1)], [with_effect(100.0 - kept)])
        assert is_told_by_level(OF_100, NOTHING, limits) == is_told
    # Hits together, or an effect that follows the level: there is nothing to look at.
    promise(monkeypatch, [], [])
    assert not is_told_by_level(OF_100, NOTHING, limits)


@pytest.mark.parametrize(
    ("sizes", "is_told"),
    [((1.0,), True), ((0.01,), False), ((0.01, 1.0), True), ((0.01, 0.01), False)],
)
def test_what_changes_too_little_with_the_level_is_not_told_by_it(sizes, is_told, monkeypatch):
    promise(monkeypatch, [50.0] * len(sizes), [with_effect(60.0, size=s) for s in sizes])
    assert is_told_by_level(OF_100, NOTHING, made_calibration(apart=20.0)) == is_told


def promise(monkeypatch, gains, fitted):
    """What joints' changes with the level promise in nats, and the fits they come to in turn."""
    promised = [SimpleNamespace(gain=gain, instance=None) for gain in gains]
    fits = iter(fitted)
    monkeypatch.setattr(calibration, "changes_with_level", lambda *_: promised)
    monkeypatch.setattr(calibration, "fit_with", lambda *_: next(fits))


def test_a_tail_goes_on_as_an_exponential():
    rng = np.random.default_rng(5)
    tail = Tail.of(rng.exponential(7.0, 100_000))
    # Beyond the 5 % of 100 000 the mean of 5000 excesses: 1.4 %; four deviations.
    assert tail.scale == pytest.approx(7.0, rel=0.06)
    assert tail.limit(1e-4) == pytest.approx(7.0 * np.log(1e4), rel=0.06)
    assert tail.p_value(tail.limit(1e-4)) == pytest.approx(1e-4)


def test_limits_are_told_with_what_they_rest_on():
    told = made_calibration(40.0, limits={"bearing": 30.0}).record()
    assert told.limits == {"bearing": 30.0}
    assert told.limit_otherwise == 40.0
    assert told.replicas == 1000
    assert "upper 5%" in told.tail


def with_effect(cost, *, size=1.0):
    """A fit with an effect that matters beyond 0.1."""
    sized = Parameter(name="size", unit="", mean=0.0, std=1.0)
    own = Instance(
        effect=SimpleNamespace(name="much", some_is_ordinary=False),
        place="",
        parameters=(sized,),
        size="size",
        material=0.1,
    )
    hypothesis = Hypothesis(ordinary=None, instances=(own,))
    return made_fit(hypothesis, cost=cost, space=Space([sized]), u=[size], resting=["size"])


@pytest.mark.parametrize(
    ("gain", "size", "leaves", "by_level", "wanted"),
    [
        (41.0, 1.0, 9.0, 0.0, True),
        (39.0, 1.0, 9.0, 0.0, False),
        (41.0, 0.01, 9.0, 0.0, False),  # too small to matter
        (0.0, 1.0, 1.0, 0.0, True),  # more is left than half of the replicas leave
        (0.0, 1.0, 9.0, 19.0, False),
        (0.0, 1.0, 9.0, 21.0, True),  # the hits' level tells what nothing follows
    ],
)
def test_a_search_goes_on_for_what_matters_and_has_its_limit_in_reach(
    gain, size, leaves, by_level, wanted, monkeypatch
):
    limits = made_calibration(apart=20.0, limits={"much": 40.0})
    promise(monkeypatch, [by_level], [with_effect(100.0 - by_level)])
    monkeypatch.setattr(calibration, "calibrate", lambda *_: limits)
    monkeypatch.setattr(calibration, "misfit_per_line", lambda *_: 2.0)
    monkeypatch.setattr(calibration, "misfit_of_replicas", lambda *_: leaves)
    begun = [with_effect(100.0 - gain, size=size)]
    assert Calibrations(0.01).needs_more(OF_100, NOTHING, begun) == wanted


@pytest.mark.parametrize(("deviations", "wanted"), [(4.9, False), (FARTHEST, True)])
def test_ordinary_errors_as_far_as_any_is_tried_stand_for_something_else(
    deviations, wanted, monkeypatch
):
    monkeypatch.setattr(calibration, "changes_with_level", lambda *_: [])
    monkeypatch.setattr(calibration, "calibrate", lambda *_: made_calibration(apart=20.0))
    monkeypatch.setattr(calibration, "misfit_per_line", lambda *_: 1.0)
    monkeypatch.setattr(calibration, "misfit_of_replicas", lambda *_: 9.0)
    mass = Parameter(name="ln mass", unit="", mean=0.0, std=0.05)
    present = made_fit(Hypothesis(ordinary=None), cost=100.0, space=Space([mass]), u=[deviations])
    assert Calibrations(0.01).needs_more(None, present, []) == wanted


def test_a_model_is_calibrated_anew_only_where_another_is_best(monkeypatch):
    made = []
    ratios = iter((0.8, 1.2, 0.6))

    def calibrate_(*given):
        made.append(given)
        return made_calibration(error_ratio=next(ratios))

    monkeypatch.setattr(calibration, "calibrate", calibrate_)
    present, one, two = with_effect(100.0), with_effect(90.0), with_effect(80.0)
    calibrations = Calibrations(0.05)
    told = [
        calibrations.of(None, present, rivals).error_ratio
        for rivals in ((), (), (one,), (one,), (one, two))
    ]
    assert made == [(None, present, best, 0.05) for best in (present, one, two)]
    # A model is wrong where it errs with its best rival and without.
    assert told == [0.8, 0.8, 0.8, 0.8, 0.6]
