"""What a search for rivals does with a fit that it is given."""

from types import SimpleNamespace

import pytest
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.effects import hit_direction
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.search import rivals
from armodal.analyzer.gap.search.rivals import find_rivals
from armodal.analyzer.gap.search.scan import Candidate

STAGES = ("widest", "broad", "middle", "sharp")
NAMED = Hypothesis(
    ordinary=SimpleNamespace(), instances=(Instance(effect=hit_direction.WORDS, place="p"),)
)


def fit(cost):
    return made_fit(NAMED, cost=cost, space=Space([]), u=[])


STUCK, FRESH = fit(100.0), fit(10.0)


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
    monkeypatch.setattr(rivals, "best_starting_point", better)
    monkeypatch.setattr(
        rivals, "fit_hypothesis", lambda _, h, **__: made_fit(h, cost=0.0, space=Space([]), u=[])
    )
    monkeypatch.setattr(rivals, "other_candidates", lambda *_: [])
    monkeypatch.setattr(rivals, "all_candidates", lambda *_, **__: looked)
    monkeypatch.setattr(rivals, "others_beside", lambda _: [])
    find_rivals(STAGES, NAMED, lambda *_: False, start={})
    sizes = [values["soft"] for values in tried["soft"] if "soft" in values]
    assert min(sizes) < soft.std
    assert max(sizes) >= 2.0 * soft.std  # a normal prior is rarely beyond
    assert all("pull" not in values for values in tried["pull"])  # signed: its slope tells
