"""Change a package at random places, one at a time, and see whether its tests notice.

`docs/mutation-testing.md` tells how it is called and what it found. A mutant lives in the memory
of a process of its own: no file is changed. It meets only tests that touch the changed line, those
of its package first, the quickest of them first. Mutants that OUT already holds are not run again:
delete their lines to judge them once more.
"""

from __future__ import annotations

import argparse
import importlib.machinery
import importlib.util
import json
import multiprocessing
import os
import random
import resource
import signal
import sys
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

import h5py  # noqa: F401 - loaded once for all, before processes part
import pinocchio  # noqa: F401 - likewise
import pytest
import scipy.optimize
import scipy.signal
import scipy.stats  # noqa: F401 - likewise
from mutants import Mutant, drawn
from touching_tests import Tests, reach

ROOT = Path(__file__).parents[1]
PYTEST = ["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--hypothesis-seed=0"]
SPARE_S = 20.0  # of processor time, to start and to import
MEMORY_BYTES = 6 << 30


class Loader(importlib.machinery.SourceFileLoader):
    """Loads a mutant in a module's place."""

    def __init__(self, module: str, mutant: Mutant | None) -> None:
        name = ".".join(("armodal", *Path(module).with_suffix("").parts))
        super().__init__(name.removesuffix(".__init__"), str(ROOT / "armodal" / module))
        source = (ROOT / module).read_text()
        self.code = mutant.code(source, self.path) if mutant else compile(source, self.path, "exec")

    def get_code(self, _):
        return self.code

    def find_spec(self, name, _path=None, _target=None):
        found = name == self.name
        return importlib.util.spec_from_file_location(name, loader=self) if found else None


def tested(loader: Loader, tests: list[str], cpu_s: int) -> None:
    """In a process of its own: run the tests on the mutant, end with pytest's exit code."""
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    with Path(os.devnull).open("w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    sys.meta_path.insert(0, loader)
    os._exit(pytest.main([*PYTEST, *tests]))


def verdict(loader: Loader, tests: list[str], seconds: float) -> str:
    if not tests:
        return "no test"
    cpu_s = int(SPARE_S + 4 * seconds)
    part = multiprocessing.get_context("fork").Process(target=tested, args=(loader, tests, cpu_s))
    part.start()
    part.join(20 * cpu_s)
    with suppress(ProcessLookupError):
        os.killpg(part.pid, signal.SIGKILL)
    if part.exitcode in (None, -signal.SIGXCPU, -signal.SIGKILL):
        return "too long"
    return {0: "survived", 4: "unknown test", 5: "unknown test"}.get(part.exitcode, "killed")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("coverage", help="of the tests, with contexts")
    parser.add_argument("durations", help="what pytest printed of them")
    parser.add_argument("out", type=Path, help="a line of JSON per mutant")
    parser.add_argument("packages", nargs="+", help="package=number of mutants")
    parser.add_argument("--without", nargs="*", default=[], help="modules to leave out")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--budget", type=float, default=40.0, help="seconds of tests per mutant")
    told = parser.parse_args()
    tests, rng = Tests(told.coverage, told.durations), random.Random(told.seed)  # noqa: S311 - a draw, no secret
    plan = []
    for package in told.packages:
        name, _, size = package.partition("=")
        for mutant in drawn(rng, ROOT, name, int(size), told.without):
            lines = reach((ROOT / mutant.module).read_text(), mutant.line)
            plan.append((mutant, tests.chosen(mutant.module, lines, told.budget)))
    rng.shuffle(plan)  # whatever was judged before a stop is a random sample too
    rows = told.out.read_text().splitlines() if told.out.exists() else []
    done = {Mutant(**json.loads(row)["mutant"]) for row in rows}
    ahead = [(mutant, chosen) for mutant, chosen in plan if mutant not in done]
    # Tests that fail by themselves are left out by what pytest printed; that they run here is seen
    # from one unchanged module.
    first, tried = next(((mutant.module, chosen) for mutant, chosen in ahead if chosen), ("", []))
    if tried and verdict(Loader(first, None), tried, told.budget) != "survived":
        sys.exit(f"the tests of {first} fail without a change")
    for mutant, chosen in ahead:
        loader = Loader(mutant.module, mutant)
        seconds = sum(tests.seconds[test] for test in chosen)
        found = verdict(loader, chosen, seconds)
        with told.out.open("a") as out:
            row = {"mutant": asdict(mutant), "verdict": found, "tests": chosen}
            print(json.dumps(row), file=out)


if __name__ == "__main__":
    main()
