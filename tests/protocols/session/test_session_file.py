import hashlib
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from armodal.protocols.errors import EstimateError, JournalError, SessionError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.compare import first_difference
from armodal.protocols.session.hdf5 import (
    Provenance,
    read_frfs,
    read_provenance,
    read_session,
    write_session,
)
from armodal.protocols.session.hdf5_hits import write_losses
from armodal.protocols.session.journal import load_journal
from armodal.protocols.session.records import Hit, Session, SessionHeader
from armodal.protocols.session.recovery import rebuild

Frfs = tuple[FrequencyResponse, ...]


def test_session_and_frfs_round_trip(example, frfs: Frfs, written: Path) -> None:
    assert first_difference(read_session(written), example.session, "session") is None
    assert first_difference(read_frfs(written), frfs, "frfs") is None
    assert [item.name for item in written.parent.iterdir()] == ["a.h5"]


def test_session_without_hits_or_frfs_round_trips(header: SessionHeader, tmp_path: Path) -> None:
    session = Session(header=header, hits=(), losses=(), complete=False)
    write_session(session, tmp_path / "a.h5")
    assert first_difference(read_session(tmp_path / "a.h5"), session, "session") is None
    assert read_frfs(tmp_path / "a.h5") == ()
    provenance = read_provenance(tmp_path / "a.h5")
    assert provenance == Provenance(journal_sha256=None, software=header.software)


def test_journal_and_file_tell_of_the_same_session(example, tmp_path: Path) -> None:
    (tmp_path / "a.journal").write_bytes(example.journal)
    session = load_journal(tmp_path / "a.journal")
    write_session(session, tmp_path / "a.h5")
    assert first_difference(read_session(tmp_path / "a.h5"), session, "session") is None


def default_plot(file: h5py.File) -> h5py.Group:
    """Follow @default from the root as the NeXus manual has it."""
    group = file
    while group.attrs["NX_class"] != "NXdata":
        group = group[group.attrs["default"]]
    return group


def check_nxdata(group: h5py.Group) -> None:
    signal = group[group.attrs["signal"]]
    axes = list(group.attrs["axes"])
    assert len(axes) == signal.ndim
    for dimension, name in enumerate(axes):
        if name != ".":
            assert group[name].shape == (signal.shape[dimension],)
            assert group[name].attrs["units"]
            assert group.attrs[f"{name}_indices"] == dimension
    assert signal.attrs["units"]
    assert signal.attrs["interpretation"] == "spectrum"
    assert signal.dtype.kind in "fi"


def test_default_leads_viewers_to_the_frf_magnitude(frfs: Frfs, written: Path) -> None:
    with h5py.File(written) as file:
        group = default_plot(file)
        check_nxdata(group)
        assert np.array_equal(group[group.attrs["signal"]][()], np.abs(frfs[0].values))
        assert group["values"].dtype == np.complex128
        check_nxdata(file["session/frf_002"])


def test_default_leads_viewers_to_a_hit_while_there_are_no_frfs(example, tmp_path: Path) -> None:
    write_session(example.session, tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        group = default_plot(file)
        check_nxdata(group)
        assert np.array_equal(group["counts"][()], example.session.hits[0].counts.T)
        # Trigger sample is the third after the first; times are exact quotients of one rate.
        assert group["time_s"][3] == 0
        for hit in example.session.hits:
            check_nxdata(file[f"session/hits/hit_{hit.number:04d}"])


def test_who_measured_is_kept_where_it_was_told(header: SessionHeader, tmp_path: Path) -> None:
    for name, who in (("told", "shift two"), ("untold", "")):
        session = Session(
            header=replace(header, measured_by=who), hits=(), losses=(), complete=False
        )
        path = tmp_path / f"{name}.h5"
        write_session(session, path)
        assert read_session(path).header.measured_by == who
        with h5py.File(path) as file:
            assert ("measured_by" in file["session"]) == bool(who)


def test_calibration_stands_in_words(header: SessionHeader, written: Path) -> None:
    with h5py.File(written) as file:
        channels = file["session/board/channels"]
        for index, channel in enumerate(header.dictionary.channels):
            assert channels["scale"][index] == channel.scale
            assert channels["unit"][index].decode() == channel.unit
            assert channels["serial_number"][index].decode() == channel.serial_number
            assert bytes.fromhex(channels["teds_hex"][index].decode()) == channel.teds


def test_file_says_what_it_is(written: Path) -> None:
    with h5py.File(written) as file:
        assert file["session/definition"][()] == b"armodal-session"
        assert file["session/format_version"][()] == 1


def test_columns_of_hits_have_units_where_there_are_such(written: Path) -> None:
    with h5py.File(written) as file:
        table = file["session/hits/table"]
        units = {name: table[name].attrs["units"] for name in table if "units" in table[name].attrs}
    assert units == {"trigger_host_s": "s", "peak_n": "N", "width_s": "s"}


def test_interrupted_write_leaves_the_old_file(
    example, written: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = written.read_bytes()

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("armodal.protocols.session.hdf5.write_losses", full)
    with pytest.raises(SessionError, match="no space is left"):
        write_session(example.session, written)
    assert written.read_bytes() == before
    assert [item.name for item in written.parent.iterdir()] == ["a.h5"]


def test_file_that_reads_back_otherwise_is_thrown_away(
    example, written: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = written.read_bytes()
    monkeypatch.setattr("armodal.protocols.session.hdf5.write_losses", lambda entry, _: lose(entry))

    def lose(entry: h5py.Group) -> None:
        write_losses(entry, ())

    with pytest.raises(SessionError, match=r"differs from the session at session\.losses"):
        write_session(example.session, written)
    assert written.read_bytes() == before


def test_session_that_contradicts_itself_is_not_written(
    example, make_hit: Callable[..., Hit], tmp_path: Path
) -> None:
    stranger = replace(make_hit(9), posture="elsewhere")
    session = replace(example.session, hits=(stranger,))
    with pytest.raises(SessionError, match="no posture"):
        write_session(session, tmp_path / "a.h5")
    unreadable = replace(session.header, dictionary_bytes=b"\0")
    with pytest.raises(SessionError, match="dictionary"):
        write_session(replace(example.session, header=unreadable), tmp_path / "a.h5")
    negative = replace(session.losses[0], count=-1)
    with pytest.raises(SessionError, match="is not written: loss: count"):
        write_session(replace(example.session, losses=(negative,)), tmp_path / "a.h5")
    assert list(tmp_path.iterdir()) == []


def test_folder_that_is_not_there_is_one_clear_message(example, tmp_path: Path) -> None:
    with pytest.raises(SessionError, match=r"cannot be written.* journal, where there is one"):
        write_session(example.session, tmp_path / "none" / "a.h5")


def test_frfs_that_contradict_themselves_are_not_written(
    example, frfs: Frfs, tmp_path: Path
) -> None:
    for change, says in (
        ({"n_hits": np.ones((2, 1), dtype=np.int64)}, "n_hits"),
        ({"freq_hz": frfs[0].freq_hz[::-1]}, "rise"),
        ({"coherence": frfs[0].coherence[:2]}, "coherence"),
    ):
        with pytest.raises(SessionError, match=says):
            write_session(example.session, tmp_path / "a.h5", frfs=[replace(frfs[0], **change)])


def test_220_hits_are_written_and_proven_within_a_second_of_a_processor(
    header: SessionHeader, make_hit: Callable[..., Hit], tmp_path: Path
) -> None:
    hits = tuple(make_hit(number, samples=2048) for number in range(1, 221))
    session = Session(header=header, hits=hits, losses=(), complete=False)
    begin_s = time.process_time()
    write_session(session, tmp_path / "a.h5")
    assert time.process_time() - begin_s < 1.0


def test_rebuild_says_what_it_recovered_and_dropped(example, frfs: Frfs, tmp_path: Path) -> None:
    journal = tmp_path / "a.journal"
    torn = example.journal[:-5]
    journal.write_bytes(torn)
    recovery = rebuild(
        journal, tmp_path / "a.h5", software="armodal test", estimate_frfs=lambda _: frfs
    )
    assert (recovery.accepted, recovery.rejected) == (2, 1)
    assert recovery.journal_bytes == len(torn)
    assert recovery.dropped_bytes == len(example.records[-1]) - 5
    assert not recovery.records_beyond
    assert recovery.frf_problem is None
    assert journal.read_bytes() == torn
    assert first_difference(read_session(tmp_path / "a.h5"), recovery.session, "session") is None
    assert len(read_frfs(tmp_path / "a.h5")) == len(frfs)
    assert read_provenance(tmp_path / "a.h5") == Provenance(
        journal_sha256=hashlib.sha256(torn).hexdigest(), software="armodal test"
    )


def test_rebuild_goes_on_without_frfs_when_hits_are_too_few(example, tmp_path: Path) -> None:
    (tmp_path / "a.journal").write_bytes(example.journal)

    def refuse(_: Session) -> Frfs:
        raise EstimateError("three hits a point were wanted")

    recovery = rebuild(
        tmp_path / "a.journal", tmp_path / "a.h5", software="test", estimate_frfs=refuse
    )
    assert recovery.frf_problem == "three hits a point were wanted"
    assert len(read_session(tmp_path / "a.h5").hits) == len(example.session.hits)


@pytest.mark.parametrize("link", ["same", "symbolic", "hard", "folder"])
def test_rebuild_never_takes_the_journals_place(example, tmp_path: Path, link: str) -> None:
    journal = tmp_path / "a.journal"
    journal.write_bytes(example.journal)
    other = journal if link == "same" else tmp_path / "a.h5"
    if link == "symbolic":
        other.symlink_to(journal)
    elif link == "hard":
        other.hardlink_to(journal)
    elif link == "folder":
        (tmp_path / "again").symlink_to(tmp_path)
        other = tmp_path / "again" / "a.journal"
    for read, written in ((journal, other), (other, journal)):
        with pytest.raises(SessionError, match="got the journal itself"):
            rebuild(read, written, software="test")
        assert journal.read_bytes() == other.read_bytes() == example.journal
        assert other.is_symlink() == (link == "symbolic")


def test_rebuild_of_something_else_writes_nothing(tmp_path: Path) -> None:
    (tmp_path / "a.journal").write_bytes(b"#!/bin/sh\n")
    with pytest.raises(JournalError, match="not an armodal journal"):
        rebuild(tmp_path / "a.journal", tmp_path / "a.h5", software="test")
    assert not (tmp_path / "a.h5").exists()
