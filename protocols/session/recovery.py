"""A session file rebuilt from its journal, and what was found on the way."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from armodal.protocols.errors import EstimateError, SessionError
from armodal.protocols.file_layer import DISK, FileLayer
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.hdf5 import Provenance, write_session
from armodal.protocols.session.journal import decode_journal, session_of
from armodal.protocols.session.journal_bytes import journal_file, pieces
from armodal.protocols.session.records import Session

__all__ = ["Recovery", "rebuild"]

FrfEstimator = Callable[[Session], Sequence[FrequencyResponse]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Recovery:
    """What `rebuild` recovered and what it had to drop."""

    session: Session
    frfs: tuple[FrequencyResponse, ...]
    journal_bytes: int
    recovered_bytes: int
    accepted: int
    rejected: int
    records_beyond: bool  # complete records lie behind the damage
    frf_problem: str | None  # why there are no FRFs, where they were asked for

    @property
    def dropped_bytes(self) -> int:
        """Bytes behind the last complete record of the journal."""
        return self.journal_bytes - self.recovered_bytes


def rebuild(
    journal_path: str | Path,
    session_path: str | Path,
    *,
    software: str,
    estimate_frfs: FrfEstimator | None = None,
    files: FileLayer = DISK,
) -> Recovery:
    """Write the session file that a journal tells of.

    Parameters
    ----------
    journal_path, session_path
        What is read, and what is written or replaced. The journal is never changed.
    software
        Name and version of what rebuilds, for the provenance.
    estimate_frfs
        Makes FRF matrices of the session. If it raises EstimateError (too few hits, say), the
        file is written without FRFs.
    files
        What the session file is written through.

    Raises
    ------
    JournalError, SessionError
        As `load_journal` and `write_session`; SessionError too if both paths are one file.
    """
    _check_not_the_journal(Path(journal_path), Path(session_path))
    digest = hashlib.sha256()
    with journal_file(Path(journal_path)) as data:
        journal = decode_journal(data)
        for part in pieces(data, 0, data.size):
            digest.update(part)
    session = session_of(journal)
    frfs: tuple[FrequencyResponse, ...] = ()
    frf_problem = None
    if estimate_frfs is not None:
        try:
            frfs = tuple(estimate_frfs(session))
        except EstimateError as error:
            frf_problem = str(error)
    provenance = Provenance(journal_sha256=digest.hexdigest(), software=software)
    write_session(session, session_path, frfs=frfs, provenance=provenance, files=files)
    accepted = len(session.accepted())
    return Recovery(
        session=session,
        frfs=frfs,
        journal_bytes=journal.size,
        recovered_bytes=journal.good_end,
        accepted=accepted,
        rejected=len(session.hits) - accepted,
        records_beyond=not journal.may_append,
        frf_problem=frf_problem,
    )


def _check_not_the_journal(journal: Path, session: Path) -> None:
    try:
        same = journal.samefile(session)
    except OSError:  # one of them is not there
        same = False
    if same:
        raise SessionError(
            f"wanted a session file beside the journal, got the journal itself, {session}: it is "
            "left as it is; give the session file another name, with armodal recover --out"
        )
