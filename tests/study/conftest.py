"""What holds for the tests of studies."""

import pytest

import armodal.study.pace


@pytest.fixture(autouse=True)
def _a_hasty_pace(monkeypatch):
    """How fast the machine is just now is not asked at length."""
    monkeypatch.setattr(armodal.study.pace, "_SQUARES", 1000)
