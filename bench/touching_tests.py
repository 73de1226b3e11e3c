"""Which tests touch a line, from a coverage database with contexts, and how long they take."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from pathlib import Path

from coverage import CoverageData


def reach(source: str, line: int) -> range:
    """Lines of the innermost statement: only the head of a block, but all of a function."""
    spans = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.stmt):
            first = min(d.lineno for d in (node, *getattr(node, "decorator_list", ())))
            last = node.end_lineno
            if getattr(node, "body", None) and not isinstance(node, ast.FunctionDef):
                last = max(first, node.body[0].lineno - 1)
            spans.append(range(first, last + 1))
    return max((span for span in spans if line in span), key=lambda span: span.start)


class Tests:
    """Which tests touch a line, and how long each takes."""

    def __init__(self, coverage: str, durations: str) -> None:
        self.data = CoverageData(coverage)
        self.data.read()
        printed = Path(durations).read_text()
        # What fails without a change says nothing of one.
        self.failing = set(re.findall(r"(?m)^(?:FAILED|ERROR) ([^\[\s]+)", printed))
        self.seconds = defaultdict(float)
        rows = re.findall(r"(?m)^([\d.]+)s \w+ +([^\[\s]+)", printed)
        for took, test in rows:
            self.seconds[test] += float(took)

    def touching(self, module: str, lines: range) -> set[str]:
        path = next((f for f in self.data.measured_files() if f.endswith("/" + module)), "")
        by_line = self.data.contexts_by_lineno(path)
        contexts = {c for line in lines for c in by_line.get(line, ())}
        if "" in contexts:  # on import: every test of the module may tell
            contexts = {c for of_line in by_line.values() for c in of_line}
        touching = {re.match(r"[^\[|]*", context)[0] for context in contexts}
        # What a fixture did, every test of its file may look at.
        files = {c.partition("::")[0] for c in contexts if c.endswith("|setup")}
        beside = {test for test in self.seconds if test.partition("::")[0] in files}
        return {t for t in touching | beside if t.startswith("tests/")} - self.failing

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
