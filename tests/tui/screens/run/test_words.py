"""Every reason of the judge has its word and its advice."""

import ast
from pathlib import Path

import pytest

import armodal.daq
from armodal.tui.screens.run.words import advice_for, reason_word

DAQ = Path(armodal.daq.__file__).parent


def reasons():
    """First arguments of what rejects, and of the pairs that are told in a loop."""
    found = set()
    for path in DAQ.glob("judge*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "reject":
                first = node.args[0]
                if isinstance(first, ast.Constant):
                    found.add(first.value)
    return sorted(found)


def test_the_judge_has_reasons():
    assert {"soft", "stuck", "swing", "late"} <= set(reasons())


@pytest.mark.parametrize("reason", [*reasons(), "double", "bounce"])
def test_the_operator_is_told_in_words(reason):
    assert advice_for(reason) != "Hit once more." or reason == "cut-off"
    assert reason_word(reason) != reason.upper() or reason in {"late", "cut-off"}
