"""What a command prints for machines is JSON that any reader takes."""

import json
from math import inf, nan

import numpy as np

from armodal.tui.json_text import json_text

FOUND = {
    "n": np.int64(3),
    "covers": np.bool_(True),
    "std": [0.5, inf, np.float64(nan)],
    "row": (np.array([1.0, nan]), {"low": -inf, "word": "nan"}),
}


def refuse(word: str) -> None:
    raise AssertionError(f"{word} is no JSON")


def test_numbers_of_numpy_are_plain_and_those_that_are_not_finite_are_null():
    assert json.loads(json_text(FOUND), parse_constant=refuse) == {
        "n": 3,
        "covers": True,
        "std": [0.5, None, None],
        "row": [[1.0, None], {"low": None, "word": "nan"}],
    }
