"""The closed loop: measure, judge, ask for the next test, measure that, until a verdict stands.

Every session lies in the folder, so that a loop that was stopped goes on where it was.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

from armodal.analyzer.gap.records import NextTest
from armodal.analyzer.gap.workflow import GapOutcome, find_gap
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import SessionError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Plan
from armodal.protocols.session.hdf5 import read_session, write_session
from armodal.protocols.session.records import Session
from armodal.protocols.text_file import replace_text

__all__ = ["ClosedLoop", "Laboratory", "run_loop"]


class Laboratory(Protocol):
    """What the loop asks of a laboratory."""

    @property
    def arm(self) -> Arm:
        """The arm as its user believes it."""

    @property
    def identity(self) -> str:
        """One line that no other laboratory or arm on its floor has."""

    def measure(self, plan: Plan | None, number: int) -> Session:
        """Measure by a plan, or by the laboratory's own for the first test."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """What was measured and why, and what it came to."""

    outcome: GapOutcome
    sessions: tuple[Path, ...]  # in the order in which they were measured
    tests: tuple[dict[str, Any], ...]


def run_loop(
    laboratory: Laboratory,
    folder: Path,
    *,
    budget: int,
    tell: Callable[[str], None] = lambda _: None,
    gates: bool = True,
) -> ClosedLoop:
    """Measure and judge until no further test is worth it, or the budget is spent.

    Parameters
    ----------
    folder
        Of `test-1.h5`, `test-2.h5`, ...: what is there already is not measured again. Its file
        `laboratory` tells whose they are.
    budget
        Further tests at most, beside the first.

    Raises
    ------
    SessionError
        If the folder is another laboratory's, or a session in it is of another arm or plan.
    EstimateError
        If the first session cannot carry the judgement.
    """
    folder.mkdir(parents=True, exist_ok=True)
    _claim(folder, laboratory.identity)
    sessions = [_test(laboratory, folder, 1, None, tell)]
    tests: list[dict[str, Any]] = []
    while True:
        outcome = _judged(sessions, tell, gates=gates)
        result = outcome.result
        advice = result.next_test
        if tests:
            tests[-1]["verdict_after"] = result.verdict.value
        if advice is None or len(sessions) > budget:
            break
        number = len(sessions) + 1
        tests.append({"number": number, "verdict_before": result.verdict.value, **_said(advice)})
        plan = plan_from_text(advice.plan_toml, laboratory.arm, origin="proposed plan")
        sessions.append(_test(laboratory, folder, number, plan, tell))
    paths = tuple(_path(folder, number) for number in range(1, len(sessions) + 1))
    return ClosedLoop(outcome=outcome, sessions=paths, tests=tuple(tests))


def _claim(folder: Path, identity: str) -> None:
    """Put the laboratory's name on an empty folder; refuse another's."""
    name = folder / "laboratory"
    if name.exists():
        came = name.read_text(encoding="utf-8", errors="replace").strip()
    elif _path(folder, 1).exists():
        came = "one that is not told"
    else:
        replace_text(name, f"{identity}\n")
        return
    if came != identity:
        raise SessionError(
            f"{folder} holds sessions of another laboratory: wanted {identity}, got {came[:100]}; "
            "give another folder"
        )


def _judged(sessions: Sequence[Session], tell: Callable[[str], None], *, gates: bool) -> GapOutcome:
    return find_gap(sessions[0], more=sessions[1:], gates=gates, modes=False, tell=tell)


def _path(folder: Path, number: int) -> Path:
    return folder / f"test-{number}.h5"


def _said(advice: NextTest) -> dict[str, Any]:
    said = asdict(advice)
    said.pop("plan_toml")
    return said


def _test(
    laboratory: Laboratory,
    folder: Path,
    number: int,
    plan: Plan | None,
    tell: Callable[[str], None],
) -> Session:
    """The session of a test: measured, or read where it was measured before."""
    path = _path(folder, number)
    if path.exists():
        session = read_session(path)
        wanted = None if plan is None else plan.sha256
        if session.header.arm.name != laboratory.arm.name:
            raise SessionError(
                f"{path} is of arm '{session.header.arm.name}', the laboratory's is "
                f"'{laboratory.arm.name}'; give another folder"
            )
        if wanted is not None and session.header.plan.sha256 != wanted:
            raise SessionError(
                f"{path} was measured by another plan than is asked for now; give another folder"
            )
        return session
    tell(f"test {number}: measuring")
    session = laboratory.measure(plan, number)
    write_session(session, path)
    return session
