"""JSON as its standard has it: no NaN, no infinity, numbers of numpy as plain ones."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["json_text", "plain"]


def json_text(value: object) -> str:
    """Return the text of one JSON object, with its last line's end."""
    return json.dumps(plain(value), indent=2, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """Replace numbers and lists of numpy by plain ones, and by None what JSON has no word for."""
    if isinstance(value, Mapping):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, np.generic | np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value
