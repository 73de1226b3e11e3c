"""No number that describes a real arm stands in the analyzer and in a maker of test data.

Which numbers count. Of an effect: what its priors (`Parameter`) and its equations (functions that
take an assembly, and what they call) are made of in `analyzer/gap/effects`; in `hil_sim` all that
the files hold which make it. Of ordinary errors: the constants of `model/priors.py`, and those in
`hil_sim` whose names share a word that names a part or an error. Makers have none in common either.
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
DISCREPANCY = ANALYZER / "gap" / "model" / "weigh.py"
# What repeating a session is taken to change, by which makers tell how far an effect stands out.
YARDSTICKS = {
    SIMULATOR / "study" / "prominence.py": ("LINE", "CHANNEL"),
    SIMULATOR / "makers" / "mujoco" / "standing.py": ("LOCAL", "OF_CHANNEL"),
    SIMULATOR / "makers" / "frame" / "visibility.py": ("OWN_SCATTER", "OTHER_SCATTER"),
}
# By a word of a prior's name: the words of constants that tell the same of an arm.
SAME = {
    "bearing": {"bearing", "weak", "tilt"},
    "loss": {"loss"},
    "floor": {"base", "floor", "plate"},
    "bend": {"bend", "link", "shell"},
    "relaxing": {"stiffer", "slow", "fast"},
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


def locals_of(tree):
    """Names that functions give to something, and what it is made of."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            yield node.targets[0].id, node.value


def of_priors_and_equations(path):
    """Numbers of `Parameter(...)` and of what adds terms, constants and helpers followed."""
    tree = parsed(path)
    known = dict(locals_of(tree)) | dict(constants(tree))
    known |= {f.name: f for f in tree.body if isinstance(f, ast.FunctionDef)}
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


def effects_of(path):
    """Names of the effects that a file of `hil_sim/effects` makes."""
    yield path.stem
    for name, value in constants(parsed(path)):
        if name in {"HIDES", "OF_FILE", "COMPARED"} and isinstance(value, ast.Dict):
            yield from (key.value for key in value.keys if isinstance(key, ast.Constant))


def by_effect(paths, names=lambda path: [path.stem]):
    """Of each effect, the numbers of the files that make it."""
    found = {}
    for path in paths:
        for name in names(path):
            found[name] = found.get(name, set()) | set(literals(parsed(path)))
    return found


MAKERS = {
    "home": by_effect(SIMULATOR.glob("effects/*.py"), effects_of),
    "frame": by_effect(SIMULATOR.glob("makers/frame/effects/*.py")),
    "mujoco": by_effect(SIMULATOR.glob("makers/mujoco/effects/*.py")),
}


def of_simulator(name):
    return set().union(*(numbers.get(name, ()) for numbers in MAKERS.values()))


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


@pytest.mark.parametrize("name", sorted(set().union(*MAKERS.values())))
def test_no_two_makers_have_a_number_of_an_effect_in_common(name):
    for one, other in itertools.combinations(MAKERS.values(), 2):
        assert not one.get(name, set()) & other.get(name, set())


def test_no_two_makers_draw_what_is_ordinary_between_the_same_bounds():
    of_each = [
        {(words, number) for n, v in constants(parsed(path)) for words, number in tagged(n, v)}
        for path in ORDINARY
    ]
    for one, other in itertools.combinations(of_each, 2):
        assert not one & other


def tagged(name, value):
    """What part of an arm or error a constant is of, with each of its numbers."""
    own = set(name.lower().split("_"))
    for word, same in SAME.items():
        if same & own and ("loss" in own) == (word == "loss"):
            yield from ((word, number) for number in literals(value))


def test_what_a_maker_calls_seen_is_not_what_the_analyzer_believes_of_a_right_model():
    classes = [n for n in parsed(DISCREPANCY).body if getattr(n, "name", "") == "Discrepancy"]
    fields = (field for c in classes for field in c.body if isinstance(field, ast.AnnAssign))
    # A hundredth counts here.
    ours = {node.value for f in fields for node in ast.walk(f.value) if hasattr(node, "value")}
    assert len(ours) == 4
    for path, names in YARDSTICKS.items():
        told = dict(constants(parsed(path)))
        theirs = [told[name] for name in names]
        assert not ours & {
            n.value for value in theirs for n in ast.walk(value) if hasattr(n, "value")
        }
