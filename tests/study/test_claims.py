"""The figures that are claimed, and whether stated confidence is true, from lines of studies."""

import re

import numpy as np
import pytest
from support.made_line import MADE_LINE

from armodal.study.claims import claims
from armodal.study.reliability import reliability, reliability_svg

JOINT = {"joint": "a", "k": 1.02, "std": 0.1, "low": 0.9, "high": 1.1, "true": 1.0}
WITHOUT_TESTS = {key: MADE_LINE[key] for key in MADE_LINE.keys() - {"after", "brought", "widths"}}
SIZE = {"name": "base", "true": 1.0, "found": 1.1, "low": 1.05, "high": 1.2}


def line(outcome, magnitude="clear", true=("base",), confidence=None, **more):
    own = {
        "magnitude": magnitude,
        "true": list(true),
        "true_verdict": "named" if true else "nothing_detectable",
        "verdict": "named" if confidence is not None else "nothing_detectable",
        "outcome": outcome,
        "confidence": confidence,
        "place_right": True if outcome == "right" and true else None,
        "stiffness": [JOINT] * 4,
        "sizes": [SIZE],
    }
    return WITHOUT_TESTS | own | more


NULL = line("right", "none", (), sizes=[])


def test_figures_are_counted_maker_by_maker_and_together():
    table = claims(
        {
            "home": [NULL, line("right", confidence=0.99), line("wrong name", confidence=0.9)],
            "frame": [NULL, line("missed", "medium"), {"error": "refused", "number": 7}],
        }
    )
    assert table.head == ("", "home", "frame", "together", "wanted")
    cells = {row[0]: row[1:-1] for row in table.rows}
    begins = {name: [cell.split(" (")[0] for cell in own] for name, own in cells.items()}
    assert begins["nulls silent"] == ["1 of 1", "1 of 1", "2 of 2"]
    assert begins["clear, right and alone"] == ["1 of 2", "", "1 of 2"]
    placed = begins["— single ones named right, at their true place"]
    assert placed == ["1 of 1", "", "1 of 1"]
    assert begins["medium"] == ["", "0 of 1", "0 of 1"]
    assert begins["two at once, both named"] == ["", "", ""]
    assert begins["wrong or surplus names, effects"] == ["1 of 2", "0 of 1", "1 of 3"]
    # Three of four joints are asked for, and only a right case tells of its size and k's error.
    range_covers = begins["— its range covers, what nobody would see included"]
    assert range_covers == ["9 of 9", "6 of 6", "15 of 15"]
    assert begins["size of a named effect in its 95 % interval"] == ["0 of 1", "", "0 of 1"]
    assert cells["k of joints 1 to 3, median error (right verdicts)"] == ("2.00 %",) * 3


def test_an_interval_is_told_beside_the_range_of_all_that_could_hide():
    # Off by 2 %: within 1.96 deviations of 1.1 %, beyond those of 1 %; the range is 10 % wide.
    cases = [line("right", stiffness=[JOINT | {"std": std}] * 3) for std in (0.011, 0.01)]
    cells = {row[0]: row[1].split(" (")[0] for row in claims({"home": cases}).rows}
    assert cells["— its 95 % interval covers, every verdict"] == "3 of 6"
    assert cells["— its range covers, what nobody would see included"] == "6 of 6"


def drawn(confidences, seed, right_of=lambda c: c):
    rng = np.random.default_rng(seed)
    return [
        line("right" if rng.random() < right_of(c) else "wrong name", confidence=c)
        for c in confidences
    ]


def test_confidence_that_is_true_lies_in_its_intervals():
    # 400 names in 4 bins: a bin's 95 % interval misses the truth in one of twenty.
    bins = reliability(drawn(np.linspace(0.6, 0.999, 400), 3))
    assert [own.right.n for own in bins] == [100] * 4
    assert sum(own.right.low <= own.stated <= own.right.high for own in bins) >= 3
    assert [own.stated for own in bins] == sorted(own.stated for own in bins)


def test_confidence_that_is_too_high_is_seen():
    surest = reliability(drawn(np.full(200, 0.99), 4, lambda c: c - 0.2))[-1]
    assert surest.right.high < surest.stated


@pytest.mark.parametrize("more", [{"outcome": "wrong name"}, {"place_right": False}])
def test_a_wrong_name_and_a_wrong_place_count_as_wrong(more):
    (only,) = reliability([line("right", confidence=0.99), line("right", confidence=0.99) | more])
    assert (only.right.k, only.right.n) == (1, 2)


def test_what_has_no_name_has_no_confidence():
    assert reliability([NULL, line("missed", "faint")]) == []


def test_a_bin_stands_on_the_diagonal_where_it_is_true():
    bins = reliability([line(o, confidence=0.75) for o in ["right"] * 3 + ["wrong name"]])
    x, y = re.search(r'<circle cx="([\d.]+)" cy="([\d.]+)"', reliability_svg(bins)).groups()
    diagonal = re.search(r'x1="([\d.]+)" y1="([\d.]+)" .* stroke-dasharray', reliability_svg(bins))
    x0, y0 = diagonal.groups()
    # To the rounding of both: a quarter is as far along as up.
    assert float(x) - float(x0) == pytest.approx(float(y0) - float(y), abs=0.2)
