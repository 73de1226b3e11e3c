"""Files to be made wrong: journals, HDF5, MATLAB, arrays, manifests, universal files."""

import io
import struct
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np
import scipy.io
from support.bombs_of_hdf5 import lengths_told
from support.mutate import mutated, mutated_text

from armodal.protocols.foreign.manifest import load_manifest
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.foreign.uff_measured import uff_content
from armodal.protocols.foreign.uff_read import uff_from_bytes
from armodal.protocols.session.hdf5 import read_frfs, read_provenance, read_session
from armodal.protocols.session.journal import decode_journal, encode_record, scan, session_of


def mutate_journal(data, rng, others):
    """Change bytes, or a record's payload with a CRC that fits again."""
    if rng.random() < 0.4:
        return mutated(data, rng, others=others, limit=4 << 20)
    records = list(scan(data).records)
    at = int(rng.integers(len(records)))
    if at == 0 and rng.random() < 0.8:  # a header takes long, and the rest is then not reached
        at = int(rng.integers(len(records)))
    out = [data[:8]]
    for i, record in enumerate(records):
        payload, kind = bytes(record.payload), record.kind
        if i == at:
            change = mutated_text if rng.random() < 0.5 else mutated
            payload = change(payload, rng)
            if rng.random() < 0.1:
                kind = int(rng.integers(0, 8))
        out.append(encode_record(kind, payload))
    if rng.random() < 0.2:
        out.insert(int(rng.integers(1, len(out) + 1)), out[int(rng.integers(1, len(out)))])
    return b"".join(out)


def decode_session_journal(data):
    session_of(decode_journal(data))


class FileDecoder:
    """Put bytes in a file and read that."""

    def __init__(self, folder, name, read):
        self._path = Path(folder) / name
        self._read = read

    def __call__(self, data):
        self._path.write_bytes(data)
        self._read(self._path)


def read_all_of(path):
    read_session(path)
    read_frfs(path)
    read_provenance(path)


def mutate_hdf5(data, rng, others):
    """Change what tells of the data rather than the data: headers, heaps, trees, lengths."""
    if rng.random() < 0.3:
        return mutated(data, rng, others=others)
    changed = bytearray(data)
    lengths = lengths_told(data)
    if lengths and rng.random() < 0.2:
        at = lengths[rng.integers(len(lengths))]
        changed[at : at + 4] = int(rng.integers(2**32)).to_bytes(4, "little")
        return bytes(changed)
    signs = [b"TREE", b"SNOD", b"HEAP", b"OHDR", b"FRHP", b"\x89HDF", b"GCOL", b"OCHK", b"BTHD"]
    sign = signs[rng.integers(len(signs))]
    places = [i for i in range(0, len(changed), 8) if changed[i : i + 4] == sign] or [0]
    if rng.random() < 0.5:  # an object header of version 1 has no sign: 01 00 n 00
        places = [i for i in range(0, len(changed), 8) if changed[i] == 1 and changed[i + 1] == 0]
    for _ in range(int(rng.integers(1, 4))):
        at = places[rng.integers(len(places))] + 8 * int(rng.integers(0, 16))
        if at + 8 > len(changed):
            continue
        if rng.random() < 0.5:
            changed[at + int(rng.integers(8))] ^= 1 << int(rng.integers(8))
        else:
            width = int(rng.choice((1, 2, 4, 8)))
            number = int(rng.choice((0, 1, 2, 255, 65535, 2**31 - 1, len(data), 2**62)))
            changed[at : at + width] = (number % (1 << 8 * width)).to_bytes(width, "little")
    return bytes(changed)


def mat_bytes(rng, *, hit):
    stream = io.BytesIO()
    if hit:
        t = np.arange(200) / 1000.0
        content = {"time": t, "force": np.sin(t), "acc_x": np.cos(t)}
    else:
        content = {
            "freq_hz": np.arange(1.0, 9.0),
            "frf": rng.normal(size=(2, 1, 8)) + 1j * rng.normal(size=(2, 1, 8)),
            "coherence": np.ones((2, 1, 8)),
            "form": "accelerance",
            "unit": "SI",
            "responses": np.array(["1:x", "1:y"], dtype=object),
            "references": np.array(["2:z"], dtype=object),
        }
    scipy.io.savemat(stream, content, do_compression=not hit)
    return stream.getvalue()


def mutate_mat(data, rng, others):
    """Change the file, or what is inside of a compressed variable."""
    if rng.random() < 0.5 or len(data) < 136:
        return mutated(data, rng, others=others)
    kind, n = struct.unpack_from("<II", data, 128)
    if kind != 15:
        return data[:128] + mutated(data[128:], rng, largest=3)
    with suppress(zlib.error):
        inner = zlib.compress(mutated(zlib.decompress(data[136 : 136 + n]), rng, largest=3))
        return data[:128] + struct.pack("<II", 15, len(inner)) + inner + data[136 + n :]
    return mutated(data, rng)


def array_seeds(rng):
    t = np.arange(64) / 1000.0
    table = np.stack([t, np.sin(t), np.cos(t)])
    npy, npz = io.BytesIO(), io.BytesIO()
    np.save(npy, table)
    np.savez(npz, time=t, force=np.sin(t), acc_x=np.cos(t))
    packed = io.BytesIO()
    np.savez_compressed(packed, time=t, force=np.sin(t), acc_x=np.cos(t))
    rows = "\n".join(f"{a:.6g},{b:.6g},{c:.6g}" for a, b, c in table.T)
    return (npy.getvalue(),), (npz.getvalue(), packed.getvalue()), (
        f"time [s],force [N],acc_x [g]\n{rows}\n".encode(),
    )  # fmt: skip


MANIFEST = b"""
format = "armodal-import-1"
arm = "none"
mode = "roving-response"
axes = "link"
form = "accelerance"
units = { response = "g", force = "N" }
[nodes]
"12" = "A"
[windows]
exponential_end = 0.03
[[postures]]
name = "one"
joints_deg = [0.0, 10.0]
files = ["a.uff", { path = "b.csv", responses = ["1:x"], reference = "2:-z" }]
averages = 3
hit_point = "2"
hit_direction = [0.0, 0.6, -0.8]
"""


def read_manifest(path):
    manifest = load_manifest(path)
    for posture in manifest.file.postures:
        manifest.files(posture)


def decode_uff(data):
    uff_content(uff_from_bytes(data, "f.uff"), Hints(), "f.uff")


def mutate_uff(data, rng, others):
    return (mutated_text if rng.random() < 0.6 else mutated)(data, rng, others=others)
