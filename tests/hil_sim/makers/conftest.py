"""Arms of tables as both makers build them, without errors."""

from __future__ import annotations

import pytest
from support.ideal_maker import Ideal


@pytest.fixture(scope="session")
def ideal():
    return Ideal
