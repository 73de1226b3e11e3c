"""What the test says, in sentences: the report's findings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.gap.records import GapResult, PostureGap, Verdict
from armodal.analyzer.identification.records import AxisResult, Explained, Identification
from armodal.analyzer.identification.scatter import stated_half_width_95
from armodal.analyzer.report.effect_words import certainty, effect_sentence
from armodal.analyzer.report.words import plus_minus, rounded, share

__all__ = ["Finding", "findings"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One sentence, and how sure it is."""

    text: str
    sure: str


def findings(result: Identification, gap: GapResult | None) -> tuple[Finding, ...]:
    """What was found, most important first."""
    return _of_gap(gap) if gap is not None else _of_identification(result)


def _of_gap(gap: GapResult) -> tuple[Finding, ...]:
    found = [
        Finding(text=effect_sentence(effect), sure=f"Certainty {certainty(effect.confidence)}.")
        for effect in gap.effects
    ]
    if gap.verdict is not Verdict.NAMED:
        standing = ", ".join(f"{r.title} ({r.place})" for r in gap.rivals if r.standing)
        found.append(
            Finding(
                text=gap.summary,
                sure=f"Still possible: {standing}." if standing else "",
            )
        )
    foretold = _foretold(gap)
    return (*found, *([] if foretold is None else [foretold]))


def _foretold(gap: GapResult) -> Finding | None:
    """How near model and measurement are, postures apart that were not fitted."""
    after = gap.gap_after or gap.gap_before
    unseen = [row for row in after if row.held_out]
    worst = _worst(after)
    if worst is None:
        return None
    # Soft and hard hits of a posture have its modes in common.
    apart = {_without_level(row.posture): row for row in after}
    n_modes = sum(len(row.modes) for row in apart.values())
    before = _worst(gap.gap_before) if gap.effects else None
    text = (
        f"{'With it, the' if len(gap.effects) == 1 else 'With them, the' if gap.effects else 'The'}"
        f" model pairs {n_modes} modes in {len(apart)} postures within {share(worst)} in "
        f"frequency{f'; without, within {share(before)}' if before is not None else ''}."
    )
    if not unseen:
        return Finding(
            text=text, sure="No posture was kept for validation: this is a fit, not a prediction."
        )
    names = " and ".join(dict.fromkeys(_without_level(row.posture) for row in unseen))
    return Finding(text=text, sure=f"Left out of the last fit: {names}.")


def _without_level(title: str) -> str:
    return title.removesuffix(", soft hits").removesuffix(", hard hits")


def _worst(rows: Sequence[PostureGap]) -> float | None:
    errors = [abs(m.model_hz / m.measured_hz - 1.0) for row in rows for m in row.modes]
    return max(errors) if errors else None


_WITHOUT_AXES = {
    Explained.JOINTS: "Springs at the joints alone explain the measured motion; no link is "
    "compliant about an axis of its own.",
    Explained.ORDINARY: "Springs at the joints explain the measured motion beside bearings, links "
    "and a base that give way as in any sound arm; no link is compliant about an axis of its own.",
    Explained.NOTHING: "Springs at the joints do not explain the measured motion, nor does an axis "
    "in a link; a gap analysis tells what the model lacks.",
}


def _of_identification(result: Identification) -> tuple[Finding, ...]:
    found = [_axis(axis) for axis in result.axes]
    if not result.axes:
        found.append(
            Finding(
                text=_WITHOUT_AXES[result.explained_by],
                sure=f"{_structural(result)} of {len(result.modes)} modes move in ways that joints "
                "do not explain.",
            )
        )
    departing = [
        f"{j.joint} {rounded(j.k_n_m_per_rad / j.believed_k_n_m_per_rad, 2)} times"
        for j in result.joints
        if abs(j.k_n_m_per_rad - j.believed_k_n_m_per_rad)
        > TWO_SIDED_95 * np.hypot(j.k_std, j.k_std_model)
    ]
    if departing:
        found.append(
            Finding(
                text=f"Stiffness differs from the arm file's: {', '.join(departing)} as stiff.",
                sure="Outside the 95 % range of this measurement.",
            )
        )
    checked = _validation(result)
    return (*found, *([] if checked is None else [checked]))


def _axis(axis: AxisResult) -> Finding:
    std = float(np.hypot(axis.k_std, axis.k_std_model))
    half = stated_half_width_95(axis)
    k, spread = plus_minus(axis.k_n_m_per_rad, std)
    low, high = rounded(axis.k_n_m_per_rad - half), rounded(axis.k_n_m_per_rad + half)
    return Finding(
        text=f"The {axis.link} is compliant about an axis of its own: stiffness {k} ± {spread} "
        f"N m/rad (95 %: {low} to {high}), "
        f"strained most at {axis.f_hz:.2f} Hz in {axis.posture}.",
        sure="; ".join(axis.doubts) or "Nothing in the measurement speaks against it.",
    )


def _structural(result: Identification) -> str:
    return str(sum(mode.structural for mode in result.modes))


def _validation(result: Identification) -> Finding | None:
    rows = result.validation
    if not rows:
        return None
    errors = [
        abs(row.predicted_hz / row.measured_hz - 1.0) for row in rows if row.measured_hz is not None
    ]
    names = " and ".join(dict.fromkeys(row.posture for row in rows))
    if not errors:
        return Finding(
            text=f"None of the {len(rows)} modes predicted for {names} was found there.",
            sure="Do not use the model in other postures.",
        )
    return Finding(
        text=f"{len(errors)} of {len(rows)} modes predicted for {names} were found, within "
        f"{share(max(errors))} in frequency.",
        sure="Predicted without using these postures.",
    )
