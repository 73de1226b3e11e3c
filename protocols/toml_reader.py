"""Strict reading of TOML files that people write: unknown keys and impossible values are refused.

Every refusal is one sentence with the file, the key's path, what was wanted and what came:
`arm file a.toml: joints[2].stiffness_n_m_per_rad.value: wanted greater than 0, got -5.0`.
Positions in arrays count from 0.
"""

from __future__ import annotations

import difflib
import os
import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, NoReturn, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails, PydanticCustomError

from armodal.protocols.bounds import MOST_KEY_PARTS, MOST_TABLE_DEPTH
from armodal.protocols.errors import ArmodalError
from armodal.protocols.os_words import os_words
from armodal.protocols.printable import UNSEEN

__all__ = [
    "FileModel",
    "Name",
    "Vector3",
    "not_wanted",
    "parse_toml",
    "read_text",
    "refuse",
    "validate",
]

# Names reach terminals and reports: no control characters, C0 or C1, and none that turns the line.
Name = Annotated[str, Field(min_length=1, max_length=64, pattern=rf"^[^{UNSEEN}]+$")]
Vector3 = Annotated[list[float], Field(min_length=3, max_length=3)]

ModelT = TypeVar("ModelT", bound="FileModel")

_LONGEST_SHOWN = 60
_BETWEEN_KEYS = re.compile(r"[=,:;#\[\]{}()]")
_JOINED = re.compile(r"""[\w"'-]\s*\.\s*(?=[\w"'-])""")


def not_wanted(wanted: str) -> PydanticCustomError:
    """Return the error a validator raises where a value is not `wanted`."""
    # pydantic fills {} from a context that is not given here.
    return PydanticCustomError("armodal", wanted.replace("{", "(").replace("}", ")"))


class FileModel(BaseModel):
    """A table of a file: strict types, finite numbers, no key that is not known."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, data: Any) -> Any:
        if isinstance(data, dict):
            known = list(cls.model_fields)
            for key in data:
                if key not in known:
                    raise PydanticCustomError("unknown_key", "{key}", {"key": key, "known": known})
        return data


def read_text(path: Path, *, what: str, limit_bytes: int, error: type[ArmodalError]) -> str:
    """Read a UTF-8 text file of at most `limit_bytes`.

    Raises
    ------
    ArmodalError
        Of type `error`, if the file is absent, no plain file, too large or not UTF-8.
    """
    try:
        absent = not path.is_file()
    except (OSError, ValueError) as problem:
        raise error(
            f"{what} {path}: cannot be read ({os_words(problem)}); check the path"
        ) from problem
    if absent:
        raise error(f"{what} {path}: wanted a readable file, found none; check the path")
    try:
        with path.open("rb") as file:
            size = os.fstat(file.fileno()).st_size  # read() takes room for what it is told
            data = file.read(min(size, limit_bytes) + 1)
    except (OSError, ValueError) as problem:
        raise error(
            f"{what} {path}: cannot be read ({os_words(problem)}); check the path"
        ) from problem
    if len(data) > limit_bytes:
        raise error(f"{what} {path.name}: wanted at most {limit_bytes} bytes, got more")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as problem:
        raise error(
            f"{what} {path.name}: wanted UTF-8 text, got byte 0x{data[problem.start]:02x} at "
            f"offset {problem.start}; save it as UTF-8"
        ) from problem


def parse_toml(text: str, *, origin: str, error: type[ArmodalError]) -> dict[str, Any]:
    """Parse TOML text into plain dictionaries, or raise `error` with line and column."""
    # A key of n parts is n tables, and the parser copies what leads to each: n^2 of memory.
    for number, line in enumerate(text.split("\n"), start=1):
        parts = max(len(_JOINED.findall(key)) for key in _BETWEEN_KEYS.split(line)) + 1
        if parts > MOST_TABLE_DEPTH:
            raise error(
                f"{origin}: line {number}: wanted keys of at most {MOST_TABLE_DEPTH} parts, got "
                f"{parts}"
            )
        if len(_JOINED.findall(line)) > MOST_KEY_PARTS:
            raise error(
                f"{origin}: line {number}: wanted at most {MOST_KEY_PARTS} dots on a line, got "
                "more; part it"
            )
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as problem:
        raise error(f"{origin}: wanted valid TOML, got: {problem}") from problem
    if _depth(data) > MOST_TABLE_DEPTH:
        raise error(f"{origin}: wanted tables at most {MOST_TABLE_DEPTH} deep, got more")
    return data


def validate(
    model: type[ModelT], data: dict[str, Any], *, origin: str, error: type[ArmodalError]
) -> ModelT:
    """Fit `data` into `model`, or raise `error` naming the first key that does not fit."""
    try:
        return model.model_validate(data)
    except ValidationError as problem:
        details = problem.errors(include_url=False)
        more = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
        raise error(f"{origin}: {_sentence(details[0], data)}{more}") from problem


def refuse(
    error: type[ArmodalError], origin: str, path: str, *, wanted: str, got: object
) -> NoReturn:
    """Raise `error` for a value that fits its key alone but not the rest of the file."""
    raise error(f"{origin}: {path}: wanted {wanted}, got {shown(got)}")


def shown(value: object) -> str:
    """Return a value as a message may show it: short, on one line.

    >>> shown("a" * 100)
    "'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa..."
    """
    try:
        text = repr(value)
    except ValueError:  # an integer of more digits than Python prints
        return "a huge integer"
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


def _depth(data: dict[str, Any]) -> int:
    depth, layer = 0, [data]  # type: int, list[Any]
    while layer and depth <= MOST_TABLE_DEPTH:
        depth += 1
        layer = [
            child
            for item in layer
            for child in (item.values() if isinstance(item, dict) else item)
            if isinstance(child, dict | list)
        ]
    return depth


def _sentence(detail: ErrorDetails, data: dict[str, Any]) -> str:
    loc, context = list(detail["loc"]), detail.get("ctx", {})
    kind, message, value = detail["type"], detail["msg"], detail["input"]
    named = _name_of_entry(loc, data)
    if kind == "unknown_key":
        key, known = context["key"], context["known"]
        near = difflib.get_close_matches(key, known, n=1)
        hint = f" (did you mean {near[0]}?)" if near else ""
        return (
            f"{_path([*loc, key])}: wanted one of the keys {', '.join(known)}, "
            f"got the unknown key {shown(key)}{hint}{named}"
        )
    if kind == "missing":
        return f"{_path(loc)}: wanted a value, got nothing; add the key{named}"
    if kind in {"too_short", "too_long"}:
        bound = "at least" if kind == "too_short" else "at most"
        number = context["min_length" if kind == "too_short" else "max_length"]
        return f"{_path(loc)}: wanted {bound} {number} items, got {shown(value)}{named}"
    if kind == "model_type":
        message = "a table"
    elif kind == "string_pattern_mismatch":
        message = "text without control characters" if "x00" in message else message
    wanted = message.removeprefix("Input should be ")
    wanted = wanted.replace("a valid integer", "an integer").replace("a valid ", "a ")
    return f"{_path(loc)}: wanted {wanted}, got {shown(value)}{named}"


def _path(loc: Sequence[int | str]) -> str:
    text = ""
    for step in loc:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            key = step if step.isidentifier() else shown(step)
            text += f".{key}" if text else key
    return text or "the file"


def _name_of_entry(loc: Sequence[int | str], data: dict[str, Any]) -> str:
    """Say which named entry an array position is, to spare the reader the counting."""
    here: Any = data
    for depth, step in enumerate(loc):
        try:
            here = here[step]
        except (KeyError, IndexError, TypeError):
            return ""
        if isinstance(step, int) and isinstance(here, dict):
            for key in ("name", "id", "joint"):
                if isinstance(here.get(key), str):
                    return f"; {_path(loc[: depth + 1])} is {shown(here[key])}"
    return ""
