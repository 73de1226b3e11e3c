"""What a search ends with."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.made_calibration import made_calibration
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.decision import calibration
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.decision.verdict import verdict_of
from armodal.analyzer.gap.effects import (
    bearing,
    gravity_compensator,
    link_axis,
    microslip,
    softening,
)
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.search.rivals import Rivals

# A thousand residuals, soft and hard hits together.
OF_1000 = SimpleNamespace(weighings=[SimpleNamespace(n=1000)])
ORDINARY = SimpleNamespace(arm=SimpleNamespace(joints=()), level_span=0.0)


@pytest.fixture(autouse=True)
def by_level(monkeypatch):
    """Nats that each joint's change with the level promises, and a fit keeps; none of itself."""
    gains = []
    monkeypatch.setattr(
        calibration,
        "changes_with_level",
        lambda *_: [SimpleNamespace(gain=gain, instance=None) for gain in gains],
    )
    monkeypatch.setattr(
        calibration,
        "fit_with",
        lambda _stage, fit, _change: SimpleNamespace(evidence=fit.evidence - gains[0], last=None),
    )
    monkeypatch.setattr(calibration, "matters", lambda *_: True)
    return gains


def replicas_leave(_fit):
    return 0.8


def fit_that_leaves(misfit, *instances):
    """A fit with a misfit a residual."""
    hypothesis = Hypothesis(ordinary=ORDINARY, instances=instances)
    return made_fit(hypothesis, cost=0.5 * misfit * 1000)


STANDING = (
    fit_that_leaves(0.50, Instance(effect=bearing.WORDS, place="j0")),
    fit_that_leaves(0.51, Instance(effect=gravity_compensator.WORDS, place="j1")),
)


def ended(final, standing=(), *, rivals=(), named=False, doubted=False):
    return told_of(final, standing, rivals=rivals, named=named, doubted=doubted)[0]


def told_of(final, standing=(), *, rivals=(), named=False, doubted=False):
    found = Rivals(present=final, rivals=(*standing, *rivals))
    judged = Judged(
        named=None, standing=standing, phi=1.0, calibration=made_calibration(), doubted=doubted
    )
    return verdict_of(OF_1000, final, found, judged, named=named, leaves=replicas_leave)


@pytest.mark.parametrize("named", [False, True])
def test_a_misfit_beyond_what_replicas_leave_is_outside_the_library_whatever_was_named(named):
    inside = Verdict.NAMED if named else Verdict.NOTHING_DETECTABLE
    assert ended(fit_that_leaves(0.79), named=named) is inside
    assert ended(fit_that_leaves(0.81), named=named) is Verdict.OUTSIDE_LIBRARY


def test_errors_larger_than_a_right_model_s_where_effects_feel_them_are_outside_the_library():
    final = fit_that_leaves(0.5)
    found = Rivals(present=final, rivals=())
    for error_ratio, verdict in ((0.9, Verdict.NAMED), (1.1, Verdict.OUTSIDE_LIBRARY)):
        judged = Judged(
            named=None,
            standing=(),
            phi=1.0,
            calibration=made_calibration(error_ratio=error_ratio),
        )
        said, _ = verdict_of(OF_1000, final, found, judged, named=True, leaves=replicas_leave)
        assert said is verdict


def test_what_stands_explains_the_misfit_unless_held_out_postures_speak_against_it():
    final = fit_that_leaves(0.81)
    assert ended(final, STANDING) is Verdict.AMBIGUOUS
    assert ended(final, STANDING, doubted=True) is Verdict.OUTSIDE_LIBRARY


def test_several_that_stand_are_ambiguous_and_none_is_nothing_detectable():
    final = fit_that_leaves(0.6)
    assert ended(final, STANDING) is Verdict.AMBIGUOUS
    assert ended(final) is Verdict.NOTHING_DETECTABLE
    assert ended(final, STANDING, named=True) is Verdict.NAMED


def law_of(words, place="j0"):
    return Instance(effect=words, place=place, level_dependent=True)


# The made calibration accepts a hundredth, errors as large that this is 20 nats of one look.
OF_SIX_JOINTS = 20.0 * np.log(6 / 0.01) / np.log(1 / 0.01)


@pytest.mark.parametrize("named", [False, True])
def test_what_the_level_tells_and_no_effect_follows_is_outside_the_library(named, by_level):
    final = fit_that_leaves(0.5)
    by_level[:] = [0.99 * OF_SIX_JOINTS, *[0.0] * 5]
    inside = Verdict.NAMED if named else Verdict.NOTHING_DETECTABLE
    assert told_of(final, named=named) == (inside, [])
    by_level[0] = 1.01 * OF_SIX_JOINTS
    verdict, (why,) = told_of(final, named=named)
    assert verdict is Verdict.OUTSIDE_LIBRARY
    assert "depends on the hits' level, and nothing that was named does" in why
    # Of fewer joints less is by chance.
    by_level[:] = [0.99 * OF_SIX_JOINTS, *[0.0] * 4]
    assert ended(final, named=named) is Verdict.OUTSIDE_LIBRARY


def test_what_the_level_tells_may_be_a_law_that_stands_but_only_where_nothing_is_named(by_level):
    by_level[:] = [1e3]
    laws = tuple(
        fit_that_leaves(misfit, law_of(words))
        for misfit, words in ((0.50, softening.WORDS), (0.51, microslip.WORDS))
    )
    final = fit_that_leaves(0.6)
    assert ended(final, laws) is Verdict.AMBIGUOUS
    assert ended(final, STANDING) is Verdict.OUTSIDE_LIBRARY
    assert ended(final, laws, named=True) is Verdict.OUTSIDE_LIBRARY


@pytest.mark.parametrize(
    ("ahead", "verdict"), [(21.0, Verdict.NOTHING_DETECTABLE), (19.0, Verdict.OUTSIDE_LIBRARY)]
)
def test_a_law_with_some_evidence_may_be_what_the_level_tells(ahead, verdict, by_level):
    by_level[:] = [1e3]
    final = fit_that_leaves(0.5)
    likely = made_fit(
        Hypothesis(ordinary=ORDINARY, instances=(law_of(softening.WORDS),)),
        cost=final.cost - ahead,
    )
    assert ended(final, rivals=(likely,)) is verdict


def test_a_named_axis_is_none_where_the_level_tells_a_law_at_a_joint_of_its_link():
    joints = [SimpleNamespace(name=f"j{i}", link=SimpleNamespace(name=f"l{i}")) for i in range(4)]
    ordinary = SimpleNamespace(arm=SimpleNamespace(joints=joints), level_span=0.0)
    axis = Instance(effect=link_axis.WORDS, place="l1")
    final = made_fit(Hypothesis(ordinary=ordinary, instances=(axis,)), cost=300.0)

    limits = made_calibration(limits={"softening": 40.0})

    def told(place, gain):
        slips = law_of(softening.WORDS, place)
        rival = made_fit(
            Hypothesis(ordinary=ordinary, instances=(axis, slips)), cost=final.cost - gain
        )
        found = Rivals(present=final, rivals=(rival,))
        judged = Judged(named=None, standing=(), phi=1.0, calibration=limits)
        return verdict_of(OF_1000, final, found, judged, named=True, leaves=replicas_leave)

    verdict, why = told("j2", 41.0)
    assert verdict is Verdict.OUTSIDE_LIBRARY
    assert "together are what one mechanism would look like" in why[0]
    assert told("j1", 41.0)[0] is Verdict.OUTSIDE_LIBRARY
    assert told("j2", 39.0) == (Verdict.NAMED, [])
    assert told("j3", 90.0) == (Verdict.NAMED, [])
