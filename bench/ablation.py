"""What each number of the gap workflow's search and decision changes, moved by 30 % either way.

The numbers are those of module constants in `analyzer/gap/search` and `analyzer/gap/decision`, and
the cases those of a maker. A case as it is comes first. Then all numbers are moved together, up in
half of the cases and down in the others by a coin of each: where verdict and names stay, all of
them are taken to change nothing in that case; where not, halves are moved, down to the number that
does it alone. Two that cancel each other in every case would be missed. A change that has been
found in three cases is not looked for in further ones. A rule whose numbers change no verdict and
no name is one to take out; conventions and sizes of the search should change none. One line of JSON
a run is kept: what was stopped goes on where it was. A table of the numbers ends it.

    python bench/ablation.py --out FOLDER --maker frame --nulls 50 --effects 50
    python bench/ablation.py --list
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import math
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from itertools import groupby, product
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
ENOUGH = 3
TOGETHER = 8  # cases of a round


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


@dataclass(frozen=True, slots=True)
class Change:
    """A number and what it is multiplied by."""

    number: Number
    factor: float

    @property
    def name(self) -> str:
        """Return what a line of the file says."""
        return f"{self.number.name} {self.factor}"


def changes() -> list[Change]:
    """Every number, either way."""
    return [Change(number, factor) for number, factor in product(numbers(), WAYS)]


@contextmanager
def moved(group: Sequence[Change]) -> Iterator[None]:
    """Move numbers in their modules, and wherever others have taken them from there."""
    before = {(c.number.module, c.number.constant): _held(c.number) for c in group}
    values = {key: own for key, (own, _) in before.items()}
    for c in group:
        key = c.number.module, c.number.constant
        values[key] = _times(values[key], c.number.place, c.factor)
    for (module, constant), (_, holders) in before.items():
        _put(holders, constant, values[module, constant])
    try:
        yield
    finally:
        for (_, constant), (own, holders) in before.items():
            _put(holders, constant, own)


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


def judged(group: Sequence[Change], spec: CaseSpec) -> Line:
    """Judge one case with numbers moved."""
    session = case_of(spec).session()
    try:
        with moved(group):
            result = find_gap(session, gates=False, modes=False, advice=False).result
        verdict, named = result.verdict.value, sorted(effect.name for effect in result.effects)
    except (ArithmeticError, ValueError) as error:  # a number out of its range
        verdict, named = "failed", [type(error).__name__]
    return {
        "key": key_of(group, spec.number),
        "case": spec.number,
        "moved": [change.name for change in group],
        "verdict": verdict,
        "named": named,
        "right": sorted(spec.kinds) == named,
    }


def key_of(group: Sequence[Change], case: int) -> str:
    return f"{case} {hash_of(' '.join(change.name for change in group))}"


def hash_of(text: str) -> str:
    """Return a short name of a text, the same in every process."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Ablation:
    """What lines say so far, and what is still to be run.

    `lines` are those of one maker and seed, in any order; `every` are the changes looked at.
    """

    lines: Sequence[Line]
    every: Sequence[Change]

    def waiting(self, case: int) -> list[tuple[Change, ...]]:
        """Return groups of a case that are to be run next; none once all of it is told.

        Cases of earlier rounds must have been told: what they found is not looked for here.
        """
        plain = self._line((), case)
        if plain is None:
            return [()]
        return list(self._waiting_of(self.first_group(case), case, plain))

    def first_group(self, case: int) -> tuple[Change, ...]:
        """Each number up or down, by a coin; what is known to matter is left out."""
        coin = {n: int(hash_of(f"{case} {n.name}"), 16) % 2 for n in {c.number for c in self.every}}
        return tuple(
            c
            for c in self.every
            if (c.factor > 1.0) == bool(coin[c.number])
            and self._found(c, before=case // TOGETHER * TOGETHER) < ENOUGH
        )

    def alike(self, change: Change, case: int) -> bool | None:
        """Whether a case is alike with a change alone; None where it was not looked at."""
        plain = self._line((), case)
        if plain is None:
            return None
        first = self.first_group(case)
        return self._alike_in(change, first, case, plain) if change in first else None

    def told(self, change: Change, case: int) -> tuple[Line, Line] | None:
        """A case as it is, and with a change alone; None where that was not run."""
        plain, own = self._line((), case), self._line((change,), case)
        return None if plain is None or own is None else (plain, own)

    def only_together(self, cases: Sequence[int]) -> int:
        """Count groups that change a case where neither of their halves does."""
        count = 0
        for case in cases:
            plain = self._line((), case)
            heap = [self.first_group(case)]
            while plain is not None and heap:
                group = heap.pop()
                line = self._line(group, case)
                if line is None or _same(line, plain) or len(group) == 1:
                    continue
                parts = [self._line(half, case) for half in _halves(group)]
                count += all(part is not None and _same(part, plain) for part in parts)
                heap.extend(_halves(group))
        return count

    def _found(self, change: Change, before: int) -> int:
        pairs = (self.told(change, case) for case in self._cases if case < before)
        return sum(pair is not None and not _same(*pair) for pair in pairs)

    def _waiting_of(
        self, group: tuple[Change, ...], case: int, plain: Line
    ) -> Iterator[tuple[Change, ...]]:
        line = self._line(group, case)
        if line is None:
            if group:
                yield group
        elif not _same(line, plain) and len(group) > 1:
            for half in _halves(group):
                yield from self._waiting_of(half, case, plain)

    def _alike_in(
        self, change: Change, group: tuple[Change, ...], case: int, plain: Line
    ) -> bool | None:
        line = self._line(group, case)
        if line is None:
            return None
        if _same(line, plain):
            return True
        if len(group) == 1:
            return False
        half = next(half for half in _halves(group) if change in half)
        return self._alike_in(change, half, case, plain)

    def _line(self, group: Sequence[Change], case: int) -> Line | None:
        return self._by_key.get(key_of(group, case))

    @cached_property
    def _by_key(self) -> dict[str, Line]:
        return {line["key"]: line for line in self.lines}

    @cached_property
    def _cases(self) -> list[int]:
        return sorted({line["case"] for line in self.lines})


def _halves(group: tuple[Change, ...]) -> tuple[tuple[Change, ...], tuple[Change, ...]]:
    half = len(group) // 2
    return group[:half], group[half:]


def _same(a: Line, b: Line) -> bool:
    return bool((a["verdict"], a["named"]) == (b["verdict"], b["named"]))


def table(lines: Sequence[Line], every: Sequence[Change]) -> list[str]:
    """A row a change: cases it was looked at in, those it changes, and right names lost and won."""
    told = Ablation(lines, every)
    cases = sorted({line["case"] for line in lines})
    words = ("cases", "changed", "lost", "won")
    rows = [f"{'number':44} {'factor':>6} " + " ".join(f"{word:>7}" for word in words)]
    for change in every:
        looked = [own for case in cases if (own := told.alike(change, case)) is not None]
        pairs = [pair for case in cases if (pair := told.told(change, case)) is not None]
        lost = sum(a["right"] and not b["right"] for a, b in pairs)
        won = sum(b["right"] and not a["right"] for a, b in pairs)
        counts = (len(looked), looked.count(False), lost, won)
        rows.append(
            f"{change.number.name:44} {change.factor:6.1f} "
            + " ".join(f"{count:7}" for count in counts)
        )
    rows.append(f"{told.only_together(cases)} groups change a case where neither half of them does")
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
    parser.add_argument("--workers", type=int, default=1)
    wanted = parser.parse_args()
    if wanted.list or wanted.out is None:
        print("\n".join(f"{n.name:50} {n.value:g}" for n in numbers()))
        print(f"{len(list(numbers()))} numbers; --out FOLDER judges cases with each moved")
        return 0
    drawn = draw_cases(wanted.maker, wanted.seed, nulls=wanted.nulls, effects=wanted.effects)
    specs = sorted(drawn, key=lambda spec: spec.number)
    wanted.out.mkdir(parents=True, exist_ok=True)
    path = wanted.out / f"ablation-{wanted.maker}-{wanted.seed}.jsonl"
    lines, every = kept_lines(path, "key"), changes()
    # Started afresh: a worker must hold the numbers of the files, whatever its parent moved.
    with ProcessPoolExecutor(wanted.workers, mp_context=get_context("spawn")) as executor:
        as_they_are = [
            ((), spec) for spec in specs if Ablation(lines, every).waiting(spec.number) == [()]
        ]
        run_and_keep(path, executor, judged, as_they_are, lines.append)
        for _, of_round in groupby(specs, lambda spec: spec.number // TOGETHER):
            own = [*of_round]
            while jobs := [(g, s) for s in own for g in Ablation(lines, every).waiting(s.number)]:
                run_and_keep(path, executor, judged, jobs, lines.append)
    print("\n".join(table(lines, every)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
