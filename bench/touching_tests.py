"""Which tests touch a line, from a coverage database with contexts, and how long they take."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from pathlib import Path

from coverage import CoverageData


def reach(source: str, line: int) -> range:
    """Lines of the innermost statement: only the head of a block, but all of a function."""
    statements = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.stmt))
    around = (node for node in statements if node.lineno <= line <= node.end_lineno)
    inner = max(around, key=lambda node: node.lineno)
    if getattr(inner, "body", None) and not isinstance(inner, ast.FunctionDef):
        return range(inner.lineno, max(inner.body[0].lineno, line + 1))
    return range(inner.lineno, inner.end_lineno + 1)


class Tests:
    """Which tests touch a line, and how long each takes."""

    def __init__(self, coverage: str, durations: str) -> None:
        self.data = CoverageData(coverage)
        self.data.read()
        self.seconds = defaultdict(float)
        rows = re.findall(r"(?m)^([\d.]+)s \w+ +([^\[\s]+)", Path(durations).read_text())
        for took, test in rows:
            self.seconds[test] += float(took)
            self.seconds[test.partition("::")[0]] += float(took)

    def touching(self, module: str, lines: range) -> set[str]:
        path = next((f for f in self.data.measured_files() if f.endswith("/" + module)), "")
        by_line = self.data.contexts_by_lineno(path)
        contexts = {c for line in lines for c in by_line.get(line, ())}
        if "" in contexts:  # on import: every test of the module may tell
            contexts = {c for of_line in by_line.values() for c in of_line}
        contexts = {c for c in contexts if c.startswith("tests/")}
        # What a fixture did, every test of its file may look at.
        files = {c.partition("::")[0] for c in contexts if c.endswith("|setup")}
        single = {re.match(r"[^\[|]+", c)[0] for c in contexts}
        return files | {test for test in single if test.partition("::")[0] not in files}

    def chosen(self, module: str, lines: range, budget_s: float) -> list[str]:
        near = f"tests/{Path(module).parent}/"
        ordered = sorted(
            self.touching(module, lines),
            key=lambda test: (not test.startswith(near), self.seconds[test], test),
        )
        kept, total_s = [], 0.0
        for test in ordered:
            total_s += self.seconds[test]
            if not kept or total_s <= budget_s:
                kept.append(test)
        return kept
