"""Places where a program may be changed, and a random sample of changes."""

from __future__ import annotations

import ast
import random
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

# An operator is replaced by one of its own kind: others end in a TypeError, which tells nothing.
KINDS = (
    {"Add", "Sub", "Mul", "Div", "FloorDiv", "Mod", "Pow"},
    {"BitAnd", "BitOr", "BitXor", "LShift", "RShift"},
    {"Eq", "NotEq", "Lt", "LtE", "Gt", "GtE"},
    {"Is", "IsNot"},
    {"UAdd", "USub"},
)
# They guard against a programmer's slip, and change nothing where there is none.
GUARDS = {"strict", "frozen", "slots", "kw_only"}


@dataclass(frozen=True)
class Mutant:
    """One change: the `occurrence`-th place in the module where the operator applies."""

    module: str
    line: int
    column: int
    operator: str
    occurrence: int

    def source(self, original: str) -> str:
        return mutate_code(original, get_operator(self.operator)(), self.occurrence)


def operators() -> dict[str, object]:
    chosen = {}
    for name in operator_names():
        pair = set(name.split("_")[1:])
        if not pair or "Delete" in pair or any(pair <= kind for kind in KINDS):
            operator = get_operator(name)
            if not operator.arguments():
                chosen[name] = operator()
    return chosen


def mute(source: str) -> list[tuple]:
    """Begin and end of each type annotation and guard."""
    nodes = list(ast.walk(ast.parse(source)))
    found = [getattr(node, name, None) for node in nodes for name in ("annotation", "returns")]
    found += [n for n in nodes if isinstance(n, ast.keyword) and n.arg in GUARDS]
    return [
        ((node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset))
        for node in found
        if node is not None
    ]


def places(module: str, source: str) -> dict[tuple, list[Mutant]]:
    """Mutants by place and kind of change, except those of type annotations and guards."""
    every = list(ast_nodes(get_ast(source)))
    stars = [n for n in every if n.type == "operator" and n.parent.type == "parameters"]
    left_out = mute(source) + [(star.start_pos, star.end_pos) for star in stars]
    found = defaultdict(list)
    for name, operator in operators().items():
        starts = [start for node in every for start, _ in operator.mutation_positions(node)]
        for occurrence, start in enumerate(starts):
            if not any(first <= start < last for first, last in left_out):
                kind = name.split("_")[0]
                found[start, kind].append(Mutant(module, *start, name, occurrence))
    return found


def drawn(rng: random.Random, root: Path, package: str, size: int, without: list[str]):
    """As many places at random, of each module its share, and one mutant at random of each."""
    modules = sorted(str(path.relative_to(root)) for path in (root / package).glob("*.py"))
    found = {m: places(m, (root / m).read_text()) for m in modules if m not in without}
    total = sum(map(len, found.values()))
    mutants = sum(len(of_place) for of_module in found.values() for of_place in of_module.values())
    print(f"{package}: {mutants} mutants at {total} places, {min(size, total)} drawn")
    sample, share = [], 0.0
    for of_module in found.values():
        before, share = round(share), share + min(size, total) * len(of_module) / total
        chosen = sorted(rng.sample(sorted(of_module), round(share) - before))
        sample += [rng.choice(of_module[place]) for place in chosen]
    return sample
