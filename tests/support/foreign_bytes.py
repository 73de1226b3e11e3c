"""One small valid file of every foreign format, and what any reading of bytes may come to."""

import io

import h5py
import numpy as np
import scipy.io
from support.foreign_samples import accelerance, frf_set, si_set, write_sets
from support.foreign_writers import (
    NODES_2411,
    TESTLAB_GEOMETRY,
    kyowa,
    lvm,
    mat73,
    pulse,
    rattlesnake,
    signalcalc,
    table,
    wav,
)

from armodal.protocols.errors import ArmodalError
from armodal.protocols.foreign.inspection import inspect_file

RATE = 1024
T = np.arange(70) / RATE
FORCE = np.exp(-(((T - 0.01) / 0.002) ** 2))
RESPONSE = np.cos(90 * T)
FREQ = 0.5 * np.arange(30)
FRF = accelerance(FREQ, 0, 0)


def small_files(folder):
    """Return bytes by name: the ending is that of the format."""
    hit = {"time": T, "force": FORCE, "acc": RESPONSE}
    frf = {"freq": FREQ, "H": FRF, "coherence": np.full(30, 0.9), "form": "accelerance"}
    files = {
        "signalcalc.txt": signalcalc(FREQ, FRF),
        "pulse.txt": pulse(FREQ, [FRF, 2 * FRF]),
        "kyowa.csv": kyowa(RATE, [FORCE, RESPONSE], ["N", "m/s2"]),
        "plain.txt": table([T, FORCE, RESPONSE]).encode(),
        "comma.csv": ("f [Hz];Re;Im\n" + table([FREQ, FRF.real, FRF.imag], ";", ",")).encode(
            "utf-16"
        ),
        "complex.txt": "\n".join(f"({h.real:g}{h.imag:+g}j)" for h in FRF).encode(),
        "no.lvm": lvm(1 / RATE, [{"Force": FORCE, "Acc": RESPONSE}]),
        "multi.lvm": lvm(
            1 / RATE, [{"Force": FORCE, "Acc": RESPONSE}], columns="Multi", decimal=","
        ),
        "a.wav": wav(RATE, [FORCE, RESPONSE / 2]),
        "geometry.unv": (TESTLAB_GEOMETRY + NODES_2411).encode(),
    }
    for name, variables in (("hit.mat", hit), ("frf.mat", frf), ("struct.mat", {"S": frf, **hit})):
        stream = io.BytesIO()
        scipy.io.savemat(stream, variables, do_compression=name == "frf.mat")
        files[name] = stream.getvalue()
    for name, save in (("a.npz", np.savez), ("packed.npz", np.savez_compressed)):
        stream = io.BytesIO()
        save(stream, **{k: v for k, v in frf.items() if k != "form"})
        files[name] = stream.getvalue()
    stream = io.BytesIO()
    np.save(stream, np.vstack([T, FORCE, RESPONSE]))
    files["a.npy"] = stream.getvalue()
    path = folder / "small"
    sets = [si_set(), frf_set(1, FRF, FREQ), frf_set(1, np.full(30, 1.1), FREQ, func_type=6)]
    files["a.uff"] = write_sets(path, sets).read_bytes()
    mat73(path, frf)
    files["v73.mat"] = path.read_bytes()
    rattlesnake(path, 0.5, FRF[:, None, None], np.full((30, 1), 0.9))
    files["a.nc4"] = path.read_bytes()
    with h5py.File(path, "w") as file:
        file["time"], file["force"], file["acc"] = T, FORCE, RESPONSE
    files["plain.h5"] = path.read_bytes()
    path.unlink()
    files |= tdms_files()
    return files


def tdms_files():
    try:
        from nptdms import ChannelObject, TdmsWriter  # noqa: PLC0415 - an extra
    except ImportError:
        return {}
    stream = io.BytesIO()
    with TdmsWriter(stream) as writer:
        told = {"wf_increment": 1 / RATE}
        writer.write_segment(
            [
                ChannelObject("hit", "force", FORCE, properties={**told, "unit_string": "N"}),
                ChannelObject("hit", "acc", RESPONSE, properties={**told, "unit_string": "g"}),
            ]
        )
    return {"a.tdms": stream.getvalue()}


def read_or_refused(path, data):
    """Read bytes; return None, or the one sentence they are refused with."""
    path.write_bytes(data)
    try:
        inspect_file(path)
    except ArmodalError as error:
        return str(error)
    return None
