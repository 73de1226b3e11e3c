"""A joint that softens, hit at one level: not named another thing; the test asked for names it."""

import itertools
import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from support.made_gap_fits import made_fit, made_words
from support.small_case import small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.decision.without_levels import first_with_levels, is_alike, titles
from armodal.analyzer.gap.effects import gravity_compensator, servo
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.study import make_case
from armodal.protocols.errors import ArmError
from armodal.protocols.plan import plan_from_text


def test_the_model_that_has_what_all_have_stands_as_nothing_more():
    first, second, third = (
        Instance(effect=made_words(name, title=name), place="") for name in ("one", "two", "three")
    )
    ordinary = SimpleNamespace(levels_hit=True)

    def fit(*instances):
        return made_fit(
            Hypothesis(ordinary=ordinary, instances=instances), cost=1.0, space=Space([]), u=[]
        )

    assert titles([fit(first, second), fit(first)]) == "two or nothing more"
    assert titles([fit(first, second), fit(first, third), fit(first)]) == (
        "two or three or nothing more"
    )
    assert titles([fit(second), fit(third)]) == "two or three"


@pytest.fixture(scope="module")
def case():
    """In a joint that carries weight: what changes with the posture may look the same."""
    drawn = (make_case(seed, "ur5", "softening", "clear") for seed in itertools.count(5))
    return next(case for case in drawn if place_of(case) != "shoulder_pan")


def place_of(case):
    return json.loads(case.open_truth())["effects"][0]["place"]


@pytest.fixture(scope="module")
def plain(case):
    """Hit as an operator hits: 12 to 28 N."""
    return case.session()


@pytest.fixture(scope="module")
def found(plain):
    return find_gap(plain, gates=False, modes=False)


@pytest.fixture(scope="module")
def quick():
    """Few postures and points, and nothing hidden: which sessions count is told by the hits."""
    return small_case(5, "ur5")


@pytest.fixture(scope="module")
def once(quick):
    return quick.session()


@pytest.fixture(scope="module")
def asked(quick):
    """A session as a test asks for: at three levels about those of before."""
    return quick.session(levels_n=(8.0, 18.0, 40.0), run=1)


@pytest.mark.long
def test_what_a_softer_joint_looks_like_is_not_named(found):
    result = found.result
    assert result.verdict in (Verdict.AMBIGUOUS, Verdict.OUTSIDE_LIBRARY)
    assert not result.effects
    assert "a joint that changes with the hits' level" in result.next_test.why
    assert any("hits' level were not looked for" in note for note in result.notes)


@pytest.mark.long
def test_all_postures_are_asked_for_at_three_levels_about_those_of_before(plain, found):
    test = found.result.next_test
    assert test.gain is None
    plan = plan_from_text(test.plan_toml, plain.header.arm, origin="next test")
    was = plain.header.plan
    assert [p.name for p in plan.postures] == [p.name for p in was.postures]
    peaks = sorted(hit.verdict.peak_n for hit in plain.hits)
    for posture in plan.postures:
        soft, middle, hard = posture.peaks_n
        assert soft < peaks[0] < middle < peaks[-1] < hard


@pytest.mark.long
def test_the_session_it_asked_for_names_the_joint(plain, found, case):
    plan = plan_from_text(found.result.next_test.plan_toml, case.arm, origin="next test")
    asked = case.session(plan, levels_n=plan.postures[0].peaks_n, run=1)
    result = find_gap(plain, more=[asked], gates=False, modes=False, advice=False).result
    assert result.verdict is Verdict.NAMED
    assert [effect.name for effect in result.effects] == ["softening"]
    assert result.notes[0] == ("test 2 has hits at several levels; 1 session without was left out")


def test_a_session_with_levels_goes_before_those_without_and_keeps_the_first_arm(once, asked):
    believed = replace(once.header.arm, name="as believed")
    own = replace(once, header=replace(once.header, arm=believed))
    again = replace(asked)
    first, (further,), numbers, notes = first_with_levels(own, [once, asked, again])
    assert first.hits is asked.hits
    assert first.header.arm is believed
    assert further is again
    assert numbers == (3, 4)
    (note,) = notes
    assert note.startswith("test 3 has hits at several levels; 2 sessions without were left out")
    assert note.endswith("below, test 2 is what was given as test 4")
    assert first_with_levels(asked, [once]) == (asked, (once,), (1, 2), [])
    assert first_with_levels(once, [once]) == (once, (once,), (1, 2), [])


def test_one_posture_at_levels_does_not_stand_for_a_session(once, asked):
    name = asked.hits[0].posture
    alone = replace(asked, hits=tuple(hit for hit in asked.hits if hit.posture == name))
    assert first_with_levels(once, [alone]) == (once, (alone,), (1, 2), [])


def test_another_arm_at_levels_is_refused(once, asked):
    arm = asked.header.arm
    other = replace(arm, points=(*arm.points, replace(arm.points[0], id="new")))
    wrong = replace(asked, header=replace(asked.header, arm=other))
    with pytest.raises(ArmError, match="does not match the session"):
        first_with_levels(once, [wrong])


@pytest.mark.parametrize("levels_hit", [False, True])
def test_only_what_changes_with_the_posture_is_alike_and_only_without_levels(once, levels_hit):
    ordinary = Ordinary(
        superset=Superset(once.header.arm), postures=("one", "other"), levels_hit=levels_hit
    )

    def fit(*instances):
        return _Fit(Hypothesis(ordinary=ordinary, instances=instances))

    compensator = gravity_compensator.instances(ordinary)[0]
    drive = servo.instances(ordinary)[0]
    assert is_alike(fit(drive, compensator)) is not levels_hit
    assert not is_alike(fit(compensator, drive))
    assert not is_alike(fit())


class _Fit:
    def __init__(self, hypothesis):
        self.hypothesis = hypothesis
