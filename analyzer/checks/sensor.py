"""The sensor over all postures: what the rigid-link checks say together.

A sensor that is mounted, labelled or wired wrongly is so in every posture, errors of aim are new
in each. Likelihood ratios of one fault therefore add up over postures, and a fault too faint for
any of them may be clear in all of them together.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.checks.candidates import Candidate, describe
from armodal.analyzer.checks.decision import CLEARLY_BETTER, CONTINUOUS_BAR, RIVAL_WITHIN
from armodal.analyzer.checks.records import Fault, Finding, Outcome
from armodal.analyzer.checks.rigid_link import RigidLinkResult

__all__ = ["sensor_verdict"]

LEAST_IN_EACH = 8.0  # of twice the log likelihood ratio, in two postures at least
AGREE = 0.5  # sizes of a gain in two postures differ by less than this part of their sum


@dataclass(frozen=True, slots=True, kw_only=True)
class _Named:
    """A fault with the names of its points, the same in every posture."""

    fault: Fault
    points: tuple[str, ...]
    everywhere: bool
    key: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Total:
    named: _Named
    gain: float  # sum over postures of twice the log likelihood ratio
    support: int  # postures with a part in it
    seen_in: tuple[str, ...]
    candidate: Candidate  # of the posture that says most
    measured: tuple[str, ...]
    agree: bool
    short: float  # by how much other faults explain single postures better, summed


def sensor_verdict(
    results: Sequence[RigidLinkResult], narrower: Iterable[Sequence[RigidLinkResult]] = ()
) -> Finding:
    """One finding over all postures.

    A fault that one posture alone names, while others do not have it, is said to be of that
    posture: of a mounting there. One that all postures name only together must lead in every band.
    A wrong sensor is wrong at every frequency; what bends, gives way in a bearing or moves with the
    sensor's own mass is not.

    Parameters
    ----------
    narrower
        Of each narrower band, the results of all postures; asked for where they are needed.
    """
    usable = [r for r in results if r.candidates]
    faults = [r.finding for r in usable if r.finding.outcome is Outcome.FAULT]
    alike = {(f.fault, f.points, f.everywhere) for f in faults}
    if len(faults) > 1 and len(alike) == 1:
        return _of(faults, f"{faults[0].text} (in {_postures(faults)})")
    clear = _clear(usable)
    if clear:
        together = _together(clear)
        elsewhere = together.outcome is Outcome.FAULT and not _leads(together, narrower)
        if not elsewhere:
            return together
        if not faults:
            text = f"perhaps {together.text}, but not by lines of every band; measure it again"
            return _say(Outcome.CANNOT_TELL, text)
    if len(alike) == 1:
        return _of(faults, f"{faults[0].text}, in {_postures(faults)} only")
    if faults:
        names = _postures(faults)
        return _say(Outcome.CANNOT_TELL, f"different faults in {names}; see each posture")
    return _without_fault(usable)


def _leads(finding: Finding, narrower: Iterable[Sequence[RigidLinkResult]]) -> bool:
    """Whether all postures together lead to a fault in every band that can be judged."""
    named = finding.fault, finding.points, finding.everywhere
    for results in narrower:
        usable = [r for r in results if r.candidates]
        best = _leading(usable)
        if usable and (best is None or (best.fault, best.points, best.everywhere) != named):
            return False
    return True


def _leading(results: Sequence[RigidLinkResult]) -> _Named | None:
    """What all postures together are explained best by, if by more than rivals are apart."""
    found = [t for t in (_total(named, results) for named in _names(results)) if t is not None]
    best = max(found, key=lambda t: t.gain, default=None)
    return None if best is None or best.gain < RIVAL_WITHIN else best.named


def _without_fault(results: Sequence[RigidLinkResult]) -> Finding:
    """Good only if no posture is plainly wrong in a way that got no name."""
    good = [r.finding for r in results if r.finding.outcome is Outcome.GOOD]
    wrong = [r.finding for r in results if r.finding.outcome is Outcome.CANNOT_TELL and not r.faint]
    if wrong:
        return _say(Outcome.CANNOT_TELL, f"{wrong[0].text} (in {_postures(wrong)})")
    if not good:
        return _say(Outcome.CANNOT_TELL, "no posture could be judged")
    confidence = min(f.confidence for f in good)
    return _say(Outcome.GOOD, f"nothing wrong in {_postures(good)}", confidence)


def _together(clear: Sequence[_Total]) -> Finding:
    """A fault all postures name together, or the rivals they leave."""
    best = clear[0]
    if len(clear) > 1:
        words = "; ".join(describe(t.measured, t.candidate) for t in clear[:4])
        return _say(Outcome.CANNOT_TELL, f"something is wrong, one of: {words}")
    return Finding(
        check="sensor",
        posture="all",
        outcome=Outcome.FAULT,
        fault=best.named.fault,
        points=best.named.points,
        everywhere=best.named.everywhere,
        confidence=float(1.0 / (1.0 + np.exp(-0.5 * (best.gain - RIVAL_WITHIN)))),
        text=f"{describe(best.measured, best.candidate)} (from {', '.join(best.seen_in)})",
    )


def _clear(results: Sequence[RigidLinkResult]) -> list[_Total]:
    """The fault that all postures together name, with its rivals; empty where there is none."""
    totals = [_total(named, results) for named in _names(results)]
    clear = [
        t
        for t in totals
        if t is not None
        and t.agree
        and t.support > 1
        and t.short < CLEARLY_BETTER
        and t.gain > CLEARLY_BETTER * (CONTINUOUS_BAR if t.candidate.continuous else 1.0)
    ]
    if not clear:
        return []
    clear.sort(key=lambda t: -t.gain)
    best = clear[0]

    def place(t: _Total) -> tuple[Fault, tuple[str, ...], bool]:
        return t.named.fault, t.named.points, t.named.everywhere

    rivals = [t for t in clear[1:] if t.gain > best.gain - RIVAL_WITHIN and place(t) != place(best)]
    return [best, *rivals]


def _names(results: Sequence[RigidLinkResult]) -> list[_Named]:
    """Every fault that was fitted in any posture and is large enough to matter."""
    names: dict[_Named, None] = {}
    for r in results:
        for c in r.candidates:
            if c.fault is not None and c.material:
                names.setdefault(_name(r, c.fault, c), None)
    return list(names)


def _name(result: RigidLinkResult, fault: Fault, c: Candidate) -> _Named:
    points = () if c.everywhere else tuple(result.measured[p] for p in c.at)
    return _Named(fault=fault, points=points, everywhere=c.everywhere, key=c.key)


def _total(named: _Named, results: Sequence[RigidLinkResult]) -> _Total | None:
    """Sum of one fault over the postures that could show it."""
    gain, support, short = 0.0, 0, 0.0
    parts: list[tuple[float, Candidate, RigidLinkResult]] = []
    for r in results:
        if not named.everywhere and not set(named.points) <= set(r.measured):
            continue
        null = next(c for c in r.candidates if c.fault is None)
        same = next(
            (c for c in r.candidates if c.fault is not None and _name(r, c.fault, c) == named),
            None,
        )
        if same is None:  # fell out of the screen: worse than nothing wrong at all
            gain -= CLEARLY_BETTER
            short += CLEARLY_BETTER
            continue
        part = (null.cost - same.cost) / r.scale
        short += (same.cost - r.candidates[0].cost) / r.scale
        gain += part
        support += part > LEAST_IN_EACH
        parts.append((part, same, r))
    if not parts:
        return None
    parts.sort(key=lambda p: -p[0])
    most = parts[0]
    sizes = np.array([c.size for part, c, _ in parts if part > LEAST_IN_EACH])
    agree = bool(sizes.size == 0 or np.ptp(sizes) <= AGREE * abs(sizes.sum()))
    return _Total(
        named=named,
        gain=gain,
        support=support,
        seen_in=tuple(r.finding.posture for part, _, r in parts if part > LEAST_IN_EACH),
        candidate=most[1],
        measured=most[2].measured,
        agree=agree,
        short=short,
    )


def _postures(findings: Sequence[Finding]) -> str:
    return ", ".join(f.posture for f in findings)


def _of(faults: Sequence[Finding], text: str) -> Finding:
    first = faults[0]
    return Finding(
        check="sensor",
        posture="all",
        outcome=Outcome.FAULT,
        fault=first.fault,
        points=first.points,
        everywhere=first.everywhere,
        confidence=1.0 - float(np.prod([1.0 - f.confidence for f in faults])),
        text=text,
    )


def _say(outcome: Outcome, text: str, confidence: float = 0.0) -> Finding:
    return Finding(
        check="sensor",
        posture="all",
        outcome=outcome,
        fault=None,
        points=(),
        everywhere=False,
        confidence=confidence,
        text=text,
    )
