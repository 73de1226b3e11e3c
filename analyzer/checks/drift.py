"""Whether resonances stay where they are from one mounting of the sensor to the next."""

from __future__ import annotations

from armodal.analyzer.checks.records import Finding, Outcome
from armodal.analyzer.modal import ModalModel, drift_told

__all__ = ["drift_finding"]


def drift_finding(posture: str, model: ModalModel | None) -> Finding:
    """Tell how far each mode moves, along which points, and what would do it.

    Parameters
    ----------
    posture
        Name of the posture.
    model
        Its modes; None where the FRFs cannot be fitted.
    """
    if model is None or not model.modes:
        return _finding(posture, Outcome.CANNOT_TELL, "no mode was found that could move")
    if len(model.mountings) < 2:
        return _finding(
            posture, Outcome.CANNOT_TELL, "one point was measured; a second one shows what moves"
        )
    told = drift_told(model)
    if not told:
        return _finding(
            posture, Outcome.GOOD, "no mode moves from point to point by more than scatter explains"
        )
    points = tuple(dict.fromkeys(name for one in told for name in (one.lowest[0], one.highest[0])))
    return _finding(posture, Outcome.TO_KNOW, "; ".join(one.words for one in told), points)


def _finding(posture: str, outcome: Outcome, text: str, points: tuple[str, ...] = ()) -> Finding:
    return Finding(
        check="drift",
        posture=posture,
        outcome=outcome,
        fault=None,
        points=points,
        everywhere=False,
        confidence=0.0,
        text=text,
    )
