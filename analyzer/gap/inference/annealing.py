"""The stages of a session: lines of all postures, from the widest to sharp."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.arm.reduced import model_modes, reduce_model
from armodal.analyzer.arm.same_parts import check_same_parts
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.fit import Stage, models_of
from armodal.analyzer.gap.model.lines import (
    Annealing,
    PostureLines,
    own_lines,
    shifted_lines,
)
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = [
    "EVERY_STAGE",
    "FEWEST_POSTURES",
    "annealing_stages",
    "of_test",
    "with_test",
    "with_tests",
]

FEWEST_POSTURES = 2
# Sigma, step, and step where soft and hard hits are told apart, all in Hz: those are twice as many
# lines, of which every second frequency or so costs about the same.
_STAGES = ((40.0, 28.0, 42.0), (16.0, 12.0, 18.0), (6.0, 6.0, 9.0), (2.0, 3.0, 6.0))
EVERY_STAGE = tuple(range(len(_STAGES)))
_ROUNDING = 1e-9  # of a frequency


def _band_hz(superset: Superset, frfs: Sequence[FrequencyResponse]) -> tuple[float, float]:
    """From below the lowest believed mode to well above the highest, as far as was measured."""
    structure = believed_structure(superset.arm)
    lowest, highest = [], []
    for frf in frfs:
        if frf.joints_rad is None:
            continue
        modes = model_modes(reduce_model(superset, superset.posture(frf.joints_rad), structure))
        lowest.append(modes.f_hz[0])
        highest.append(modes.f_hz[-1])
    low = max(0.6 * min(lowest), *(float(f.freq_hz[0]) for f in frfs))
    wanted = min(max(1.3 * max(highest), 150.0), 250.0)
    return low, min(wanted, *(0.95 * float(f.freq_hz[-1]) for f in frfs))


def annealing_stages(
    superset: Superset,
    session: Session,
    frfs: Sequence[FrequencyResponse],
    *,
    models: Sequence[PosedModel] = (),
    level_about: float | None = None,
    only: Sequence[int] = EVERY_STAGE,
    band_of: Sequence[FrequencyResponse] | None = None,
) -> tuple[Stage, ...]:
    """Return the widest, broad, middle and sharp lines of every posture with known angles.

    Parameters
    ----------
    frfs
        Of its postures: they give the band and, where there are no hits, the lines.
    models
        Postures already solved, in order.
    level_about
        Soft and hard hits apart, their levels about this (`hit_levels.middle_level`).
    only
        Which of the four.
    band_of
        FRFs that give the band instead: `frfs` cut to what is to be fitted, since lines are best
        made of whole ones.

    Raises
    ------
    EstimateError
        If fewer than two postures have joint angles.
    """
    known = [frf for frf in frfs if frf.joints_rad is not None]
    if len(known) < FEWEST_POSTURES:
        raise EstimateError(
            f"wanted joint angles for at least {FEWEST_POSTURES} postures, got {len(known)}; "
            "measure with the controller's angles on the bus"
        )
    band = _band_hz(superset, known if band_of is None else band_of)
    made: list[Stage] = []
    for sigma_hz, step_hz, step_by_level_hz in (_STAGES[i] for i in only):
        step = step_hz if level_about is None else step_by_level_hz
        stage = Annealing(sigma_rad_s=2.0 * np.pi * sigma_hz, step_hz=step, band_hz=band)
        lines: tuple[PostureLines, ...]
        if session.hits:
            lines = own_lines(superset, session, stage, level_about=level_about)
        else:
            mass = session.header.plan.sensor.mass_kg
            lines = shifted_lines(superset, known, stage, sensor_mass_kg=mass)
        # Soft and hard hits are of the same posture: they share its geometry.
        given = [model for model in models for _ in range(2)] if models else None
        lines = _in_state(lines, session)
        made.append(
            Stage(superset, lines, Discrepancy(), models=made[-1].models if made else given)
        )
    return tuple(made)


def _in_state(lines: Sequence[PostureLines], session: Session) -> tuple[PostureLines, ...]:
    """Lines with what the laboratory did to the arm in their posture."""
    planned = {posture.name: posture for posture in session.header.plan.postures}
    found = []
    for own in lines:
        state = planned.get(own.name)
        brakes, mass = (False, None) if state is None else (state.brakes, state.known_mass)
        found.append(replace(own, brakes=brakes, known_mass=mass))
    return tuple(found)


def with_test(
    stages: tuple[Stage, ...],
    superset: Superset,
    session: Session,
    number: int,
    *,
    level_about: float | None = None,
    only: Sequence[int] = EVERY_STAGE,
) -> tuple[Stage, ...]:
    """The stages with a further test's postures; `level_about` and `only` as theirs."""
    if not session.hits:
        raise EstimateError(
            "wanted a further test with records of its hits, got one without; give a session "
            "that was measured with armodal"
        )
    check_same_parts(superset.arm, session.header.arm)
    made: list[Stage] = []
    models: list[PosedModel] = []
    for which, old in zip(only, stages, strict=True):
        sigma_hz, step_hz, step_by_level_hz = _STAGES[which]
        step = step_hz if level_about is None else step_by_level_hz
        stage = Annealing(sigma_rad_s=2.0 * np.pi * sigma_hz, step_hz=step, band_hz=_band_of(old))
        tested = own_lines(superset, session, stage, level_about=level_about)
        lines = [replace(own, name=of_test(own.name, number)) for own in _in_state(tested, session)]
        models = models or models_of(superset, lines)
        made.append(
            Stage(superset, [*old.lines, *lines], Discrepancy(), models=[*old.models, *models])
        )
    return tuple(made)


def with_tests(
    stages: tuple[Stage, ...],
    superset: Superset,
    more: Sequence[Session],
    level_about: float | None = None,
    only: Sequence[int] = EVERY_STAGE,
) -> tuple[Stage, ...]:
    """The stages with the postures of all further tests."""
    for number, other in enumerate(more, start=2):
        stages = with_test(stages, superset, other, number, level_about=level_about, only=only)
    return stages


def of_test(posture: str, number: int) -> str:
    """Return the name of a further test's posture among those of other sessions."""
    return f"{posture} (test {number})"


def _band_of(stage: Stage) -> tuple[float, float]:
    f_hz = stage.lines[0].s_rad_s.imag / (2.0 * np.pi)
    return float(f_hz[0]) * (1.0 - _ROUNDING), float(f_hz[-1]) * (1.0 + _ROUNDING)
