"""Acquisitions begun by a test, all ended with it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from support.acquisition_run import Run


@pytest.fixture
def start(lab: Any) -> Iterator[Callable[..., Run]]:
    runs: list[Run] = []

    def begin(**changes: Any) -> Run:
        runs.append(Run(lab, **changes))
        return runs[-1]

    yield begin
    for run in runs:
        run.end()
