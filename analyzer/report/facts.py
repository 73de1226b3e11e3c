"""What was tested, with what and when, as the head of a report's first page."""

from __future__ import annotations

from collections import Counter

from armodal.protocols.session.records import Session

__all__ = ["Facts", "equipment", "facts", "loss_warnings", "preview_samples_lost"]

Facts = tuple[tuple[str, str], ...]

_PREVIEW = "stream"  # samples for the screen; a hit has its own


def facts(session: Session) -> Facts:
    """Return label and text of each row."""
    header = session.header
    postures = header.plan.postures
    unseen = [posture.name for posture in postures if posture.validation]
    rows = [
        ("Session", f"{header.session_id}, {header.created[:16].replace('T', ' ')} UTC"),
        ("Measured by", header.measured_by or "not recorded"),
        (
            "Postures",
            f"{len(postures)}" + (f", {len(unseen)} of them kept for validation" if unseen else ""),
        ),
        ("Hits", _hits(session)),
        ("Equipment", equipment(session)),
    ]
    if header.time_scale != 1.0:
        speed = f", at {header.time_scale:g} times real time"
        rows.append(("Laboratory", f"simulated{speed}: no real arm was measured"))
    return tuple((label, text) for label, text in rows if text)


def equipment(session: Session) -> str:
    """Return board and sensors with serial numbers and days of calibration."""
    dictionary = session.header.dictionary
    sensors: dict[tuple[str, str], list[str]] = {}
    for channel in dictionary.channels:
        sensors.setdefault((channel.serial_number, channel.calibration_date), []).append(
            channel.name
        )
    told = []
    for (serial, date), names in sensors.items():
        inside = f"{serial or 'no serial number'}{f', calibrated {date}' if date else ''}"
        told.append(f"{' '.join(names)} ({inside})")
    board = [f"board {dictionary.board_id}"] if dictionary.board_id else []
    return "; ".join(board + told)


def loss_warnings(session: Session) -> tuple[str, ...]:
    """Return what was lost and matters: not samples of the preview, which no hit is made of."""
    counts = Counter[tuple[str, str]]()
    for loss in session.losses:
        if loss.kind != _PREVIEW:
            counts[loss.kind, loss.note] += loss.count
    simulated = session.header.time_scale != 1.0
    return tuple(_told(kind, note, count, simulated) for (kind, note), count in counts.items())


def preview_samples_lost(session: Session) -> int:
    """Return how many samples of the preview were lost: the screen's loss, no hit's."""
    return sum(loss.count for loss in session.losses if loss.kind == _PREVIEW)


def _told(kind: str, note: str, count: int, simulated: bool) -> str:
    whose = " by the simulator, which ran faster than real time" if simulated else ""
    return f"Lost{whose}: {count} of {kind} ({note}). No accepted hit lacks a sample."


def _hits(session: Session) -> str:
    if not session.hits:
        return "FRFs averaged elsewhere" if session.frfs else ""
    accepted = len(session.accepted())
    reasons = Counter(
        reason for hit in session.hits for reason in hit.verdict.reasons if not hit.verdict.accepted
    )
    said = f"{accepted} accepted, {len(session.hits) - accepted} rejected"
    if reasons:
        said += f" ({', '.join(f'{reason} {n}' for reason, n in reasons.items())})"
    return said
