"""Numbers of search and decision moved together, and the ones that matter found."""

import ast
from pathlib import Path

import ablation
import numpy as np
import pytest

from armodal.analyzer import gap
from armodal.analyzer.gap.search import race, rivals

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
    found = EVERY[7 :: len(EVERY) // 3][:count]
    lines = told(0, found)
    own = ablation.Ablation(lines, EVERY)
    assert [c for c in EVERY if own.alike(c, 0) is False] == found
    assert [c for c in EVERY if own.alike(c, 0)] == [c for c in EVERY if c not in found]
    # Two for each halving, five or six of which lead to one of thirty; then the first three.
    assert len(lines) <= 3 + count * 2 * 5
    assert own.only_together([0]) == 0


def test_a_change_that_was_found_often_is_not_looked_for_again():
    found, lines = EVERY[5], []
    for case in range(ablation.ENOUGH):
        lines = told(case, [found], cases=lines)
    before = len(lines)
    lines = told(ablation.ENOUGH, [found], cases=lines)
    assert len(lines) == before + 3
    assert ablation.Ablation(lines, EVERY).alike(found, ablation.ENOUGH) is None


def test_numbers_are_moved_at_once_and_put_back():
    steps, kept = (
        next(c for c in EVERY if c.number.constant == name and c.factor > 1.0)
        for name in ("PATIENCE", "_PARTS")
    )
    second = next(c for c in EVERY if c.number.name.endswith("_PARTS[1]") and c.factor < 1.0)
    before = race.PATIENCE, vars(rivals)["_PARTS"]
    with ablation.moved([steps, kept, second]):
        assert pytest.approx(1.3 * before[0], rel=1e-12) == race.PATIENCE
        assert rivals.PATIENCE == race.PATIENCE
        factors = [a / b for a, b in zip(vars(rivals)["_PARTS"], before[1], strict=True)]
        np.testing.assert_allclose(factors, [1.3, 0.7, 1.0], rtol=1e-12)
    assert before == (race.PATIENCE, vars(rivals)["_PARTS"])


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
