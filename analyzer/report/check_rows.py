"""Checks of the measurement as a few rows: green, amber or red, and always in words."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from armodal.analyzer.checks.records import Outcome
from armodal.analyzer.gap.records import Gate

__all__ = ["CheckRow", "check_rows", "state_of"]

_STATES = {
    Outcome.GOOD.value: "good",
    Outcome.TO_KNOW.value: "unsure",
    Outcome.CANNOT_TELL.value: "unsure",
}
_WORDS = {"good": "good", "unsure": "not settled", "fault": "fault"}


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckRow:
    """One kind of check over all postures."""

    check: str
    state: str  # "good", "unsure" or "fault": its colour
    word: str
    text: str


def state_of(outcome: str) -> str:
    """Return the colour of a check's outcome: what is not known for good is not green."""
    return _STATES.get(outcome, "fault")


def check_rows(gates: Sequence[Gate], postures: Collection[str]) -> tuple[CheckRow, ...]:
    """One row a kind of check; the worst of its postures gives the colour and speaks."""
    kinds: dict[str, list[tuple[str, Gate]]] = {}
    for gate in gates:
        posture = next((name for name in (*postures, "all") if gate.check.endswith(f" {name}")), "")
        kind = gate.check.removesuffix(f" {posture}") if posture else gate.check
        kinds.setdefault(kind, []).append((posture, gate))
    return tuple(_row(kind, rows) for kind, rows in kinds.items())


def _row(kind: str, rows: list[tuple[str, Gate]]) -> CheckRow:
    by_state: dict[str, list[tuple[str, Gate]]] = {}
    for posture, gate in rows:
        by_state.setdefault(state_of(gate.outcome), []).append((posture, gate))
    worst = next(state for state in ("fault", "unsure", "good") if state in by_state)
    speaking = by_state[worst]
    said = []
    for words in dict.fromkeys(gate.words for _, gate in speaking):
        at = [posture for posture, gate in speaking if gate.words == words and posture != "all"]
        everywhere = len(at) == len(rows) or not any(at)
        said.append(words if everywhere else f"{', '.join(at)}: {words}")
    if worst == "good":
        text = said[0] if len(said) == 1 else f"at all {len(rows)} postures"
    elif len(said) > 1:
        text = f"{said[0]}; and {len(said) - 1} more, see Checks"
    else:
        text = said[0]
    if worst != "good" and "good" in by_state:
        text += f"; good at {len(by_state['good'])} of {len(rows)}"
    return CheckRow(check=kind, state=worst, word=_WORDS[worst], text=text)
