"""Fuzz every decoder of bytes from outside: valid files, mutated with their structure in mind.

Each decoder runs in a process of its own with its memory bounded and a watchdog on every input:
a crash, a hang, an error that is not an ArmodalError, or memory beyond the bound is a fault. The C
decoders run under the address and undefined-behaviour sanitizers.

    python bench/torture_fuzz.py [--bytes 50e6] [--inputs 5000] [--only NAME ...] [--seed 1]
                                 [--keep FOLDER]

A decoder gets at least so many bytes and at least so many inputs: of large files few would do for
the bytes. Exit code 1 if there is any fault, or if a decoder got fewer bytes than are wanted; the
input that made a fault is kept, and its name printed.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.accepted_hits import quick_folder, quick_place
from support.decoders import Decoder, check
from support.fuzz_c import C_DECODER, fuzz_c
from support.fuzz_material import decoders_in

WANTED_BYTES = 50_000_000  # of each decoder
MEMORY_BOUND = 1536 * 2**20  # of the whole process, the libraries (0.3 GB) counted in
HANGS_AFTER_S = 20.0  # far beyond the slowest input on a busy machine
SLOW_S = 2.0  # of processor time on one input
MOST_FAULTS = 10


def fuzz(
    decoder: Decoder, n_bytes: int, n_inputs: int, rng: np.random.Generator, keep: Path
) -> dict[str, Any]:
    """Feed mutated files to a decoder until so many bytes, and so many inputs, have gone in."""
    at_hand = keep / (decoder.name.replace(" ", "-") + ".input")
    done = inputs = faults = 0
    slowest_s = 0.0
    words: list[str] = []
    decoder.decode(decoder.seeds[0])
    while (done < n_bytes or inputs < n_inputs) and faults < MOST_FAULTS:
        data = decoder.mutate(decoder.seeds[rng.integers(len(decoder.seeds))], rng, decoder.seeds)
        at_hand.write_bytes(data)  # there still if the process dies of it
        faulthandler.dump_traceback_later(HANGS_AFTER_S, exit=True)
        begun_s = time.process_time()
        wrong = check(decoder, data)
        took_s = time.process_time() - begun_s
        faulthandler.cancel_dump_traceback_later()
        slowest_s = max(slowest_s, took_s)
        if wrong is None and took_s > SLOW_S:
            wrong = f"took {took_s:.1f} s"
        done += len(data)
        inputs += 1
        if wrong is not None:
            faults += 1
            at_hand.with_suffix(f".fault-{faults}").write_bytes(data)
            words.append(wrong[:300])
    faulthandler.cancel_dump_traceback_later()
    at_hand.unlink(missing_ok=True)
    return {
        "bytes": done,
        "inputs": inputs,
        "faults": faults,
        "slowest_s": round(slowest_s, 3),
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
        "told": words,
    }


def child(name: str, n_bytes: int, n_inputs: int, seed: int, keep: Path) -> int:
    """Body of the process of one decoder."""
    warnings.simplefilter("ignore")
    with quick_folder() as folder:
        decoder = decoders_in(folder)[name]
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_BOUND, MEMORY_BOUND))
        print(json.dumps(fuzz(decoder, n_bytes, n_inputs, np.random.default_rng(seed), keep)))
    return 0


def in_process(name: str, n_bytes: int, n_inputs: int, seed: int, keep: Path) -> dict[str, Any]:
    """Fuzz a decoder in a process of its own; its death is a fault."""
    command = [sys.executable, __file__, "--child", name, "--bytes", str(n_bytes)]
    command += ["--inputs", str(n_inputs), "--seed", str(seed), "--keep", str(keep)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return dict(json.loads(done.stdout.splitlines()[-1]))
    return {
        "bytes": 0, "inputs": 0, "faults": 1, "slowest_s": 0.0, "peak_mb": 0,
        "told": [f"the process ended with {done.returncode}: {done.stderr[-2500:]}"],
    }  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bytes", type=float, default=50e6)
    parser.add_argument("--inputs", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--child")
    given = parser.parse_args()
    keep = given.keep or Path(tempfile.mkdtemp(prefix="armodal-fuzz-", dir=quick_place()))
    keep.mkdir(parents=True, exist_ok=True)
    n_bytes = int(given.bytes)
    if given.child:
        return child(given.child, n_bytes, given.inputs, given.seed, keep)
    with quick_folder() as folder:
        names = [C_DECODER, *decoders_in(folder)]
    results: dict[str, dict[str, Any]] = {}
    for name in given.only or names:
        begun_s = time.monotonic()
        if name == C_DECODER:
            found = fuzz_c(n_bytes, np.random.default_rng(given.seed))
        else:
            found = in_process(name, n_bytes, given.inputs, given.seed, keep)
        print(
            f"{name}: {found['bytes']:,} bytes in {found['inputs']:,} inputs, "
            f"{found['faults']} faults, slowest {found['slowest_s']} s, "
            f"peak {found['peak_mb']} MB, {time.monotonic() - begun_s:.0f} s",
            flush=True,
        )
        for line in found["told"]:
            print(f"  {line}", flush=True)
        results[name] = found
    if any(keep.iterdir()):
        print(f"inputs that made a fault are kept in {keep}")
    elif given.keep is None:
        keep.rmdir()
    return told(figures_of(results))


def figures_of(found: dict[str, dict[str, Any]]) -> list[Figure]:
    """Return the bytes and faults of every decoder as rows of the table."""
    n_bytes = {name: int(of["bytes"]) for name, of in found.items()}
    faults = sum(int(of["faults"]) for of in found.values())
    rows = [
        Figure(
            f"fuzzed bytes, {name}: {of['inputs']:,} inputs, {of['faults']} faults",
            f"{n_bytes[name]:,}",
            f"{WANTED_BYTES:,}",
            n_bytes[name] >= WANTED_BYTES and of["faults"] == 0,
        )
        for name, of in found.items()
    ]
    least = min(n_bytes.values())
    what = f"... least of {len(found)} decoders"
    rows.append(Figure(what, f"{least:,}", f"{WANTED_BYTES:,}", least >= WANTED_BYTES))
    return [*rows, Figure("... faults of all of them", str(faults), "0", faults == 0)]


if __name__ == "__main__":
    sys.exit(main())
