"""How the library is compiled, and what is said where it cannot be."""

import os

import pytest
from support.c_device import FFI, C

from armodal.protocols.c import build
from armodal.protocols.c.build import (
    INCLUDE,
    SOURCES,
    STRICT,
    CompilerError,
    compile_with,
    compilers,
)
from armodal.protocols.c.library import declarations
from armodal.protocols.c.sizes import CODE_LIMIT_BYTES, RAM_LIMIT_BYTES, main, measure

PORTABLE = ("-ffreestanding", "-c")


@pytest.mark.parametrize(
    "options",
    [
        pytest.param(("-O2",), marks=pytest.mark.long),
        ("-Os", "-DAB_FAST_CRC=1"),
        pytest.param(("-O0",), marks=pytest.mark.long),
    ],
    ids=str,
)
def test_the_sources_are_clean_under_strict_warnings(options, tmp_path):
    compiler = next(compilers())
    for source in SOURCES:
        arguments = [*STRICT, *PORTABLE, *options, f"-I{INCLUDE}", str(source)]
        assert compile_with(compiler, arguments, tmp_path / "one.o") == ""


def test_the_sources_include_nothing_but_freestanding_headers():
    included = {
        line.split()[1]
        for path in [*SOURCES, *INCLUDE.glob("*.h"), *build.HERE.glob("src/*.h")]
        for line in path.read_text(encoding="utf-8").splitlines()
        if line.startswith("#include")
    }
    own = {f'"{path.name}"' for path in build.HEADERS} | {'"internal.h"'}
    assert included == own | {"<stdbool.h>", "<stddef.h>", "<stdint.h>"}


def test_the_size_figures_are_kept(capsys, monkeypatch):
    try:
        sizes = measure()
    except CompilerError as error:
        pytest.skip(str(error))
    if not sizes.is_judged:
        pytest.skip("no arm-none-eabi-gcc here: the limits are those of a microcontroller")
    assert sizes.core_code <= CODE_LIMIT_BYTES
    assert sizes.core_ram <= RAM_LIMIT_BYTES
    monkeypatch.setattr("armodal.protocols.c.sizes.measure", lambda: sizes)
    assert main() == 0
    assert f"{sizes.core_code} B  without host.c" in capsys.readouterr().out


def test_the_declarations_are_those_of_the_header_without_comments():
    text = declarations(build.INCLUDE / "armodal_board.h")
    assert "#" not in text
    assert "/*" not in text
    assert "ab_init_result ab_init(" in text


def test_structs_have_the_layout_that_the_compiler_gave_them():
    # The last field of each struct is written by the library and read by cffi.
    board = FFI.new("ab_board *")
    board.preview_dropping = True
    config = FFI.new("ab_config *")
    C.ab_init(board, config, b"", 0, 5)
    assert not board.preview_dropping
    assert (board.session, board.config) == (5, config)


@pytest.fixture
def elsewhere(monkeypatch, tmp_path):
    """A library of one small source is to be built in an empty place."""
    source = tmp_path / "one.c"
    source.write_text("int one(void);\n\nint one(void)\n{\n    return 1;\n}\n", encoding="utf-8")
    monkeypatch.setattr(build, "SOURCES", (source,))
    monkeypatch.setattr(build, "LIBRARY", tmp_path / "build" / "lib.so")
    return tmp_path


def test_a_missing_library_is_compiled_and_a_current_one_left(elsewhere):
    made = build.ensure_library()
    first = made.stat().st_mtime_ns
    assert build.is_current()
    assert build.ensure_library().stat().st_mtime_ns == first
    os.utime(made, (0, 0))
    assert not build.is_current()
    build.ensure_library()
    assert build.is_current()


def test_without_any_compiler_the_message_says_what_to_do(elsewhere, monkeypatch):
    monkeypatch.setattr(build, "compilers", lambda: iter(()))
    with pytest.raises(CompilerError, match="Install gcc or clang"):
        build.ensure_library()


def test_a_compiler_that_fails_is_named_and_the_next_one_tried(elsewhere, monkeypatch):
    good = next(compilers())
    monkeypatch.setattr(build, "compilers", lambda: iter([["no-such-cc"], good]))
    assert build.ensure_library().is_file()
    os.utime(build.LIBRARY, (0, 0))
    monkeypatch.setattr(build, "compilers", lambda: iter([["no-such-cc"]]))
    with pytest.raises(CompilerError, match="no-such-cc"):
        build.ensure_library()


def test_cc_in_the_environment_comes_first(monkeypatch):
    monkeypatch.setenv("CC", "my-cc --fast")
    assert next(compilers()) == ["my-cc", "--fast"]
