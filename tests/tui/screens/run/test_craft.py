"""What the screens say of the craft: tip, driving point, drift, scatter, hits still wanted."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from support.made_run import ARM, AT_HIT, HIT_EVENTS, PLAN, after, counts, fresh, judged, prompted
from support.screen import screen_rows
from support.stage import Stage, play

from armodal.analyzer.checks.records import Fault
from armodal.daq.session_machine import hit_judged
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.errors import SessionError
from armodal.protocols.frf_records import Dof
from armodal.protocols.session.hdf5 import write_session
from armodal.tui.screens.run.craft import (
    Moved,
    Scatter,
    check_driving_point,
    excited_band,
    good_hit_before,
    place_before,
    resonance_moved,
    scatter_at_resonance,
)
from armodal.tui.screens.run.earlier import check_reciprocity, earlier_frfs, mirrors_in
from armodal.tui.screens.run.measured import point_frf
from armodal.tui.screens.run.views.craft import (
    craft_text,
    drift_line,
    driving_line,
    reciprocity_line,
    scatter_line,
    tip_line,
)

HERE = ("test 1", "1")
LINE_HZ = 0.85  # about 1/T of the made records


def hit_at(number, *, point="1", f_hz=20.0, sign=1.0, width_s=2e-3, seed=4, reasons=()):
    """A hit whose answer is a decaying sine; the sensor's z axis looks along the hit."""
    made = judged(number, *reasons, point=point)
    values = counts()
    rate_hz = 51200 / 31
    t = (np.arange(len(values)) - 100) / rate_hz
    force = np.where((t >= 0) & (t < width_s), np.sin(np.pi * t / width_s), 0.0)
    # Velocity that begins with the hit and falls off: mobility with a positive real part.
    w, d = 2 * np.pi * f_hz, 5.0
    ring = np.where(t > 0, np.exp(-d * t) * (-d * np.cos(w * t) - w * np.sin(w * t)), 0.0)
    noise = np.random.default_rng(seed).normal(0.0, 20.0, values.shape)
    values = noise + np.outer(force, [1e5, 0.0, 0.0, 0.0])
    along = axis_of_the_hit(made)
    values[:, 1:] += sign * np.outer(ring, along) * 300.0
    hit = replace(made.hit, counts=np.round(values).astype(np.int32))
    return replace(made, hit=hit)


def axis_of_the_hit(made):
    placed = ARM.point(made.hit.sensor_point)
    posture = PLAN.postures[0]
    rotation = link_pose(ARM, placed.link, posture.joints_rad)[:3, :3] @ placed.R_link_sensor
    return rotation.T @ made.hit.hit_direction


def state_of(*hits):
    return after(fresh(), *HIT_EVENTS, *hits)


def test_a_long_pulse_asks_for_a_harder_tip_and_says_where_its_energy_ends():
    soft = state_of(hit_at(1, width_s=8e-3))
    band = excited_band(soft, soft.last_hit.hit)
    # |S| of a half sine of length T is cos(pi f T) / (1 - (2 f T)^2) of its mean: by pi e / 8 at
    # f T = 3/2 - e, which is 2 % at e = 0.051. The band ends on the line before.
    ends_hz = (1.5 - 0.02 * 8.0 / np.pi) / 8e-3
    assert band.high_hz == pytest.approx(ends_hz, abs=LINE_HZ)
    assert tip_line(band).plain == f"harder tip for more: energy ends at {band.high_hz:.0f} Hz"
    hard = state_of(hit_at(1, width_s=1.5e-3))
    assert "energy up to 644 Hz" in tip_line(excited_band(hard, hard.last_hit.hit)).plain


def test_no_tip_is_judged_by_a_hit_that_was_not_accepted():
    state = state_of(hit_at(1, reasons=("double",)))
    assert excited_band(state, state.last_hit.hit) is None


@pytest.mark.parametrize(
    ("sign", "fault"),
    [pytest.param(1.0, None, marks=pytest.mark.long), (-1.0, Fault.SIGN_FLIPPED)],
)
def test_a_flipped_sensor_is_seen_at_the_driving_point_after_one_hit(sign, fault):
    finding = check_driving_point(point_frf(state_of(hit_at(1, sign=sign)), HERE))
    assert finding.fault is fault


def test_faults_of_the_driving_point_are_told_in_a_row_of_80_columns():
    finding = check_driving_point(point_frf(state_of(hit_at(1, sign=-1.0)), HERE))
    assert "the polarity of sensor or hammer is reversed" in driving_line(finding).plain
    other = replace(finding, fault=Fault.NOT_A_DRIVING_POINT)
    assert "direction of the hit is not as stated" in driving_line(other).plain
    assert max(driving_line(f).cell_len for f in (finding, other)) <= 78


def test_away_from_the_hammer_there_is_no_driving_point():
    state = state_of(hit_at(1, point="2"))
    assert check_driving_point(point_frf(state, ("test 1", "2"))) is None


@pytest.mark.parametrize(("now_hz", "clear"), [(20.0, False), (24.0, True)])
def test_a_resonance_that_moved_from_point_to_point_is_told(now_hz, clear):
    state = state_of(hit_at(1), hit_at(2, point="2", f_hz=now_hz))
    assert place_before(state, ("test 1", "2")) == HERE
    before, now = (point_frf(state, ("test 1", point)) for point in "12")
    moved = resonance_moved(before.frf, now.frf)
    assert moved.clear is clear
    # A line on either side: peaks are read off the lines.
    assert moved.now_hz - moved.before_hz == pytest.approx(now_hz - 20.0, abs=2 * LINE_HZ)
    assert ("check mounting" in drift_line(moved, "1").plain) is clear


def test_scatter_needs_two_hits_and_falls_as_the_root_of_their_number():
    assert scatter_at_resonance(point_frf(state_of(hit_at(1)), HERE)) is None
    state = state_of(hit_at(1), hit_at(2, seed=5))
    found = scatter_at_resonance(point_frf(state, HERE))
    assert found.f_hz == pytest.approx(20.0, abs=LINE_HZ)
    assert 0.0 < found.relative_std < 0.05
    words = scatter_line(Scatter(f_hz=20.0, relative_std=0.02, n_hits=2), 6).plain
    assert words == "FRF at 20.0 Hz: ± 2 % from 2 hits, 6 more hits wanted: ± 1 %"


def test_the_good_hit_before_skips_rejected_and_withdrawn_ones():
    assert good_hit_before(state_of(hit_at(1))) is None
    state = state_of(hit_at(1), hit_at(2, reasons=("double",)), hit_at(3))
    assert good_hit_before(state).number == 1
    assert good_hit_before(replace(state, withdrawn=frozenset({1}))) is None


def test_what_asks_for_something_comes_first_and_short_lines_share_a_row():
    moved = Moved(before_hz=20.0, now_hz=24.0, half_width_hz=1.0)
    lines = (scatter_line(None, 2), drift_line(moved, "1"))
    assert craft_text(lines, 60, 1).plain.startswith("24.0 Hz was 20.0 Hz at point 1")
    assert craft_text(lines, 160, 1).plain.endswith(" · 2 more hits wanted")


@pytest.mark.parametrize("size", [pytest.param((80, 24), marks=pytest.mark.long), (160, 45)])
def test_the_hit_screen_says_what_is_wrong_and_what_is_still_wanted(tmp_path, size):
    stage = Stage(tmp_path)

    async def body(pilot):
        once = hit_judged(AT_HIT, accepted=True)
        await stage.tell(pilot, *HIT_EVENTS, hit_at(1), prompted(once))
        await stage.settle(pilot)
        assert "2 more hits wanted" in stage.text()
        twice = hit_judged(once, accepted=True)
        await stage.tell(pilot, hit_at(2, sign=-1.0), prompted(twice))
        await stage.tell(pilot, hit_at(3, sign=-1.0))
        await stage.settle(pilot)
        assert "dim: hit 2" in stage.text()

    play(stage, body, size)


def test_the_hits_that_a_wanted_scatter_still_takes_are_counted():
    found = Scatter(f_hz=20.0, relative_std=0.02, n_hits=2)
    begin = "FRF at 20.0 Hz: ± 2 % from 2 hits, ± 1 % "
    assert scatter_line(found, 6, 0.01).plain == f"{begin}wants 6 more hits"
    assert scatter_line(found, 1, 0.01).plain == f"{begin}wants 6 more hits, 5 beyond the plan (t)"
    assert scatter_line(found, 1, 0.02).plain.endswith("± 2 % is reached")


def test_the_craft_of_a_finished_point_stands_under_the_next_one(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        at = AT_HIT
        for number in range(1, 4):
            at = hit_judged(at, accepted=True)
            await stage.tell(pilot, *(HIT_EVENTS if number == 1 else ()), hit_at(number))
        await stage.tell(pilot, prompted(at))
        # From the other process every prompt comes as a copy.
        await stage.tell(pilot, pickle.loads(pickle.dumps(prompted(at))))  # noqa: S301 - our own
        await stage.settle(pilot)
        assert "Mount the sensor at point 2" in stage.text()
        assert "FRF at 19.5 Hz" in screen_rows(stage.app)[-3]

    play(stage, body, (80, 24))


def mirrored(*, sign=1.0, gain=1.0):
    """FRFs of an earlier session in which point 2 was hit and point 1 measured, in one posture."""
    now = point_frf(state_of(hit_at(1, point="2")), ("test 1", "2")).frf
    along = np.array([dof.direction for dof in now.responses])
    hit_then = along[2]  # along the z axis of the sensor at point 2
    axes_then = np.eye(3)
    # Of the motion at point 2 along the hit then, all goes along the hit of today at point 1.
    there = sign * gain * now.values[2, 0] * now.references[0].direction[:, None]
    return replace(
        now,
        responses=tuple(
            Dof(point="1", direction=axis, label=name)
            for axis, name in zip(axes_then, ("1:x", "1:y", "1:z"), strict=True)
        ),
        references=(Dof(point="2", direction=hit_then, label="2"),),
        values=there[:, None, :],
        joints_rad=PLAN.postures[0].joints_rad,
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, "reciprocity of points 2 and 1 holds"),
        ({"sign": -1.0}, "the polarity of sensor or hammer is reversed"),
        ({"gain": 1.3}, "a sensitivity differs from the other day's"),
    ],
)
def test_a_path_that_another_session_has_the_other_way_round_is_compared(change, words):
    now = point_frf(state_of(hit_at(1, point="2")), ("test 1", "2")).frf
    there = mirrors_in((mirrored(**change),), PLAN.postures[0])
    assert words in reciprocity_line(check_reciprocity(now, there)).plain


def test_no_path_is_compared_where_none_was_measured_the_other_way_round():
    now = point_frf(state_of(hit_at(1)), HERE).frf
    assert check_reciprocity(now, mirrored()) is None
    assert mirrors_in((mirrored(),), PLAN.postures[1]) is None


def test_an_earlier_session_is_of_the_same_arm_or_refused(session, tmp_path):
    path = tmp_path / "s.h5"
    write_session(session, path)
    found = earlier_frfs(path, session.header.arm)
    assert [frf.posture for frf in found] == [p.name for p in session.header.plan.postures]
    assert mirrors_in(found, session.header.plan.postures[1]) is found[1]
    with pytest.raises(SessionError, match=r"--earlier .*: wanted a session of .*leave it out"):
        earlier_frfs(path, load_arm("ur5"))
