"""Every decoder of bytes from outside, with valid files to begin from and mutations that fit.

A decoder takes any bytes. It may raise an ArmodalError; anything else is a fault.
"""

import resource
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
from support.foreign_bytes import small_files
from support.fuzz_files import (
    MANIFEST,
    FileDecoder,
    array_seeds,
    decode_session_journal,
    decode_uff,
    mat_bytes,
    mutate_hdf5,
    mutate_journal,
    mutate_mat,
    mutate_uff,
    read_all_of,
    read_manifest,
)
from support.fuzz_lines import board_stream, bus_decoder, decode_board, mutate_frames, slcan_lines
from support.more_decoders import more_decoders, mutation
from support.mutate import mutated, mutated_text

from armodal.protocols.arm.files import arm_from_texts, load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.frf_records import FrfForm
from armodal.protocols.inertia_targets import load_inertia_targets
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.hdf5 import write_session
from armodal.protocols.session.records import Session

MOST_KB = 200_000  # of a small file: `armodal.protocols.bounds`

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
    uncalibrated = Path(str(resources.files("armodal.protocols"))) / "arm/targets"
    viper = load_arm(uncalibrated / "viper_s650-uncalibrated.toml")
    urdf = (arm.urdf_text or "").encode()
    dbc = shipped("armodal.protocols", "dbc", ("armodal_controller.dbc", "cia402.dbc"))
    arms = shipped("armodal.protocols", "arm/arms", ("rv4frl.toml", "viper_s650.toml"))
    plans = shipped(
        "armodal.protocols", "plans", ("rv4frl-three-postures.toml", "rv4frl-roving-hammer.toml")
    )
    targets = shipped("armodal.protocols", "arm/targets", ("viper_s650-with-table4.toml",))
    session_path = folder / "valid.h5"
    write_session(session, session_path, frfs=frfs)
    npy, npz, csv = array_seeds(rng)
    hints = Hints()
    small = small_files(folder)
    told = Hints(form=FrfForm.ACCELERANCE, force_scale=1.0, response_scale=1.0)

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
            FileDecoder(folder, "f.mat", lambda p: read_content(p, hints)),
            mutate_mat,
        ),
        Decoder("npy", npy, FileDecoder(folder, "f.npy", lambda p: read_content(p, hints)), plain),
        Decoder("npz", npz, FileDecoder(folder, "f.npz", lambda p: read_content(p, hints)), plain),
        Decoder("csv", csv, FileDecoder(folder, "f.csv", lambda p: read_content(p, hints)), text),
        *(
            Decoder(
                name,
                tuple(data for path, data in small.items() if path.endswith(name)),
                FileDecoder(folder, f"f.{name}", lambda p: read_content(p, told)),
                change,
            )
            for name, change in (("lvm", text), ("txt", text), ("wav", plain), ("nc4", mutate_hdf5))
        ),
        Decoder(
            "hdf5",
            (session_path.read_bytes(),),
            FileDecoder(folder, "s.h5", read_all_of),
            mutate_hdf5,
        ),
        *(
            Decoder(name, seeds, decode, mutation(kind))
            for name, seeds, decode, kind in more_decoders(folder, journal, small)
        ),
    ]
    return {decoder.name: decoder for decoder in found}


def check(decoder: Decoder, data: bytes) -> str | None:
    """Return what is wrong with how a decoder takes these bytes, None where nothing is.

    Memory is held to what a small file may take, where the system tells.
    """
    before_kb = _most_kb()
    try:
        decoder.decode(data)
    except ArmodalError as error:
        if not str(error):
            return f"{type(error).__name__} without a message"
    except Exception as error:  # noqa: BLE001 - any other error is the finding
        return f"{type(error).__name__}: {error}"
    took_kb = _most_kb() - before_kb
    return f"took {took_kb // 1000} MB" if took_kb > MOST_KB else None


def _most_kb() -> int:
    """Return the most memory that this process had at once; 0 where that is not told so."""
    if sys.platform != "linux":
        return 0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
