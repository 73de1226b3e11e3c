"""A name more in the model: where its fit begins, and turns and axes of the arm file."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.made_calibration import made_calibration
from support.made_gap_fits import made_fit, made_words

from armodal.analyzer.gap.decision import added_effect
from armodal.analyzer.gap.decision.added_effect import Step, beside_rivals, with_step
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.effects import base, link_axis, released_joint, sensor_axes
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import Linearised
from armodal.analyzer.gap.model.priors import FARTHEST
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.search import rivals


class Lines(str):
    """A stage, by its name; of its lines none is asked for."""

    __slots__ = ()
    lines = ()


STAGES = tuple(Lines(name) for name in ("widest", "broad", "middle", "sharp"))
ORDINARY = SimpleNamespace(arm=SimpleNamespace(joints=()))
SPACE = Space(
    [Parameter(name=name, unit="", mean=0.0, std=1e-6) for name in ("ordinary", "axis l1")]
)


def step_to(fit):
    return Step(
        without=replace(fit, cost=fit.cost + 1000.0),
        fit=fit,
        gains={"p": 1000.0},
        judged=Judged(named=fit, standing=(fit,), phi=1.0, calibration=made_calibration()),
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

    monkeypatch.setattr(added_effect, "fit_hypothesis", fitted)


def test_a_turn_that_joins_one_of_the_arm_file_is_still_named(plain, monkeypatch):
    words = made_words("swapped_axes")
    of_file, found, both = (Instance(effect=words, place=p) for p in ("one", "two", "both"))
    monkeypatch.setattr(
        sensor_axes, "together", lambda _, a, b: both if (a, b) == (of_file, found) else None
    )
    fit, named = with_step([None], [], step_to(fit_of(of_file, found)), {}, [])
    assert fit.hypothesis.instances == (both,)
    assert [step.fit.last for step in named] == [both]


def test_a_turn_that_joins_an_earlier_one_stands_in_its_step(plain, monkeypatch):
    words = made_words("swapped_axes")
    before, found, both = (Instance(effect=words, place=p) for p in ("one", "two", "both"))
    monkeypatch.setattr(
        sensor_axes, "together", lambda _, a, b: both if (a, b) == (before, found) else None
    )
    earlier = [step_to(fit_of(before))]
    fit, named = with_step([None], earlier, step_to(fit_of(before, found)), {}, [])
    assert fit.hypothesis.instances == (both,)
    assert [step.fit.last for step in named] == [both]


def test_an_axis_of_the_arm_file_is_not_swapped_for_what_it_may_stand_for(plain):
    released = Instance(effect=released_joint.WORDS, place="j1", size="free j1")
    axis = Instance(
        effect=link_axis.WORDS,
        place="l1",
        size="axis l1",
        alternatives=lambda values: [(released, values)],
    )
    other = Instance(effect=base.WORDS, place="")

    def fit_and_names(*instances):
        fit = fit_to(Hypothesis(ordinary=None, instances=instances), cost=200.0)
        found, named = with_step(STAGES[-1:], [], step_to(fit), {}, [])
        return found.hypothesis.instances, [step.fit.last for step in named]

    assert fit_and_names(axis, other) == ((axis, other), [other])
    # One that was named is: the same axis, as the last of its step.
    assert fit_and_names(other, axis) == ((other, released), [released])


@pytest.mark.parametrize(
    ("off", "again", "kept"),
    [(5.0, 90.0, 90.0), (5.0, 110.0, 100.0), (4.8, 90.0, 100.0)],
)
def test_a_name_beside_another_begins_from_nothing_where_its_fit_ended_at_a_limit(
    off, again, kept, monkeypatch
):
    """An ordinary error as far off as is tried has taken on what the effect explains."""
    begun = []

    def fitted(stage, hypothesis, *, start=None, max_iterations, resumed=None, closing=True):
        if len(hypothesis.instances) == 1:  # without one of the two
            return fit_to(hypothesis, 1e6)
        begun.append((stage, start))
        return fit_to(hypothesis, again)

    for module in (added_effect, rivals):
        monkeypatch.setattr(module, "fit_hypothesis", fitted)
    payload, rotor = (Instance(effect=made_words(name), place="") for name in ("body", "rotor"))
    ended = replace(fit_of(payload, rotor), u=np.array([off, 1.0]))
    begin = {"body": 3.0}
    fit, named = with_step(STAGES, [], step_to(ended), begin, [])
    assert fit.cost == kept
    assert [step.fit.last for step in named] == [rotor]
    assert [stage for stage, _ in begun] == (list(STAGES) if off == FARTHEST else [])
    assert [start for _, start in begun[:1]] in ([], [begin])


def test_a_name_alone_never_begins_again(plain):
    alone = Instance(effect=made_words("body"), place="")
    ended = replace(fit_of(alone), u=np.array([6.0, 1.0]))
    fit, _ = with_step(STAGES, [], step_to(ended), {}, [])
    assert fit is ended


@pytest.mark.parametrize(
    "named_about", [None, Linearised(values={}, table={})], ids=["effect", "law"]
)
@pytest.mark.parametrize(("gain", "is_kept"), [(0.9, False), (1.1, True)])
def test_an_effect_that_a_later_one_made_unneeded_is_taken_out_again(
    gain, is_kept, named_about, monkeypatch
):
    """A law is worked out about other values in every fit, and stays the same effect."""
    notes = []

    def fitted(stage, hypothesis, **_):
        return fit_to(hypothesis, 100.0 + gain * made_calibration().limit("one"))

    monkeypatch.setattr(added_effect, "fit_hypothesis", fitted)
    one, two = (Instance(effect=made_words(name, title=name), place="") for name in ("one", "two"))
    earlier = [step_to(fit_of(replace(one, about=named_about)))]
    fit, named = with_step(STAGES, earlier, step_to(fit_of(one, two)), {}, notes)
    assert fit.hypothesis.instances == ((one, two) if is_kept else (two,))
    assert [step.fit.last.key for step in named] == ([one.key, two.key] if is_kept else [two.key])
    assert notes == (
        [] if is_kept else ["one was taken out again: beside the others it is no longer clear"]
    )


def test_a_rival_takes_the_name_where_mountings_err_as_the_better_model_foretells(monkeypatch):
    """One that was let go while the effect was missing is right once its mountings are allowed."""
    words = made_words("made")
    axis, joint, third = (Instance(effect=words, place=p) for p in ("axis", "joint", "third"))
    cost = {"axis": 100.0, "joint": 80.0, "third": 90.0}

    def fitted(stage, hypothesis, *, resumed=None, **_):
        return resumed or fit_to(hypothesis, cost[hypothesis.instances[-1].place])

    monkeypatch.setattr(added_effect, "fit_hypothesis", fitted)
    rivals = [fit_of(axis), fit_of(joint), fit_of(third)]
    better, (step,) = beside_rivals(STAGES[-1], fit_of(axis), rivals, [step_to(fit_of(axis))])
    assert better.last is joint
    assert step.fit.last is joint
    assert step.judged.named is not None
    cost["axis"] = 70.0
    kept, (step,) = beside_rivals(
        STAGES[-1], fit_to(fit_of(axis).hypothesis, 70.0), rivals, [step_to(fit_of(axis))]
    )
    assert kept.last is axis
    assert step.fit.last is axis


@pytest.mark.parametrize(("size", "is_taken"), [(0.4, False), (0.6, True)])
def test_what_holds_the_name_inside_it_takes_it_only_where_the_rest_is_large_enough(
    size, is_taken, monkeypatch
):
    """Wrist gears beside the joint they drive: a ratio of nearly nothing is nearer all the same."""
    words = made_words("made")
    joint = Instance(effect=words, place="joint", size="ordinary")
    gears = Instance(effect=words, place="gears", size="axis l1", material=0.5e-6)

    def fitted(stage, hypothesis, *, resumed=None, **_):
        return resumed or made_fit(
            hypothesis, cost=90.0, space=SPACE, u=[0.0, size], resting=["axis l1"]
        )

    monkeypatch.setattr(added_effect, "fit_hypothesis", fitted)
    better, _ = beside_rivals(STAGES[-1], fit_of(joint), [fit_of(gears)], [step_to(fit_of(joint))])
    assert better.last is (gears if is_taken else joint)


@pytest.mark.parametrize(("behind", "is_taken"), [(50.0, False), (500.0, True)])
def test_an_axis_that_lies_on_the_named_joint_takes_its_name_only_by_much(
    behind, is_taken, monkeypatch
):
    plain, askew = (made_words(name) for name in ("joint", "axis"))
    joint = Instance(effect=plain, place="joint")
    axis = Instance(effect=askew, place="axis", is_also=lambda _values, other: other is joint)

    def fitted(stage, hypothesis, *, resumed=None, **_):
        return resumed or fit_to(hypothesis, 100.0 - behind)

    monkeypatch.setattr(added_effect, "fit_hypothesis", fitted)  # without either: 1100 nats
    better, _ = beside_rivals(STAGES[-1], fit_of(joint), [fit_of(axis)], [step_to(fit_of(joint))])
    assert better.last is (axis if is_taken else joint)
