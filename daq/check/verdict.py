"""What a check found: steps, each with what was wanted, what came, and what to do about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Generic, TypeVar

__all__ = ["Finding", "Report", "Step", "StepResult", "Verdict", "failed", "passed", "unchecked"]

BenchT = TypeVar("BenchT")

MOST_PROBLEMS = 3


class Verdict(StrEnum):
    """Outcome of a step."""

    PASS = "pass"  # noqa: S105 - a verdict, not a password
    FAIL = "fail"
    NOT_CHECKED = "not checked"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What came, and what it is worth."""

    verdict: Verdict
    came: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Step(Generic[BenchT]):
    """One claim about a device, and the function that tries it."""

    name: str
    title: str
    wanted: str
    hint: str  # what to do where it fails
    run: Callable[[BenchT], Finding]


@dataclass(frozen=True, slots=True, kw_only=True)
class StepResult:
    """A step that has been tried."""

    name: str
    title: str
    wanted: str
    came: str
    verdict: Verdict
    hint: str  # empty where it passed


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """All steps of a check, in order."""

    device: str
    steps: tuple[StepResult, ...]

    @property
    def passed(self) -> bool:
        """Whether no step failed; steps that were not checked do not count."""
        return all(step.verdict is not Verdict.FAIL for step in self.steps)

    def step(self, name: str) -> StepResult:
        """Return the step called `name`, or raise KeyError."""
        for step in self.steps:
            if step.name == name:
                return step
        raise KeyError(name)

    def count(self, verdict: Verdict) -> int:
        """Return how many steps have this verdict."""
        return sum(step.verdict is verdict for step in self.steps)

    def as_json(self) -> dict[str, Any]:
        """Return the report as an object of JSON."""
        return {
            "device": self.device,
            "passed": self.passed,
            "steps": [
                {
                    "name": step.name,
                    "title": step.title,
                    "wanted": step.wanted,
                    "came": step.came,
                    "verdict": step.verdict.value,
                    "hint": step.hint,
                }
                for step in self.steps
            ],
        }


def passed(came: str) -> Finding:
    """Return that it is as wanted."""
    return Finding(verdict=Verdict.PASS, came=came)


def unchecked(reason: str) -> Finding:
    """Return that it could not be tried, and why."""
    return Finding(verdict=Verdict.NOT_CHECKED, came=reason)


def failed(problems: str | Iterable[str]) -> Finding:
    """Return that it is not as wanted: one problem, or the first few of many.

    >>> failed(["a", "b", "c", "d", "e"]).came
    'a; b; c; and 2 more'
    """
    listed = [problems] if isinstance(problems, str) else list(problems)
    text = "; ".join(listed[:MOST_PROBLEMS])
    if len(listed) > MOST_PROBLEMS:
        text += f"; and {len(listed) - MOST_PROBLEMS} more"
    return Finding(verdict=Verdict.FAIL, came=text)


def result_of(step: Step[BenchT], finding: Finding) -> StepResult:
    """Return the record of a step tried."""
    return StepResult(
        name=step.name,
        title=step.title,
        wanted=step.wanted,
        came=finding.came,
        verdict=finding.verdict,
        hint="" if finding.verdict is Verdict.PASS else step.hint,
    )
