"""The pinned versions, with and without hashes."""

from __future__ import annotations

import re

import pytest
from support.pinned import CONSTRAINTS, HASHED, pinned

MADE_BY = "made by `make hashes`"


def test_both_constraints_files_pin_the_same_versions():
    plain = {name: version for name, (version, _) in pinned(CONSTRAINTS).items()}
    hashed = {name: version for name, (version, _) in pinned(HASHED).items()}
    assert hashed == plain, MADE_BY


def test_every_hashed_version_has_sha256_hashes():
    for name, (_, hashes) in pinned(HASHED).items():
        assert hashes, name
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", one) for one in hashes), name


def test_hashes_cover_the_wheels_of_several_systems_and_pythons():
    # One wheel for each of four Pythons on Linux, macOS and Windows, and the source.
    assert len(pinned(HASHED)["numpy"][1]) > 12


@pytest.mark.parametrize("path", [CONSTRAINTS, HASHED], ids=lambda path: path.name)
def test_constraints_carry_no_address_and_no_path(path):
    found = re.findall(
        r"^.*(?:://|@|/|--index|--find-links|--extra).*$", path.read_text(), re.MULTILINE
    )
    assert found == []
