"""Every number that describes an arm has a source: in `docs/gap-priors.md`, or in its own module.

A module names them in `SOURCES`, by the constant; the page has the others, each with its value.
Left out: numbers of a search (where it begins, how far it steps, how many it keeps).
"""

import ast
from importlib import import_module
from pathlib import Path

from armodal import analyzer

ROOT = Path(__file__).parents[3]
GAP = Path(analyzer.__file__).parent / "gap"
FILES = [GAP / "model" / "priors.py", *sorted((GAP / "effects").glob("*.py"))]
OF_A_SEARCH = {
    "_STEP",
    "_STEPS",
    "_ROUNDS",
    "_PARTS",
    "_ROTORS",
    "_LAGS",
    "_WRIST_FROM",
    "_UP",
    "FLOOR",
}


def numbers(node):
    """Sizes of the literals, in order; signs and roots are left out."""
    for part in ast.walk(node):
        if isinstance(part, ast.Constant) and type(part.value) in (int, float) and part.value:
            yield float(part.value)


def own_sources(path):
    """Sources that a module states itself, by the constant."""
    module = import_module(
        f"{analyzer.__name__}.{'.'.join(path.relative_to(GAP.parent).parts)[:-3]}"
    )
    return getattr(module, "SOURCES", {})


def of_code():
    for path in FILES:
        if path.stem.endswith("_candidates"):
            continue
        stated = own_sources(path)
        assert all(stated.values()), path.stem
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if not isinstance(node, ast.Assign):
                continue
            for target in node.targets:
                pairs = [(target, node.value)]
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = list(zip(target.elts, node.value.elts, strict=True))
                for name, value in pairs:
                    found = sorted(numbers(value))
                    is_number = isinstance(name, ast.Name) and name.id.lstrip("_").isupper()
                    left_out = OF_A_SEARCH | {"WORDS", "_SAID", "SOURCES"} | stated.keys()
                    if is_number and name.id not in left_out and found:
                        yield f"{path.stem}.{name.id}", found


def of_page():
    for line in (ROOT / "docs" / "gap-priors.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 4 and "." in cells[0]:
            assert cells[2], cells[0]
            assert cells[3], cells[0]
            yield cells[0], sorted(float(number) for number in cells[1].split())


def test_the_page_has_every_number_and_no_other():
    code, page = dict(of_code()), dict(of_page())
    assert {name for name in code if name not in page} == set()
    assert {name for name in page if name not in code} == set()


def test_the_page_has_the_values_of_the_code():
    code = dict(of_code())
    assert {name: values for name, values in of_page() if values != code[name]} == {}


def test_no_number_hides_in_a_parameter():
    """None and all of a part are no numbers of an arm."""
    hidden = [
        f"{path.name}:{part.lineno}"
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Parameter"
        for told in node.keywords
        for part in ast.walk(told.value)
        if isinstance(part, ast.Constant) and type(part.value) is float
        if part.value not in (0.0, 1.0)
    ]
    assert hidden == []
