"""One long recording of hammer hits on a structure of two modes, and how programs write it."""

from __future__ import annotations

import struct
from dataclasses import dataclass

import h5py
import numpy as np
from scipy import io, signal

RATE = 4096
MODES = ((60.0, 8.0, 1.0), (170.0, 15.0, -0.6))  # Hz, decay 1/s, gain (m/s^2)/(N s)
TIMES_S = (1.0, 2.9, 5.1, 7.0, 9.2, 11.05, 13.0)
PEAKS_N = (60.0, 85.0, 40.0, 120.0, 75.0, 50.0, 95.0)
DOUBLE = 3  # this hit has a second pulse 40 ms later
END_S = 15.2


@dataclass(frozen=True)
class Long:
    """time s, forces N (n_hammers, n), accelerations m/s^2 (k, n)."""

    time: np.ndarray
    force: np.ndarray
    response: np.ndarray


def _section(f_hz, decay, gain):
    r, w = np.exp(-decay / RATE), 2 * np.pi * f_hz / RATE
    return np.array([0.0, gain * r * np.sin(w)]), np.array([1.0, -2 * r * np.cos(w), r * r])


def truth(freq_hz, channel=0):
    """Acceleration over force of a channel at these frequencies, as it was simulated."""
    return (channel + 1) * sum(
        signal.freqz(*_section(*mode), worN=2 * np.pi * freq_hz / RATE)[1] for mode in MODES
    )


def recording(
    *,
    channels=1,
    sign=1.0,
    touch=0.0,
    times=TIMES_S,
    peaks=PEAKS_N,
    double=DOUBLE,
    end_s=END_S,
    width_s=2e-3,
    noise=1e-3,
    seed=31,
):
    """A recording; `touch` N is a weak pulse between the second and the third hit."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(end_s * RATE)) / RATE
    push = np.zeros(t.size)

    def strike(at_s, peak):
        x = (t - at_s) / width_s
        push[(x > 0) & (x < 1)] += peak * np.sin(np.pi * x[(x > 0) & (x < 1)])

    for i, (at_s, peak) in enumerate(zip(times, peaks, strict=True)):
        strike(at_s, peak)
        if i == double:
            strike(at_s + 0.04, 0.5 * peak)
    if touch:
        strike(0.5 * (times[1] + times[2]), touch)
    ringing = sum(signal.lfilter(*_section(*mode), push) for mode in MODES)
    response = np.array([(k + 1) * ringing for k in range(channels)])
    response += noise * rng.standard_normal(response.shape)
    force = sign * push + 0.01 * rng.standard_normal(t.size)
    return Long(time=t, force=force[None], response=response)


def write_wav(path, long, full_scale):
    """24-bit PCM, the force first; full scale is the same number of N and m/s^2."""
    table = np.vstack([long.force, long.response]).T / full_scale
    steps = np.rint(table * 2**23).astype("<i4").reshape(-1, 1)
    data = steps.view(np.uint8)[:, :3].tobytes()
    n = table.shape[1]
    head = struct.pack("<HHIIHH", 1, n, RATE, 3 * n * RATE, 3 * n, 24)
    body = b"WAVE" + b"fmt " + struct.pack("<I", 16) + head
    body += b"data" + struct.pack("<I", len(data)) + data
    path.write_bytes(b"RIFF" + struct.pack("<I", len(body)) + body)


def write_tdms(path, long):
    """One group with waveform properties, as LabVIEW writes it."""
    from nptdms import ChannelObject, RootObject, TdmsWriter  # noqa: PLC0415 - an extra

    def channel(name, values, unit):
        properties = {"wf_increment": 1.0 / RATE, "wf_start_offset": 0.0, "unit_string": unit}
        return ChannelObject("Log", name, values, properties=properties)

    channels = [channel("Hammer", long.force[0], "N")]
    channels += [channel(f"Acc {i}", r, "m/s^2") for i, r in enumerate(long.response)]
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([RootObject(), *channels])


def write_mat(path, long):
    """Columns beside one another, with a rate of its own."""
    io.savemat(
        path,
        {
            "time": long.time[:, None],
            "hammer_N": long.force.T,
            "acc_m_s2": long.response.T,
        },
    )


def write_npz(path, long):
    np.savez(path, time_s=long.time, force_n=long.force[0], acc_m_s2=long.response)


def write_csv(path, long):
    names = ["Time [s]", "Hammer [N]"] + [f"Acc {i} [m/s^2]" for i in range(len(long.response))]
    table = np.vstack([long.time, long.force, long.response]).T
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="", fmt="%.9g")


def write_hdf5(path, long):
    with h5py.File(path, "w") as file:
        file["time_s"] = long.time
        for name, values, unit in (("force", long.force[0], "N"), ("acc", long.response, "m/s^2")):
            file[name] = values
            file[name].attrs["units"] = unit


WRITERS = {
    "tdms": write_tdms,
    "mat": write_mat,
    "npz": write_npz,
    "csv": write_csv,
    "h5": write_hdf5,
}
