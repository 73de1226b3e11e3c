from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field

from armodal.protocols.errors import ArmError, PlanError
from armodal.protocols.toml_reader import (
    FileModel,
    Name,
    Vector3,
    parse_toml,
    read_text,
    refuse,
    validate,
)


class Inner(FileModel):
    number: float
    count: int = 0
    vector: Vector3 | None = None


class Outer(FileModel):
    name: str
    items: list[Inner] = Field(default=[])
    tables: dict[str, Inner] = Field(default={})


def message_of(data: dict[str, Any]) -> str:
    with pytest.raises(ArmError) as caught:
        validate(Outer, data, origin="file x.toml", error=ArmError)
    return str(caught.value)


def test_an_unknown_key_is_named_with_its_path_and_the_nearest_known_one() -> None:
    message = message_of({"name": "a", "items": [{"number": 1.0}, {"number": 1.0, "cuont": 2}]})
    assert message == (
        "file x.toml: items[1].cuont: wanted one of the keys number, count, vector, "
        "got the unknown key 'cuont' (did you mean count?)"
    )


def test_a_missing_key_is_named() -> None:
    assert message_of({}) == "file x.toml: name: wanted a value, got nothing; add the key"


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        ("1.0", "items[0].number: wanted a number, got '1.0'"),
        (True, "items[0].number: wanted a number, got True"),
        (float("nan"), "items[0].number: wanted a finite number, got nan"),
        (float("inf"), "items[0].number: wanted a finite number, got inf"),
        ([], "items[0].number: wanted a number, got []"),
    ],
)
def test_a_value_of_the_wrong_kind_is_shown(value: object, sentence: str) -> None:
    assert message_of({"name": "a", "items": [{"number": value}]}) == f"file x.toml: {sentence}"


def test_a_vector_of_the_wrong_length_is_shown() -> None:
    message = message_of({"name": "a", "items": [{"number": 1, "vector": [1.0, 2.0]}]})
    assert message == "file x.toml: items[0].vector: wanted at least 3 items, got [1.0, 2.0]"


def test_a_value_in_place_of_a_table_is_shown() -> None:
    assert message_of({"name": "a", "items": [3]}) == "file x.toml: items[0]: wanted a table, got 3"


def test_keys_that_are_no_identifiers_are_quoted_in_the_path() -> None:
    message = message_of({"name": "a", "tables": {"a b": {"number": "x"}}})
    assert "tables.'a b'.number: wanted a number, got 'x'" in message


def test_further_faults_are_counted() -> None:
    assert message_of({"items": [{}]}).endswith("(and 1 more)")


def test_a_whole_number_serves_as_a_number() -> None:
    got = validate(Outer, {"name": "a", "items": [{"number": 3}]}, origin="x", error=ArmError)
    assert got.items[0].number == 3.0


@pytest.mark.parametrize(
    "text",
    [
        "a = ",
        "a = 1\na = 2",
        "a = " + "9" * 5000,  # more digits than Python converts
        "a = " + "[" * 5000,
        "a = " + "[" * 100 + "]" * 100,
    ],
)
def test_what_is_no_toml_is_refused_with_the_callers_error(text: str) -> None:
    with pytest.raises(PlanError, match=r"file x\.toml: wanted "):
        parse_toml(text, origin="file x.toml", error=PlanError)


@given(st.text(max_size=100))
def test_any_text_is_toml_or_refused(text: str) -> None:
    with contextlib.suppress(ArmError):
        parse_toml(text, origin="x", error=ArmError)


@pytest.mark.parametrize(
    "text",
    [
        ".".join("a" * 20_000) + " = 1",
        "x = 1\n[" + " . ".join("a" * 20_000) + "]",
        'x = {"a"' + '."a"' * 20_000 + " = 1}",
    ],
)
def test_a_key_of_many_parts_is_refused_before_it_is_parsed(text: str) -> None:
    """40 kB of them take 1.7 GB and 18 s to parse: each part copies what leads to it."""
    with pytest.raises(ArmError, match="wanted keys of at most 32 parts"):
        parse_toml(text, origin="file", error=ArmError)


def test_numbers_and_sentences_are_no_keys() -> None:
    text = "x = [" + "1.5, " * 100 + "2.5]\ny = 'One. Two. Three.'\n# ....... " + "." * 100
    assert len(parse_toml(text, origin="file", error=ArmError)["x"]) == 101


class Named(FileModel):
    name: Name


@pytest.mark.parametrize("unseen", ["\x07", "\x1b", "\x7f", "\x9b", "\u202e", "\u2066", "\u2028"])
def test_a_name_holds_nothing_that_a_terminal_would_obey(unseen: str) -> None:
    with pytest.raises(ArmError, match="name"):
        validate(Named, {"name": f"a{unseen}b"}, origin="file", error=ArmError)
    assert validate(Named, {"name": "Gr\u00f6\u00dfe 1"}, origin="file", error=ArmError)


def test_files_beyond_the_limit_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "big.toml"
    path.write_text("#" * 101)
    with pytest.raises(ArmError, match=r"arm file big\.toml: wanted at most 100 bytes"):
        read_text(path, what="arm file", limit_bytes=100, error=ArmError)


def test_files_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"ab\xff")
    with pytest.raises(ArmError, match="wanted UTF-8 text, got byte 0xff at offset 2"):
        read_text(path, what="arm file", limit_bytes=100, error=ArmError)


@pytest.mark.parametrize("name", ["absent.toml", ".", "nul\0byte"])
def test_paths_without_a_file_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ArmError, match="arm file"):
        read_text(tmp_path / name, what="arm file", limit_bytes=100, error=ArmError)


def test_long_values_are_cut_in_messages() -> None:
    with pytest.raises(ArmError) as caught:
        refuse(ArmError, "x", "key", wanted="less", got="a" * 1000)
    assert len(str(caught.value)) < 100
