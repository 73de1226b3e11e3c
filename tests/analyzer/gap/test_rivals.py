"""What a search for rivals does with a fit that it is given."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.effects import bearing, hit_direction
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.search import first_steps, race, rivals
from armodal.analyzer.gap.search.rivals import find_rivals
from armodal.analyzer.gap.search.scan import Candidate

STAGES = ("widest", "broad", "middle", "sharp")
NAMED = Hypothesis(
    ordinary=SimpleNamespace(), instances=(Instance(effect=hit_direction.WORDS, place="p"),)
)


def fit(cost):
    return made_fit(NAMED, cost=cost, space=Space([]), u=[])


STUCK, FRESH = fit(100.0), fit(10.0)


def every_fit_is(fitted, monkeypatch):
    """Fits are made by `fitted`, from the first of their beginnings; nothing else is looked at."""
    for module in (rivals, race):
        monkeypatch.setattr(module, "fit_hypothesis", fitted)
    monkeypatch.setattr(first_steps, "best_starting_point", lambda _s, _h, points: points[0])
    monkeypatch.setattr(rivals, "other_candidates", lambda *_: [])
    monkeypatch.setattr(rivals, "others_beside", lambda _: [])


@pytest.fixture
def fits_from_the_start_end_lower(monkeypatch):
    """Of the model with what was named; no other effect has anything to promise."""
    monkeypatch.setattr(rivals, "fit_hypothesis", lambda *_, **how: how.get("resumed", FRESH))
    monkeypatch.setattr(rivals, "other_candidates", lambda *_: [])
    monkeypatch.setattr(rivals, "all_candidates", lambda *_, **__: [])
    monkeypatch.setattr(rivals, "others_beside", lambda _: [])


@pytest.mark.usefixtures("fits_from_the_start_end_lower")
@pytest.mark.parametrize(("needs_more", "present"), [(True, FRESH), (False, STUCK)])
def test_what_a_stuck_fit_leaves_is_sought_from_the_start_before_in_other_effects(
    needs_more, present
):
    def more(base, _begun):
        return needs_more and base is STUCK

    found = find_rivals(STAGES, NAMED, more, start={}, fitted=STUCK)
    assert found.present is present


def test_a_compliance_is_begun_within_its_prior_and_at_its_far_end(monkeypatch):
    """A mode of its own comes down from above the lines: beside it the fit leads back to none."""
    soft = Parameter(name="soft", unit="rad/(N m)", mean=0.0, std=2e-6, low=0.0)
    pull = Parameter(name="pull", unit="", mean=0.0, std=1.0)
    spring, other = (
        Instance(effect=hit_direction.WORDS, place=p.name, parameters=(p,), size=p.name)
        for p in (soft, pull)
    )
    tried = {}

    def better(_stage, hypothesis, starting_points):
        tried[hypothesis.instances[-1].place] = starting_points
        return starting_points[0]

    looked = [Candidate(instance=one, gain=100.0) for one in (spring, other)]
    monkeypatch.setattr(first_steps, "best_starting_point", better)
    for module in (rivals, race):
        monkeypatch.setattr(
            module,
            "fit_hypothesis",
            lambda _, h, **__: made_fit(h, cost=0.0, space=Space([]), u=[]),
        )
    monkeypatch.setattr(rivals, "other_candidates", lambda *_: [])
    monkeypatch.setattr(rivals, "all_candidates", lambda *_, **__: looked)
    monkeypatch.setattr(rivals, "others_beside", lambda _: [])
    find_rivals(STAGES, NAMED, lambda *_: False, start={})
    sizes = [values["soft"] for values in tried["soft"] if "soft" in values]
    assert min(sizes) < soft.std
    assert max(sizes) >= 2.0 * soft.std  # a normal prior is rarely beyond
    assert all("pull" not in values for values in tried["pull"])  # signed: its slope tells


@pytest.mark.parametrize(("start", "anew"), [(0.5, True), (None, False)])
def test_on_wide_lines_what_has_a_beginning_of_its_own_is_begun_beside_no_error(
    start, anew, monkeypatch
):
    """Ordinary errors that took on what is missing lead back to where they are."""
    mass = Parameter(name="mass", unit="kg", mean=0.0, std=1.0, low=0.0, start=start)
    body = Instance(effect=hit_direction.WORDS, place="m", parameters=(mass,), size="mass")
    begun = []

    def fitted(_stage, hypothesis, *, start=None, resumed=None, **_):
        if hypothesis.instances[-1] is body and start is not None:
            begun.append(dict(start))
        space = Space([Parameter(name="ln mass of a link", unit="", mean=0.0, std=0.05)])
        made = made_fit(hypothesis, cost=0.0, space=space, u=[4.0])
        return replace(made, converged=True)

    every_fit_is(fitted, monkeypatch)
    monkeypatch.setattr(rivals, "fitted_laws", lambda *_, **__: [])
    looked = [Candidate(instance=body, gain=100.0)]
    monkeypatch.setattr(
        rivals, "all_candidates", lambda *_, from_start, **__: looked if from_start else []
    )
    find_rivals(STAGES, NAMED, lambda *_: True, start={}, afresh=False)
    assert [{} for values in begun if not values] == [{}] * anew


@pytest.mark.parametrize(("from_there", "present"), [(12.0, 12.0), (500.0, 1000.0)])
def test_what_a_stuck_fit_leaves_is_no_effect_where_the_model_comes_as_near_without_it(
    from_there, present, monkeypatch
):
    """With a body a fit finds a better minimum of everything else: of 10 against 1000."""
    mass = Parameter(name="mass", unit="kg", mean=0.0, std=1.0, low=0.0)
    body = Instance(effect=hit_direction.WORDS, place="m", parameters=(mass,), size="mass")

    def fitted(_stage, hypothesis, *, start=None, resumed=None, **_):
        if hypothesis is not NAMED:
            made = made_fit(hypothesis, cost=10.0, space=Space([mass]), u=[1.0])
        elif resumed is not None:
            made = resumed
        else:
            cost = from_there if "mass" in start else 1000.0
            made = made_fit(hypothesis, cost=cost, space=Space([]), u=[])
        return replace(made, converged=True)

    every_fit_is(fitted, monkeypatch)
    looked = [Candidate(instance=body, gain=100.0)]
    monkeypatch.setattr(rivals, "all_candidates", lambda *_, **__: looked)
    found = find_rivals(STAGES, NAMED, lambda *_: False, start={})
    assert found.present.cost == present
    assert [rival.cost for rival in found.rivals] == [10.0]


def on_the_way(hypothesis, to, cost, slope):
    """A fit that some steps brought to a cost, on the way to one of two minima."""
    space = Space([Parameter(name="angle", unit="rad", mean=0.0, std=1.0)])
    made = made_fit(hypothesis, cost=cost, space=space, u=[to])
    return replace(made, slope=np.array([slope]), converged=slope == 0.0)


@pytest.mark.parametrize("separate", [True, False])
def test_of_several_minima_the_one_that_is_ahead_after_some_steps_may_be_the_worse(
    separate, monkeypatch
):
    """Minimum 1 is reached at once, 2 only by steps more: its quadratic still promises 18 nats."""
    words = replace(hit_direction.WORDS, separate_minima=separate)
    swings = Instance(
        effect=words,
        place="q",
        parameters=(Parameter(name="angle", unit="rad", mean=0.0, std=1.0),),
        size="angle",
    )
    looked = [Candidate(instance=swings, gain=100.0, begin={"angle": to}) for to in (1.0, 2.0)]

    def fitted(_stage, hypothesis, *, start=None, resumed=None, **_):
        if hypothesis is NAMED:
            return fit(100.0)
        if resumed is not None:
            there = on_the_way(hypothesis, to=2.0, cost=20.0, slope=0.0)
            return resumed if resumed.converged else there
        first = start["angle"] < 0.15  # the last beginning: a tenth of the way
        return on_the_way(
            hypothesis, start["angle"], 50.0 if first else 60.0, 0.0 if first else 6.0
        )

    monkeypatch.setattr(first_steps, "best_starting_point", lambda *given: given[-1][-1])
    monkeypatch.setattr(rivals, "fit_hypothesis", fitted)
    monkeypatch.setattr(race, "fit_hypothesis", fitted)
    monkeypatch.setattr(rivals, "other_candidates", lambda *_: [])
    monkeypatch.setattr(rivals, "all_candidates", lambda *_, **__: looked)
    monkeypatch.setattr(rivals, "others_beside", lambda _: [])
    found = find_rivals(STAGES, NAMED, lambda *_: False, start={})
    assert [one.cost for one in found.rivals] == ([20.0] if separate else [50.0])


def test_what_cannot_come_beside_the_best_is_left_where_it_stands(monkeypatch):
    """Nor what ends no better than the model without it; what still promises enough goes on."""
    asked = []

    def fitted(_stage, hypothesis, *, is_hopeless=None, **_):
        if hypothesis is NAMED:
            return fit(100.0)
        asked.append(is_hopeless)
        return made_fit(hypothesis, cost=20.0, space=Space([]), u=[])

    looked = [
        Candidate(instance=Instance(effect=hit_direction.WORDS, place=place), gain=50.0)
        for place in "qr"
    ]
    monkeypatch.setattr(first_steps, "best_starting_point", lambda *given: given[-1][-1])
    monkeypatch.setattr(rivals, "fit_hypothesis", fitted)
    monkeypatch.setattr(race, "fit_hypothesis", fitted)
    monkeypatch.setattr(rivals, "other_candidates", lambda *_: [])
    monkeypatch.setattr(rivals, "all_candidates", lambda *_, **__: looked)
    monkeypatch.setattr(rivals, "others_beside", lambda _: [])
    find_rivals(STAGES, NAMED, lambda *_: False, start={})
    first, *_ = asked
    # 25 nats beside the best, which is at 20; a slope of 6 promises 18, three times that 54.
    assert not first(on_the_way(NAMED, 0.0, 44.0, 0.0))
    assert first(on_the_way(NAMED, 0.0, 46.0, 0.0))
    assert not first(on_the_way(NAMED, 0.0, 98.0, 6.0))
    assert first(on_the_way(NAMED, 0.0, 100.0, 6.0))


def test_what_promises_most_is_begun_though_it_may_hide_in_what_its_limit_is_read_from(monkeypatch):
    """Three times its promise of 80 nats is below its limit, likewise that of the next."""
    leads, next_one = (Instance(effect=hit_direction.WORDS, place=place) for place in "ab")
    reaching = Instance(effect=bearing.WORDS, place="c")
    gains = ((leads, 80.0), (next_one, 79.0), (reaching, 78.0))
    looked = [Candidate(instance=i, gain=gain) for i, gain in gains]
    begun = []

    def fitted(_stage, hypothesis, *, resumed=None, **_):
        if resumed is None and hypothesis is not NAMED:
            begun.append(hypothesis.instances[-1])
        return fit(100.0) if hypothesis is NAMED else made_fit(hypothesis, cost=50.0)

    for module in (rivals, race):
        monkeypatch.setattr(module, "fit_hypothesis", fitted)
    monkeypatch.setattr(first_steps, "best_starting_point", lambda *given: given[-1][-1])
    monkeypatch.setattr(rivals, "other_candidates", lambda *_: [])
    monkeypatch.setattr(rivals, "all_candidates", lambda *_, **__: looked)
    monkeypatch.setattr(rivals, "others_beside", lambda _: [])
    limits = {hit_direction.WORDS.name: 300.0, bearing.WORDS.name: 200.0}
    find_rivals(
        STAGES, NAMED, lambda *_: False, limit=lambda _, name: limits[name], start={}, fitted=STUCK
    )
    assert begun == [leads, reaching]


@pytest.mark.parametrize(("more", "places"), [(False, "ac"), (True, "acb")])
def test_what_was_turned_down_at_first_is_begun_once_more_is_to_be_explained(
    more, places, monkeypatch
):
    """A servo had been below its limit, and what was begun instead an absorber: it had the name."""
    of = {"a": hit_direction.WORDS, "b": hit_direction.WORDS, "c": bearing.WORDS}
    instances = {place: Instance(effect=words, place=place) for place, words in of.items()}
    looked = [Candidate(instance=i, gain=80.0) for i in instances.values()]
    begun = []

    def fitted(_stage, hypothesis, *, resumed=None, **_):
        if resumed is None and hypothesis is not NAMED:
            begun.append(hypothesis.instances[-1].place)
        return fit(100.0) if hypothesis is NAMED else made_fit(hypothesis, cost=50.0)

    every_fit_is(fitted, monkeypatch)
    monkeypatch.setattr(rivals, "fitted_laws", lambda *_, **__: [])
    monkeypatch.setattr(
        rivals, "all_candidates", lambda *_, from_start, **__: [] if from_start else looked
    )
    limits = {hit_direction.WORDS.name: 300.0, bearing.WORDS.name: 200.0}
    find_rivals(
        STAGES,
        NAMED,
        lambda _, begun: more and bool(begun),
        limit=lambda _, name: limits[name],
        start={},
        fitted=STUCK,
        afresh=False,
    )
    assert "".join(begun) == places
