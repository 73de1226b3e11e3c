"""Every decoder of files takes no more memory and time than `protocols/bounds.py` allows."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import support.bombs_of_hdf5
import support.bombs_of_others  # noqa: F401 - adds to them
from support.bombs import BOMBS, SLOW_TO_MAKE, SLOW_TO_READ
from support.bounded import decode_bounded, wrong_with
from support.changed_meshes import WHOLE, changed_meshes
from support.quick import few_quick

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="bounds a process as Linux does"),
    pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning"),
]

SLOW = SLOW_TO_MAKE | SLOW_TO_READ
NAMES = [pytest.param(name, marks=[pytest.mark.long] if name in SLOW else []) for name in BOMBS]


@pytest.mark.parametrize("name", NAMES)
def test_a_bomb_is_read_or_refused_within_bounds(name, tmp_path):
    decoders, ending, make = BOMBS[name]
    path = tmp_path / f"bomb{ending}"
    make(path)
    for decoder in decoders:
        assert wrong_with(decoder, path) == ""


def test_a_decoder_beyond_its_bounds_is_told(tmp_path):
    path = tmp_path / "a.npy"
    path.write_bytes(bytes(10))
    assert decode_bounded("glutton", path, most_bytes=10**7, most_s=10).is_fault
    assert "MB" in wrong_with("large", path)


@pytest.mark.parametrize("ending", few_quick(WHOLE, ".ply"))
def test_a_mesh_made_wrong_is_read_or_refused_within_bounds(ending, tmp_path):
    path = tmp_path / f"a{ending}"
    path.write_bytes(WHOLE[ending])
    whole = decode_bounded("mesh", path, most_bytes=10**8, most_s=10)
    assert (whole.said, whole.is_fault) == ("", False)
    for kind, data in changed_meshes(1, np.random.default_rng(0)):
        if kind == ending:
            path.write_bytes(data)
            assert wrong_with("mesh", path) == ""
