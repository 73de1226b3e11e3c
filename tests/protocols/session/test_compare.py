import math

import numpy as np
import pytest

from armodal.protocols.session.compare import first_difference

EQUAL = [math.nan, 1.0, np.array([1.0, math.nan]), np.array(["a"]), ("a", None), {"a": 1}]
DIFFERENT = [
    (math.nan, 1.0),
    (1.0, math.nan),
    (1, 1.0),
    (np.array([1.0, math.nan]), np.array([1.0, 2.0])),
    (np.array([1.0]), np.array([1], dtype=np.int64)),
    (np.array([1.0]), np.array([1.0, 1.0])),
    ((1,), (1, 2)),
    ({"a": 1}, {"b": 1}),
]


@pytest.mark.parametrize("one", EQUAL, ids=repr)
def test_what_is_the_same_has_no_difference(one: object) -> None:
    assert first_difference(one, one, "it") is None


@pytest.mark.parametrize(("one", "other"), DIFFERENT, ids=repr)
def test_what_differs_is_named(one: object, other: object) -> None:
    assert first_difference(one, other, "it") == "it"


def test_the_first_part_that_differs_is_named() -> None:
    assert first_difference({"a": (1, 2.0)}, {"a": (1, math.nan)}, "it") == "it['a'][1]"
