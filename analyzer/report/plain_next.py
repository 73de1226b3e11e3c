"""What to do next with a plain structure's test."""

from __future__ import annotations

from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.modal import ModalModel, missing_mode_hints
from armodal.analyzer.report.plain_words import shape_of
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["plain_steps"]


def plain_steps(frf: FrequencyResponse, model: ModalModel) -> list[str]:
    """Return a few sentences, most useful first."""
    if not model.modes:
        return ["Hit harder, or nearer to where the structure moves; or look at another --band."]
    steps = []
    missing = [hint for hint in missing_mode_hints(frf, model) if hint.beside_hz is None]
    if missing:
        near = ", ".join(f"{hint.f_hz:.5g}" for hint in missing[:3])
        steps.append(f"Look at the poles near {near} Hz by hand: armodal review SESSION.")
    n_places = len(shape_of(model, model.modes[0]))
    if n_places < len(model.modes):
        steps.append("Measure more points or directions: shapes look alike with so few.")
    measured = {dof.point for dof in frf.responses}
    if not any(dof.point in measured for dof in frf.references):
        steps.append("Hit a point where a sensor sits: without one there is no modal mass.")
    if any(m.damping_ratio < TWO_SIDED_95 * m.damping_std for m in model.modes):
        steps.append("Take more hits, or longer records: a damping ratio may still be 0.")
    return steps or ["Nothing: no question is left open by this test."]
