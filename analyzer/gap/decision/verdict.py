"""What a search ended with: named, ambiguous, nothing detectable, outside the library; and why."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from armodal.analyzer.gap.decision.calibration import is_told_by_level
from armodal.analyzer.gap.decision.judge import Judged, one_mechanism
from armodal.analyzer.gap.inference.compare import posture_gap
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.misfit import misfit_per_line
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.search.rivals import Rivals

__all__ = ["verdict_of"]

Leaves = Callable[[Fit], float]

# Of the response, in a posture fitted to: where soft and hard hits are apart their difference
# counts as scatter, and no misfit tells of what only that explains. True models leave 0.09.
_LEFT = 0.2


def verdict_of(
    stage: Stage,
    final: Fit,
    found: Rivals,
    judged: Judged,
    *,
    named: bool,
    leaves: Leaves,
) -> tuple[Verdict, list[str]]:
    """Return the verdict, and why something is outside the library.

    Parameters
    ----------
    stage
        The sharp lines.
    final, found, judged
        The model with everything that was named, its rivals, and which of them stand.
    named
        Whether anything was.
    leaves
        The misfit that replicas of a fit leave at most.
    """
    standing = judged.standing
    # A name is judged by what its own model leaves; of several that stand one must explain.
    explaining = standing if standing and not named and not judged.doubted else (final,)
    least = min(explaining, key=lambda fit: misfit_per_line(stage, fit))
    is_much = misfit_per_line(stage, least) > leaves(least) or judged.calibration.is_model_wrong
    why: list[str] = []
    both = _one_mechanism(final, found, judged)
    if both is not None:
        why.append(
            f"{both[0].title} and {both[1].title} together are what one mechanism would look "
            f"like, such as {both[0].effect.one_such_as}; the library does not know it"
        )
    if _left_between_levels(stage, final) > _LEFT:
        why.append(
            f"more than {_LEFT:.0%} of the response is left: what the hits' level "
            "changes is no joint's stiffness or damping"
        )
    if _is_unfollowed(stage, final, found, judged, named=named):
        why.append("the response depends on the hits' level, and nothing that was named does")
    if why or is_much:
        return Verdict.OUTSIDE_LIBRARY, why
    if named:
        return Verdict.NAMED, why
    return Verdict.AMBIGUOUS if len(standing) > 1 else Verdict.NOTHING_DETECTABLE, why


def _one_mechanism(final: Fit, found: Rivals, judged: Judged) -> tuple[Instance, Instance] | None:
    """Two effects that one mechanism would look like: both named, or one the level tells."""
    likely = [
        fit.last
        for fit in found.rivals
        if fit.last.level_dependent
        and found.present.evidence - fit.evidence > judged.calibration.limit(fit.last.effect.name)
    ]
    hypothesis = final.hypothesis
    return one_mechanism([*hypothesis.instances, *likely], hypothesis.ordinary.arm.joints)


def _left_between_levels(stage: Stage, final: Fit) -> float:
    """Largest part of a posture's response that is left where soft and hard hits are apart.

    A posture that hardly answers, such as one hit near the base, is mostly noise: there it is the
    part of what half of the postures answer at least.
    """
    if not final.hypothesis.ordinary.level_span:
        return 0.0
    postures = range(len(stage.lines))
    parts = np.array([posture_gap(stage, final, p, held_out=False).frf_error for p in postures])
    sizes = np.array([np.sqrt(np.mean(np.abs(own.values) ** 2)) for own in stage.lines])
    return float(np.max(parts * sizes / np.maximum(sizes, np.median(sizes))))


def _is_unfollowed(stage: Stage, final: Fit, found: Rivals, judged: Judged, *, named: bool) -> bool:
    """Whether the level tells what nothing named follows, or where nothing is, nothing likely."""
    if not is_told_by_level(stage, final, judged.calibration):
        return False
    least = judged.calibration.apart
    likely = [f for f in found.rivals if found.present.evidence - f.evidence > least]
    return named or not any(f.hypothesis.level_dependent for f in (*judged.standing, *likely))
