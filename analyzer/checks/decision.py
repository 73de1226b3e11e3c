"""When a fault is named: the rule over the candidates of one posture.

Four conditions, all of them needed: the fault explains the data far better than ordinary errors do;
no fault of another name or place comes near; it is large enough to matter; what it leaves is noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.checks.candidates import Candidate, describe
from armodal.analyzer.checks.records import Finding, Outcome

__all__ = [
    "ADEQUATE",
    "CLEARLY_BETTER",
    "CONTINUOUS_BAR",
    "RIVAL_WITHIN",
    "Decision",
    "combined_finding",
    "decide",
]

CLEARLY_BETTER = 40.0  # of twice the log likelihood ratio, over the scale of the residual
PERHAPS = 0.6  # of the bar: too much for a good word, too little for a name
CONTINUOUS_BAR = 1.5  # times as high a bar for what errors of aim can look like
FULL_CONSTRAINTS = 20  # with fewer independent constraints the bar is that much higher
RIVAL_WITHIN = 10.0
ADEQUATE = 1.0  # residual per degree of freedom that noise and local discrepancies may leave


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """A finding, the discrete fault to undo before looking for a second one, and its strength.

    `faint` is a *cannot tell* that stays below the bar: the next posture may dispel it.
    """

    finding: Finding
    undo: Candidate | None
    faint: bool


def decide(
    posture: str,
    measured: tuple[str, ...],
    found: list[Candidate],
    dof: float,
    constraints: int,
    gain_std: npt.NDArray[np.float64],
) -> Decision:
    """Decide between candidates, sorted by cost, of which one is that nothing is wrong."""
    null = next(c for c in found if c.fault is None)
    best = found[0]
    bar = CLEARLY_BETTER * max(1.0, FULL_CONSTRAINTS / max(constraints, 1))
    scale = max(1.0, best.residual / max(dof, 1.0))

    def say(
        outcome: Outcome,
        text: str,
        *,
        confidence: float = 0.0,
        undo: Candidate | None = None,
        faint: bool = False,
    ) -> Decision:
        named = outcome is Outcome.FAULT
        finding = Finding(
            check="rigid link",
            posture=posture,
            outcome=outcome,
            fault=best.fault if named else None,
            points=tuple(measured[p] for p in best.at) if named and not best.everywhere else (),
            everywhere=named and best.everywhere,
            confidence=confidence,
            text=text,
        )
        return Decision(finding=finding, undo=undo, faint=faint)

    if dof < 1.0:
        return say(Outcome.CANNOT_TELL, "no link has enough points", faint=True)

    def over_bar(c: Candidate) -> float:
        high = bar * (CONTINUOUS_BAR if c.continuous else 1.0)
        return (null.cost - c.cost) / scale / high

    if best.fault is None or over_bar(best) < 1.0 or not best.material:
        suspect = max((c for c in found if c.material and c.fault), key=over_bar, default=null)
        near = over_bar(suspect)
        seen = np.sqrt(CONTINUOUS_BAR * bar * scale) * float(np.median(gain_std))
        text = (
            "the points move as rigid links within the ordinary errors; a gain off by "
            f"{100.0 * seen:.0f} % along one axis would show at half of the points"
        )
        confidence = float(np.clip(1.0 - near, 0.0, 1.0))
        outcome, faint = Outcome.GOOD, False
        if null.residual / dof > ADEQUATE:
            outcome, confidence = Outcome.CANNOT_TELL, 0.0
            text = "the points do not move as rigid links, and no single fault explains it"
        elif near > PERHAPS:
            outcome, confidence, faint = Outcome.CANNOT_TELL, 0.0, True
            text = f"perhaps {describe(measured, suspect)}; measure it again"
        return say(outcome, text, confidence=confidence, faint=faint)
    rivals = [
        c for c in found if c.name != best.name and (c.cost - best.cost) / scale < RIVAL_WITHIN
    ]
    if rivals:
        words = "; ".join(describe(measured, c) for c in (best, *rivals[:3]))
        return say(Outcome.CANNOT_TELL, f"something is wrong, one of: {words}")
    undo = None if best.continuous else best
    if best.residual / dof > ADEQUATE:
        text = "something is wrong, and no single fault explains it"
        return say(Outcome.CANNOT_TELL, text, undo=undo)
    return say(
        Outcome.FAULT,
        describe(measured, best),
        confidence=_confidence(found, best, scale),
        undo=undo,
    )


def combined_finding(
    first: Finding, second: Finding, measured: tuple[str, ...], undone: Candidate
) -> Finding:
    """What is said of a fault together with what is left once it is undone."""
    told = describe(measured, undone)
    at = () if undone.everywhere else tuple(measured[p] for p in undone.at)
    if second.outcome is Outcome.FAULT:
        return replace(
            second,
            points=(*at, *(p for p in second.points if p not in at)),
            fault=undone.fault,
            everywhere=undone.everywhere or second.everywhere,
            text=f"{told}; and besides, {second.text}",
        )
    if first.outcome is Outcome.FAULT and second.outcome is Outcome.CANNOT_TELL:
        return replace(first, text=f"{told}; and besides, {second.text}")
    return first


def _confidence(found: list[Candidate], chosen: Candidate, scale: float) -> float:
    """Share of the likelihood that candidates of the chosen name hold."""
    least = found[0].cost
    weight = np.exp([-0.5 * (c.cost - least) / scale for c in found])
    same = np.array([c.name == chosen.name for c in found])
    return float(weight[same].sum() / weight.sum())
