"""Sessions, FRFs and modes for scripts."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from armodal import SOFTWARE
from armodal.analyzer import modal
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.given_frfs import with_variances
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.merge_sessions import merge_sessions
from armodal.daq.judge_imported import judged
from armodal.protocols.arm import files as arm_files
from armodal.protocols.arm.records import Arm
from armodal.protocols.foreign import import_session as foreign
from armodal.protocols.foreign.manifest import load_manifest
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.hdf5 import Provenance, read_session, write_session
from armodal.protocols.session.records import Session

__all__ = [
    "fit_modes",
    "frfs",
    "import_session",
    "load_arm",
    "merge",
    "open_session",
    "save_session",
]


def open_session(path: str | Path) -> Session:
    """Read a session file.

    Raises
    ------
    SessionError
        If it is no session file, or damaged.
    """
    return read_session(path)


def import_session(manifest: str | Path) -> Session:
    """Read measurements of another program, as a manifest tells; hits are judged as our own.

    Parameters
    ----------
    manifest
        TOML file that names the files, their points and directions (docs/exchange.md).

    Raises
    ------
    ForeignFileError
        If the manifest or a file it names cannot be read.
    """
    created = datetime.now(UTC).isoformat(timespec="seconds")
    session = foreign.import_session(
        load_manifest(Path(manifest)), created=created, software=SOFTWARE
    )
    return with_variances(judged(session))


def save_session(session: Session, path: str | Path) -> None:
    """Write a session file whole or not at all.

    Raises
    ------
    SessionError
        If it cannot be written.
    """
    provenance = Provenance(journal_sha256=None, software=SOFTWARE)
    write_session(session, Path(path), provenance=provenance)


def load_arm(name_or_path: str | Path) -> Arm:
    """Read an arm file, or a shipped arm such as `rv4frl`, `viper_s650` or `ur5`.

    Raises
    ------
    ArmError
        If it does not describe an arm.
    """
    return arm_files.load_arm(str(name_or_path))


def frfs(
    session: Session, *, band_hz: tuple[float, float] | None = None
) -> tuple[FrequencyResponse, ...]:
    """FRFs of every posture: averaged over its accepted hits, or those that were imported.

    Parameters
    ----------
    session
        With accepted hits or FRFs.
    band_hz
        Lines taken although the hits hardly excite them.

    Returns
    -------
    tuple of FrequencyResponse
        `values` (n_resp, n_ref, n_freq), of own hits accelerance in m/(s² N).

    Raises
    ------
    EstimateError
        If a posture's hits cannot be averaged.
    """
    return estimate_frfs(session, Superset(session.header.arm), band_hz=band_hz)


def merge(sessions: Sequence[Session]) -> Session:
    """One session of several hammers' FRFs, every line weighted by its variance.

    Parameters
    ----------
    sessions
        Two or more, of the same points.

    Raises
    ------
    EstimateError
        If they are not measurements of the same FRFs, or one tells no variance.
    """
    names = [f"session {i + 1}" for i in range(len(sessions))]
    created = datetime.now(UTC).isoformat(timespec="seconds")
    return merge_sessions(sessions, names, created=created, software=SOFTWARE)[0]


def fit_modes(
    frf: FrequencyResponse, *, band_hz: tuple[float, float] | None = None, max_order: int = 60
) -> modal.ModalModel:
    """Modes of one posture's FRFs with uncertainties, without a starting guess.

    Parameters
    ----------
    frf
        FRFs of any form.
    band_hz
        Lines used, and where modes may lie; all by default.
    max_order
        Highest order of the stabilisation.

    Raises
    ------
    EstimateError
        If the FRFs cannot be fitted.

    References
    ----------
    docs/theory-modal.md.
    """
    return modal.fit_modes(frf, band_hz=band_hz, max_order=max_order)
