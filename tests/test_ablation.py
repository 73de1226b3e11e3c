"""Numbers of search and decision moved together, and the ones that matter found."""

import ast
from pathlib import Path

import ablation
import numpy as np
import pytest

from armodal.analyzer import gap
from armodal.analyzer.gap.search import first_steps, race, rivals

EVERY = ablation.changes()


def told(case, found, cases=()):
    """Run a case to its end where `found` are the changes that matter; gives all lines."""
    lines = list(cases)
    while groups := ablation.Ablation(lines, EVERY).waiting(case):
        for group in groups:
            wrong = set(group) & set(found)
            lines.append(
                {
                    "key": ablation.key_of(group, case),
                    "case": case,
                    "verdict": "named",
                    "named": ["another"] if wrong else ["base"],
                    "right": not wrong,
                }
            )
    return lines


@pytest.mark.parametrize("count", [0, 1, 3])
def test_the_changes_that_matter_are_found_with_few_runs(count):
    moved = ablation.Ablation([], EVERY).first_group(0)
    found = [*moved[7 :: len(moved) // 3][:count]]
    lines = told(0, found)
    own = ablation.Ablation(lines, EVERY)
    assert [c for c in EVERY if own.alike(c, 0) is False] == found
    assert [c for c in EVERY if own.alike(c, 0)] == [c for c in moved if c not in found]
    # Two for each halving, six of which lead to one of the others; then the first two.
    assert len(lines) <= 2 + count * 2 * 6
    assert own.only_together([0]) == 0


def test_every_number_is_moved_up_in_half_of_the_cases_and_down_in_the_others():
    groups = [ablation.Ablation([], EVERY).first_group(case) for case in range(100)]
    assert {len(group) for group in groups} == {len(EVERY) // 2}
    ups = [sum(c in group for group in groups) for c in EVERY if c.factor > 1.0]
    # Four deviations of a coin thrown a hundred times, each of which 5.
    assert min(ups) >= 30
    assert max(ups) <= 70


def test_a_change_that_was_found_often_is_not_looked_for_in_later_rounds():
    # Both ways of a number, so that each case has one of them.
    found, lines = EVERY[4:6], []
    for case in range(ablation.TOGETHER):
        lines = told(case, found, cases=lines)
    own = ablation.Ablation(lines, EVERY)
    times = [sum(own.alike(c, case) is False for case in range(ablation.TOGETHER)) for c in found]
    assert sum(times) == ablation.TOGETHER
    often = [c for c, n in zip(found, times, strict=True) if n >= ablation.ENOUGH]
    assert often
    later = range(ablation.TOGETHER, 5 * ablation.TOGETHER)
    assert not any(c in own.first_group(case) for c in often for case in later)


def test_numbers_are_moved_at_once_and_put_back():
    steps, kept = (
        next(c for c in EVERY if c.number.constant == name and c.factor > 1.0)
        for name in ("PATIENCE", "_PARTS")
    )
    second = next(c for c in EVERY if c.number.name.endswith("_PARTS[1]") and c.factor < 1.0)
    before = race.PATIENCE, vars(first_steps)["_PARTS"]
    with ablation.moved([steps, kept, second]):
        assert pytest.approx(1.3 * before[0], rel=1e-12) == race.PATIENCE
        assert rivals.PATIENCE == race.PATIENCE
        factors = [a / b for a, b in zip(vars(first_steps)["_PARTS"], before[1], strict=True)]
        np.testing.assert_allclose(factors, [1.3, 0.7, 1.0], rtol=1e-12)
    assert before == (race.PATIENCE, vars(first_steps)["_PARTS"])


def test_functions_of_search_and_decision_hold_no_number_of_their_own():
    """What is no index, dimension or part of a formula is a constant, and moved."""
    # 5: of the golden angle; 64: kept answers; 100: percent
    plain = {-1, 0, 1, 2, 3, 5, 6, 64, 100, 0.5}
    found = set()
    for path in sorted(
        path
        for folder in ablation.FOLDERS
        for path in (Path(gap.__file__).parent / folder).glob("*.py")
    ):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        of_module = {
            node
            for own in tree.body
            if isinstance(own, ast.Assign | ast.AnnAssign)
            for node in ast.walk(own)
        }
        found |= {
            (path.name, node.value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Constant)
            and isinstance(node.value, int | float)
            and node not in of_module
            and node.value not in plain
        }
    assert not found


def test_search_and_decision_have_few_numbers():
    """Forty together: each is one more thing that nobody can tell from another arm."""
    assert len({change.number for change in EVERY}) <= 40
