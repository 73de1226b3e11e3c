"""The result of the workflow, put together from the fits it ended with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from armodal.analyzer.gap.decision.added_effect import Step
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.decision.matters import matters
from armodal.analyzer.gap.decision.recurrence import recurrence
from armodal.analyzer.gap.decision.verdict import verdict_of
from armodal.analyzer.gap.decision.without_levels import titles
from armodal.analyzer.gap.inference.compare import disagreement_map, posture_gap
from armodal.analyzer.gap.inference.dispersion import dispersion
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.inference.held_out import HeldOut, held_out
from armodal.analyzer.gap.inference.hit_direction_notes import hit_direction_notes
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.analyzer.gap.inference.misfit import misfit_of_replicas, misfit_per_line
from armodal.analyzer.gap.library import title_of
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.priors import FARTHEST
from armodal.analyzer.gap.next_test.advice import Advice, advise, at_levels
from armodal.analyzer.gap.records import (
    EffectFound,
    GapResult,
    Gate,
    Hidden,
    LineDeviation,
    Misfit,
    PostureGap,
    RivalRow,
    Verdict,
)
from armodal.analyzer.gap.search.candidates import other_candidates
from armodal.analyzer.gap.search.hidden_size import HiddenSize
from armodal.analyzer.gap.search.interfaces import lines_of_interfaces
from armodal.analyzer.gap.search.rivals import Rivals
from armodal.analyzer.gap.search.scan import Candidate
from armodal.analyzer.gap.stiffness_ranges import (
    extreme_sizes,
    hidden_sizes,
    largest_size,
    stiffness_ranges,
)
from armodal.analyzer.gap.summary import summary_words
from armodal.analyzer.modal.fit import fit_modes
from armodal.analyzer.modal.modes import ModalModel
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.plan_records import Plan

__all__ = ["GapOutcome", "conclude", "notes_on_its_end"]

# Nats that a fit's own quadratic still promises: a deviation and a half of a single parameter.
_UNFINISHED = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class GapOutcome:
    """The result, and the models behind it for who wants to go on."""

    result: GapResult
    stages: tuple[Stage, ...]
    before: Fit  # the arm as believed, all postures
    final: Fit  # with everything that was named
    standing: tuple[Fit, ...]  # rivals of the last step that still stand
    compared: tuple[Fit, ...] = ()  # what the next test is to tell apart
    # Numbers of the sessions that were fitted to, in order; 1 is the first that was given.
    sessions: tuple[int, ...] = (1,)


def conclude(
    *,
    modes_of: Sequence[FrequencyResponse],
    stages: tuple[Stage, ...],
    before: Fit,
    final: Fit,
    found: Rivals,
    judged: Judged,
    named: Sequence[Step],
    test: tuple[int, ...],
    gates: tuple[Gate, ...],
    notes: list[str],
    false_name: float,
    assumed: str,
    sessions: tuple[int, ...],
    plan: Plan | None,
    tell: Callable[[str], None],
) -> GapOutcome:
    """Verdict, effects, rivals, ranges and gaps of the models a search ended with.

    With a plan the next test is proposed as one; `modes_of` are FRFs whose modes are paired with
    the models'. The summary ends with what was `assumed`.
    """
    sharp = stages[-1]
    misfit = misfit_per_line(sharp, final)
    standing = judged.standing
    calibration = judged.calibration
    leaves = partial(misfit_of_replicas, sharp, beyond=false_name)
    disagreement = dispersion(sharp, final)
    spread = max(judged.phi, disagreement)
    # Of effects, errors that all postures share, which no disagreement shows: as of replicas.
    n_postures = len({lines.name for lines in sharp.lines})
    shared = max(judged.phi, n_postures * disagreement)
    effects = tuple(_effect(step, final, shared) for step in named)
    verdict, why = verdict_of(sharp, final, found, judged, named=bool(named), leaves=leaves)
    if verdict is not Verdict.NAMED and effects:
        found_on_the_way = "; ".join(effect.title for effect in effects)
        why = [*why, f"found on the way, but no name: {found_on_the_way}"]
    notes += [*why, *notes_on_its_end(final), *hit_direction_notes(sharp, final)]
    if effects and len(standing) > 1:
        notes.append(f"something more is there that cannot be told: {titles(standing)}")
    alive = standing or (final,)
    others = found.others if found.others is not None else other_candidates(sharp, final)
    hiding = [c for c in others if c.instance.size and np.isfinite(c.size_std)]
    advice = Advice()
    if plan is not None and verdict is Verdict.OUTSIDE_LIBRARY:
        # What depends on the level is looked for only where points were hit softly and hard.
        if not final.hypothesis.ordinary.levels_hit:
            advice = at_levels(sharp, final, (), plan)
            notes += [advice.why_none] if advice.why_none else []
    elif plan is not None:
        advice = advise(
            sharp,
            final,
            standing,
            found.rivals,
            hiding,
            partial(extreme_sizes, final=final, phi=spread),
            plan,
            tell,
        )
        notes += [advice.why_none] if advice.why_none else []
    points = [point.id for point in final.hypothesis.ordinary.arm.points]
    where = disagreement_map(sharp, before, points)
    is_outside = verdict is Verdict.OUTSIDE_LIBRARY
    left = disagreement_map(sharp, final, points) if is_outside else where
    measured = _measured_modes(modes_of, sharp)
    tell("held-out postures")
    first = held_out(sharp, before, test)
    last = held_out(sharp, final, test) if named else first
    sizes = hidden_sizes(stages[-2], alive[0], hiding, spread)
    is_settled = not is_outside and not standing[1:]
    ranges = stiffness_ranges(alive, sizes, spread, settled=is_settled)
    result = GapResult(
        verdict=verdict,
        summary=summary_words(verdict, effects, standing, misfit, left) + assumed,
        effects=effects if verdict is Verdict.NAMED else (),
        rivals=_rivals(sharp, found, judged, shared),
        hidden=_hidden(hiding, sizes, spread),
        joint_stiffness_ranges=ranges,
        gap_before=_gaps(sharp, before, first, measured),
        gap_after=_gaps(sharp, final, last, measured),
        where=where,
        interface=_interface(stages[1], before, calibration.limit_otherwise),
        gates=gates,
        notes=tuple(dict.fromkeys(notes)),
        misfit_per_line=misfit,
        next_test=advice.test,
        false_name_probability=_false_name(effects) if verdict is Verdict.NAMED else None,
        confidence=_confidence(effects) if verdict is Verdict.NAMED else None,
        calibration=calibration.record(),
        misfit=Misfit(measured=misfit, replicas_leave=leaves(final)),
    )
    return GapOutcome(
        result=result,
        stages=stages,
        before=before,
        final=final,
        standing=standing,
        compared=advice.compared,
        sessions=sessions,
    )


def _effect(step: Step, final: Fit, phi: float) -> EffectFound:
    fit = step.fit
    instance = fit.last
    words = instance.effect
    gain = step.without.evidence - fit.evidence
    calibration = step.judged.calibration
    chance = calibration.p_value(words.name, gain)
    return EffectFound(
        name=words.name,
        title=words.title,
        place=instance.place,
        parameters=intervals(final, instance.told, phi),
        size=instance.size,
        sizes=instance.sizes,
        description={} if instance.describe is None else instance.describe(final.values),
        confidence=step.judged.confidence * recurrence(instance, step.gains) * (1.0 - chance),
        gain=gain,
        held_out_gain=sum(step.gains.values()),
        signature=words.signature,
        confused_with=tuple(title_of(name) for name in words.confused_with),
        told_by=words.told_by,
        remedy=words.remedy,
        false_name_probability=chance,
        line=_line(final, instance, phi),
        details=instance.details,
        words=instance.words,
    )


def _line(fit: Fit, instance: Instance, phi: float) -> LineDeviation | None:
    moves = intervals(fit, instance.begins_at, phi).values()
    if not moves:
        return None
    turned, shifted = (
        float(np.linalg.norm([move.std for move in moves if move.unit == unit]))
        for unit in ("", "m")
    )
    return LineDeviation(turned_rad=turned, shifted_m=shifted)


def _false_name(effects: Sequence[EffectFound]) -> float:
    """That any of the names is chance, at most."""
    return min(1.0, sum(e.false_name_probability or 0.0 for e in effects))


def _confidence(effects: Sequence[EffectFound]) -> float:
    return float(np.prod([e.confidence for e in effects]))


def _rivals(stage: Stage, found: Rivals, judged: Judged, phi: float) -> tuple[RivalRow, ...]:
    fits = found.with_standing(judged.standing)
    return tuple(_rival(stage, fit, found.present, fits[0], judged, phi) for fit in fits)


def _rival(stage: Stage, fit: Fit, present: Fit, best: Fit, judged: Judged, phi: float) -> RivalRow:
    instance = fit.last
    calibration, gain = judged.calibration, present.evidence - fit.evidence
    behind = fit.evidence - best.evidence
    return RivalRow(
        name=instance.effect.name,
        title=instance.effect.title,
        place=instance.place,
        gain=gain,
        behind=behind,
        standing=any(f is fit for f in judged.standing),
        material=matters(stage, present, fit, instance, judged.phi),
        parameters=intervals(fit, instance.told, phi),
        told_by=instance.effect.told_by,
        false_name_probability=calibration.p_value(instance.effect.name, gain),
        odds=calibration.odds(behind),
        line=_line(fit, instance, phi),
        details=instance.details,
    )


def _hidden(
    hiding: Sequence[Candidate], sizes: Sequence[HiddenSize], phi: float
) -> tuple[Hidden, ...]:
    """How large each could be; of what hides in a joint, as far as data leave it open."""
    told = {h.candidate.instance.key: h for h in sizes if h.candidate.instance.hides_in}
    rows = [
        Hidden(
            name=c.instance.effect.name,
            title=c.instance.effect.title,
            place=c.instance.place,
            parameter=c.instance.size,
            words=c.instance.words.get(c.instance.size, ""),
            unit=c.instance.unit,
            largest=told[c.instance.key].at_most
            if c.instance.key in told
            else largest_size(c, phi),
        )
        for c in hiding
    ]
    return tuple(sorted(rows, key=lambda r: (r.name, r.place)))


def _measured_modes(frfs: Sequence[FrequencyResponse], stage: Stage) -> Mapping[str, ModalModel]:
    top = max(float(stage.lines[0].s_rad_s[-1].imag) / (2.0 * np.pi), 1.0)
    found = {}
    for frf in frfs:
        try:
            found[frf.posture] = fit_modes(frf, band_hz=(float(frf.freq_hz[0]), 1.05 * top))
        except EstimateError:
            continue
    return found


def _gaps(
    stage: Stage, fit: Fit, split: HeldOut, measured: Mapping[str, ModalModel]
) -> tuple[PostureGap, ...]:
    """Postures of the training by its own fit, held-out ones by what was foretold."""
    return tuple(
        posture_gap(
            stage,
            split.training if p in split.postures else fit,
            p,
            held_out=p in split.postures,
            measured=measured.get(lines.name),
        )
        for p, lines in enumerate(stage.lines)
    )


def _interface(stage: Stage, before: Fit, least: float) -> str:
    near = fit_hypothesis(stage, before.hypothesis, resumed=before, max_iterations=3)
    lines = lines_of_interfaces(stage, near)
    if not lines or lines[0].gain < least:
        return "no interface of a link departs from the model beyond what is allowed"
    names = [joint.link.name for joint in before.hypothesis.ordinary.arm.joints]
    best = names[lines[0].link]
    second = next((line for line in lines if names[line.link] != best), None)
    words = f"the motion departs from the model most at the root of link '{best}'"
    if second is not None and second.gain > 0.5 * lines[0].gain:
        words += f", nearly as much at '{names[second.link]}'"
    return words


def notes_on_its_end(final: Fit) -> list[str]:
    """Say where the final fit ended before its end, and which errors no tolerance explains."""
    notes = []
    if final.ordinary_at_limit:
        notes.append(
            f"{', '.join(final.ordinary_at_limit)}: ended {FARTHEST:.0f} deviations off, as far as "
            "is tried: give it more if the arm file has its std; else what is missing hides there"
        )
    if final.promised >= _UNFINISHED:
        notes.append(
            "the last fit did not converge: its steps brought next to nothing where "
            f"{100.0 * final.promised / final.cost:.2g} % of its misfit was promised; sizes and "
            "stiffnesses may be off by more than is stated"
        )
    return notes
