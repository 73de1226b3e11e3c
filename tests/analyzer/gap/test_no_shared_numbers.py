"""No number that describes a real arm stands in the analyzer and in a maker of test data.

Which numbers count. Of an effect: what its priors (`Parameter`) and its equations (functions that
take an assembly, and what they call) are made of in `analyzer/gap/effects`; in `hil_sim` all that
its files, its function and that function's constants hold. Of ordinary errors: the constants of
`model/priors.py`, and those in `hil_sim` whose names share a word that names a part or an error.
Thresholds of judgement and places where a search begins are none of an arm's properties.
Not counted, since they describe no arm: integers to ten (counts, indices), a half, powers of ten
(units, steps of differences), and what a number is multiplied by to change its unit.
"""

import ast
import itertools
import math
from pathlib import Path

import pytest

from armodal import analyzer, hil_sim

ANALYZER, SIMULATOR = (Path(package.__file__).parent for package in (analyzer, hil_sim))
EFFECTS = ANALYZER / "gap" / "effects"
PRIORS = ANALYZER / "gap" / "model" / "priors.py"
ORDINARY = [
    SIMULATOR / "study" / "model_error.py",
    SIMULATOR / "study" / "nuisances.py",
    SIMULATOR / "makers" / "frame" / "everyday.py",
    SIMULATOR / "makers" / "mujoco" / "ordinary.py",
]
MAKERS = sorted((SIMULATOR / "study").glob("hide_*.py"))
# By a word of a prior's name: the words of constants that tell the same of an arm.
SAME = {
    "bearing": {"bearing", "weak"},
    "loss": {"loss"},
    "floor": {"base", "floor", "plate"},
    "bend": {"link", "shell"},
    "delay": {"delay"},
    "place": {"point", "blow"},
}


def counts(value):
    if value in range(11) or value == 0.5:
        return False
    return not math.log10(abs(value)).is_integer()


def literals(tree):
    for node in ast.walk(tree):
        value = getattr(node, "value", None)
        if isinstance(node, ast.Constant) and type(value) in (int, float) and counts(value):
            yield float(value)


def parsed(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def constants(tree):
    """Names of a module's constants, and what they are made of."""
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            for target in targets:
                pairs = [(target, node.value)]
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = list(zip(target.elts, node.value.elts, strict=True))
                yield from ((t.id, v) for t, v in pairs if isinstance(t, ast.Name))


def of_maker(path, name):
    """Numbers of a function of that name and of the constants it uses."""
    tree = parsed(path)
    known = dict(constants(tree))
    for function in tree.body:
        if isinstance(function, ast.FunctionDef) and function.name == name:
            yield from literals(function)
            for used in ast.walk(function):
                if isinstance(used, ast.Name) and used.id in known:
                    yield from literals(known[used.id])


def of_priors_and_equations(path):
    """Numbers of `Parameter(...)` and of what adds terms, constants and helpers followed."""
    tree = parsed(path)
    known = dict(constants(tree)) | {f.name: f for f in tree.body if isinstance(f, ast.FunctionDef)}
    waiting = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Parameter":
            waiting += [told.value for told in node.keywords if told.arg != "start"]
        elif isinstance(node, ast.FunctionDef) and "assembly" in {a.arg for a in node.args.args}:
            waiting.append(node)
    seen = set()
    while waiting:
        node = waiting.pop()
        yield from literals(node)
        for used in ast.walk(node):
            if isinstance(used, ast.Name) and used.id in known and used.id not in seen:
                seen.add(used.id)
                waiting.append(known[used.id])


def of_simulator(name):
    own = [*SIMULATOR.glob(f"effects/{name}.py"), *SIMULATOR.glob(f"makers/*/effects/{name}.py")]
    found = set(itertools.chain(*(literals(parsed(path)) for path in own)))
    return found | set(itertools.chain(*(of_maker(path, name) for path in MAKERS)))


NAMES = sorted(path.stem for path in EFFECTS.glob("*.py") if of_simulator(path.stem))


def test_effects_of_both_sides_are_seen():
    assert len(NAMES) > 25
    assert {0.25, 0.38} <= of_simulator("link_axis")


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_has_no_number_of_its_maker(name):
    ours = set(of_priors_and_equations(EFFECTS / f"{name}.py"))
    assert not ours & of_simulator(name)


@pytest.mark.parametrize("source", ORDINARY, ids=lambda path: path.stem)
def test_a_prior_has_no_number_of_what_is_drawn(source):
    drawn = [(set(n.lower().split("_")), set(literals(v))) for n, v in constants(parsed(source))]
    for name, value in constants(parsed(PRIORS)):
        ours = set(name.lower().split("_"))
        words = set(itertools.chain(*(SAME.get(word, ()) for word in ours)))
        for theirs, numbers in drawn:
            if words & theirs and ("loss" in ours) == ("loss" in theirs):
                assert not set(literals(value)) & numbers, (name, theirs)
