"""The C decoders fed with mutated bytes under the address and undefined-behaviour sanitizers."""

import shutil
import struct
import subprocess
import tempfile
from pathlib import Path

from support.fuzz_lines import board_payloads, board_stream, example_dictionary, mutate_frames
from support.mutate import mutated

from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.c.build import INCLUDE, SOURCES, STRICT, compile_with, compilers

__all__ = ["C_DECODER", "c_inputs", "compile_fuzz", "compile_libfuzzer", "fuzz_c"]

C_DECODER = "board frames in C"
SANITIZE = ("-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
C_TESTS = Path(__file__).parents[1] / "protocols" / "c"
TIME_LIMIT_S = 1200.0


def compile_fuzz(folder):
    """Return the sanitized program, or None where no compiler here makes one."""
    program = Path(folder) / "sanitized_fuzz"
    for compiler in compilers():
        arguments = [*STRICT, *SANITIZE, f"-I{INCLUDE}", str(C_TESTS / "sanitized_fuzz.c")]
        if not compile_with(compiler, [*arguments, *map(str, SOURCES)], program):
            return program
    return None


def compile_libfuzzer(folder):
    """Return the program that libFuzzer drives, or None where there is no clang that has it."""
    clang = shutil.which("clang")
    program = Path(folder) / "libfuzzer"
    flags = ["-g", "-O1", "-DLIBFUZZER", "-fsanitize=fuzzer,address,undefined"]
    arguments = [*STRICT, *flags, f"-I{INCLUDE}", str(C_TESTS / "sanitized_fuzz.c")]
    if clang is None or compile_with([clang], [*arguments, *map(str, SOURCES)], program):
        return None
    return program


def c_inputs(n_bytes, rng):
    """Yield streams, payloads and dictionaries made wrong, with their lengths in front."""
    stream = board_stream()
    seeds = (*(payload for _, payload in board_payloads()), encode_dictionary(example_dictionary()))
    done = 0
    while done < n_bytes:
        if rng.random() < 0.5:
            data = mutate_frames(stream, rng, seeds)
        else:
            data = mutated(seeds[rng.integers(len(seeds))], rng, others=seeds, limit=4096)
        done += len(data)
        yield struct.pack("<I", len(data)) + data


def fuzz_c(n_bytes, rng):
    """Feed the program until so many bytes have gone in; return what came of it."""
    with tempfile.TemporaryDirectory() as folder:
        program = compile_fuzz(folder)
        if program is None:
            return _told(0, 0, 1, "no C compiler here makes sanitized programs")
        with (
            (Path(folder) / "said").open("w+") as said,
            subprocess.Popen(
                [str(program)], stdin=subprocess.PIPE, stdout=said, stderr=said
            ) as process,
        ):
            assert process.stdin is not None
            try:
                for data in c_inputs(n_bytes, rng):
                    process.stdin.write(data)
                process.stdin.close()
            except BrokenPipeError:
                pass
            code = process.wait(TIME_LIMIT_S)
            said.seek(0)
            words = said.read()
    if code != 0:
        return _told(0, 0, 1, words[-2500:])
    done, inputs, frames, payloads, dictionaries = map(int, words.split())
    read = f"{frames} frames, {payloads} payloads and {dictionaries} dictionaries were read"
    return _told(done, inputs, 0, read)


def _told(done, inputs, faults, words):
    return {
        "bytes": done, "inputs": inputs, "faults": faults, "slowest_s": 0.0, "peak_mb": 0,
        "told": [words],
    }  # fmt: skip
