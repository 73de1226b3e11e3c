"""Fuzz the decoders with their coverage watched: atheris for Python, libFuzzer for C.

    make fuzz
    python bench/fuzz.py [NAME ...] [--seconds 300] [--keep]

A decoder gets valid files, the corpus of `tests/fuzz_corpus` and a dictionary of telling words, and
every input that reaches code not reached before is changed further. Inputs found are kept in
`build/fuzz`, so that the next run goes on; `--keep` puts a dozen small ones of each decoder into
`tests/fuzz_corpus`, which the tests replay. An input that makes a fault is kept in
`build/fuzz/faults`: put it into `tests/fuzz_corpus` when it is mended. C is fuzzed where clang is
installed, else that is said.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from figures import Figure, told
from fuzz_child import forked

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

CORPUS = ROOT / "tests" / "fuzz_corpus"
WORK = ROOT / "build" / "fuzz"
SECONDS = int(os.environ.get("FUZZ_SECONDS", "300"))  # of each decoder
KEPT_BYTES = 2048  # of an input in the repository
KEPT_INPUTS = 12  # of a decoder
MEMORY_MB = 4096  # of a process: atheris keeps what it has compared, some 100 kB of a long input
ROUND_S = 60  # then another process goes on
HANGS_AFTER_S = 20
C_NAME = "board frames in C"
_TELLS = re.compile(r"Error\b|ERROR|Test unit")


def python_names() -> list[str]:
    """Return the names of the Python decoders."""
    from support.fuzz_material import decoders_in  # noqa: PLC0415 - behind sys.path

    with tempfile.TemporaryDirectory() as folder:
        return list(decoders_in(folder))


def dictionary() -> Path:
    """Write the words that say much to decoders, as libFuzzer reads them."""
    from support.mutate import TELLING_TOKENS  # noqa: PLC0415 - behind sys.path

    words = [*TELLING_TOKENS, b"RJ", b"\x89AMJ\r\n\x1a\x01", b"SG_ ", b"BO_ ", b"<link", b"<joint"]
    path = WORK / "words.dict"
    quoted = ("".join(f"\\x{byte:02x}" for byte in word[:60]) for word in words)
    path.write_text("".join(f'"{word}"\n' for word in quoted), encoding="ascii")
    return path


def fuzz(name: str, command: list[str] | None, seconds: int) -> tuple[int, str]:
    """Fuzz one decoder, by a program or in Python, process after process.

    Returns how many inputs were tried, and what went wrong, if anything.
    """
    tried, wrong, left = 0, "", seconds
    while left > 0 and not wrong:
        more, wrong = fuzz_once(name, command, min(left, ROUND_S))
        tried, left = tried + more, left - ROUND_S
    return tried, wrong


def fuzz_once(name: str, command: list[str] | None, seconds: int) -> tuple[int, str]:
    """Fuzz one decoder in one process."""
    inputs, faults, corpus = WORK / _folder(name), WORK / "faults", CORPUS / _folder(name)
    for folder in (inputs, faults, corpus):
        folder.mkdir(parents=True, exist_ok=True)
    arguments = [
        f"-max_total_time={seconds}", f"-dict={dictionary()}", f"-rss_limit_mb={MEMORY_MB}",
        f"-timeout={HANGS_AFTER_S}", "-print_final_stats=1",
        f"-artifact_prefix={faults}/{_folder(name)}-", str(inputs), str(corpus),
    ]  # fmt: skip
    said = WORK / f"{_folder(name)}.log"
    if command is None:
        code = forked(name, inputs, arguments, said)
    else:
        with said.open("wb") as file:
            code = subprocess.run([*command, *arguments], stderr=file, check=False).returncode
    text = said.read_text(errors="replace")
    counted = re.search(r"number_of_executed_units: (\d+)", text)
    tried = int(counted.group(1)) if counted else 0
    if code == 0:
        return tried, ""
    words = [line for line in text.splitlines() if _TELLS.search(line)]
    return tried, f"exit code {code}: {' | '.join(words)[:600] or text[-600:]}"


def keep(name: str) -> None:
    """Put a dozen small inputs that reached code not reached before into the repository's corpus.

    libFuzzer keeps such inputs alone, and shortens them as it goes.
    """
    corpus = CORPUS / _folder(name)
    found = [path for path in (WORK / _folder(name)).iterdir() if path.is_file()]
    small = sorted(
        (path for path in found if path.stat().st_size <= KEPT_BYTES),
        key=lambda path: (path.stat().st_size, path.name),
    )
    step = max(1, len(small) // KEPT_INPUTS)
    for path in small[::step][:KEPT_INPUTS]:
        shutil.copy(path, corpus / path.name)


def _folder(name: str) -> str:
    return name.replace(" ", "-")


def c_command() -> list[str] | None:
    """Compile the C decoders with libFuzzer; None where that cannot be."""
    from support.fuzz_c import compile_libfuzzer  # noqa: PLC0415 - behind sys.path

    program = compile_libfuzzer(WORK)
    return None if program is None else [str(program)]


def main() -> int:
    """Fuzz one decoder after the other; print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--seconds", type=int, default=SECONDS)
    parser.add_argument("--keep", action="store_true")
    given = parser.parse_args()
    if importlib.util.find_spec("atheris") is None:
        print("atheris is not installed: pip install 'armodal[fuzz]' (Linux)")
        return 2
    WORK.mkdir(parents=True, exist_ok=True)
    names = given.names or [*python_names(), C_NAME]
    # Seconds are of the clock: one more at once than there are processors.
    with ThreadPoolExecutor((os.cpu_count() or 1) + 1) as pool:
        found = pool.map(lambda name: figure_of(name, given.seconds, kept=given.keep), names)
        return told([figure for figure in found if figure is not None])


def figure_of(name: str, seconds: int, *, kept: bool) -> Figure | None:
    """Fuzz one decoder; return its figure, None where it cannot be fuzzed here."""
    command = c_command() if name == C_NAME else None
    if name == C_NAME and command is None:
        print(f"{name}: no clang with libFuzzer on this machine, not fuzzed", flush=True)
        return None
    tried, wrong = fuzz(name, command, seconds)
    print(f"{name}: {tried:,} inputs in {seconds} s{': ' if wrong else ''}{wrong}", flush=True)
    if kept and not wrong:
        keep(name)
    good = not wrong and tried > 0
    return Figure(
        f"coverage-guided for {seconds} s, {name}: inputs", f"{tried:,}", "1, no fault", good
    )


if __name__ == "__main__":
    sys.exit(main())
