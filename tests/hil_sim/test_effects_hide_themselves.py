"""Nothing of a study knows an effect by name: each file hides and compares its own."""

import ast
from pathlib import Path

import pytest

from armodal import study as studies
from armodal.hil_sim import study
from armodal.hil_sim.study.catalogue import HIDES, LIBRARY, OUTSIDE, stand_apart

FOLDERS = [Path(package.__file__).parent for package in (study, studies)]
# Every arm has ordinary errors, which are tables of some of these kinds.
ORDINARY = {"model_error.py", "nuisances.py"}
# One hidden loss stands in place of all ordinary ones; a known mass is a payload; the arm's root.
OTHERWISE = {
    ("hiding.py", "hysteretic"),
    ("cases.py", "payload"),
    ("places.py", "base"),
    ("plant_of_arm.py", "base"),
    ("score.py", "base"),
}
SOURCES = sorted(p for own in FOLDERS for p in own.glob("*.py") if p.name not in ORDINARY)


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.name)
def test_it_names_no_effect(source):
    tree = ast.parse(source.read_text(encoding="utf-8"))
    named = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)} & {*HIDES}
    assert not {name for name in named if (source.name, name) not in OTHERWISE}


def test_each_is_in_the_library_or_outside_of_it():
    assert {"coupling", "servo", "absorber"} <= {*LIBRARY}
    assert {"dress_pack", "one_sided"} <= {*OUTSIDE}
    assert {*LIBRARY} | {*OUTSIDE} == {*HIDES}
    assert not {*LIBRARY} & {*OUTSIDE}


def test_what_stands_apart_is_known_and_does_so_both_ways():
    assert {name for own in HIDES.values() for name in own.apart_from} <= {*HIDES}
    assert stand_apart("rotor", "servo")
    assert stand_apart("servo", "rotor")
    assert stand_apart("payload", "payload")
    assert not stand_apart("payload", "rotor")
