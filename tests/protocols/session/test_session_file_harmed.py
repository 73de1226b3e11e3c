"""Session files that were changed since they were written, and files that are none."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from armodal.protocols.errors import SessionError
from armodal.protocols.session.compare import first_difference
from armodal.protocols.session.hdf5 import read_frfs, read_session


def put(file: h5py.File, name: str, value: object, **options: object) -> None:
    del file[name]
    file.create_dataset(name, data=value, **options)


def link_soft(file: h5py.File) -> None:
    file["session/elsewhere"] = file["session/losses"]
    del file["session/losses"]
    file["session/losses"] = h5py.SoftLink("/session/elsewhere")


def link_external(file: h5py.File) -> None:
    del file["session/plan"]
    file["session/plan"] = h5py.ExternalLink("other.h5", "/session/plan")


def store_outside(file: h5py.File) -> None:
    del file["session/losses/host_s"]
    file["session/losses"].create_dataset(
        "host_s", shape=(2,), dtype="<f8", external=[("outside.bin", 0, 16)]
    )


def make_virtual(file: h5py.File) -> None:
    del file["session/losses/host_s"]
    layout = h5py.VirtualLayout(shape=(2,), dtype="<f8")
    layout[:] = h5py.VirtualSource("other.h5", "x", shape=(2,))
    file["session/losses"].create_virtual_dataset("host_s", layout)


def claim_much(file: h5py.File) -> None:
    name = "session/hits/hit_0001/counts"
    del file[name]
    file.create_dataset(name, shape=(4, 2**24), dtype="<i4")


def claim_much_compressed(file: h5py.File) -> None:
    name = "session/hits/hit_0001/counts"
    del file[name]
    file.create_dataset(name, shape=(4, 2**24), dtype="<i4", chunks=(4, 2**20), compression="gzip")


def change_counts(file: h5py.File) -> None:
    file["session/hits/hit_0001/counts"][2, 3] += 1


def exchange_arm(file: h5py.File) -> None:
    text = file["session/arm/text"][()] + b"\n# a later thought\n"
    put(file, "session/arm/text", np.bytes_(text))


def recalibrate(file: h5py.File) -> None:
    file["session/board/channels/scale"][0] *= 1.01


@pytest.mark.parametrize(
    ("harm", "says"),
    [
        (link_soft, "a SoftLink came"),
        (link_external, "a ExternalLink came"),
        (store_outside, "data in another file"),
        (make_virtual, "data in another file"),
        (claim_much, "bytes stored"),
        (claim_much_compressed, "100 times the file"),
        (change_counts, "CRC-32"),
        (exchange_arm, "not the one the session began with"),
        (recalibrate, "what the board's dictionary says"),
        (lambda f: put(f, "session/board/channels/unit", np.array([b"A"] * 4)), "dictionary says"),
        (lambda f: put(f, "session/board/channels/unit", np.array([b"z"] * 4)), "dictionary says"),
        (lambda f: put(f, "session/definition", np.bytes_(b"NXarpes")), "definition"),
        (lambda f: put(f, "session/format_version", np.int64(9)), "version 9"),
        (lambda f: put(f, "session/session_id", "vlen"), "fixed-length"),
        (lambda f: put(f, "session/complete", np.uint8(2)), "zeros and ones"),
        (lambda f: put(f, "session/complete", np.float64(1)), "complete"),
        (lambda f: put(f, "session/complete", h5py.Empty("u1")), "complete"),
        (lambda f: put(f, "session/losses/host_s", [1.0]), r"shape \(2\)"),
        (lambda f: put(f, "session/losses/host_s", [np.nan, 1.0]), "finite"),
        (lambda f: put(f, "session/losses/count", [-5, 1]), "row 0"),
        (lambda f: put(f, "session/hits/table/number", [1, 3, 3]), "hit"),
        (lambda f: put(f, "session/hits/table/reasons", np.array([b"[1]"] * 3)), "JSON"),
        (lambda f: put(f, "session/hits/table/posture", np.array([b"\xff"] * 3)), "UTF-8"),
        (lambda f: put(f, "session/hits/table/posture", np.array([b"x"] * 3)), "no posture"),
        (lambda f: put(f, "session/losses/count", [1, 1], fletcher32=True), "filter"),
        (lambda f: f.__delitem__("session/plan"), "nothing came"),
        (lambda f: f.__delitem__("session"), "something else"),
    ],
)
def test_harmed_file_is_refused_in_one_message(
    harm: Callable[[h5py.File], None], says: str, written: Path
) -> None:
    with h5py.File(written, "r+") as file:
        harm(file)
    with pytest.raises(SessionError, match=says) as caught:
        read_session(written)
    assert "\n" not in str(caught.value)
    assert "armodal recover" in str(caught.value)


def test_frfs_harmed_in_the_file_are_refused_with_their_place(written: Path) -> None:
    with h5py.File(written, "r+") as file:
        file["session/frf_002/responses/direction"][0] *= 2
    with pytest.raises(SessionError, match=r"frf_002: .*a unit vector was wanted.*armodal recover"):
        read_frfs(written)


def test_repacked_file_is_read(example, written: Path) -> None:
    with h5py.File(written, "r+") as file:
        for hit in example.session.hits:
            name = f"session/hits/hit_{hit.number:04d}/counts"
            counts = file[name][()]
            put(file, name, counts, compression="gzip", shuffle=True)
    assert first_difference(read_session(written), example.session, "session") is None


@pytest.mark.parametrize("content", [b"", b"text", b"\x89HDF\r\n\x1a\n" + bytes(100)])
def test_what_is_not_hdf5_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.h5").write_bytes(content)
    with pytest.raises(SessionError, match="wanted a session file") as said:
        read_session(tmp_path / "a.h5")
    assert "recover" not in str(said.value)
    (tmp_path / "a.journal").write_bytes(b"")
    with pytest.raises(SessionError, match="armodal recover"):
        read_session(tmp_path / "a.h5")


def test_missing_file_is_one_clear_message(tmp_path: Path) -> None:
    with pytest.raises(SessionError, match="there is no session file"):
        read_session(tmp_path / "a.h5")


def test_truncated_file_is_refused(written: Path) -> None:
    data = written.read_bytes()
    for cut in range(0, len(data), len(data) // 40):
        written.write_bytes(data[:cut])
        with pytest.raises(SessionError):
            read_session(written)
