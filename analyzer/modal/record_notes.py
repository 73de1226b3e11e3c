"""What a person should know of the records behind a posture's FRFs."""

from __future__ import annotations

from armodal.analyzer.modal.chosen_hits import accepted_hits
from armodal.analyzer.modal.spectra import hit_spectra
from armodal.analyzer.modal.usable_band import UsableBand
from armodal.protocols.session.records import Session

__all__ = ["band_of_hits", "record_notes"]


def band_of_hits(session: Session, posture: str) -> UsableBand | None:
    """Return the band that a posture's hits excite; None where its FRFs were given."""
    if any(frf.posture == posture for frf in session.frfs) or not session.accepted(posture):
        return None
    return hit_spectra(session, accepted_hits(session, posture)).usable


def record_notes(
    session: Session,
    posture: str,
    *,
    band_hz: tuple[float, float] | None = None,
    board_limits: bool = True,
    ends_earlier: bool = False,
) -> tuple[str, ...]:
    """Say what was taken of a posture's hits: the band, and records of other lengths cut.

    Parameters
    ----------
    band_hz
        The band asked for; a warning where it leaves what the hits excite.
    board_limits
        Whether a band that the board ends, and not the force, is said too.
    ends_earlier
        Whether what was made of the FRFs ends below them and has said so: where they end tells
        nobody anything then.
    """
    usable = band_of_hits(session, posture)
    if usable is None:
        return ()
    where = f"posture {posture!r}: "
    notes = [usable.warning(band_hz)] if band_hz is not None else []
    if band_hz is None and not ends_earlier and (board_limits or usable.by_force):
        notes.append(usable.words)
    behind = [
        len(hit.counts) - (hit.trigger_sample - hit.first_sample)
        for hit in session.accepted(posture)
    ]
    if len({len(hit.counts) for hit in session.accepted(posture)}) > 1:
        notes.append(
            f"records hold {min(behind)} to {max(behind)} samples from the trigger on: the first "
            f"{min(behind)} are used"
        )
    return tuple(where + note for note in notes if note)
