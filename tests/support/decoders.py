"""Every decoder of bytes from outside, with valid files to begin from and mutations that fit.

A decoder takes any bytes. It may raise an ArmodalError; anything else is a fault.
"""

import io
import struct
import zlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from importlib import resources
from pathlib import Path

import numpy as np
import scipy.io
from cobs import cobs
from support.mutate import mutated, mutated_text

from protocols.arm.files import arm_from_texts, load_arm
from protocols.board.codec import FrameDecoder, encode_frame
from protocols.board.messages import (
    decode_block_info,
    decode_configuration,
    decode_dictionary,
    decode_release,
    decode_reply,
    decode_resend,
    decode_samples,
    decode_status,
    encode_block_info,
    encode_configuration,
    encode_dictionary,
    encode_release,
    encode_reply,
    encode_resend,
    encode_samples,
    encode_status,
    hello_fragments,
    join_hello,
)
from protocols.board.records import (
    BlockInfo,
    BoardDictionary,
    BoardState,
    BoardStatus,
    Channel,
    Configuration,
    FrameType,
    Header,
    IepeState,
    ReplyCode,
    Samples,
    Slope,
)
from protocols.can_database import CanDecoder, CanEncoder
from protocols.can_records import CanFrame
from protocols.errors import ArmodalError
from protocols.foreign.arrays_measured import array_content
from protocols.foreign.manifest import load_manifest
from protocols.foreign.mat import mat_content
from protocols.foreign.measured import Hints
from protocols.foreign.uff_measured import uff_content
from protocols.foreign.uff_read import uff_from_bytes
from protocols.inertia_targets import load_inertia_targets
from protocols.plan import plan_from_text
from protocols.session.hdf5 import read_frfs, read_provenance, read_session, write_session
from protocols.session.journal import decode_journal, encode_record, scan, session_of
from protocols.session.records import Session
from protocols.slcan import SlcanParser, encode_slcan

Mutate = Callable[[bytes, np.random.Generator, tuple[bytes, ...]], bytes]


@dataclass(frozen=True)
class Decoder:
    """A decoder, valid files for it, and how they are made wrong."""

    name: str
    seeds: tuple[bytes, ...]
    decode: Callable[[bytes], object]
    mutate: Mutate


def plain(data, rng, others):
    return mutated(data, rng, others=others)


def text(data, rng, others):
    return mutated_text(data, rng, others=others)


# Board


def example_dictionary():
    def channel(name, quantity):
        return Channel(
            name=name,
            quantity=quantity,
            unit="N" if quantity == "force" else "m/s^2",
            scale=1e-4,
            full_scale=800.0,
            iepe=IepeState.OK,
            highpass_hz=0.5,
            serial_number="SN 1",
            calibration_date="2026-01-31",
            teds=bytes(range(16)),
        )

    return BoardDictionary(
        board_id="board",
        firmware="1",
        link_bytes_per_s=1_000_000,
        block_capacity=1 << 19,
        tick_hz=1_000_000,
        filter_group_delay_samples=16.0,
        channels=(
            channel("hammer", "force"),
            *(channel(f"acc_{a}", "acceleration") for a in "xyz"),
        ),
    )


def board_payloads():
    """Return (type, payload) of every message."""
    hello = hello_fragments(encode_dictionary(example_dictionary()))
    counts = np.arange(-80, 80, dtype=np.int32).reshape(-1, 4) * 5000
    status = BoardStatus(
        state=BoardState.RUNNING, next_sequence=7, next_sample=1 << 40, buffered_blocks=2,
        oldest_block=3, stream_samples_dropped=5, triggers_missed=1, adc_overruns=0,
    )  # fmt: skip
    configuration = Configuration(
        rate_hz=Fraction(51200, 31), channel_mask=15, trigger_channel=0, trigger_level_counts=3000,
        slope=Slope.RISING, pretrigger=64, block_length=256, stream=True,
    )  # fmt: skip
    block = Samples(first_sample=1000, counts=counts, block_id=3)
    info = BlockInfo(
        block_id=3, first_sample=1000, length=256, trigger_sample=1064, trigger_ticks=1 << 33
    )
    return [
        (FrameType.CONFIGURE, encode_configuration(configuration)),
        (FrameType.RESEND, encode_resend(3, 0, 64)),
        (FrameType.RELEASE, encode_release(3)),
        *((FrameType.HELLO_REPLY, fragment) for fragment in hello),
        (FrameType.STATUS_REPLY, encode_status(status)),
        (FrameType.CONFIGURE_REPLY, encode_reply(ReplyCode.BAD_VALUE, "rate cannot be made")),
        (FrameType.STREAM, encode_samples(Samples(first_sample=64, counts=counts))),
        (FrameType.BLOCK_READY, encode_block_info(info)),
        (FrameType.BLOCK_DATA, encode_samples(block)),
    ]  # fmt: skip


def board_stream():
    return b"".join(
        encode_frame(
            Header(type=kind, session=1, sequence=i, dictionary_hash=2, first_sample=64), payload
        )
        for i, (kind, payload) in enumerate(board_payloads())
    )


def mutate_frames(data, rng, others):
    """Change the line's bytes, or what is in a frame, with a CRC that fits again."""
    if rng.random() < 0.4:
        return mutated(data, rng, others=others)
    frames = [f for f in data.split(b"\0") if f]
    at = int(rng.integers(len(frames)))
    with suppress(cobs.DecodeError):
        body = mutated(cobs.decode(frames[at])[:-4], rng, largest=3, limit=4096)
        if rng.random() < 0.7:
            body = b"\x01" + body[1:]
        frames[at] = cobs.encode(body + struct.pack("<I", zlib.crc32(body)))
    return b"\0" + b"\0\0".join(frames) + b"\0"


PAYLOADS = {
    FrameType.CONFIGURE: decode_configuration,
    FrameType.RESEND: decode_resend,
    FrameType.RELEASE: decode_release,
    FrameType.STATUS_REPLY: decode_status,
    FrameType.BLOCK_READY: decode_block_info,
}


def decode_board(data):
    frames = FrameDecoder().feed(data)
    fragments = []
    for frame in frames:
        with suppress(ArmodalError):
            kind = frame.header.type
            if kind in {FrameType.STREAM, FrameType.BLOCK_DATA}:
                decode_samples(frame)
            elif kind is FrameType.HELLO_REPLY:
                fragments.append(frame.payload)
                whole = join_hello(fragments)
                if whole is not None:
                    decode_dictionary(whole)
            else:
                PAYLOADS.get(kind, decode_reply)(frame.payload)


# Bus


def slcan_lines():
    arm = load_arm("rv4frl")
    encoder = CanEncoder(arm.can)
    names = [joint.name for joint in arm.joints]
    lines = b""
    for counter in range(8):
        frames = encoder.encode(dict.fromkeys(names, 0.1 * counter), drive_state=2, counter=counter)
        lines += b"".join(encode_slcan(f.can_id, f.data) for f in frames)
    return lines + b"F00\rV1013\rNS042\r\x07T00000123411\rr1234\rR000000010\rz\rZ\r"


def bus_decoder():
    arm = load_arm("rv4frl")

    def decode(data):
        decoder = CanDecoder(arm.can)
        for item in SlcanParser().feed(data):
            if isinstance(item, CanFrame):
                with suppress(ArmodalError):
                    decoder.decode(item)

    return decode


# Journal


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


# Files


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
    """Change what tells of the data rather than the data: headers, heaps, trees."""
    if rng.random() < 0.3:
        return mutated(data, rng, others=others)
    changed = bytearray(data)
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


def shipped(package, folder, names):
    return tuple((resources.files(package) / folder / n).read_bytes() for n in names)


def make_decoders(folder, journal, session: Session, frfs, uff_files):
    """Return every decoder by its name; files are put in `folder`.

    Parameters
    ----------
    journal, session, frfs
        A valid journal's bytes, the session it holds, and FRFs to go with it.
    uff_files
        Bytes of valid universal files.
    """
    folder = Path(folder)
    rng = np.random.default_rng(1)
    arm = load_arm("rv4frl")
    uncalibrated = Path(str(resources.files("protocols"))) / "arm/targets"
    viper = load_arm(uncalibrated / "viper_s650-uncalibrated.toml")
    urdf = (arm.urdf_text or "").encode()
    dbc = shipped("protocols", "dbc", ("armodal_controller.dbc", "cia402.dbc"))
    arms = shipped("protocols", "arm/arms", ("rv4frl.toml", "viper_s650.toml"))
    plans = shipped(
        "protocols", "plans", ("rv4frl-three-postures.toml", "rv4frl-roving-hammer.toml")
    )
    targets = shipped("protocols", "arm/targets", ("viper_s650-with-table4.toml",))
    session_path = folder / "valid.h5"
    write_session(session, session_path, frfs=frfs)
    npy, npz, csv = array_seeds(rng)
    hints = Hints()

    def arm_text(data):
        source = data.decode(errors="replace")
        arm_from_texts(source, urdf_text=arm.urdf_text, database_text=dbc[0].decode())

    found = [
        Decoder("board frames", (board_stream(),), decode_board, mutate_frames),
        Decoder("slcan", (slcan_lines(),), bus_decoder(), plain),
        Decoder("journal", (journal,), decode_session_journal, mutate_journal),
        Decoder("arm", arms[:1], arm_text, text),
        Decoder(
            "arm without files",
            arms[1:],
            lambda data: arm_from_texts(
                data.decode(errors="replace"), urdf_text=None, database_text=None
            ),
            text,
        ),
        Decoder(
            "urdf",
            (urdf,),
            lambda data: arm_from_texts(
                arms[0].decode(),
                urdf_text=data.decode(errors="replace"),
                database_text=dbc[0].decode(),
            ),
            text,
        ),
        Decoder(
            "dbc",
            dbc[:1],
            lambda data: arm_from_texts(
                arms[0].decode(),
                urdf_text=arm.urdf_text,
                database_text=data.decode(errors="replace"),
            ),
            text,
        ),
        Decoder(
            "plan",
            plans,
            lambda data: plan_from_text(data.decode(errors="replace"), arm),
            text,
        ),
        Decoder(
            "targets",
            targets,
            FileDecoder(folder, "t.toml", lambda p: load_inertia_targets(p, viper)),
            text,
        ),
        Decoder("manifest", (MANIFEST,), FileDecoder(folder, "m.toml", read_manifest), text),
        Decoder("uff", uff_files, decode_uff, mutate_uff),
        Decoder(
            "mat",
            (mat_bytes(rng, hit=True), mat_bytes(rng, hit=False)),
            FileDecoder(folder, "f.mat", lambda p: mat_content(p, hints)),
            mutate_mat,
        ),
        Decoder("npy", npy, FileDecoder(folder, "f.npy", lambda p: array_content(p, hints)), plain),
        Decoder("npz", npz, FileDecoder(folder, "f.npz", lambda p: array_content(p, hints)), plain),
        Decoder("csv", csv, FileDecoder(folder, "f.csv", lambda p: array_content(p, hints)), text),
        Decoder(
            "hdf5",
            (session_path.read_bytes(),),
            FileDecoder(folder, "s.h5", read_all_of),
            mutate_hdf5,
        ),
    ]
    return {decoder.name: decoder for decoder in found}


def read_manifest(path):
    manifest = load_manifest(path)
    for posture in manifest.file.postures:
        manifest.files(posture)


def decode_uff(data):
    uff_content(uff_from_bytes(data, "f.uff"), Hints(), "f.uff")


def mutate_uff(data, rng, others):
    return (mutated_text if rng.random() < 0.6 else mutated)(data, rng, others=others)


def check(decoder: Decoder, data: bytes) -> str | None:
    """Return what is wrong with how a decoder takes these bytes, None where nothing is."""
    try:
        decoder.decode(data)
    except ArmodalError as error:
        return None if str(error) else f"{type(error).__name__} without a message"
    except Exception as error:  # noqa: BLE001 - any other error is the finding
        return f"{type(error).__name__}: {error}"
    return None
