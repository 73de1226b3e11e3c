"""Fuzz every decoder of bytes from outside: valid files, mutated with their structure in mind.

Each decoder runs in a process of its own with its memory bounded and a watchdog on every input:
a crash, a hang, an error that is not an ArmodalError, or memory beyond the bound is a fault. The C
decoders run under the address and undefined-behaviour sanitizers.

    python bench/torture_fuzz.py [--total 1e6] [--inputs 5000] [--only NAME ...] [--seed 1]
                                 [--keep FOLDER]

A decoder gets at least so many mutated files. Then all get as much time as each other, until all
of them together had the total. Exit code 1 if there is any fault, or if fewer were tried than are
wanted; the input that made a fault is kept, and its name printed.
"""

from __future__ import annotations

import argparse
import faulthandler
import hashlib
import json
import os
import resource
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.accepted_hits import quick_folder, quick_place
from support.decoders import Decoder, check
from support.fuzz_c import C_DECODER, fuzz_c
from support.fuzz_material import decoders_in

WANTED = 1_000_000  # mutated files, of all decoders together
WANTED_EACH = 5000
C_BYTES = 50_000_000
MEMORY_BOUND = 1536 * 2**20  # of the whole process, the libraries (0.3 GB) counted in
HANGS_AFTER_S = 120.0  # far beyond the slowest input on a busy machine
WATCHED_AT_ONCE = 100  # inputs
SLOW_S = 2.0  # of processor time on one input
MOST_FAULTS = 10
MARGIN = 1.05  # so that a second turn is enough


@dataclass
class Tried:
    """What a decoder was given, and what it made of it."""

    inputs: int = 0
    bytes: int = 0
    cpu_s: float = 0.0
    faults: int = 0
    slowest_s: float = 0.0
    peak_mb: int = 0
    told: list[str] = field(default_factory=list)

    def add(self, more: Tried) -> None:
        """Count what came after."""
        self.inputs += more.inputs
        self.bytes += more.bytes
        self.cpu_s += more.cpu_s
        self.faults += more.faults
        self.slowest_s = max(self.slowest_s, more.slowest_s)
        self.peak_mb = max(self.peak_mb, more.peak_mb)
        self.told += more.told


def fuzz(
    decoder: Decoder, n_inputs: int, seconds: float, rng: np.random.Generator, keep: Path
) -> Tried:
    """Feed mutated files to a decoder, so many and for so many seconds of a processor."""
    at_hand = keep / (decoder.name.replace(" ", "-") + ".input")
    tried = Tried()
    decoder.decode(decoder.seeds[0])
    all_s = time.process_time()
    while (
        tried.inputs < n_inputs or time.process_time() - all_s < seconds
    ) and tried.faults < MOST_FAULTS:
        data = decoder.mutate(decoder.seeds[rng.integers(len(decoder.seeds))], rng, decoder.seeds)
        at_hand.write_bytes(data)  # there still if the process dies of it
        if tried.inputs % WATCHED_AT_ONCE == 0:  # a watchdog is a thread: it takes its time
            faulthandler.dump_traceback_later(HANGS_AFTER_S, exit=True)
        begun_s = time.process_time()
        wrong = check(decoder, data)
        took_s = time.process_time() - begun_s
        tried.slowest_s = max(tried.slowest_s, took_s)
        if wrong is None and took_s > SLOW_S:
            wrong = f"took {took_s:.1f} s"
        tried.bytes += len(data)
        tried.inputs += 1
        if wrong is not None:
            tried.faults += 1
            name = f"{at_hand.stem}.fault-{hashlib.sha1(data, usedforsecurity=False).hexdigest()}"
            at_hand.with_name(name).write_bytes(data)
            tried.told.append(wrong[:300])
    faulthandler.cancel_dump_traceback_later()
    at_hand.unlink(missing_ok=True)
    tried.cpu_s = time.process_time() - all_s
    tried.peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    return tried


def apart(decoder: Decoder, n_inputs: int, seconds: float, seed: list[int], keep: Path) -> Tried:
    """Fuzz a decoder in a fork of this process; its death is a fault."""
    reading, writing = os.pipe()
    said = keep / "said"
    child = os.fork()
    if child == 0:
        code = 1
        try:
            os.close(reading)
            with said.open("wb") as file:
                os.dup2(file.fileno(), 2)
            faulthandler.enable()
            warnings.simplefilter("ignore")
            resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_BOUND, MEMORY_BOUND))
            found = fuzz(decoder, n_inputs, seconds, np.random.default_rng(seed), keep)
            os.write(writing, json.dumps(asdict(found)).encode())
            code = 0
        except BaseException:  # noqa: BLE001 - told by the parent
            traceback.print_exc()
        finally:
            os._exit(code)
    os.close(writing)
    with os.fdopen(reading, "rb") as file:
        data = file.read()
    _, status = os.waitpid(child, 0)
    words = said.read_text(errors="replace")[-2500:]
    said.unlink(missing_ok=True)
    if data:
        return Tried(**json.loads(data))
    code = os.waitstatus_to_exitcode(status)
    return Tried(faults=1, told=[f"the process ended with {code}: {words}"])


def all_tried(
    decoders: list[Decoder], total: int, each: int, seed: int, keep: Path
) -> dict[str, Tried]:
    """Fuzz every decoder, then all of them for as long as the total takes."""
    found = {decoder.name: Tried() for decoder in decoders}
    counted, share_s, turn = 0, 0.0, 0
    while counted < total and not any(of.faults >= MOST_FAULTS for of in found.values()):
        for decoder in decoders:
            before_s = time.monotonic()
            n = each if turn == 0 else 1
            more = apart(decoder, n, share_s, [seed, turn], keep)
            found[decoder.name].add(more)
            print(
                f"{decoder.name}: {more.inputs:,} inputs, {more.bytes:,} bytes, {more.faults} "
                f"faults, slowest {more.slowest_s:.3f} s, peak {more.peak_mb} MB, "
                f"{more.cpu_s:.0f} s of {time.monotonic() - before_s:.0f} s",
                flush=True,
            )
            for line in more.told:
                print(f"  {line}", flush=True)
        counted = sum(of.inputs for of in found.values())
        speeds = [of.inputs / max(of.cpu_s, 1e-3) for of in found.values()]
        share_s = MARGIN * (total - counted) / max(sum(speeds), 1.0)
        turn += 1
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--total", type=float, default=WANTED)
    parser.add_argument("--inputs", type=int, default=WANTED_EACH)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    keep = given.keep or Path(tempfile.mkdtemp(prefix="armodal-fuzz-", dir=quick_place()))
    keep.mkdir(parents=True, exist_ok=True)
    found = {}
    if given.only is None or C_DECODER in given.only:
        of = fuzz_c(C_BYTES, np.random.default_rng(given.seed))
        names = ("inputs", "bytes", "faults", "told")
        found[C_DECODER] = Tried(**{name: of[name] for name in names})
    with quick_folder() as folder:
        decoders = [
            decoder
            for decoder in decoders_in(folder).values()
            if given.only is None or decoder.name in given.only
        ]
        left = int(given.total) - sum(of.inputs for of in found.values())
        found |= all_tried(decoders, left, given.inputs, given.seed, keep)
    if any(keep.iterdir()):
        print(f"inputs that made a fault are kept in {keep}")
    elif given.keep is None:
        keep.rmdir()
    return told(figures_of(found))


def figures_of(found: dict[str, Tried]) -> list[Figure]:
    """Return the mutated files and faults of every decoder as rows of the table."""
    faults = sum(of.faults for of in found.values())
    rows = [
        Figure(
            f"mutated files, {name}: {of.bytes / 1e6:.1f} MB, {of.faults} faults",
            f"{of.inputs:,}",
            f"{WANTED_EACH:,}",
            of.inputs >= WANTED_EACH and of.faults == 0,
        )
        for name, of in found.items()
    ]
    total = sum(of.inputs for of in found.values())
    what = f"... of all {len(found)} decoders"
    rows.append(Figure(what, f"{total:,}", f"{WANTED:,}", total >= WANTED))
    return [*rows, Figure("... faults of all of them", str(faults), "0", faults == 0)]


if __name__ == "__main__":
    sys.exit(main())
