"""The workflow: gates, baseline, where, which, fit and judge, add; again until nothing is left."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analyzer.arm.reduced import model_modes, reduce_model
from analyzer.arm.structure import believed_structure
from analyzer.arm.superset import Superset
from analyzer.checks.session import check_session
from analyzer.gap.add import instances_of_file
from analyzer.gap.compare import disagreement_map, posture_gap
from analyzer.gap.effects.effect import Instance
from analyzer.gap.fit import Fit, Stage, fit_hypothesis
from analyzer.gap.held_out import HeldOut, held_out
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.judge import Judged, Thresholds, judge, misfit_per_line, scale
from analyzer.gap.library import all_instances
from analyzer.gap.lines import Annealing, PostureLines, own_lines, shifted_lines
from analyzer.gap.ordinary import Ordinary
from analyzer.gap.records import (
    Disagreement,
    EffectFound,
    GapResult,
    Gate,
    Hidden,
    Interval,
    PostureGap,
    RivalRow,
    StiffnessRange,
    Verdict,
)
from analyzer.gap.rivals import Rivals, find_rivals
from analyzer.gap.scan import Candidate, scan_axes, scan_instances
from analyzer.gap.weigh import Discrepancy
from analyzer.identification.identify import estimate_frfs
from analyzer.modal.fit import fit_modes
from analyzer.modal.modes import ModalModel
from protocols.errors import EstimateError
from protocols.frf_records import FrequencyResponse
from protocols.plan_records import Mode
from protocols.session.records import Session

__all__ = ["GapOutcome", "find_gap"]

_STAGES = ((16.0, 8.0), (6.0, 4.0), (2.0, 3.0))  # sigma Hz, step Hz
_FEWEST_POSTURES, _FEWEST_POINTS = 2, 4
_MOST_EFFECTS, _MOST_ROUNDS = 3, 5
_TWO_SIDED_95, _ONE_SIDED_95 = 1.96, 1.645
_WIDEST = 0.7  # of ln k

Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class GapOutcome:
    """The result, and the models behind it for who wants to go on."""

    result: GapResult
    stages: tuple[Stage, ...]
    before: Fit  # the arm as believed, all postures
    final: Fit  # with everything that was named
    standing: tuple[Fit, ...]  # rivals of the last step that still stand
    scale: float  # of the data's variance: 1 where the allowance suffices


def find_gap(
    session: Session,
    *,
    frfs: Sequence[FrequencyResponse] | None = None,
    thresholds: Thresholds | None = None,
    gates: bool = True,
    modes: bool = True,
    tell: Tell = lambda _: None,
) -> GapOutcome:
    """Find where model and measurement disagree, and what is missing.

    Parameters
    ----------
    session
        Own or imported. Where it has no records of single hits its averaged FRFs are used.
    frfs
        FRFs of its postures if they are at hand.
    gates, modes
        Run the checks without a model; pair modes in the comparison before and after.
    tell
        Told what is being done.

    Raises
    ------
    EstimateError
        If the session cannot carry the judgement: fewer than two postures with known angles, too
        few points, an arm without an elastic joint.
    """
    limits = thresholds or Thresholds()
    superset = Superset(session.header.arm)
    _check_enough(session)
    single_hits = bool(session.hits)
    if frfs is None:
        frfs = estimate_frfs(session, superset) if single_hits else session.frfs
    tell("checks without a model")
    gate_rows = _gates(session, frfs, superset) if gates and single_hits else ()
    stages = _stages(superset, session, frfs)
    ordinary = Ordinary(superset=superset, postures=tuple(p.name for p in stages[-1].lines))
    test = _test_postures(session, stages[-1].lines)
    notes = _notes(session, single_hits)

    from_file, start = instances_of_file(ordinary)
    present = Hypothesis(ordinary=ordinary, instances=from_file)
    named: list[tuple[Fit, Fit, HeldOut, HeldOut, Judged]] = []
    before: Fit | None = None
    rounds = 0
    while True:
        found = find_rivals(stages, present, start=start, tell=tell)
        before = before or found.present
        judged = judge(stages[-1], found.present, found.rivals, limits)
        rounds += 1
        if judged.named is None or len(named) == _MOST_EFFECTS or rounds > _MOST_ROUNDS:
            break
        better = judged.named
        tell(f"held-out postures: {better.hypothesis.name}")
        without = held_out(stages[-1], found.present, test)
        with_it = held_out(stages[-1], better, test)
        gains = np.subtract(without.surprise, with_it.surprise)
        # What the null has with a narrow prior foretells little more when that is widened.
        wanted = -limits.held_out if _only_relaxes(better) else limits.held_out
        if gains.sum() < wanted * judged.phi:
            notes.append(
                f"{better.hypothesis.instances[-1].title} fits better but does not foretell "
                "postures it was not fitted to; it was not named"
            )
            judged = Judged(named=None, standing=(better, found.present), phi=judged.phi)
            break
        named.append((found.present, better, without, with_it, judged))
        present, start, gone = _still_earning(stages[-1], better, limits, judged.phi)
        named = [step for step in named if _last(step[1]) not in gone]
        notes += [
            f"{instance.title} was taken out again: it no longer earns its place"
            for instance in gone
        ]
    final = found.present
    phi = scale(stages[-1], [final, *found.rivals], limits)
    return _outcome(
        frfs=frfs,
        stages=stages,
        before=before,
        final=final,
        found=found,
        judged=judged,
        named=named,
        test=test,
        phi=phi,
        gates=gate_rows,
        notes=notes,
        limits=limits,
        with_modes=modes,
    )


def _only_relaxes(fit: Fit) -> bool:
    return bool(_last(fit).relaxes) and not _last(fit).parameters


def _last(fit: Fit) -> Instance:
    return fit.hypothesis.instances[-1]


def _still_earning(
    stage: Stage, fit: Fit, limits: Thresholds, phi: float
) -> tuple[Hypothesis, dict[str, float], list[Instance]]:
    """Take out effects, added before the last, that the later ones made unneeded."""
    gone: list[Instance] = []
    while True:
        for instance in fit.hypothesis.instances[:-1]:
            rest = tuple(i for i in fit.hypothesis.instances if i is not instance)
            fewer = fit_hypothesis(stage, replace(fit.hypothesis, instances=rest), start=fit.values)
            small = not instance.is_material(fit.values)
            if small or fewer.evidence - fit.evidence < limits.clear * phi:
                gone.append(instance)
                fit = fewer
                break
        else:
            return fit.hypothesis, fit.values, gone


def _check_enough(session: Session) -> None:
    arm = session.header.arm
    if not any(joint.stiffness is not None for joint in arm.joints):
        raise EstimateError(
            f"arm '{arm.name}' has no joint with a stiffness, so there is no model to compare; "
            "give the joints a believed stiffness in the arm file"
        )
    accepted = [hit for hit in session.hits if hit.verdict.accepted]
    if session.hits and not accepted:
        raise EstimateError(
            "no hit of this session was accepted, so there is nothing to compare; "
            "see the reasons with `armodal check session` and measure again"
        )
    if accepted:
        postures = {hit.posture for hit in accepted}
        roving = session.header.plan.mode is Mode.ROVING_HAMMER
        points = {hit.hit_point if roving else hit.sensor_point for hit in accepted}
    else:
        postures = {frf.posture for frf in session.frfs}
        points = {dof.point for frf in session.frfs for dof in (*frf.responses, *frf.references)}
    if len(postures) < _FEWEST_POSTURES:
        raise EstimateError(
            f"wanted at least {_FEWEST_POSTURES} postures to tell effects apart, got "
            f"{len(postures)}; measure two more that move the masses beyond each joint"
        )
    if len(points) < _FEWEST_POINTS:
        raise EstimateError(
            f"wanted at least {_FEWEST_POINTS} points, three on every link that matters, got "
            f"{len(points)}; measure more points"
        )


def _gates(
    session: Session, frfs: Sequence[FrequencyResponse], superset: Superset
) -> tuple[Gate, ...]:
    return tuple(
        Gate(
            check=f"{finding.check} {finding.posture}".strip(),
            outcome=finding.outcome.value,
            words=finding.text,
        )
        for finding in check_session(session, frfs, superset)
    )


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


def _stages(
    superset: Superset, session: Session, frfs: Sequence[FrequencyResponse]
) -> tuple[Stage, ...]:
    known = [frf for frf in frfs if frf.joints_rad is not None]
    if len(known) < _FEWEST_POSTURES:
        raise EstimateError(
            f"wanted joint angles for at least {_FEWEST_POSTURES} postures, got {len(known)}; "
            "measure with the controller's angles on the bus"
        )
    band = _band_hz(superset, known)
    made: list[Stage] = []
    for sigma_hz, step_hz in _STAGES:
        stage = Annealing(sigma_rad_s=2.0 * np.pi * sigma_hz, step_hz=step_hz, band_hz=band)
        lines: tuple[PostureLines, ...]
        if session.hits:
            lines = own_lines(superset, session, stage)
        else:
            mass = session.header.plan.sensor.mass_kg
            lines = shifted_lines(superset, known, stage, sensor_mass_kg=mass)
        models = made[-1].models if made else None
        made.append(Stage(superset, lines, Discrepancy(), models=models))
    return tuple(made)


def _test_postures(session: Session, lines: Sequence[PostureLines]) -> tuple[int, ...]:
    """The plan's validation postures; without any, the last third."""
    planned = {p.name for p in session.header.plan.postures if p.validation}
    test = tuple(i for i, posture in enumerate(lines) if posture.name in planned)
    if test and len(lines) - len(test) >= 1:
        return test
    return tuple(range(len(lines) - max(len(lines) // 3, 1), len(lines)))


def _notes(session: Session, single_hits: bool) -> list[str]:
    notes = []
    if not single_hits:
        notes.append(
            "only averaged FRFs are there: checks that need single hits, and effects that need "
            "several hit levels, stayed closed"
        )
    if not session.complete:
        notes.append("the session is not complete; what is missing was not judged")
    return notes


def _outcome(
    *,
    frfs: Sequence[FrequencyResponse],
    stages: tuple[Stage, ...],
    before: Fit,
    final: Fit,
    found: Rivals,
    judged: Judged,
    named: Sequence[tuple[Fit, Fit, HeldOut, HeldOut, Judged]],
    test: tuple[int, ...],
    phi: float,
    gates: tuple[Gate, ...],
    notes: list[str],
    limits: Thresholds,
    with_modes: bool,
) -> GapOutcome:
    sharp = stages[-1]
    misfit = misfit_per_line(sharp, final)
    standing = judged.standing
    effects = tuple(_effect(step, final, phi) for step in named)
    left = min([misfit, *(misfit_per_line(sharp, f) for f in standing)])
    if left > limits.outside_misfit:
        verdict = Verdict.OUTSIDE_LIBRARY
    elif effects:
        verdict = Verdict.NAMED
    elif len(standing) > 1:
        verdict = Verdict.AMBIGUOUS
    else:
        verdict = Verdict.NOTHING_DETECTABLE
    if effects and len(standing) > 1:
        titles = " or ".join(_title(f) for f in standing)
        notes.append(f"something more is there that cannot be told: {titles}")
    alive = (final, *standing)
    hiding = _could_hide(sharp, final)
    where = disagreement_map(
        sharp, before, [point.id for point in final.hypothesis.ordinary.arm.points]
    )
    measured = _measured_modes(frfs, sharp) if with_modes else {}
    first = named[0][2] if named else held_out(sharp, before, test)
    last = named[-1][3] if named else first
    result = GapResult(
        verdict=verdict,
        summary=_summary(verdict, effects, standing, misfit, where),
        effects=effects,
        rivals=tuple(_rival(f, found, standing, phi) for f in found.rivals),
        hidden=_hidden(hiding, phi),
        joint_stiffness_ranges=_ranges(alive, hiding, phi),
        gap_before=_gaps(sharp, before, first, measured),
        gap_after=_gaps(sharp, final, last, measured),
        where=where,
        interface=_interface(stages[0], before),
        gates=gates,
        notes=tuple(notes),
        misfit_per_line=misfit,
    )
    return GapOutcome(
        result=result, stages=stages, before=before, final=final, standing=standing, scale=phi
    )


def _title(fit: Fit) -> str:
    return fit.hypothesis.instances[-1].title if fit.hypothesis.instances else "nothing missing"


def _intervals(fit: Fit, names: Sequence[str], phi: float) -> dict[str, Interval]:
    values = fit.values
    std = np.sqrt(np.diag(fit.covariance(phi))) * fit.space.std
    found = {}
    for name in names:
        if name not in fit.space.index:
            continue
        i = fit.space.index[name]
        p = fit.space.parameters[i]
        half = _TWO_SIDED_95 * float(std[i])
        found[name] = Interval(
            value=values[name],
            std=float(std[i]),
            low=max(values[name] - half, p.low),
            high=min(values[name] + half, p.high),
        )
    return found


def _effect(step: tuple[Fit, Fit, HeldOut, HeldOut, Judged], final: Fit, phi: float) -> EffectFound:
    present, fit, without, with_it, judged = step
    instance = fit.hypothesis.instances[-1]
    words = instance.effect
    others = [f for f in judged.standing if f is not fit]
    odds = sum(float(np.exp(-(f.evidence - fit.evidence) / (judged.phi * 10.0))) for f in others)
    return EffectFound(
        name=words.name,
        title=words.title,
        place=instance.place,
        parameters=_intervals(final, instance.owned, phi),
        size=instance.size,
        description={} if instance.describe is None else instance.describe(final.values),
        confidence=1.0 / (1.0 + odds),
        gain=present.evidence - fit.evidence,
        held_out_gain=float(np.sum(without.surprise) - np.sum(with_it.surprise)),
        signature=words.signature,
        confused_with=words.confused_with,
        told_by=words.told_by,
        remedy=words.remedy,
    )


def _rival(fit: Fit, found: Rivals, standing: tuple[Fit, ...], phi: float) -> RivalRow:
    instance: Instance = fit.hypothesis.instances[-1]
    best = found.rivals[0]
    return RivalRow(
        name=instance.effect.name,
        title=instance.effect.title,
        place=instance.place,
        gain=found.present.evidence - fit.evidence,
        behind=fit.evidence - best.evidence,
        standing=any(f is fit for f in standing),
        material=instance.is_material(fit.values),
        parameters=_intervals(fit, instance.owned, phi),
        told_by=instance.effect.told_by,
    )


def _could_hide(stage: Stage, final: Fit) -> list[Candidate]:
    """Every effect that is not in the final model, linearly about it."""
    taken = {i.key for i in final.hypothesis.instances}
    instances = [i for i in all_instances(final.hypothesis.ordinary) if i.key not in taken]
    found = scan_instances(stage, final, [i for i in instances if i.size])
    return [c for c in found if np.isfinite(c.size_std)]


def _hidden(hiding: Sequence[Candidate], phi: float) -> tuple[Hidden, ...]:
    """How large each could be."""
    rows = [
        Hidden(
            name=c.instance.effect.name,
            place=c.instance.place,
            parameter=c.instance.size,
            largest=_largest(c, phi),
        )
        for c in hiding
    ]
    return tuple(sorted(rows, key=lambda r: (r.name, r.place)))


def _largest(candidate: Candidate, phi: float) -> float:
    return float(abs(candidate.size) + _ONE_SIDED_95 * candidate.size_std * np.sqrt(phi))


def _ranges(
    alive: Sequence[Fit], hiding: Sequence[Candidate], phi: float
) -> tuple[StiffnessRange, ...]:
    """Union of the 95 % intervals of all models that still stand, and of what could hide.

    An effect that nobody would see can still stand for a part of a joint's stiffness: a servo
    behind the transmission does.
    """
    best = alive[0]
    rows = []
    for i in best.hypothesis.ordinary.elastic:
        joint = best.hypothesis.ordinary.arm.joints[i].name
        name = f"ln k {joint}"
        found = [_intervals(f, [name], phi)[name] for f in alive]
        k = float(np.exp(found[0].value))
        half = found[0].high - found[0].value
        low, high = min(f.low for f in found), max(f.high for f in found)
        for c in hiding:
            # Beyond a factor of two the linear look says nothing but "very wide".
            shift = float(np.clip(c.follow.get(name, 0.0) * _largest(c, phi), -_WIDEST, _WIDEST))
            reach = [found[0].value + shift]
            if c.instance.parameters and c.instance.parameters[0].low < 0.0:
                reach.append(found[0].value - shift)
            # Both are rarely at their limits at once: variances add.
            for end in reach:
                spread = float(np.hypot(end - found[0].value, half))
                if end < found[0].value:
                    low = min(low, found[0].value - spread)
                else:
                    high = max(high, found[0].value + spread)
        rows.append(
            StiffnessRange(
                joint=joint,
                k_n_m_per_rad=k,
                k_std=k * found[0].std,
                low=float(np.exp(low)),
                high=float(np.exp(high)),
            )
        )
    return tuple(rows)


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


def _interface(stage: Stage, before: Fit) -> str:
    lines = scan_axes(stage, fit_hypothesis(stage, before.hypothesis, start=before.values))
    if not lines or lines[0].gain < Thresholds().clear:
        return "no interface of a link departs from the model beyond what is allowed"
    best = lines[0].instance.place
    second = next((c for c in lines if c.instance.place != best), None)
    words = f"the motion departs from the model most at the root of link '{best}'"
    if second is not None and second.gain > 0.5 * lines[0].gain:
        words += f", nearly as much at '{second.instance.place}'"
    return words


def _summary(
    verdict: Verdict,
    effects: Sequence[EffectFound],
    standing: Sequence[Fit],
    misfit: float,
    where: Sequence[Disagreement],
) -> str:
    if verdict is Verdict.NAMED:
        words = "; ".join(f"{e.title} ({e.place})" if e.place else e.title for e in effects)
        return f"Missing in the model: {words}."
    if verdict is Verdict.AMBIGUOUS:
        return "Something is missing, but it cannot be told which: " + " or ".join(
            _title(f) for f in standing
        )
    if verdict is Verdict.OUTSIDE_LIBRARY:
        worst = max(where, key=lambda d: d.ratio)
        return (
            "Something is missing that the library does not know: a misfit of "
            f"{misfit:.1f} is left, most at point {worst.point} {worst.axis} in posture "
            f"'{worst.posture}' at {worst.band_hz[0]:.0f}-{worst.band_hz[1]:.0f} Hz."
        )
    return "Model and measurement agree within scatter and ordinary errors."
