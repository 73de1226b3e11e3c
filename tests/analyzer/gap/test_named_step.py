"""A name more in the model: where its fit begins, and turns and axes of the arm file."""

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from support.made_gap_fits import made_fit

from armodal.analyzer.gap import named_step
from armodal.analyzer.gap.effects import link_axis, sensor_axes
from armodal.analyzer.gap.effects.effect import Instance
from armodal.analyzer.gap.hypothesis import Hypothesis
from armodal.analyzer.gap.judge import Judged, Thresholds
from armodal.analyzer.gap.named_step import Step, with_step
from armodal.analyzer.gap.space import Parameter, Space
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.study import draw_study, sealed
from armodal.study.score import mark

ORDINARY = SimpleNamespace(arm=SimpleNamespace(joints=()))
SPACE = Space(
    [Parameter(name=name, unit="", mean=0.0, std=1e-6) for name in ("ordinary", "axis l1")]
)


def step_to(fit):
    surprise = SimpleNamespace(surprise=())
    return Step(
        without=replace(fit, cost=fit.cost + 1000.0),
        fit=fit,
        foretold_without=surprise,
        foretold_with=surprise,
        judged=Judged(named=fit, standing=(fit,), phi=1.0),
    )


def fit_of(*instances):
    return fit_to(Hypothesis(ordinary=ORDINARY, instances=instances))


def fit_to(hypothesis, cost=100.0):
    """Every ordinary parameter as believed, an axis in l1 of one deviation."""
    return made_fit(hypothesis, cost=cost, space=SPACE, u=[0.0, 1.0])


@pytest.fixture
def plain(monkeypatch):
    """No joint may be released, and every effect of the two earns its place."""

    def fitted(stage, hypothesis, **_):
        return fit_to(hypothesis, 100.0 if len(hypothesis.instances) > 1 else 1e6)

    monkeypatch.setattr(named_step, "all_instances", lambda _: ())
    monkeypatch.setattr(named_step, "fit_hypothesis", fitted)


def test_a_turn_that_joins_one_of_the_arm_file_is_still_named(plain, monkeypatch):
    words = SimpleNamespace(name="swapped_axes", title="")
    of_file, found, both = (Instance(effect=words, place=p) for p in ("one", "two", "both"))
    monkeypatch.setattr(
        sensor_axes, "together", lambda _, a, b: both if (a, b) == (of_file, found) else None
    )
    fit, named = with_step([None], [], step_to(fit_of(of_file, found)), {}, Thresholds(), [])
    assert fit.hypothesis.instances == (both,)
    assert [step.fit.last for step in named] == [both]


def test_a_turn_that_joins_an_earlier_one_stands_in_its_step(plain, monkeypatch):
    words = SimpleNamespace(name="swapped_axes", title="")
    before, found, both = (Instance(effect=words, place=p) for p in ("one", "two", "both"))
    monkeypatch.setattr(
        sensor_axes, "together", lambda _, a, b: both if (a, b) == (before, found) else None
    )
    earlier = [step_to(fit_of(before))]
    fit, named = with_step([None], earlier, step_to(fit_of(before, found)), {}, Thresholds(), [])
    assert fit.hypothesis.instances == (both,)
    assert [step.fit.last for step in named] == [both]


def test_an_axis_of_the_arm_file_is_not_swapped_for_a_released_joint(plain, monkeypatch):
    joint = SimpleNamespace(name="j1", link=SimpleNamespace(name="l1"))
    ordinary = SimpleNamespace(arm=SimpleNamespace(joints=(joint,)))
    released = Instance(
        effect=SimpleNamespace(name="released_joint", title=""), place="j1", size="free j1"
    )
    axis = Instance(effect=link_axis.WORDS, place="l1", size="axis l1")
    other = Instance(effect=SimpleNamespace(name="base", title=""), place="")
    monkeypatch.setattr(named_step, "all_instances", lambda _: (released,))
    monkeypatch.setattr(named_step, "spread_of", lambda axis, fit: None)

    def fit_and_names(*instances):
        fit = fit_to(Hypothesis(ordinary=ordinary, instances=instances))
        found, named = with_step([None], [], step_to(fit), {}, Thresholds(), [])
        return found.hypothesis.instances, [step.fit.last for step in named]

    assert fit_and_names(axis, other) == ((axis, other), [other])
    # One that was named is: the same axis, as the last of its step.
    assert fit_and_names(other, axis) == ((other, released), [released])


@pytest.mark.long
def test_a_name_beside_another_begins_from_nothing_where_its_fit_ended_beyond_belief():
    """A body of 15 kg had been fitted as one of 1 kg before the rotor beside it was found."""
    spec = next(
        spec
        for spec in draw_study(31, nulls=150, effects=174, pairs=20, outside=34, ladder=True)
        if spec.number == 58
    )
    case = sealed(spec)
    result = find_gap(case.session(), gates=False, modes=False, advice=False).result
    truth = json.loads(case.open_truth())
    assert mark(truth, result).outcome == "right"
    (true,) = (e for e in truth["effects"] if e["name"] == "payload")
    (payload,) = (e for e in result.effects if e.name == "payload")
    mass = payload.parameters[payload.size]
    # Masses and gains are known to some per cent only.
    assert mass.value == pytest.approx(true["parameters"]["mass_kg"], rel=0.1)
