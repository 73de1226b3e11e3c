"""Places where a program may be changed, and a random sample of changes."""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType

# An operator is replaced by one of its own kind: others end in a TypeError, which tells nothing.
KINDS: tuple[tuple[type, ...], ...] = (
    (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow),
    (ast.BitAnd, ast.BitOr, ast.BitXor, ast.LShift, ast.RShift),
    (ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE),
    (ast.Is, ast.IsNot),
    (ast.In, ast.NotIn),
    (ast.And, ast.Or),
    (ast.UAdd, ast.USub),
    (ast.Break, ast.Continue),
)
# They guard against a programmer's slip, and change nothing where there is none.
GUARDS = {"strict", "frozen", "slots", "kw_only"}


@dataclass(frozen=True)
class Mutant:
    """One change of one node: the `place`-th of the module's tree, walked from the top."""

    module: str
    line: int
    place: int
    change: str

    def code(self, source: str, path: str) -> CodeType:
        """The changed module, compiled."""
        tree = ast.parse(source)
        node = list(ast.walk(tree))[self.place]
        dict(changes(node))[self.change]()
        return compile(ast.fix_missing_locations(tree), path, "exec", dont_inherit=True)


def changes(node: ast.AST) -> Iterator[tuple[str, object]]:
    """What may be done to a node, by name; each call changes the node itself."""

    def put(field: str, value: object):
        return lambda: setattr(node, field, value)

    def turn(into: type):
        return lambda: setattr(node, "__class__", into)

    operator = getattr(node, "op", None)
    for other in _others(operator):
        yield f"{type(operator).__name__} to {other.__name__}", put("op", other())
    if isinstance(node, ast.Compare):
        for other in _others(node.ops[0]):
            name = f"{type(node.ops[0]).__name__} to {other.__name__}"
            yield name, put("ops", [other(), *node.ops[1:]])
    if isinstance(node, ast.Break | ast.Continue):
        for other in _others(node):
            yield f"{type(node).__name__} to {other.__name__}", turn(other)
    if isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield f"{node.value} to {not node.value}", put("value", not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        for by in (1, -1):
            yield f"number {by:+d}", put("value", node.value + by)
    if isinstance(node, ast.If | ast.While | ast.IfExp):
        yield "negate the condition", put("test", ast.UnaryOp(ast.Not(), node.test))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.Invert):
        yield "drop the unary operator", put("operand", ast.UnaryOp(node.op, node.operand))
    if isinstance(node, ast.For):
        yield "loop over nothing", put("iter", ast.List(elts=[], ctx=ast.Load()))
    if isinstance(node, ast.FunctionDef) and node.decorator_list:
        yield "drop the decorators", put("decorator_list", [])


def _others(operator: object) -> list[type]:
    return [
        other
        for kind in KINDS
        if type(operator) in kind
        for other in kind
        if other is not type(operator)
    ]


def _mute(tree: ast.AST) -> set[int]:
    """Nodes of type annotations, guards and docstrings, by identity."""
    roots: list[ast.AST] = []
    for node in ast.walk(tree):
        roots += [part for name in ("annotation", "returns") if (part := getattr(node, name, None))]
        if isinstance(node, ast.keyword) and node.arg in GUARDS:
            roots.append(node)
    return {id(inner) for root in roots for inner in ast.walk(root)}


def places(module: str, source: str) -> list[list[Mutant]]:
    """Mutants of each node that may be changed, except of type annotations and guards."""
    tree = ast.parse(source)
    mute = _mute(tree)
    found = []
    for place, node in enumerate(ast.walk(tree)):
        line = getattr(node, "lineno", None)
        if line is None or id(node) in mute:
            continue
        of_node = [Mutant(module, line, place, name) for name, _ in changes(node)]
        if of_node:
            found.append(of_node)
    return found


def drawn(
    rng: random.Random, root: Path, package: str, size: int, without: list[str]
) -> list[Mutant]:
    """As many places at random, of each module its share, and one mutant at random of each."""
    modules = sorted(str(path.relative_to(root)) for path in (root / package).glob("*.py"))
    found = {m: places(m, (root / m).read_text()) for m in modules if m not in without}
    total = sum(map(len, found.values()))
    mutants = sum(len(of_place) for of_module in found.values() for of_place in of_module)
    print(f"{package}: {mutants} mutants at {total} places, {min(size, total)} drawn")
    sample, share = [], 0.0
    for of_module in found.values():
        before, share = round(share), share + min(size, total) * len(of_module) / total
        chosen = sorted(rng.sample(range(len(of_module)), round(share) - before))
        sample += [rng.choice(of_module[index]) for index in chosen]
    return sample
