import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "support"))

from analyzer.arm import Superset
from protocols.arm.files import load_arm


@pytest.fixture(scope="session")
def arm():
    return load_arm("rv4frl")


@pytest.fixture(scope="session")
def superset(arm):
    return Superset(arm)
