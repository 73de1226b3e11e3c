"""Files that want more than their bytes: made by code, each for one decoder or more."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

from armodal.protocols.bounds import MOST_TEXT_NUMBERS

TOML = ("arm", "plant")  # all are read by `protocols/toml_reader.py`

# Hundreds of megabytes that are packed, or not, before anything is read.
SLOW_TO_MAKE = {
    "seven_arrays_of_zeros", "zeros_of_eight_bytes", "texts_of_a_gigabyte",
    "half_a_gigabyte_of_doubles", "one_large_chunk", "padding_in_a_chunk", "many_chunks_of_padding",
    "large_rows_of_one_digit", "large_rows_as_many_as_are_read", "large_rows_of_measured_numbers",
    "a_large_wave_of_bytes", "large_bytes_of_an_array"}  # fmt: skip

# As large as others of their kind, and read for seconds.
SLOW_TO_READ = {
    "many_tables_of_a_row", "tables_of_a_row", "two_million_columns", "many_signals",
    "macros_of_macros",
    "a_power_of_a_power", "thirty_million_copies", "a_billion_keyframes", "a_bag_without_end",
    "a_face_of_many_corners", "nodes_of_nodes",
    "large_rows_of_ones", "blanks_in_an_mcap", "large_lines_of_letters", "large_line_of_numbers",
    # Half a second each, and read by what reads another one in the quick tests too.
    "many_tables", "many_keys", "many_messages", "zeros_that_are_measurements",
    "bytes_that_matlab_calls_doubles", "four_thousand_columns", "copies_of_copies",
    "a_grid_of_millions", "keys_unknown",
    # A quarter of a second or more, as those.
    "many_numbers", "two_thousand_signals", "many_links", "eight_bytes_each_from_one",
    "rows_of_two_digits", "a_text_of_a_gigabyte", "a_long_number",
}  # fmt: skip

# What a bomb is called: the decoders it is for, its file's ending, and what writes it.
BOMBS: dict[str, tuple[tuple[str, ...], str, Callable[[Path], object]]] = {}


def bomb(
    decoders: tuple[str, ...], ending: str
) -> Callable[[Callable[[], bytes]], Callable[[], bytes]]:
    """Make a function that returns a file's bytes one of the bombs."""

    def taken(make: Callable[[], bytes]) -> Callable[[], bytes]:
        BOMBS[make.__name__] = decoders, ending, lambda path: path.write_bytes(make())
        return make

    return taken


@bomb(TOML, ".toml")
def dotted_keys() -> bytes:
    return b".".join([b"a"] * 20_000) + b" = 1\n"


@bomb(TOML, ".toml")
def more_dotted_keys() -> bytes:
    return b".".join([b"a"] * 60_000) + b" = 1\n"


@bomb(TOML, ".toml")
def dotted_quoted_keys() -> bytes:
    return b".".join([b'"="'] * 20_000) + b" = 1\n"


@bomb(TOML, ".toml")
def dotted_keys_of_line_ends() -> bytes:
    return b".".join(['"\u2028"'.encode()] * 10_000) + b" = 1\n"


@bomb(TOML, ".toml")
def dotted_table() -> bytes:
    return b"[" + b".".join([b"a"] * 20_000) + b"]\n"


@bomb(TOML, ".toml")
def keys_of_a_thousand_parts() -> bytes:
    return b"".join(b"%d." % i + b".".join([b"a"] * 900) + b" = 1\n" for i in range(200))


@bomb(TOML, ".toml")
def nested_arrays() -> bytes:
    return b"a = " + b"[" * 100_000


@bomb(TOML, ".toml")
def many_tables() -> bytes:
    return b"[[a]]\n" * 40_000


@bomb(TOML, ".toml")
def many_keys() -> bytes:
    return b"".join(b"k%d=1\n" % i for i in range(25_000))


@bomb(TOML, ".toml")
def many_numbers() -> bytes:
    return b"a = [" + b"1," * 120_000 + b"]\n"


@bomb(TOML, ".toml")
def a_long_number() -> bytes:
    return b"a = " + b"9" * 250_000 + b"\n"


def _dbc(signals: bytes) -> bytes:
    head = b'VERSION ""\n\nNS_ :\n\nBS_:\n\nBU_: a\n\n'
    return head + b"BO_ 100 M: 8 a\n" + signals


@bomb(("dbc",), ".dbc")
def signal_far_away() -> bytes:
    return _dbc(b' SG_ J1 : -1|99999999@1+ (1,0) [0|0] "" a\n')


@bomb(("dbc",), ".dbc")
def signal_of_many_bits() -> bytes:
    return _dbc(b' SG_ J1 : 0|999999999@1+ (1,0) [0|0] "" a\n')


@bomb(("dbc",), ".dbc")
def many_signals() -> bytes:
    return _dbc(
        b"".join(b' SG_ S%d : %d|1@1+ (1,0) [0|0] "" a\n' % (i, i % 64) for i in range(20_000))
    )


@bomb(("dbc",), ".dbc")
def two_thousand_signals() -> bytes:
    return _dbc(
        b"".join(b' SG_ S%d : %d|1@1+ (1,0) [0|0] "" a\n' % (i, i % 64) for i in range(2_000))
    )


@bomb(("dbc",), ".dbc")
def many_messages() -> bytes:
    head = b'VERSION ""\n\nNS_ :\n\nBS_:\n\nBU_: a\n\n'
    return head + b"".join(b"BO_ %d M%d: 8 a\n" % (i, i) for i in range(30_000))


@bomb(("urdf",), ".urdf")
def entities_of_entities() -> bytes:
    lines = [b'<!ENTITY a0 "ha">']
    lines += [b'<!ENTITY a%d "%s">' % (i, b"&a%d;" % (i - 1) * 10) for i in range(1, 10)]
    return b'<?xml version="1.0"?><!DOCTYPE r [' + b"".join(lines) + b']><robot name="&a9;"/>'


@bomb(("urdf",), ".urdf")
def many_links() -> bytes:
    return b'<robot name="r">' + b'<link name="a"/>' * 60_000 + b"</robot>"


@bomb(("urdf",), ".urdf")
def deep_elements() -> bytes:
    return b"<a>" * 300_000


def _npz(count: int, numbers: int, dtype: str) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        head = io.BytesIO()
        np.lib.format.write_array_header_1_0(
            head, {"descr": dtype, "fortran_order": False, "shape": (numbers,)}
        )
        for i in range(count):
            with archive.open(f"a{i}.npy", "w") as member:
                member.write(head.getvalue())
                for _ in range(numbers * np.dtype(dtype).itemsize // 2**20):
                    member.write(bytes(2**20))
    return stream.getvalue()


@bomb(("content",), ".npz")
def seven_arrays_of_zeros() -> bytes:
    return _npz(7, 2**26, "|u1")


@bomb(("content",), ".npz")
def zeros_of_eight_bytes() -> bytes:
    return _npz(1, 2**26, "<f8")


@bomb(("content",), ".npz")
def bytes_that_become_numbers() -> bytes:
    return _npz(2, 2**25, "|u1")


@bomb(("content",), ".npz")
def texts_of_a_gigabyte() -> bytes:
    return _npz(2, 2**18, "<U256")


def _mat(*bodies: bytes) -> bytes:
    elements = b"".join(struct.pack("<II", 15, len(body)) + body for body in bodies)
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + elements


def _mat_zeros(name: bytes, kind: int, code: int, numbers: int, width: int) -> bytes:
    """A matrix of class `kind` whose numbers are stored as type `code`, all 0, compressed."""
    parts = [
        struct.pack("<IIII", 6, 8, kind, 0),
        struct.pack("<IIii", 5, 8, 1, numbers),
        struct.pack("<II", 1, len(name)) + name.ljust(-(-len(name) // 8) * 8, b"\0"),
        struct.pack("<II", code, numbers * width),
    ]
    size = sum(map(len, parts)) + numbers * width
    packer = zlib.compressobj()
    out = [packer.compress(struct.pack("<II", 14, size) + b"".join(parts))]
    out.extend(packer.compress(bytes(2**20)) for _ in range(numbers * width // 2**20))
    return b"".join(out) + packer.flush()


@bomb(("content",), ".mat")
def bytes_that_matlab_calls_doubles() -> bytes:
    return _mat(_mat_zeros(b"a", 6, 2, 2**26, 1))


@bomb(("content",), ".mat")
def half_a_gigabyte_of_doubles() -> bytes:
    return _mat(_mat_zeros(b"a", 6, 9, 2**26 - 2**17, 8))


@bomb(("content",), ".mat")
def eight_bytes_each_from_one() -> bytes:
    return _mat(*[_mat_zeros(b"a%d" % i, 9, 2, 2**23, 1) for i in range(8)])


@bomb(("content",), ".mat")
def cells_of_nothing() -> bytes:
    n = 100_000
    parts = [
        struct.pack("<IIII", 6, 8, 1, 0),
        struct.pack("<IIii", 5, 8, 1, n),
        struct.pack("<II", 1, 1) + b"c".ljust(8, b"\0"),
        struct.pack("<II", 14, 0) * n,
    ]
    whole = b"".join(parts)
    return _mat(zlib.compress(struct.pack("<II", 14, len(whole)) + whole))


def of_a_driver(size: int) -> bytes:
    """An HDF5 file whose superblock names a driver information block of so many bytes."""
    stream = io.BytesIO()
    with h5py.File(stream, "w", libver=("earliest", "v110")) as file:
        file["a"] = np.arange(100.0)
    data = bytearray(stream.getvalue())
    block = struct.pack("<4xI8s", size, b"NCSAmult")
    data[40:56] = struct.pack("<QQ", len(data) + len(block), len(data))  # the file's end, the block
    return bytes(data) + block


def _hdf5(path: Path, *datasets: tuple[str, tuple[int, ...], str, tuple[int, ...]]) -> None:
    with h5py.File(path, "w") as file:
        for name, shape, dtype, chunks in datasets:
            made = file.create_dataset(
                name, shape=shape, dtype=dtype, chunks=chunks, compression="gzip",
                maxshape=(None,) * len(shape),
            )  # fmt: skip
            made[(0,) * len(shape)] = 1


def _hdf5_bomb(name: str, *datasets: tuple[str, tuple[int, ...], str, tuple[int, ...]]) -> None:
    BOMBS[name] = ("content",), ".h5", lambda path: _hdf5(path, *datasets)


_hdf5_bomb("fill_values", ("a", (2**26 - 1,), "f8", (2**16,)))
_hdf5_bomb("bytes_of_fill_values", ("a", (2**26 - 1,), "u1", (2**16,)))
_hdf5_bomb("one_large_chunk", ("a", (2**25,), "f8", (2**25 - 1,)))
_hdf5_bomb("padding_in_a_chunk", ("a", (8,), "f8", (2**25 - 1,)))
_hdf5_bomb("padded_texts", ("a", (10_000,), "S100000", (100,)))
_hdf5_bomb("many_chunks_of_padding", *[(f"a{i}", (8,), "f8", (2**24,)) for i in range(200)])


def _session_of_padding(path: Path) -> None:
    _hdf5(path, ("session/definition", (200_000,), "S10000", (1000,)))


BOMBS["a_session_of_padding"] = ("session",), ".h5", _session_of_padding


@bomb(("content", "session"), ".h5")
def a_drivers_block_of_3_gb() -> bytes:
    return of_a_driver(size=0xE000_0000)


@bomb(("content",), ".npz")
def zeros_that_are_measurements() -> bytes:
    """As much as a file of its size may be: read, not refused."""
    stream = io.BytesIO()
    n = 1_000_000
    time_s = np.arange(n) / 1000.0
    zeros = np.zeros(n)
    np.savez_compressed(stream, time=time_s.astype(np.float32), force=zeros, acc_x=zeros)
    return stream.getvalue()


@bomb(("content",), ".csv")
def two_million_columns() -> bytes:
    return b"1," * 400_000 + b"1\n" + b"1," * 400_000 + b"1\n"


@bomb(("content",), ".csv")
def four_thousand_columns() -> bytes:
    return (b"1," * 4000 + b"1\n") * 120


@bomb(("content",), ".csv")
def rows_of_two_digits() -> bytes:
    return b"1,1\n" * 250_000


@bomb(("content",), ".csv")
def many_tables_of_a_row() -> bytes:
    return b"".join(b"head %d\n1,2\n1,3\n2,3\n3,4\n4,5\n" % i for i in range(30_000))


@bomb(("content",), ".csv")
def tables_of_a_row() -> bytes:
    return b"".join(b"head %d\n1,2\n1,3\n2,3\n3,4\n4,5\n" % i for i in range(3_000))


@bomb(("content",), ".csv")
def words_without_numbers() -> bytes:
    return b"word;" * 200_000


@bomb(("content",), ".csv")
def large_rows_of_one_digit() -> bytes:
    return b"1,2,3,4\n" * 12_000_000


@bomb(("content",), ".csv")
def large_rows_as_many_as_are_read() -> bytes:
    return b"1,2,3,4\n" * (MOST_TEXT_NUMBERS // 4)


@bomb(("content",), ".csv")
def large_rows_of_measured_numbers() -> bytes:
    rng = np.random.default_rng(0)
    rows = "\n".join(",".join(f"{x:.6e}" for x in row) for row in rng.normal(size=(20_000, 4)))
    return (rows.encode() + b"\n") * 90


@bomb(("content",), ".csv")
def large_two_million_columns() -> bytes:
    return b"1," * 2_000_000 + b"1\n" + b"1," * 2_000_000 + b"1\n"


@bomb(("content",), ".uff")
def many_small_datasets() -> bytes:
    return b"    -1\n   151\nx\n    -1\n" * 40_000


@bomb(("content",), ".wav")
def a_wave_of_bytes() -> bytes:
    n = 900_000
    form = struct.pack("<HHIIHH", 1, 1, 8000, 8000, 1, 8)
    return (
        b"RIFF" + struct.pack("<I", 36 + n) + b"WAVEfmt " + struct.pack("<I", 16) + form
        + b"data" + struct.pack("<I", n) + bytes(n)
    )  # fmt: skip


@bomb(("content",), ".wav")
def a_large_wave_of_bytes() -> bytes:
    n = 100_000_000
    form = struct.pack("<HHIIHH", 1, 1, 8000, 8000, 1, 8)
    return (
        b"RIFF" + struct.pack("<I", 36 + n) + b"WAVEfmt " + struct.pack("<I", 16) + form
        + b"data" + struct.pack("<I", n) + bytes(n)
    )  # fmt: skip


@bomb(("content",), ".npy")
def large_bytes_of_an_array() -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.zeros((2, 48_000_000), np.uint8))
    return stream.getvalue()


@bomb(("journal",), ".journal")
def a_journal_of_false_heads() -> bytes:
    head = (90_000_000).to_bytes(4, "little") + b"\x02\x00RJ"
    return b"\x89AMJ\r\n\x1a\x01" + head * 200_000


def _holed(path: Path) -> None:
    with path.open("wb") as file:
        file.write(b"\x89AMJ\r\n\x1a\x01")
        file.truncate(2**31)


BOMBS["a_journal_with_a_hole"] = ("journal",), ".journal", _holed
