"""A simulated hammer test in closed form: half-sine pulses on a known modal model.

The response of one mode to a half-sine is known exactly, so the records hold no integration
error; both channels carry the same AC coupling where asked for, added in closed form too.

Sampled as they are, such records alias: a half-sine has no highest frequency. `band_limited`
records went through the same anti-alias filter in both channels, as those of a board do.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from armodal.protocols.arm.records import Arm, Tolerances
from armodal.protocols.board.records import BoardDictionary, Channel, IepeState
from armodal.protocols.plan_records import (
    Averaging,
    Mode,
    Plan,
    PlannedPosture,
    Sampling,
    SensorOnArm,
    Trigger,
    Windows,
)
from armodal.protocols.session.records import Hit, JointReading, Session, SessionHeader, Verdict

FORCE_SCALE = 1e-4  # N per count
ACCELERATION_SCALE = 1e-6  # m/s^2 per count


def half_sine_response(t, width, p):
    """Response at times t of 1/(s - p) to sin(pi u / width) on 0 < u < width.

    A half-sine is a sine begun at 0 plus the same sine begun at `width`; the response to a sine of
    rate r is (r e^(p t) - r cos(r t) - p sin(r t)) / (p^2 + r^2).
    """
    rate = np.pi / width
    total = np.zeros(t.shape, dtype=complex)
    for start in (0.0, width):
        after = t > start
        later = t[after] - start
        wave = rate * (np.exp(p * later) - np.cos(rate * later)) - p * np.sin(rate * later)
        total[after] += wave / (p**2 + rate**2)
    return total


def half_sine(t, width):
    return np.where((t > 0.0) & (t < width), np.sin(np.pi * t / width), 0.0)


def acceleration(t, width, poles, residues, corner_hz=0.0):
    """(n_axes, n) acceleration to a unit half-sine; residues (n_modes, n_axes) of receptance.

    With AC coupling s/(s + wc) the transfer function s^3 / (s + wc) R/(s - p) + c.c. is split
    into partial fractions; the direct part is proportional to the force and its derivative.
    """
    wc = 2.0 * np.pi * corner_hz
    total = np.zeros((residues.shape[1], t.size))
    force = half_sine(t, width)
    slope = np.where((t > 0.0) & (t < width), np.pi / width * np.cos(np.pi * t / width), 0.0)
    for p, R in zip(poles, residues, strict=True):
        # s^3/((s + wc)(s - p)) = s + (p - wc) + A/(s - p) + B/(s + wc)
        A = p**3 / (p + wc)
        ringing = A * half_sine_response(t, width, p)
        if corner_hz > 0.0:
            B = -(wc**3) / (-wc - p)
            ringing = ringing + B * half_sine_response(t, width, -wc)
        direct = (p - wc) * force + slope
        total += 2.0 * (R[:, None] * (ringing + direct)[None, :]).real
    return total


def force_record(t, width, corner_hz=0.0):
    """Unit half-sine through AC coupling s/(s + wc)."""
    wc = 2.0 * np.pi * corner_hz
    droop = wc * half_sine_response(t, width, -wc).real if corner_hz > 0.0 else 0.0
    return half_sine(t, width) - droop


def band_limited(n, rate, start_s, width, poles, residues, corner_hz=0.0):
    """Force and accelerations (1 + n_axes, n) of a unit half-sine begun at `start_s`.

    Built on shifted lines s = a + jw, where the pulse and the model have closed forms, through a
    filter that falls to zero at half the rate; what wraps around the record is e^-12 of it.
    """
    a = 12.0 * rate / n
    freq = np.fft.rfftfreq(n, 1.0 / rate)
    s = a + 2j * np.pi * freq
    u = np.pi / width
    force = u * (1.0 + np.exp(-s * width)) / (s**2 + u**2) * np.exp(-s * start_s)
    position = np.clip((freq / rate - 0.4) / 0.1, 0.0, 1.0)
    force *= 0.5 + 0.5 * np.cos(np.pi * position)
    force *= s / (s + 2.0 * np.pi * corner_hz)
    H = sum(
        R[:, None] / (s - p) + R.conj()[:, None] / (s - np.conj(p))
        for p, R in zip(poles, residues, strict=True)
    )
    spectra = np.vstack([force, s**2 * H * force])
    return np.fft.irfft(spectra, n) * rate * np.exp(a * np.arange(n) / rate)


def dictionary(corner_hz=0.0, names=("hammer", "acc_x", "acc_y", "acc_z")):
    channels = tuple(
        Channel(
            name=name,
            quantity="force" if i == 0 else "acceleration",
            unit="N" if i == 0 else "m/s^2",
            scale=FORCE_SCALE if i == 0 else ACCELERATION_SCALE,
            full_scale=1e4,
            iepe=IepeState.OK,
            highpass_hz=corner_hz,
            serial_number="1",
            calibration_date="",
            teds=b"",
        )
        for i, name in enumerate(names)
    )
    return BoardDictionary(
        board_id="b",
        firmware="1",
        link_bytes_per_s=1_000_000,
        block_capacity=1_000_000,
        tick_hz=1_000_000,
        filter_group_delay_samples=0.0,
        channels=channels,
    )


def arm():
    tolerances = Tolerances(
        mass=0.0,
        inertia=0.0,
        center_m=0.0,
        encoder_offset_rad=0.0,
        sensor_tilt_rad=0.0,
        sensor_gain=0.0,
        hammer_gain=0.0,
        hit_direction_rad=0.0,
    )
    return Arm(
        name="a",
        source="",
        joints=(),
        gravity_m_s2=np.zeros(3),
        points=(),
        groups={},
        tolerances=tolerances,
        can=None,
        text="",
        urdf_text=None,
        sha256="",
    )


def session(
    poles,
    residues,
    *,
    mode=Mode.ROVING_RESPONSE,
    rate=1652,
    samples=2048,
    exponential_end=0.03,
    force_s=None,
    corner_hz=0.0,
    hits=3,
    noise=0.0,
    rng=None,
    aim=0.0,
    joints=(0.1, 0.2),
    averaging=None,
    anti_alias=False,
    widths_s=(2.5e-3, 4e-3),
    peaks_n=(50.0, 150.0),
):
    """Session of a roving test; residues (n_modes, n_points, 3) of receptance, one reference.

    Every pulse has a width of its own between `widths_s`, and a peak between `peaks_n`.
    """
    rng = rng or np.random.default_rng(0)
    pretrigger = 100
    points = tuple(str(i + 1) for i in range(residues.shape[1]))
    reading = JointReading(
        joints_rad=np.array(joints), drive_state=1, held=True, age_s=0.001, host_s=0.0
    )
    taken = []
    for index, point in enumerate(points):
        for _ in range(hits):
            width = rng.uniform(*widths_s)
            t = (np.arange(samples) - pretrigger + rng.uniform(0.0, 1.0)) / rate
            peak = rng.uniform(*peaks_n)
            # A hand that aims differently reaches every mode a little differently.
            reach = 1.0 + aim * rng.standard_normal((len(poles), 1))
            reached = reach * residues[:, index]
            if anti_alias:
                start_s = -t[0]
                record = peak * band_limited(
                    samples, rate, start_s, width, poles, reached, corner_hz
                )
            else:
                force = force_record(t, width, corner_hz)
                response = acceleration(t, width, poles, reached, corner_hz)
                record = peak * np.vstack([force, response])
            record += noise * rng.standard_normal(record.shape)
            scale = np.array([FORCE_SCALE] + [ACCELERATION_SCALE] * 3)
            counts = np.round(record / scale[:, None]).astype(np.int32).T
            number = len(taken) + 1
            hammer = mode is Mode.ROVING_HAMMER
            taken.append(
                Hit(
                    number=number,
                    posture="p",
                    sensor_point="7" if hammer else point,
                    hit_point=point if hammer else "7",
                    hit_direction=np.array([0.0, 0.0, -1.0]),
                    first_sample=number * 10_000,
                    trigger_sample=number * 10_000 + pretrigger,
                    trigger_host_s=0.0,
                    counts=counts,
                    before=reading,
                    after=reading,
                    verdict=Verdict(
                        accepted=True, reasons=(), notes=(), peak_n=peak, width_s=width
                    ),
                )
            )
    plan = Plan(
        name="t",
        arm="a",
        mode=mode,
        fixed_point="7",
        hits_per_point=hits,
        max_attempts=5,
        sampling=Sampling(rate_hz=Fraction(rate), samples=samples, pretrigger=pretrigger),
        trigger=Trigger(level_n=5.0, rising=True),
        windows=Windows(exponential_end=exponential_end, force_s=force_s),
        sensor=SensorOnArm(mass_kg=0.0),
        postures=(
            PlannedPosture(
                name="p",
                joints_rad=np.array(joints),
                tolerance_rad=0.01,
                points=points,
                hit_direction=None,
                validation=False,
            ),
        ),
        text="",
        sha256="",
        averaging=averaging or Averaging(),
    )
    header = SessionHeader(
        session_id="0",
        created="2025-01-01T00:00:00Z",
        software="t",
        arm=arm(),
        plan=plan,
        dictionary=dictionary(corner_hz),
        dictionary_bytes=b"",
        channel_mask=0b1111,
        time_scale=1.0,
    )
    return Session(header=header, hits=tuple(taken), losses=(), complete=True)
