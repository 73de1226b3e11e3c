"""The C sources under the address and undefined-behaviour sanitizers, in programs of their own."""

import subprocess
from pathlib import Path

import pytest
from support.c_device import VECTORS

from armodal.protocols.board import FrameType
from armodal.protocols.c.build import INCLUDE, SOURCES, STRICT, compile_with, compilers

pytestmark = pytest.mark.long  # compiles for seconds, and runs no line of Python's

HERE = Path(__file__).parent
SANITIZE = ("-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
RESULTS = {"cobs": 1, "short": 2, "long": 3, "crc": 4, "version": 5, "type": 6}
PROBE = """
#include <stdlib.h>
int main(int argc, char **argv)
{
    volatile char *bytes = calloc(4, 1);
    int found = bytes[argc == 1 ? 3 : 4];

    (void)argv;
    free((void *)bytes);
    return found != 0;
}
"""
LIVES = 150
SEEDS = (1, 2)


def run(command, text=""):
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


@pytest.fixture(scope="module")
def sanitizing_compiler(tmp_path_factory):
    """A compiler whose sanitized programs run here and are stopped where they read too far."""
    folder = tmp_path_factory.mktemp("probe")
    source, program = folder / "probe.c", folder / "probe"
    source.write_text(PROBE, encoding="utf-8")
    for compiler in compilers():
        said = compile_with(compiler, [*SANITIZE, str(source)], program)
        if not said and run([str(program)])[0] == 0 and run([str(program), "far"])[0] != 0:
            return compiler
    pytest.skip("no C compiler here makes programs with -fsanitize=address,undefined")


# Both CRCs are tested: the small table of a microcontroller and the fast ones.
@pytest.fixture(scope="module", params=["0", "1"], ids=["small", "fast"])
def programs(request, sanitizing_compiler, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sanitized")
    made = {}
    for name in ("sanitized_vectors", "sanitized_life"):
        arguments = [*STRICT, *SANITIZE, f"-DAB_FAST_CRC={request.param}", f"-I{INCLUDE}"]
        arguments += [str(HERE / f"{name}.c"), *map(str, SOURCES)]
        assert compile_with(sanitizing_compiler, arguments, folder / name) == ""
        made[name] = str(folder / name)
    return made


def vector_lines():
    """The vectors as the C program reads them."""
    for vector in VECTORS["frames"]:
        yield f"frame {vector['wire'][2:-2]}"
        if vector["payload"]:
            yield f"payload 1 {int(FrameType[vector['type']])} {vector['payload']}"
    for vector in VECTORS["invalid_frames"]:
        yield f"invalid {RESULTS[vector['reason']]} {vector['encoded']}"
    for vector in VECTORS["invalid_payloads"]:
        yield f"payload 0 {int(FrameType[vector['type']])} {vector['payload']}"
    for vector in VECTORS["dictionaries"]:
        encoded = vector["encoded"]
        yield f"dictionary 1 {encoded}"
        for end in range(0, len(encoded), 2):
            yield f"dictionary 0 {encoded[:end]}"
    for vector in VECTORS["streams"]:
        numbers = (vector["bad_frames"], vector["garbage_bytes"], len(vector["sequences"]))
        yield f"stream {' '.join(map(str, numbers))} {vector['bytes']}"


def test_the_vectors_pass_under_the_sanitizers(programs):
    lines = list(vector_lines())
    code, said, complaint = run([programs["sanitized_vectors"]], "\n".join(lines) + "\n")
    assert (code, said) == (0, f"{len(lines)} vectors\n"), complaint


def test_a_vector_that_does_not_hold_fails(programs):
    frame = VECTORS["frames"][0]["wire"][2:-2]
    code, _, complaint = run([programs["sanitized_vectors"]], f"frame {frame[:-2]}00\n")
    assert (code, complaint) == (1, "line 1: a valid frame\n")


@pytest.mark.parametrize("seed", SEEDS)
def test_boards_live_through_anything_under_the_sanitizers(programs, seed):
    code, said, complaint = run([programs["sanitized_life"], str(seed), str(LIVES)])
    assert code == 0, complaint
    frames, with_samples, blocks, refusals = (int(part.split()[0]) for part in said.split(","))
    # Far below what these lives bring: it shows that they were not spent in IDLE.
    assert min(frames, with_samples, blocks, refusals) > LIVES
