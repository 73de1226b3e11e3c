"""What a session must hold to be judged, and what is said of one that holds less than it could."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.analyzer.gap.inference.annealing import FEWEST_POSTURES
from armodal.analyzer.gap.model.hit_levels import has_levels, postures_hit_once
from armodal.analyzer.modal.record_notes import record_notes
from armodal.protocols.errors import EstimateError
from armodal.protocols.plan_records import Mode
from armodal.protocols.session.operator_angles import angles_by_hand
from armodal.protocols.session.records import Session

__all__ = ["assumed_in", "check_data_requirements", "check_tests", "notes_on"]

_FEWEST_POINTS = 4


def check_data_requirements(session: Session) -> None:
    """Check that a session can carry a judgement.

    Raises
    ------
    EstimateError
        If it cannot: no elastic joint, no accepted hit, too few postures or points.
    """
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
    if len(postures) < FEWEST_POSTURES:
        raise EstimateError(
            f"wanted at least {FEWEST_POSTURES} postures to tell effects apart, got "
            f"{len(postures)}; measure others that move the masses beyond each joint"
        )
    if len(points) < _FEWEST_POINTS:
        raise EstimateError(
            f"wanted at least {_FEWEST_POINTS} points, three on every link that matters, got "
            f"{len(points)}; measure more points"
        )


def check_tests(session: Session, more: Sequence[Session]) -> None:
    """Check that further tests can be judged with a session.

    Raises
    ------
    EstimateError
        If one has no accepted hit, or is there twice.
    """
    seen = {session.header.session_id}
    for number, other in enumerate(more, start=2):
        if other.header.session_id in seen:
            raise EstimateError(
                f"test {number} is a session that is there already, and would count twice; give "
                "each session once"
            )
        seen.add(other.header.session_id)
        accepted = [hit for hit in other.hits if hit.verdict.accepted]
        if other.hits and not accepted:
            raise EstimateError(
                f"no hit of test {number} was accepted, so it adds nothing; leave it out or "
                "measure it again"
            )


def notes_on(session: Session, more: Sequence[Session]) -> list[str]:
    """What a reader must know of a session that was judged, and of its further tests."""
    notes = [*angles_by_hand(session.header), *session.header.arm.tolerances.remarks]
    notes += [*_of_its_records(session), *_hit_once(session, "")]
    for number, other in enumerate(more, start=2):
        said = (*angles_by_hand(other.header), *_of_its_records(other))
        notes += [f"test {number}: {words}" for words in said]
        notes += _hit_once(other, f" of test {number}")
    of_hits = {hit.posture for hit in session.hits}
    averaged = sorted({frf.posture for frf in session.frfs} - of_hits)
    if of_hits and averaged:
        notes.append(
            f"postures without records of single hits were not judged: {', '.join(averaged)}"
        )
    if session.hits and has_levels(session):
        notes += [
            f"test {number} was not hit softly and hard at every point: effects that need several "
            "hit levels were not considered"
            for number, other in enumerate(more, start=2)
            if not has_levels(other)
        ]
    if not session.hits:
        notes.append(
            "only averaged FRFs are there: checks that need single hits, and effects that need "
            "several hit levels, were not considered"
        )
    elif not has_levels(session):
        notes.append(
            "not every point was hit softly and hard (`peaks_n` in the plan): effects of the hits' "
            "level were not looked for"
        )
    if not session.complete:
        notes.append("the session is not complete; what is missing was not judged")
    return notes


def assumed_in(session: Session, more: Sequence[Session]) -> str:
    """What the verdict itself says was assumed, in a sentence; empty where nothing was."""
    usual = session.header.arm.tolerances.usual
    assumed = [f"tolerances of {', '.join(usual)} (usual ones)"] if usual else []
    if any(_postures_hit_once(one) for one in (session, *more)):
        assumed.append("how far hits at a point scatter (the tolerance of their aim)")
    return f" Assumed, and not told by the test: {' and '.join(assumed)}." if assumed else ""


def _postures_hit_once(session: Session) -> tuple[str, ...]:
    return postures_hit_once([hit for hit in session.hits if hit.verdict.accepted])


def _of_its_records(session: Session) -> list[str]:
    """What an import or the test said of its records, and where records of a posture were cut."""
    postures = dict.fromkeys(hit.posture for hit in session.hits)
    cut = [note for name in postures for note in record_notes(session, name, ends_earlier=True)]
    return [*session.warnings, *cut]


def _hit_once(session: Session, of_what: str) -> list[str]:
    once = _postures_hit_once(session)
    if not once:
        return []
    words = (
        f"in {', '.join(once)}{of_what} most points were hit once, so nothing tells how far those "
        "hits scatter. The ends of their records tell noise, of the aim its tolerance is taken: "
        "with a worse one something may seem to be outside the library, and what is faint be "
        "missed; two hits at each point tell"
    )
    return [words]
