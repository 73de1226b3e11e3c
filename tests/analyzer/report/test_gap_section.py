"""The gap part of the report: all verdicts, what it must say, and its file."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.records import (
    Disagreement,
    EffectFound,
    GapResult,
    Gate,
    Hidden,
    Interval,
    LineDeviation,
    ModeMatch,
    NextTest,
    PostureGap,
    RivalRow,
    StiffnessRange,
    Verdict,
)
from armodal.analyzer.report.effect_words import mechanics_of
from armodal.analyzer.report.gap_file import gap_from_json, gap_to_json
from armodal.analyzer.report.gap_section import gap_page, gap_section
from armodal.analyzer.report.gap_svg import disagreement_svgs, errors_svg
from armodal.analyzer.report.marked_effects import drawn_effects
from armodal.protocols.arm.files import load_arm

P = {
    "axis compliance link_3": Interval(
        unit="rad/(N m)", value=2.1e-5, std=1e-6, low=1.9e-5, high=2.3e-5
    )
}
MODE = ModeMatch(
    measured_hz=12.34,
    model_hz=13.5,
    measured_damping_ratio=0.02,
    model_damping_ratio=0.03,
    mac=0.91,
)
BEFORE = tuple(
    PostureGap(posture=f"p{i}", held_out=i == 2, frf_error=0.3, floor=0.05, modes=(MODE,))
    for i in range(3)
)
NAMED = GapResult(
    verdict=Verdict.NAMED,
    summary="Link 3 bends about an axis of its own.",
    effects=(
        EffectFound(
            name="link_axis",
            title="Link is compliant about an axis of its own",
            place="link_3",
            parameters=P,
            size=next(iter(P)),
            description={
                "link": "link_3",
                "direction": [0.0, 0.0, 1.0],
                "point_m": [0.01, 0.02, 0.0],
            },
            confidence=0.998,
            gain=812.0,
            held_out_gain=240.0,
            signature="a mode about one line",
            confused_with=("bearing",),
            told_by="a hit along the axis",
            remedy="tighten the flange of link 3",
        ),
    ),
    rivals=(
        RivalRow(
            name="bearing",
            title="Bearing",
            place="joint_3",
            gain=3.0,
            behind=0.5,
            standing=True,
            material=True,
            parameters=P,
            told_by="another posture",
        ),
    ),
    hidden=(Hidden(name="payload", place="link_6", parameter="payload", unit="kg", largest=0.4),),
    joint_stiffness_ranges=(
        StiffnessRange(joint="joint_1", k_n_m_per_rad=14000.0, k_std=90.0, low=13800, high=14200),
    ),
    gap_before=BEFORE,
    gap_after=tuple(replace(gap, frf_error=0.06) for gap in BEFORE),
    where=tuple(
        Disagreement(posture=p, point=str(i), axis=a, band_hz=b, ratio=1.0 + i)
        for p in ("p0", "p1")
        for i in range(6)
        for a in "xyz"
        for b in ((5.0, 20.0), (20.0, 60.0))
    ),
    interface="between link 3 and link 4",
    gates=(Gate(check="reciprocity", outcome="passed", words="as it should"),),
    notes=("one posture was held out",),
    misfit_per_line=0.52,
)


def test_a_proposed_next_test_comes_back_from_the_file_and_an_older_file_has_none() -> None:
    test = NextTest(words="Hit 18 along y.", why="tells a from b", gain=12.5, plan_toml="a = 1\n")
    proposing = replace(NAMED, next_test=test)
    assert gap_from_json(gap_to_json(proposing)) == proposing
    older = json.loads(gap_to_json(NAMED))
    del older["next_test"]
    assert gap_from_json(json.dumps(older)) == NAMED


def page_of(result, summary="session 1"):
    superset = Superset(load_arm("bench57"))
    joints_rad = np.zeros(len(superset.arm.joints))
    return gap_page(result, summary, drawn_effects(superset, joints_rad, result.effects))


@pytest.mark.parametrize("verdict", list(Verdict))
def test_every_verdict_has_its_page_and_its_file(verdict) -> None:
    bare = verdict is not Verdict.NAMED
    result = replace(NAMED, verdict=verdict, effects=() if bare else NAMED.effects)
    page = page_of(result)
    assert result.summary in page
    assert gap_from_json(gap_to_json(result)) == result


def test_the_page_says_what_to_do_and_how_sure() -> None:
    page = page_of(NAMED)
    for said in (
        "99.8 %",
        "N m/rad",
        "direction +0.00 +0.00 +1.00, through 10 20 0 mm",
        "tighten the flange",
        "30.0 %",
        "6.0 %",
        "between link 3",
        "13800",
    ):
        assert said in page


def test_the_page_draws_the_arm_with_what_was_found() -> None:
    """An axis is drawn in a link of this arm; a place without one is marked; else no drawing."""
    link = load_arm("bench57").joints[1].link.name
    (found,) = NAMED.effects
    (drawn,) = (replace(found, description={**found.description, "link": link}),)
    assert "what was found on it" in page_of(replace(NAMED, effects=(drawn,)))
    assert f"{link}: stiffness" in page_of(replace(NAMED, effects=(drawn,)))
    marked = replace(found, description={}, place="joint_2")
    assert "what was found on it" in page_of(replace(NAMED, effects=(marked,)))
    assert "what was found on it" not in page_of(replace(NAMED, effects=()))


EVIL = "<b>&"
SHOWN = "&lt;b&gt;&amp;"


def test_a_note_that_stands_on_a_page_before_is_not_told_again() -> None:
    result = replace(NAMED, notes=("units assumed", "a fit has not ended"))
    assert "units assumed" in gap_section(result, checks=False)
    beside = gap_section(result, checks=False, told=("units assumed",))
    assert "units assumed" not in beside
    assert "a fit has not ended" in beside


def test_text_is_shown_and_never_run() -> None:
    page = page_of(replace(NAMED, summary=EVIL, gap_before=(), gap_after=(), where=()), EVIL)
    assert EVIL not in page
    assert page.count(SHOWN) == 2


def test_names_with_tags_are_shown_in_the_figures() -> None:
    evil_gap = (replace(BEFORE[0], posture=EVIL),)
    result = replace(
        NAMED,
        gap_before=evil_gap,
        gap_after=evil_gap,
        where=(replace(NAMED.where[0], posture=EVIL, point=EVIL, axis="x"),),
    )
    assert EVIL not in page_of(result)
    assert errors_svg(result).count(SHOWN) == 1
    ((_, where),) = disagreement_svgs(result)
    assert where.count(SHOWN) == 4  # posture, point, and both in the cell's own title


def test_a_cell_that_disagrees_more_is_never_lighter() -> None:
    def shade(ratio: float) -> str:
        cell = replace(NAMED.where[0], ratio=ratio)
        ((_, where),) = disagreement_svgs(replace(NAMED, where=(cell,)))
        return where.partition('fill="')[2].partition('<rect x="')[2].partition('fill="')[2][:7]

    def lightness(colour: str) -> int:
        return sum(int(colour[k : k + 2], 16) for k in (1, 3, 5))

    found = [lightness(shade(ratio)) for ratio in (0.5, 1.5, 3.0, 6.0, 12.0, 24.0, 1e3)]
    assert found == sorted(found, reverse=True)
    assert len(set(found)) == 6


def test_an_axis_is_told_as_a_line_of_its_link_and_a_stiffness_never_as_tilts_and_shifts():
    moved = LineDeviation(turned_rad=0.05, shifted_m=0.01)
    line = {"link": "link_3", "direction": [0.0, 0.6, 0.8], "point_m": [0.1, -0.04, 0.03]}
    (effect,) = NAMED.effects
    told = dict(mechanics_of(replace(effect, line=moved, description=line)))
    assert told["axis"] == (
        "direction +0.00 +0.60 +0.80, through 100 -40 30 mm, ± 2.86° and ± 10.0 mm"
    )
    # 1 / 2.1e-5, its deviation to first order; a narrow space parts thousands.
    assert told["k"].replace("\u202f", "").startswith("47600 ± 2300 N m/rad")
    assert not any("tilt" in name or "shift" in name for name in told)
