"""What a maker hides is marked by its name: the gap library has it, or the maker says not."""

import importlib
import pkgutil

import pytest

from armodal.analyzer.gap.library import title_of
from armodal.hil_sim.makers import MAKERS


@pytest.mark.parametrize("maker", MAKERS)
def test_what_the_library_lacks_is_marked_as_outside_of_it(maker):
    package = importlib.import_module(f"armodal.hil_sim.makers.{maker}.effects")
    modules = [
        importlib.import_module(f"{package.__name__}.{m.name}")
        for m in pkgutil.iter_modules(package.__path__)
    ]
    outside = {m.__name__.rpartition(".")[2]: getattr(m, "OUTSIDE", False) for m in modules}
    known = {name for name in outside if title_of(name) != name}
    assert known
    assert {name for name, marked in outside.items() if not marked} == known
