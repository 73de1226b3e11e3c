"""A pytest plugin: tells coverage which test runs, so that each line knows the tests that touch it.

    coverage run -m pytest -p coverage_contexts ...

What a fixture does counts as the test's `setup`.
"""

from __future__ import annotations

import coverage
import pytest


def _switch(item: pytest.Item, phase: str) -> None:
    current = coverage.Coverage.current()
    if current is not None:
        current.switch_context(f"{item.nodeid}|{phase}")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Name what fixtures do."""
    _switch(item, "setup")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call(item: pytest.Item) -> None:
    """Name what the test does."""
    _switch(item, "run")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Name what comes after."""
    _switch(item, "teardown")
