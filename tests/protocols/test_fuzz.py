"""Bytes from outside: a little of `bench/torture_fuzz.py`, and what it once found."""

import io
import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st
from support.decoders import check
from support.examples import examples
from support.fuzz_c import c_inputs, compile_fuzz, fuzz_c
from support.fuzz_lines import decode_board
from support.fuzz_material import decoders_in
from support.quick import every_but

from armodal.protocols.bounds import most_decoded_bytes
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign import mat_elements
from armodal.protocols.foreign.mat_elements import plain_variables
from armodal.protocols.foreign.numpy_files import npy_array

NAMES = (
    "board frames", "slcan", "journal", "arm", "arm without files", "urdf", "dbc", "plan",
    "targets", "manifest", "uff", "mat", "npy", "npz", "csv", "lvm", "txt", "wav", "nc4",
    "hdf5", "mat 7.3", "robot", "salvage", "teds", "rtde packets", "mqtt message", "mqtt file",
    "front end", "sensors", "sensor memory", "gap result", "postures", "lock", "plant", "rehearsal",
    "motion table",
)  # fmt: skip
OF_EXTRAS = (
    "tdms", "xacro", "mjcf", "stl", "obj", "log, rosbag 1", "log, rosbag 2", "log, MCAP with CDR",
    "log, MCAP with JSON",
)  # fmt: skip
INPUTS = 60
CORPUS = Path(__file__).parents[1] / "fuzz_corpus"


@pytest.fixture(scope="module")
def decoders(tmp_path_factory):
    return decoders_in(tmp_path_factory.mktemp("fuzz"))


def test_every_decoder_is_fuzzed(decoders):
    assert set(decoders) - set(OF_EXTRAS) == set(NAMES)


@pytest.mark.parametrize("name", every_but(NAMES + OF_EXTRAS, "xacro", "log, rosbag 2"))
@pytest.mark.filterwarnings("ignore")  # of libraries, about the bytes they are given
def test_changed_files_are_read_or_refused(decoders, name):
    if name not in decoders:
        pytest.skip("the extra that reads these files is not installed")
    decoder = decoders[name]
    decoder.decode(decoder.seeds[0])
    rng = np.random.default_rng((NAMES + OF_EXTRAS).index(name))
    for _ in range(INPUTS):
        data = decoder.mutate(decoder.seeds[rng.integers(len(decoder.seeds))], rng, decoder.seeds)
        assert check(decoder, data) is None


@pytest.mark.parametrize("name", NAMES + OF_EXTRAS)
@pytest.mark.filterwarnings("ignore")
def test_inputs_that_reached_far_or_made_faults_once_are_read_or_refused(decoders, name):
    """What `make fuzz` found; every fault that was mended belongs there too."""
    if name not in decoders:
        pytest.skip("the extra that reads these files is not installed")
    for path in sorted((CORPUS / name.replace(" ", "-")).glob("*")):
        assert check(decoders[name], path.read_bytes()) is None, path


@given(st.binary(max_size=600))
@settings(max_examples=examples(100))
def test_any_bytes_of_a_board_are_frames_or_garbage(data):
    decode_board(b"\0" + data + b"\0")


def test_an_npy_header_that_is_no_python_is_refused():
    stream = io.BytesIO()
    np.save(stream, np.zeros(3))
    data = stream.getvalue().replace(b"(3,), }", b"(3,(((( ")
    with pytest.raises(ForeignFileError, match="wanted an NPY file"):
        npy_array(data, "a.npy")


@pytest.mark.long
def test_the_c_decoders_bear_changed_bytes_under_the_sanitizers(tmp_path):
    if compile_fuzz(tmp_path) is None:
        pytest.skip("no C compiler here makes programs with -fsanitize=address,undefined")
    found = fuzz_c(100_000, np.random.default_rng(1))
    assert found["faults"] == 0, found["told"]
    assert found["bytes"] >= 100_000
    assert (
        sum(len(data) - 4 for data in c_inputs(100_000, np.random.default_rng(1)))
        == (found["bytes"])
    )


def mat_with_type(kind):
    """A MATLAB file whose numbers are said to be of an element type."""
    stream = io.BytesIO()
    scipy.io.savemat(stream, {"time": np.arange(4.0)})
    data = bytearray(stream.getvalue())
    at = data.index(b"time") + 4
    data[at : at + 4] = kind.to_bytes(4, "little")
    return bytes(data)


def test_numbers_of_a_matlab_file_are_of_a_type_it_knows():
    assert plain_variables(mat_with_type(9)) == ["time"]
    for kind in (0, 8, 11, 14, 19, 200, 65535):
        with pytest.raises(ValueError, match=f"data of type {kind}"):
            plain_variables(mat_with_type(kind))


@pytest.mark.long
def test_a_small_matlab_file_of_very_much_data_is_refused_before_it_is_held():
    much = 2**27  # zeros, an eighth of a megabyte compressed
    packed = zlib.compress(struct.pack("<II", 14, much) + bytes(much))
    data = b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + struct.pack("<II", 15, len(packed)) + packed
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match="too large"):
            plain_variables(data)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # A piece, its copy, and an eighth that the whole grows by.
    assert peak < 1.125 * most_decoded_bytes(len(data)) + 3 * mat_elements.PIECE_BYTES


def test_a_compressed_variable_that_is_cut_off_is_refused():
    stream = io.BytesIO()
    scipy.io.savemat(stream, {"time": np.arange(400.0)}, do_compression=True)
    data = stream.getvalue()
    size = len(data) - 136
    for kept in (0, 1, size // 2, size - 1):
        cut = data[:128] + struct.pack("<II", 15, kept) + data[136 : 136 + kept]
        with pytest.raises(ValueError, match=r"cut off|incomplete|compressed"):
            plain_variables(cut)


def test_functions_in_a_matlab_file_are_passed_over():
    stream = io.BytesIO()
    content = {"notes": {"who": "x"}, "time": np.arange(4.0), "names": np.array(["a"], object)}
    scipy.io.savemat(stream, content)
    data = bytearray(stream.getvalue())
    assert plain_variables(bytes(data)) == ["notes", "time", "names"]
    data[144] = 16  # the first variable's class: no struct, a function
    assert plain_variables(bytes(data)) == ["time", "names"]
