"""No module of the gap workflow outside `effects/` knows an effect by name."""

import ast
import importlib
import pkgutil
from pathlib import Path

import pytest

from armodal.analyzer import gap
from armodal.analyzer.gap import effects
from armodal.analyzer.gap.model.effect import EffectWords

FOLDER = Path(gap.__file__).parent
EFFECTS = {
    module.name: importlib.import_module(f"{effects.__name__}.{module.name}")
    for module in pkgutil.iter_modules(effects.__path__)
}
HOOKS = ("instances", "laws", "linear_candidates", "channel_candidates")
# Modules that hold an effect or look for one; the others are what effects share.
OWN = {name for name, module in EFFECTS.items() if any(hasattr(module, hook) for hook in HOOKS)}
NAMES = {
    words.name
    for module in EFFECTS.values()
    for words in vars(module).values()
    if isinstance(words, EffectWords)
}
# Words that mean something else too: a parameter every model has, the user's own direction.
OTHERWISE = {("derivatives.py", "delay"), ("ordinary.py", "delay"), ("lines.py", "hit_direction")}
SOURCES = sorted(p for p in FOLDER.rglob("*.py") if p.parent.name != "effects")


def test_effects_are_seen():
    assert {"coupling", "link_axis", "microslip"} <= OWN
    assert {"coupling", "link_axis", "flipped_axis"} <= NAMES
    assert len(SOURCES) > 30


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_it_names_no_effect(source):
    tree = ast.parse(source.read_text(encoding="utf-8"))
    imported, named = set(), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            *_, last = node.module.split(".")
            imported |= {last} if ".effects." in f".{node.module}." else set()
            imported |= {alias.name for alias in node.names if last == "effects"}
        if isinstance(node, ast.Constant) and node.value in NAMES:
            named.add(node.value)
    assert not imported & OWN
    assert not {name for name in named if (source.name, name) not in OTHERWISE}
