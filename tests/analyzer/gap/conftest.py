import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.protocols.arm.files import load_arm


@pytest.fixture(scope="session")
def superset():
    """Of bench57."""
    return Superset(load_arm("bench57"))
