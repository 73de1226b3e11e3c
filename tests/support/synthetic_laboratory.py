"""A laboratory around a source whose every sample is known in closed form; run, it is a process.

Channels 1 to 3 carry a ramp of the sample index, channel 0 half sines where a hit begins.
"""

import sys

import numpy as np

from armodal.hil_sim.__main__ import options_of, parse, run
from armodal.hil_sim.lab_process import ArmInCell, LabProcess
from armodal.hil_sim.plant import build_plant
from armodal.hil_sim.plant_file import PlantFile
from armodal.protocols.errors import ArmodalError

PULSE_SAMPLES = 20
PEAK_COUNTS = 200_000


def ramp(first, n):
    index = np.arange(first, first + n)
    return np.stack([(index * 7 + c) % 10_007 for c in range(1, 4)], axis=1).astype(np.int32)


class KnownSource:
    def __init__(self):
        self.first = 0
        self.hits = []
        self.posture = None
        self.point = None
        self.moving = False

    def set_posture(self, joints_rad):
        self.posture = joints_rad

    def mount(self, point_id):
        self.point = point_id

    def set_moving(self, moving):
        self.moving = moving

    def strike(self, at_sample, blow):
        if at_sample < self.first:
            raise ValueError("a hit in the past")
        self.hits.append((at_sample, blow))

    def read(self, n):
        index = np.arange(self.first, self.first + n)
        counts = np.empty((n, 4), dtype=np.int32)
        counts[:, 1:] = ramp(self.first, n)
        force = np.zeros(n)
        for at, peak in self.hits:
            phase = (index - at) / PULSE_SAMPLES
            force += np.where((phase > 0) & (phase < 1), peak * np.sin(np.pi * phase), 0.0)
        counts[:, 0] = np.round(force)
        self.first += n
        return counts


def truth():
    inertia = (0.1, 0.0, 0.0, 0.1, 0.0, 0.1)
    links = [
        {
            "name": f"link_{i}",
            "joint": f"joint_{i}",
            "origin_m": (0.0, 0.0, 0.1 * i),
            "axis": (0.0, 0.0, 1.0) if i in (1, 4, 6) else (0.0, 1.0, 0.0),
            "range_deg": (-170.0, 170.0),
            "mass_kg": 1.0,
            "center_m": (0.0, 0.0, 0.05),
            "inertia_kg_m2": inertia,
        }
        | ({"stiffness_n_m_per_rad": 1e4 * i, "damping_n_m_s_per_rad": 5.0} if i < 4 else {})
        for i in range(1, 7)
    ]
    points = [
        {
            "id": str(i),
            "link": f"link_{i}",
            "position_m": (0.0, 0.0, 0.1),
            "normal": (1.0, 0.0, 0.0),
            "x_axis": (0.0, 1.0, 0.0),
        }
        for i in range(1, 4)
    ]
    return PlantFile.model_validate(
        {
            "name": "known",
            "source": "closed form",
            "gravity_m_s2": (0.0, 0.0, -9.81),
            "links": links,
            "hidden_axis": {
                "link": "link_2",
                "point_m": (0.01, 0.02, 0.03),
                "direction": (0.0, 3.0, 4.0),
                "stiffness_n_m_per_rad": 6e4,
                "damping_n_m_s_per_rad": 10.0,
            },
            "points": points,
            "hammer": {
                "serial_number": "H1",
                "calibration_date": "2024-01-31",
                "sensitivity_v_per_n": 0.00025,
                "gain_error": 0.0,
                "highpass_hz": 0.1,
                "noise_n": 0.0,
                "flicker_n": 0.0,
            },
            "accelerometer": {
                "serial_number": "A1",
                "calibration_date": "2024-01-31",
                "mass_kg": 0.01,
                "sensitivity_v_per_m_s2": 0.05,
                "response": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
                "mount_tilt_deg": 0.0,
                "highpass_hz": 0.1,
                "noise_m_s2": 0.0,
                "flicker_m_s2": 0.0,
                "moving_vibration_m_s2": 0.0,
                "base_motion": 0.0,
            },
            "board": {"range_v": 5.0, "filter_delay_samples": 16, "oversampling": 16},
            "hand": {
                "peak_n": (100.0, 200.0),
                "width_s": (0.003, 0.005),
                "direction_std_deg": 0.0,
                "position_std_m": 0.0,
                "double_probability": 0.0,
                "double_delay_s": (0.01, 0.02),
                "double_ratio": (0.2, 0.5),
                "soft_probability": 0.0,
                "soft_peak_n": (1.0, 2.0),
                "overload_probability": 0.0,
                "overload_peak_n": (900.0, 999.0),
            },
        }
    )


def known_arm():
    return ArmInCell(
        plant=build_plant(truth()),
        make_source=lambda rate_hz: KnownSource(),
        swing=lambda point, direction, peak_n: (float(PEAK_COUNTS), {"peak_counts": PEAK_COUNTS}),
        mounted=lambda: {"tilt_rad": [0.0, 0.0, 0.0]},
    )


def main():
    given = parse()
    try:
        laboratory = LabProcess(known_arm(), options_of(given))
    except ArmodalError as error:
        sys.stderr.write(f"hil_sim: {error}\n")
        return 2
    run(laboratory, watch_stdin=given.watch_stdin)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
