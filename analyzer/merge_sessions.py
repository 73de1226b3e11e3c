"""One session of several: the same points hit with other hammers, FRFs merged by their variance."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.modal import record_notes
from armodal.analyzer.modal.merge import Disagreement, MergedFrf, merge_frfs
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Hit, Session

__all__ = ["merge_sessions"]

_LEAD_S = 0.002  # before the pulse, as spectra want it
_LEAD_SAMPLES = 8
_NAMED = 4


def merge_sessions(
    sessions: Sequence[Session], names: Sequence[str], *, created: str, software: str
) -> tuple[Session, tuple[tuple[str, MergedFrf], ...]]:
    """Merge the FRFs of every posture of the first session with those of the others.

    Arm, plan, windows and estimator are the first session's; records of hits are cut to one length,
    so that all have the same lines.

    Parameters
    ----------
    sessions
        Two or more, of hits or FRFs.
    names
        What sentences call them, such as their files.
    created, software
        ISO 8601 time, UTC, and what merges.

    Returns
    -------
    Session
        With FRFs in place of hits; what was found is among its warnings.
    tuple
        Of every posture that was merged, its name and how.

    Raises
    ------
    EstimateError
        If there are fewer than two sessions, they share no posture, or FRFs cannot be merged.
    """
    if len(sessions) < 2:
        raise EstimateError(f"wanted two sessions or more to merge, got {len(sessions)}")
    ids = [session.header.session_id for session in sessions]
    if len(set(ids)) < len(ids):
        raise EstimateError(
            f"{', '.join(names)}: wanted other measurements each, two are the same session; merged "
            "with itself it would only look surer"
        )
    told = [session.header.told_tolerance_rad for session in sessions]
    if len(set(told)) > 1:
        raise EstimateError(
            f"{', '.join(names)}: wanted joint angles of one kind, got some that were measured and "
            "some told by hand, or told to several tolerances; they are never mixed in one session"
        )
    said: list[str] = [
        f"{name}: {text}"
        for name, session in zip(names, sessions, strict=True)
        for text in session.warnings
    ]
    alike = _cut_alike(_with_windows_of_first(sessions, names, said), names, said)
    every = [
        {frf.posture: frf for frf in estimate_frfs(one, Superset(one.header.arm))} for one in alike
    ]
    frfs: list[FrequencyResponse] = []
    merged: list[tuple[str, MergedFrf]] = []
    for posture, frf in every[0].items():
        having = [k for k, found in enumerate(every) if posture in found]
        said += [f"{names[k]}: {note}" for k in having for note in record_notes(alike[k], posture)]
        if len(having) < 2:
            said.append(f"posture {posture!r}: only {names[0]} has it: its FRFs are as they were")
            frfs.append(frf)
            continue
        _check_angles(sessions[0], [every[k][posture] for k in having], [names[k] for k in having])
        result = merge_frfs([every[k][posture] for k in having])
        frfs.append(result.frf)
        merged.append((posture, result))
        said += _words(posture, result, [names[k] for k in having])
    if not merged:
        raise EstimateError(
            f"{names[0]}: wanted a posture that another session has too, got "
            f"{', '.join(repr(name) for name in every[0]) or 'none with FRFs'}; postures are "
            "matched by their names"
        )
    for name, found in zip(names[1:], every[1:], strict=True):
        more = [repr(posture) for posture in found if posture not in every[0]]
        if more:
            said.append(f"{name}: posture {', '.join(more)}: {names[0]} has it not: left out")
    header = replace(
        sessions[0].header,
        session_id=hashlib.sha256("+".join(ids).encode()).hexdigest()[:32],
        created=created,
        software=software,
        measured_by=", ".join(
            dict.fromkeys(one.header.measured_by for one in sessions if one.header.measured_by)
        ),
    )
    session = Session(
        header=header,
        hits=(),
        losses=(),
        complete=all(one.complete for one in sessions),
        warnings=tuple(dict.fromkeys(said)),
        frfs=tuple(frfs),
    )
    return session, tuple(merged)


def _with_windows_of_first(
    sessions: Sequence[Session], names: Sequence[str], said: list[str]
) -> list[Session]:
    """Give hits of all the first session's windows and estimator."""
    wanted = sessions[0].header.plan
    result = []
    for name, session in zip(names, sessions, strict=True):
        plan = session.header.plan
        changed = replace(plan, windows=wanted.windows, averaging=wanted.averaging)
        if session.hits and changed != plan:
            said.append(f"{name}: windows and averaging are those of {names[0]}")
        result.append(replace(session, header=replace(session.header, plan=changed)))
    return result


def _cut_alike(sessions: Sequence[Session], names: Sequence[str], said: list[str]) -> list[Session]:
    """Cut the records of hits to one length before and behind their trigger."""
    rates = {session.header.plan.sampling.rate_hz for session in sessions if session.hits}
    hits = [hit for session in sessions for hit in session.hits if hit.verdict.accepted]
    if len(rates) != 1 or not hits:
        return list(sessions)
    nominal = _LEAD_SAMPLES + round(_LEAD_S * float(min(rates)))
    lead = min(nominal, *(_lead(hit) for hit in hits))
    behind = min(len(hit.counts) - _lead(hit) for hit in hits)
    longest = max(len(hit.counts) - _lead(hit) for hit in hits)
    if behind < longest:
        said.append(f"records of {', '.join(names)} are cut to {behind} samples from the trigger")
    return [
        replace(
            session,
            hits=tuple(
                _cut(hit, lead if lead < nominal else _lead(hit), behind)
                for hit in session.hits
                if hit.verdict.accepted
            ),
        )
        for session in sessions
    ]


def _lead(hit: Hit) -> int:
    return int(hit.trigger_sample - hit.first_sample)


def _cut(hit: Hit, lead: int, behind: int) -> Hit:
    first = _lead(hit) - lead
    counts = hit.counts[first : first + lead + behind]
    return replace(hit, counts=counts, first_sample=hit.first_sample + first)


def _check_angles(
    session: Session, frfs: Sequence[FrequencyResponse], names: Sequence[str]
) -> None:
    """Refuse FRFs of an arm that stood otherwise."""
    first = frfs[0]
    tolerance = next(
        posture.tolerance_rad
        for posture in session.header.plan.postures
        if posture.name == first.posture
    )
    for name, frf in zip(names[1:], frfs[1:], strict=True):
        if first.joints_rad is None or frf.joints_rad is None:
            continue
        apart = np.abs(frf.joints_rad - first.joints_rad) if first.joints_rad.size else np.zeros(1)
        if float(apart.max()) > 2.0 * tolerance:
            raise EstimateError(
                f"posture {first.posture!r}: wanted the arm where {names[0]} has it, within "
                f"{np.degrees(2.0 * tolerance):.2g} deg, joint {int(apart.argmax()) + 1} is "
                f"{np.degrees(apart.max()):.3g} deg off in {name}; merge one posture only"
            )


def _words(posture: str, merged: MergedFrf, names: Sequence[str]) -> list[str]:
    """Say which hammer counts where, and where they disagree."""
    weight = np.median(merged.weight, axis=(1, 2))  # (n_inputs, n_freq)
    freq = merged.frf.freq_hz
    leads = np.argmax(weight, axis=0)
    parts = []
    for k, name in enumerate(names):
        own = leads == k
        if not own.any():
            parts.append(f"{name} leads nowhere")
            continue
        at = freq[own]
        low, high = (float(q) for q in np.quantile(at, [0.05, 0.95]))
        lines = f"{np.mean(own):.0%} of the lines, most of them {low:.4g} to {high:.5g} Hz"
        parts.append(f"{name} leads on {lines}")
    where = f"posture {posture!r}: "
    sentences = [where + "merged by variance: " + "; ".join(parts)]
    frf = merged.frf
    ranked = sorted(merged.disagreements, key=lambda one: -one.largest)
    for told in ranked[:_NAMED]:
        response, reference = frf.responses[told.response], frf.references[told.reference]
        sentences.append(
            f"{where}response {response.point} {response.label}, hit at {reference.point}: "
            f"{_disagreement(told)}; the deviation is widened there"
        )
    if len(ranked) > _NAMED:
        sentences.append(f"{where}{len(ranked) - _NAMED} more FRFs differ beyond their scatter")
    return sentences


def _disagreement(told: Disagreement) -> str:
    if told.gain != 1.0:
        return (
            f"the FRFs differ by a factor of {abs(told.gain):.4g} on all lines: the hammers' "
            "sensitivities, or their aim, are not the same"
        )
    return (
        f"the FRFs differ by up to {told.largest:.2g} of their size on {told.lines:.0%} of the "
        f"lines both have, {told.low_hz:.4g} to {told.high_hz:.5g} Hz, more than hits scatter: "
        "the level, or the structure, has changed"
    )
