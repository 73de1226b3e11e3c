"""Processes that fuzz one Python decoder each, forked from one that has instrumented the code.

To instrument it takes longer than to fuzz a decoder takes to reach most of what it reaches.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import sys
import tempfile
import threading
import warnings
from functools import cache
from multiprocessing import connection, forkserver
from pathlib import Path

HERE = Path(__file__).resolve().parent
TESTS = HERE.parent / "tests"
_FORKS = multiprocessing.get_context("forkserver")
# To start a process asks all others for their exit codes, and each is told once only.
_ONE_AT_A_TIME = threading.Lock()


def forked(name: str, inputs: Path, arguments: list[str], said: Path) -> int:
    """Fuzz one decoder in a process of its own; return its exit code.

    Parameters
    ----------
    inputs
        Folder in which valid files are put, to begin from.
    arguments
        Of libFuzzer.
    said
        File for its standard error.
    """
    process = _FORKS.Process(target=_run, args=(name, inputs, arguments, said))
    with _ONE_AT_A_TIME:
        _be_ready()
        process.start()
    connection.wait([process.sentinel])
    with _ONE_AT_A_TIME:
        process.join()
        code = process.exitcode
        process.close()
    return 1 if code is None else code


@cache
def _be_ready() -> None:
    """Start the process that is forked; it finds modules by its environment alone."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join(
        [str(HERE), str(TESTS), *([before] if before else [])]
    )
    try:
        _FORKS.set_forkserver_preload(["fuzz_instrumented"])
        forkserver.ensure_running()
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before


def _run(name: str, inputs: Path, arguments: list[str], said: Path) -> None:
    """Body of the process of one decoder; libFuzzer ends it."""
    with said.open("wb") as file:
        os.dup2(file.fileno(), 2)
    import atheris  # noqa: PLC0415 - in the extra `fuzz`
    from fuzz_instrumented import check, decoders_in  # noqa: PLC0415 - there already

    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        decoder = decoders_in(folder)[name]
        for seed in decoder.seeds:
            digest = hashlib.sha1(seed, usedforsecurity=False).hexdigest()
            (inputs / digest).write_bytes(seed)

        def one(data: bytes) -> None:
            wrong = check(decoder, data)
            if wrong is not None:
                digest = hashlib.sha1(data, usedforsecurity=False).hexdigest()
                Path(f"{artifacts}fault-{digest}").write_bytes(data)
                raise AssertionError(wrong)

        (artifacts,) = (a.partition("=")[2] for a in arguments if a.startswith("-artifact_prefix"))
        longest = max(map(len, decoder.seeds)) * 3 // 2
        atheris.Setup([sys.argv[0], f"-max_len={longest}", *arguments], one)
        atheris.Fuzz()
