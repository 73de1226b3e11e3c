"""Run the steps of a check one after another, whatever the device does."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from armodal.daq.check.verdict import (
    Finding,
    Report,
    Step,
    StepResult,
    failed,
    result_of,
    unchecked,
)
from armodal.protocols.errors import ArmodalError, DeviceLostError, DeviceTimeoutError

__all__ = ["CheckError", "choose", "run_steps"]

BenchT = TypeVar("BenchT")


class CheckError(ArmodalError, ValueError):
    """A check that was asked for and does not exist."""


def choose(steps: Iterable[Step[BenchT]], only: Iterable[str]) -> tuple[Step[BenchT], ...]:
    """Return the steps named, in their order; all where none is.

    Raises
    ------
    CheckError
        If a name is not that of a step.
    """
    known = {step.name: step for step in steps}
    wanted = set(only)
    for name in wanted:
        if name not in known:
            raise CheckError(f"wanted steps of this check ({', '.join(known)}), got {name!r}")
    return tuple(step for name, step in known.items() if not wanted or name in wanted)


def run_steps(
    device: str,
    steps: Iterable[Step[BenchT]],
    bench: BenchT,
    *,
    make_ready: Callable[[BenchT], None],
    tell: Callable[[StepResult | str], None],
) -> Report:
    """Try each step; once the device is gone, the rest is not checked."""
    results: list[StepResult] = []
    gone = ""
    for step in steps:
        tell(step.title)
        if not gone:
            try:
                make_ready(bench)
            except (DeviceLostError, DeviceTimeoutError) as error:
                gone = str(error)
            except ArmodalError as error:
                gone = f"the device cannot be made ready: {error}"
        finding = unchecked(gone) if gone else _try(step, bench)
        result = result_of(step, finding)
        tell(result)
        results.append(result)
    return Report(device=device, steps=tuple(results))


def _try(step: Step[BenchT], bench: BenchT) -> Finding:
    try:
        return step.run(bench)
    except ArmodalError as error:
        # Whatever the device sent that could not be used is what the step has found.
        return failed(str(error))
