"""The workflow: gates, baseline, where, which, fit and judge, add; again until nothing is left."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks.session import check_session
from armodal.analyzer.gap.add import instances_of_file
from armodal.analyzer.gap.begin import ordinary_of, with_places
from armodal.analyzer.gap.decision.added_effect import Step, beside_rivals, with_step
from armodal.analyzer.gap.decision.calibration import (
    FALSE_NAME,
    Calibration,
    Calibrations,
    is_told_by_level,
)
from armodal.analyzer.gap.decision.data_requirements import (
    assumed_in,
    check_data_requirements,
    check_tests,
    notes_on,
)
from armodal.analyzer.gap.decision.judge import (
    Judged,
    ends_alike,
    one_mechanism,
)
from armodal.analyzer.gap.decision.naming import judge_round, step_to
from armodal.analyzer.gap.decision.without_levels import first_with_levels
from armodal.analyzer.gap.gates import gates_of
from armodal.analyzer.gap.inference.annealing import annealing_stages, of_test, with_tests
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.inference.held_out import held_out_postures
from armodal.analyzer.gap.inference.misfit import misfit_of_replicas, misfit_per_line
from armodal.analyzer.gap.model.hit_levels import middle_level
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.outcome import GapOutcome, conclude
from armodal.analyzer.gap.records import Gate
from armodal.analyzer.gap.search.levels import told_apart
from armodal.analyzer.gap.search.rivals import Rivals, find_rivals
from armodal.analyzer.identification.estimate import estimate_frfs
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.plan_records import Mode, Plan
from armodal.protocols.session.records import Session

__all__ = ["GapOutcome", "find_gap"]

_MOST_UNFOLLOWED = 2  # effects named while the hits' level tells, none of which follows it

Tell = Callable[[str], None]


def find_gap(
    session: Session,
    *,
    more: Sequence[Session] = (),
    false_name: float = FALSE_NAME,
    gates: bool = True,
    modes: bool = True,
    advice: bool = True,
    tell: Tell = lambda _: None,
) -> GapOutcome:
    """Find where model and measurement disagree, and what is missing.

    Parameters
    ----------
    session
        Own or imported. Where it has no records of single hits its averaged FRFs are used.
    more
        Further tests of the same arm, such as a proposed one: their postures count with its own,
        in the state their plans tell (brakes, known masses).
    false_name
        Accepted probability of a false name, between 0 and 1.
    gates, modes, advice
        Run the checks without a model; pair modes in the comparison before and after; propose the
        next test.
    tell
        Told what is being done.

    Raises
    ------
    EstimateError
        If the session cannot carry the judgement: fewer than two postures with known angles, too
        few points, an arm without an elastic joint.
    """
    session, more, numbers, replaced = first_with_levels(session, more)
    superset = Superset(session.header.arm)
    check_data_requirements(session)
    check_tests(session, more)
    single_hits = bool(session.hits)
    frfs = estimate_frfs(session, superset) if single_hits else session.frfs
    gate_rows = _gates(session, frfs, superset, tell) if gates and single_hits else ()
    of_first = annealing_stages(superset, session, frfs)
    stages = with_tests(of_first, superset, more)
    ordinary = ordinary_of((session, *more), superset, stages[-1].lines)
    notes = [*replaced, *notes_on(session, more)]

    from_file, start = instances_of_file(ordinary)
    apart = cache(
        partial(_stage_with_levels_apart, session, more, superset, frfs, of_first[-1].models)
    )
    levels = partial(_with_levels_apart, apart, superset, tell)
    stages, present = levels(
        stages, Hypothesis(ordinary=ordinary, instances=from_file), start, notes
    )
    stages, near = with_places(stages, present, start)
    ordinary = present.ordinary.beside_drives(near)
    from_file, start = instances_of_file(ordinary)
    present = Hypothesis(ordinary=ordinary, instances=from_file)
    search = partial(_search, stages, (present, start), levels, false_name)
    ended, said = search(tell=tell)
    if ended.named and ended.judged.calibration.is_model_wrong:
        # A wrong first name explains much and leaves more: what else would be the first?
        first = ended.named[0].fit.last
        tell(f"again, without: {first.title}")
        other, other_said = search(tell=tell, without=(first.key,))
        if other.misfit < ended.misfit:
            ended, said = other, other_said
    notes += said
    final = ended.found.present
    return conclude(
        modes_of=[*frfs, *_frfs_of_tests(superset, more)] if modes else (),
        stages=ended.stages,
        before=ended.before,
        final=final,
        found=ended.found,
        judged=ended.judged,
        named=ended.named,
        test=held_out_postures(session, ended.stages[-1].lines),
        gates=gate_rows,
        notes=notes,
        false_name=false_name,
        assumed=assumed_in(session, more),
        sessions=numbers,
        plan=_plan_to_go_on(session, notes) if advice and single_hits else None,
        tell=tell,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Ended:
    """What a search came to."""

    stages: tuple[Stage, ...]  # with soft and hard hits apart where that was told
    before: Fit  # with nothing named
    found: Rivals
    judged: Judged
    named: tuple[Step, ...]

    @property
    def misfit(self) -> float:
        """Return what the model leaves a residual."""
        return misfit_per_line(self.stages[-1], self.found.present)


def _search(
    stages: tuple[Stage, ...],
    believed: tuple[Hypothesis, dict[str, float]],
    levels: Callable[..., tuple[tuple[Stage, ...], Hypothesis]],
    false_name: float,
    *,
    tell: Tell,
    without: Collection[tuple[str, str]] = (),
) -> tuple[_Ended, list[str]]:
    """Name what is missing, one effect at a time, until nothing earns a name.

    Parameters
    ----------
    believed
        The arm as its user believes it, and where the effects of its file begin.
    levels
        Tells soft and hard hits apart (`_with_levels_apart`).
    without
        Keys of instances that are not tried.

    Returns
    -------
    What it came to, and what is to be said of it.
    """
    present, start = believed
    notes: list[str] = []
    named: list[Step] = []
    before: Fit | None = None
    fitted: Fit | None = None
    rounds = 0
    calibrations = Calibrations(false_name)
    while True:
        rounds += 1
        found = find_rivals(
            stages,
            present,
            partial(calibrations.needs_more, stages[-1]),
            limit=partial(calibrations.limit, stages[-1]),
            start=start,
            fitted=fitted,
            without=without,
            tell=tell,
        )
        before = before or found.present
        tell("replicas of the session")
        calibration = calibrations.of(stages[-1], found.present, found.rivals)
        judged = judge_round(stages[-1], found, calibration, len(named), rounds, notes)
        if judged.named is None:
            break
        better = judged.named
        leaves = partial(misfit_of_replicas, stages[-1], beyond=false_name)
        step, doubt = step_to(stages[-1], found.present, judged, better, leaves, len(named), tell)
        if step is None:
            notes.append(f"{better.last.title} {doubt}; it was not named")
            judged = replace(judged, named=None, standing=(better, found.present), doubted=True)
            break
        notes += _begins_elsewhere(better, found.rivals, calibration.apart)
        fitted, named = with_step(stages, named, step, believed[1], notes)
        present, start = fitted.hypothesis, fitted.values
        apart, levelled = levels(
            stages, present, start, notes, calibration.apart_from(len(present.ordinary.elastic))
        )
        if levelled is not present:
            # What had been missing hid it: from the start again, without what was said meanwhile.
            notes = notes[-1:] if levelled.ordinary.swings else notes[-2:]
            rounds = 0
            stages, _ = with_places(apart, levelled, start)
            present, start = believed
            present = replace(present, ordinary=levelled.ordinary)
            named, before, fitted = [], None, None
        elif _is_outside(stages[-1], fitted, calibration, named):
            # Outside the library: what else there is would be told of a wrong model.
            found = Rivals(present=fitted, rivals=())
            judged = replace(judged, named=None, standing=())
            break
        else:
            # What one mounting has of its own is of the motion that the better model foretells.
            stages = tuple(stage.with_places(present, start) for stage in stages)
            fitted = fit_hypothesis(stages[-1], present.without_points(), start=start)
            fitted, named = beside_rivals(stages[-1], fitted, [*found.rivals, *found.let_go], named)
            present = fitted.hypothesis
    ended = _Ended(
        stages=stages,
        before=before,
        found=found,
        judged=judged,
        named=tuple(named),
    )
    return ended, notes


def _plan_to_go_on(session: Session, notes: list[str]) -> Plan | None:
    """The plan that a next test is like."""
    plan = session.header.plan
    if plan.mode is Mode.ROVING_HAMMER:
        notes.append("no further test is proposed where the hammer moves and the sensor stays")
        return None
    return plan


def _frfs_of_tests(superset: Superset, more: Sequence[Session]) -> list[FrequencyResponse]:
    return [
        replace(frf, posture=of_test(frf.posture, number))
        for number, other in enumerate(more, start=2)
        for frf in estimate_frfs(other, superset)
    ]


def _stage_with_levels_apart(
    session: Session,
    more: Sequence[Session],
    superset: Superset,
    frfs: Sequence[FrequencyResponse],
    models: Sequence[PosedModel],
    number: int,
) -> Stage:
    """Lines of soft and of hard hits of one stage; `models` of the session's own postures."""
    about = middle_level(session)
    (apart,) = annealing_stages(
        superset, session, frfs, models=models, level_about=about, only=[number]
    )
    return with_tests((apart,), superset, more, about, [number])[0]


def _with_levels_apart(
    level_apart: Callable[[int], Stage],
    superset: Superset,
    tell: Tell,
    stages: tuple[Stage, ...],
    present: Hypothesis,
    start: Mapping[str, float],
    notes: list[str],
    least: float = 0.0,
) -> tuple[tuple[Stage, ...], Hypothesis]:
    """Stages with soft and hard hits apart, if the level tells something; else as they are.

    Parameters
    ----------
    level_apart
        Gives a stage with soft and hard hits apart, by its number.
    least
        Nats it must tell at least.
    """
    ordinary = present.ordinary
    if ordinary.level_span or not ordinary.levels_hit:
        return stages, present
    tell("soft hits compared with hard ones")
    span = max(lines.level for lines in level_apart(1).lines)
    levelled = replace(present, ordinary=replace(ordinary, level_span=span))
    found = told_apart(superset, level_apart, levelled, start, Discrepancy())
    if found is None or found.gain < least:
        return stages, present
    notes.append(
        "the response depends on the hits' level: soft and hard hits were analysed separately"
    )
    if not found.swings:
        notes.append("the hits' width is not known, so no joint's law could be followed")
    told = replace(levelled, ordinary=replace(levelled.ordinary, swings=found.swings))
    # The widest lines only begin a search: there all hits together tell as much in half the time.
    return (stages[0], *found.stages), told


def _begins_elsewhere(named: Fit, rivals: Sequence[Fit], apart: float) -> list[str]:
    return [
        f"{named.last.title}: between {other.last.place} it would tell as much"
        for other in rivals
        if other is not named
        and ends_alike(other.last, named.last)
        and other.evidence - named.evidence < apart
    ]


def _is_outside(stage: Stage, fitted: Fit, calibration: Calibration, named: Sequence[Step]) -> bool:
    """Whether what was named so far tells already that the library does not know the arm."""
    present = fitted.hypothesis
    if one_mechanism(present.instances, present.ordinary.arm.joints) is not None:
        return True
    return len(named) == _MOST_UNFOLLOWED and is_told_by_level(stage, fitted, calibration)


def _gates(
    session: Session, frfs: Sequence[FrequencyResponse], superset: Superset, tell: Tell
) -> tuple[Gate, ...]:
    tell("checks without a model")
    return gates_of(check_session(session, frfs, superset))
