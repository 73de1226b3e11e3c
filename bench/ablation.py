"""What each number of the gap workflow's search and decision changes, moved by 30 % either way.

Every number of a module's constants in `analyzer/gap/search` and `analyzer/gap/decision` is moved
alone, and the same cases of a maker are judged again. A number is deleted where no verdict and no
name changes, explained where many do. One line of JSON a case and number is kept: a run that was
stopped goes on where it was. A table of the numbers ends it.

    python bench/ablation.py --out FOLDER --maker frame --nulls 50 --effects 50
    python bench/ablation.py --list
"""

from __future__ import annotations

import argparse
import ast
import math
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from itertools import product
from multiprocessing import get_context
from pathlib import Path
from types import ModuleType
from typing import Any

from armodal.analyzer import gap
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.makers import MAKERS, CaseSpec, case_of, draw_cases
from armodal.study.kept_lines import Line, kept_lines, run_and_keep

FOLDERS = ("search", "decision")
WAYS = (0.7, 1.3)
AS_IT_IS = "as it is"


@dataclass(frozen=True, slots=True, kw_only=True)
class Number:
    """A number of a constant; `place` counts within a tuple."""

    module: str
    constant: str
    place: int | None
    value: float

    @property
    def name(self) -> str:
        """Return what a line of the file says."""
        where = "" if self.place is None else f"[{self.place}]"
        return f"{self.module.rpartition('.gap.')[2]}.{self.constant}{where}"


def numbers() -> Iterator[Number]:
    """Give every number of a constant of the folders, but for limits without an end."""
    root = Path(gap.__file__).parent
    for path in sorted(p for folder in FOLDERS for p in (root / folder).glob("*.py")):
        module = f"{gap.__name__}.{path.parent.name}.{path.stem}"
        for constant in _constants(ast.parse(path.read_text(encoding="utf-8"))):
            value = getattr(import_module(module), constant)
            values = value if isinstance(value, tuple) else (value,)
            for place, one in enumerate(values):
                is_number = isinstance(one, int | float) and not isinstance(one, bool)
                if is_number and one and math.isfinite(one):
                    at = place if isinstance(value, tuple) else None
                    yield Number(module=module, constant=constant, place=at, value=float(one))


def _constants(tree: ast.Module) -> Iterator[str]:
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                parts = target.elts if isinstance(target, ast.Tuple) else [target]
                yield from (p.id for p in parts if isinstance(p, ast.Name) and _is_constant(p.id))


def _is_constant(name: str) -> bool:
    return name.isupper() and not name.startswith("__")


@contextmanager
def moved(number: Number, factor: float) -> Iterator[None]:
    """Move a number in its module, and wherever another has taken it from there."""
    home = import_module(number.module)
    before = getattr(home, number.constant)
    after = _times(before, number.place, factor)
    holders = [home]
    if not number.constant.startswith("_"):
        holders = [
            module
            for name, module in list(sys.modules.items())
            if name.startswith(gap.__name__) and getattr(module, number.constant, None) is before
        ]
    _put(holders, number.constant, after)
    try:
        yield
    finally:
        _put(holders, number.constant, before)


def _put(holders: list[ModuleType], constant: str, value: object) -> None:
    for module in holders:
        setattr(module, constant, value)


def _times(value: Any, place: int | None, factor: float) -> Any:
    """A whole number stays whole and moves by one at least; none goes below one."""
    if place is not None:
        return tuple(_times(v, None, factor) if i == place else v for i, v in enumerate(value))
    if isinstance(value, int):
        step = max(round(abs(factor - 1.0) * value), 1)
        return max(value + int(math.copysign(step, factor - 1.0)), 1)
    return value * factor


def judged(number: Number | None, factor: float, spec: CaseSpec) -> Line:
    """Judge one case with a number moved, or with all as they are."""
    session = case_of(spec).session()
    told: Callable[[], Any] = partial(find_gap, session, gates=False, modes=False, advice=False)
    if number is None:
        result = told().result
    else:
        with moved(number, factor):
            result = told().result
    return {
        "number": AS_IT_IS if number is None else number.name,
        "factor": factor,
        "case": spec.number,
        "key": f"{number.name if number else AS_IT_IS} {factor} {spec.seed}",
        "verdict": result.verdict.value,
        "named": sorted(effect.name for effect in result.effects),
        "right": sorted(spec.kinds) == sorted(effect.name for effect in result.effects),
    }


def table(lines: list[Line]) -> list[str]:
    """A row a number: how many verdicts change either way, and how many names become wrong."""
    plain = {line["case"]: line for line in lines if line["number"] == AS_IT_IS}
    rows = [f"{'number':44} {'factor':>6} {'cases':>5} {'changed':>7} {'lost':>4} {'won':>3}"]
    for name, factor in sorted({(x["number"], x["factor"]) for x in lines} - {(AS_IT_IS, 1.0)}):
        pairs = [
            (plain[x["case"]], x)
            for x in lines
            if x["number"] == name and x["factor"] == factor and x["case"] in plain
        ]
        changed = sum((a["verdict"], a["named"]) != (b["verdict"], b["named"]) for a, b in pairs)
        lost = sum(a["right"] and not b["right"] for a, b in pairs)
        won = sum(b["right"] and not a["right"] for a, b in pairs)
        rows.append(f"{name:44} {factor:6.1f} {len(pairs):5} {changed:7} {lost:4} {won:3}")
    return rows


def main() -> int:
    """Judge what is not yet in the file, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--list", action="store_true", help="print the numbers alone")
    parser.add_argument("--out", type=Path, help="folder of the file of lines")
    parser.add_argument("--maker", choices=MAKERS, default="frame")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--nulls", type=int, default=50)
    parser.add_argument("--effects", type=int, default=50)
    parser.add_argument("--only", nargs="*", default=[], help="numbers whose names hold a word")
    parser.add_argument("--workers", type=int, default=1)
    wanted = parser.parse_args()
    every = [n for n in numbers() if not wanted.only or any(w in n.name for w in wanted.only)]
    if wanted.list or wanted.out is None:
        print("\n".join(f"{n.name:50} {n.value:g}" for n in every))
        print(f"{len(every)} numbers; --out FOLDER judges cases with each moved")
        return 0
    specs = draw_cases(wanted.maker, wanted.seed, nulls=wanted.nulls, effects=wanted.effects)
    jobs: list[tuple[Number | None, float, CaseSpec]] = [(None, 1.0, spec) for spec in specs]
    jobs += [(n, factor, spec) for n, factor, spec in product(every, WAYS, specs)]
    wanted.out.mkdir(parents=True, exist_ok=True)
    path = wanted.out / f"ablation-{wanted.maker}-{wanted.seed}.jsonl"
    lines = kept_lines(path, "key")
    done = {line["key"] for line in lines}
    waiting = [
        (n, factor, spec)
        for n, factor, spec in jobs
        if f"{n.name if n else AS_IT_IS} {factor} {spec.seed}" not in done
    ]
    # Started afresh: a worker must hold the numbers of the files, whatever its parent moved.
    with ProcessPoolExecutor(wanted.workers, mp_context=get_context("spawn")) as executor:
        run_and_keep(path, executor, judged, waiting, lines.append)
    print("\n".join(table(lines)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
