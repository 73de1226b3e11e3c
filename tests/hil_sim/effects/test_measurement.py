from dataclasses import replace

import numpy as np
import pytest

from armodal.hil_sim.study import make_case
from armodal.hil_sim.study.measure import measured
from armodal.hil_sim.study.model_error import plant_of_tables

CASE = make_case(3, "bench57")
# Rounding to counts: records reach some 1e5 of them.
ROUNDED = 2.0


def record(*effects, point="f1", names=()):
    """Counts of one hit without noise, the sensor at a point; `names` are exchanged in the arm."""
    tables = dict(CASE.plant_tables())
    exchanged = dict(zip(names, names[::-1], strict=True))
    tables["points"] = [p | {"id": exchanged.get(p["id"], p["id"])} for p in tables["points"]]
    tables["effects"] = (*tables["effects"], *effects)
    tables["hammer"] = tables["hammer"] | {"noise_n": 0.0, "flicker_n": 0.0}
    tables["accelerometer"] = tables["accelerometer"] | {
        "noise_m_s2": 0.0,
        "flicker_m_s2": 0.0,
        "mount_tilt_deg": 0.0,
        "response": tuple(map(tuple, np.eye(3).tolist())),
    }
    posture = replace(CASE.plan.postures[0], points=(point,))
    plan = replace(CASE.plan, postures=(posture,), hits_per_point=1)
    (hit,) = measured(plant_of_tables(tables), CASE.arm, plan, 1).hits
    return hit.counts.astype(float)


@pytest.fixture(scope="module")
def plain():
    return record()


@pytest.mark.parametrize(("points", "factor"), [((), -1.0), (("f1",), -1.0), (("f2",), 1.0)])
def test_a_flipped_axis_changes_sign_where_it_is_flipped(plain, points, factor):
    flipped = record({"kind": "flipped_axis", "axis": "y", "points": points})
    assert flipped == pytest.approx(plain * [1.0, 1.0, factor, 1.0], abs=ROUNDED)


def test_swapped_axes_stand_in_each_other_s_place(plain):
    swapped = record({"kind": "swapped_axes", "axes": ("x", "z")})
    assert swapped == pytest.approx(plain[:, [0, 3, 2, 1]], abs=ROUNDED)


def test_gains_scale_their_channel(plain):
    scaled = record(
        {"kind": "channel_gain", "axis": "z", "factor": 1.2},
        {"kind": "hammer_gain", "factor": 0.9},
    )
    assert scaled == pytest.approx(plain * [0.9, 1.0, 1.0, 1.2], abs=ROUNDED)


@pytest.mark.parametrize("channels", [("hammer",), ("acc_x", "acc_y", "acc_z")])
def test_a_delay_turns_the_phase_in_proportion_to_frequency(plain, channels):
    late = record({"kind": "delay", "channels": channels, "delay_s": 3e-4})
    rate_hz = float(CASE.plan.sampling.rate_hz)
    turned = [0] if channels == ("hammer",) else [1, 2, 3]
    still = [i for i in range(4) if i not in turned]
    assert late[:, still] == pytest.approx(plain[:, still], abs=ROUNDED)
    weight = np.exp(-0.01 * np.arange(len(plain)))[:, None]  # decayed at the record's end
    was, now = (np.fft.rfft(counts * weight, axis=0) for counts in (plain, late))
    f_hz = np.fft.rfftfreq(len(plain), 1.0 / rate_hz)
    band = (f_hz > 20.0) & (f_hz < 100.0)
    phase = np.angle(now[band][:, turned] / was[band][:, turned])
    # The weight decays during the delay too: a part of 0.01 x 0.5 samples.
    wanted = -2.0 * np.pi * f_hz[band, None] * 3e-4 * np.ones(len(turned))
    strong = np.abs(was[band][:, turned]) > 0.05 * np.abs(was[band]).max(axis=0)[turned]
    assert phase[strong] == pytest.approx(wanted[strong], abs=5e-3)


def test_an_encoder_offset_puts_the_joint_elsewhere():
    effect = {"kind": "encoder_offset", "joint": "axis_2", "offset_deg": 2.0}
    tables = CASE.plant_tables()
    moved = plant_of_tables(tables | {"effects": (*tables["effects"], effect)})
    q = np.zeros(6)
    off = moved.hinge_angles(q) - plant_of_tables(tables).hinge_angles(q)
    assert off[moved.bodies["axis_2"]] == pytest.approx(-np.deg2rad(2.0))
    assert np.count_nonzero(off) == 1


def test_exchanged_points_are_measured_under_each_other_s_name():
    pair = ("f1", "f2")
    exchanged = record({"kind": "exchanged_points", "points": pair}, point="f2")
    assert exchanged == pytest.approx(record(point="f2", names=pair), abs=ROUNDED)
    assert np.max(np.abs(exchanged - record(point="f2"))) > 1e3


def test_a_moved_point_is_measured_where_it_stands(plain):
    moved = {"kind": "moved_point", "point": "f1", "by_m": (0.0, 0.0, 0.05)}
    shifted = record(moved)
    assert shifted[:, 0] == pytest.approx(plain[:, 0], abs=ROUNDED)
    assert np.max(np.abs(shifted - plain)) > 0.02 * np.max(np.abs(plain[:, 1:]))
    there_and_back = record(moved, moved | {"by_m": (0.0, 0.0, 0.0)})
    assert there_and_back == pytest.approx(plain, abs=ROUNDED)


def test_a_turned_hit_is_the_sum_of_its_parts():
    # About z by 90 degrees twice is a hit from the other side.
    about_z = {"kind": "hit_direction", "turn_deg": (0.0, 0.0, 90.0)}
    twice = {"kind": "hit_direction", "turn_deg": (0.0, 0.0, 180.0)}
    assert record(about_z, about_z) == pytest.approx(record(twice), abs=ROUNDED)
    assert np.max(np.abs(record(twice)[:, 1:] - record()[:, 1:])) > 1e3


def test_a_hidden_window_multiplies_the_record(plain):
    windowed = record({"kind": "exponential_window", "end": 0.2})
    weight = 0.2 ** (np.arange(len(plain)) / len(plain))
    assert windowed == pytest.approx(plain * weight[:, None], abs=ROUNDED)
