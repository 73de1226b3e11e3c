"""A gap result as JSON beside its session: `<session>.gap.json`."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from armodal.analyzer.gap.records import GapResult
from armodal.protocols.errors import EstimateError
from armodal.protocols.toml_reader import read_text

__all__ = ["gap_from_json", "gap_path", "gap_to_json", "read_gap"]

_LIMIT = 16 * 1024 * 1024
_MOST_VALUES = 200_000  # a fault of each would be told: half a kilobyte
_ADAPTER: TypeAdapter[GapResult] = TypeAdapter(GapResult)


def gap_path(session: Path) -> Path:
    """Return where the gap result of a session file lies."""
    return session.with_suffix(".gap.json")


def gap_to_json(result: GapResult) -> str:
    """Return a result as JSON text; numbers come back bit by bit."""
    return _ADAPTER.dump_json(result, indent=1).decode("utf-8")


def gap_from_json(text: str, *, origin: str = "gap result") -> GapResult:
    """Read a result, refusing unknown keys, wrong types and numbers that are not finite.

    Raises
    ------
    EstimateError
        With the path of the first value that does not fit.
    """
    advice = "; run `armodal gap` again"
    if text.count(",") > _MOST_VALUES:
        raise EstimateError(f"{origin}: wanted at most {_MOST_VALUES} values, got more{advice}")
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as problem:
        raise EstimateError(f"{origin}: wanted JSON, got: {problem}{advice}") from problem
    try:
        found = _ADAPTER.validate_json(text, strict=True)
    except (ValidationError, RecursionError) as problem:
        said = str(problem)
        if isinstance(problem, ValidationError):
            first = problem.errors(include_url=False, include_input=False)[0]
            said = f"{'.'.join(map(str, first['loc'])) or 'the file'}: {first['msg']}"
        raise EstimateError(f"{origin}: {said}{advice}") from problem
    odd = _first_difference(data, json.loads(gap_to_json(found)), "")
    if odd is not None:
        raise EstimateError(
            f"{origin}: {odd}: wanted a known key and a finite number, got another{advice}"
        )
    return found


def read_gap(path: Path) -> GapResult:
    """Read a gap result file.

    Raises
    ------
    EstimateError
        As `gap_from_json`, or if the file cannot be read.
    """
    text = read_text(path, what="gap result", limit_bytes=_LIMIT, error=EstimateError)
    return gap_from_json(text, origin=f"gap result {path.name}")


def _first_difference(given: Any, kept: Any, path: str) -> str | None:
    """Return the path of what the records did not take over, or of a number not finite."""
    if isinstance(given, float) and not math.isfinite(given):
        return path
    if isinstance(given, Mapping) and isinstance(kept, Mapping):
        for key, value in given.items():
            where = f"{path}.{key}" if path else str(key)
            if key not in kept:
                return where
            if (odd := _first_difference(value, kept[key], where)) is not None:
                return odd
    elif isinstance(given, list) and isinstance(kept, list):
        for i, (value, own) in enumerate(zip(given, kept, strict=False)):
            if (odd := _first_difference(value, own, f"{path}[{i}]")) is not None:
                return odd
    return None
