"""A verdict in a sentence."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.analyzer.gap.decision.without_levels import titles
from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.records import Disagreement, EffectFound, Verdict

__all__ = ["summary_words"]


def summary_words(
    verdict: Verdict,
    effects: Sequence[EffectFound],
    standing: Sequence[Fit],
    misfit: float,
    left: Sequence[Disagreement],
) -> str:
    """Return what was found, or what is left and where."""
    if verdict is Verdict.NAMED:
        words = "; ".join(f"{e.title} ({e.place})" if e.place else e.title for e in effects)
        return f"Missing in the model: {words}."
    if verdict is Verdict.AMBIGUOUS:
        return f"What is missing, if anything, cannot be told: {titles(standing)}."
    if verdict is Verdict.OUTSIDE_LIBRARY:
        worst = max(left, key=lambda d: d.ratio)
        return (
            "Something is missing that the library does not know: a misfit of "
            f"{misfit:.1f} is left, most at point {worst.point} {worst.axis} in posture "
            f"'{worst.posture}' at {worst.band_hz[0]:.0f}-{worst.band_hz[1]:.0f} Hz."
        )
    return "With k, c and tolerances refitted, nothing is left to explain."
