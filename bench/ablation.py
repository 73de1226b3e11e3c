"""What each number of the gap workflow's search and decision changes, moved by 30 % either way.

Every number of a module's constants in `analyzer/gap/search` and `analyzer/gap/decision` is moved
alone, and the same cases of a maker are judged again. A number is deleted where no verdict and no
name changes, explained where many do. Cases as they are come first, with every number traced
(`traced_number.py`): a change that could have changed nothing in one is not run there. One line of
JSON a case and number is kept: a run that was stopped goes on where it was. A table of the numbers
ends it.

    python bench/ablation.py --out FOLDER --maker frame --nulls 50 --effects 50
    python bench/ablation.py --list
"""

from __future__ import annotations

import argparse
import ast
import math
import sys
from collections.abc import Callable, Iterator, Sequence
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

from traced_number import TracedNumber

from armodal.analyzer import gap
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.makers import MAKERS, CaseSpec, case_of, draw_cases
from armodal.study.kept_lines import Line, kept_lines, run_and_keep

FOLDERS = ("search", "decision")
WAYS = (0.7, 1.3)
AS_IT_IS = "as it is"

Job = tuple["Number | None", float, CaseSpec]


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
    before, holders = _held(number)
    _put(holders, number.constant, _times(before, number.place, factor))
    try:
        yield
    finally:
        _put(holders, number.constant, before)


@contextmanager
def traced(every: Sequence[Number]) -> Iterator[set[str]]:
    """Trace numbers; gives the names of changes (`change`) that could have mattered so far."""
    noted: set[str] = set()
    before = {(n.module, n.constant): _held(n) for n in every}
    values = {key: own for key, (own, _) in before.items()}
    for n in every:
        own, key = before[n.module, n.constant][0], (n.module, n.constant)
        plain = own if n.place is None else own[n.place]
        changed = {change(n, factor): _times(plain, None, factor) for factor in WAYS}
        number = TracedNumber(plain, changed, noted)
        if n.place is None:
            values[key] = number
        else:
            values[key] = tuple(number if i == n.place else v for i, v in enumerate(values[key]))
    for (module, constant), (_, holders) in before.items():
        _put(holders, constant, values[module, constant])
    try:
        yield noted
    finally:
        for (_, constant), (own, holders) in before.items():
            _put(holders, constant, own)


def change(number: Number, factor: float) -> str:
    """Name a change."""
    return f"{number.name} {factor}"


def _held(number: Number) -> tuple[Any, list[ModuleType]]:
    """What a constant is, and the modules that have it."""
    home = import_module(number.module)
    before = getattr(home, number.constant)
    if number.constant.startswith("_"):
        return before, [home]
    everywhere = [
        module
        for name, module in list(sys.modules.items())
        if name.startswith(gap.__name__) and getattr(module, number.constant, None) is before
    ]
    return before, everywhere


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
    could_matter: list[str] = []
    if number is None:
        with traced(list(numbers())) as noted:
            result = told().result
        could_matter = sorted(noted)
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
        "could_matter": could_matter,
    }


def table(lines: list[Line]) -> list[str]:
    """A row a change: cases it leaves alike, how many were run, and whose verdict it changes."""
    plain = {line["case"]: line for line in lines if line["number"] == AS_IT_IS}
    told = ("cases", "alike", "run", "changed", "lost", "won")
    rows = [f"{'number':44} {'factor':>6} " + " ".join(f"{word:>7}" for word in told)]
    for n, factor in product(numbers(), WAYS):
        name = n.name
        alike = sum(change(n, factor) not in line["could_matter"] for line in plain.values())
        pairs = [
            (plain[x["case"]], x)
            for x in lines
            if x["number"] == name and x["factor"] == factor and x["case"] in plain
        ]
        changed = sum((a["verdict"], a["named"]) != (b["verdict"], b["named"]) for a, b in pairs)
        lost = sum(a["right"] and not b["right"] for a, b in pairs)
        won = sum(b["right"] and not a["right"] for a, b in pairs)
        counts = (len(plain), alike, len(pairs), changed, lost, won)
        rows.append(f"{name:44} {factor:6.1f} " + " ".join(f"{count:7}" for count in counts))
    return rows


def _waiting(jobs: Sequence[Job], lines: Sequence[Line]) -> list[Job]:
    """Jobs of which no line is kept."""
    done = {line["key"] for line in lines}
    return [
        (n, factor, spec)
        for n, factor, spec in jobs
        if f"{n.name if n else AS_IT_IS} {factor} {spec.seed}" not in done
    ]


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
    wanted.out.mkdir(parents=True, exist_ok=True)
    path = wanted.out / f"ablation-{wanted.maker}-{wanted.seed}.jsonl"
    lines = kept_lines(path, "key")
    as_it_is: list[Job] = [(None, 1.0, spec) for spec in specs]
    # Started afresh: a worker must hold the numbers of the files, whatever its parent moved.
    with ProcessPoolExecutor(wanted.workers, mp_context=get_context("spawn")) as executor:
        run_and_keep(path, executor, judged, _waiting(as_it_is, lines), lines.append)
        could = {x["case"]: set(x["could_matter"]) for x in lines if x["number"] == AS_IT_IS}
        # Case by case: a run that is stopped has told all of some cases.
        jobs = [
            (n, factor, spec)
            for spec, n, factor in product(specs, every, WAYS)
            if change(n, factor) in could[spec.number]
        ]
        run_and_keep(path, executor, judged, _waiting(jobs, lines), lines.append)
    print("\n".join(table(lines)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
