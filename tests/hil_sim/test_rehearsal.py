"""Any arm in the laboratory: drawn, sealed, spoken of on its bus."""

import json
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.chain_arm import chain_arm
from support.quick import few_quick

from armodal.hil_sim import __main__ as program
from armodal.hil_sim import lab
from armodal.hil_sim.controller import ENCODER_NOISE_RAD, ENCODER_STEP_RAD
from armodal.hil_sim.joint_messages import JointMessages
from armodal.hil_sim.lab import launch, start_laboratory
from armodal.hil_sim.ledger import LedgerWriter, read_ledger
from armodal.hil_sim.plant import build_plant, load_plant
from armodal.hil_sim.rehearsal import Rehearsal, read_rehearsal, write_rehearsal
from armodal.hil_sim.rehearsed_plant import NOT_LIVE, draw_plant, parse_hidden
from armodal.hil_sim.study import LIBRARY, OUTSIDE, rehearsal_plan
from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm, shipped_arms
from armodal.protocols.arm.generic_can import generic_mapping, with_generic_can
from armodal.protocols.can_database import CanDecoder
from armodal.protocols.errors import CanError, DeviceLostError, PlantError
from armodal.protocols.slcan import CanFrame, SlcanParser

EVERY = [*range(1, 10)]


@pytest.mark.parametrize("n", few_quick(EVERY, 1, 6, 9))
def test_an_arm_of_one_to_nine_joints_is_drawn_and_differs_from_its_file(n):
    arm = with_generic_can(chain_arm(n))
    plant, effects = draw_plant(Rehearsal(arm=arm), seed=1)
    assert effects == []
    assert [link.joint for link in plant.truth.links] == [joint.name for joint in arm.joints]
    for link, joint in zip(plant.truth.links, arm.joints, strict=True):
        assert link.stiffness_n_m_per_rad != joint.stiffness.value
        assert link.mass_kg != joint.link.mass_kg


@pytest.mark.parametrize("name", shipped_arms())
def test_every_shipped_arm_is_drawn(name):
    arm = load_arm(name)
    plant, _ = draw_plant(Rehearsal(arm=with_generic_can(arm), hidden=(("bearing", 0.5),)), seed=2)
    assert set(plant.points) == {point.id for point in arm.points}


def test_gravity_is_the_mountings_own():
    arm = chain_arm(4, gravity=(0.0, 9.80665, 0.0))
    plant, _ = draw_plant(Rehearsal(arm=arm), seed=1)
    assert plant.truth.gravity_m_s2 == (0.0, 9.80665, 0.0)


def test_a_shipped_arm_with_a_plant_of_its_own_is_that_plant_unless_something_is_hidden():
    arm = load_arm("rv4frl")
    assert draw_plant(Rehearsal(arm=arm), seed=1)[0].truth == load_plant("rv4frl").truth
    hidden = Rehearsal(arm=arm, hidden=(("delay", "medium"),))
    plant, effects = draw_plant(hidden, seed=1)
    assert plant.truth.hidden_axis is None
    assert [effect["name"] for effect in effects] == ["delay"]


@pytest.mark.parametrize("mass_kg", [0.0011, 0.025])
def test_the_accelerometer_rides_with_the_mass_that_the_plan_gives_it(mass_kg):
    arm = with_generic_can(chain_arm(3))
    drawn = rehearsal_plan(arm)
    plan = replace(drawn, sensor=replace(drawn.sensor, mass_kg=mass_kg))
    plant, _ = draw_plant(Rehearsal(arm=arm, plan=plan), seed=1)
    assert plant.truth.accelerometer.mass_kg == mass_kg


def test_another_arm_by_a_shipped_name_is_drawn_by_itself():
    other = chain_arm(6, name="rv4frl")
    assert draw_plant(Rehearsal(arm=other), seed=1)[0].truth.links[0].name == "link 1"


@pytest.mark.parametrize("n", few_quick(EVERY, 1, 6, 9))
def test_the_laboratorys_plan_lies_in_the_ranges_and_every_spring_answers(n):
    arm = chain_arm(n)
    plan = rehearsal_plan(arm)
    assert {posture.validation for posture in plan.postures} == {True, False}
    low, high = np.transpose([joint.range_rad for joint in arm.joints])
    for posture in plan.postures:
        assert np.all((low < posture.joints_rad) & (posture.joints_rad < high))
        assert np.linalg.norm(posture.hit_direction) == pytest.approx(1.0, abs=1e-12)
    assert rehearsal_plan(arm).text == plan.text


def test_an_arm_without_springs_or_points_to_hit_is_refused_with_what_is_missing():
    with pytest.raises(PlantError, match="wanted a joint with stiffness and damping, got none"):
        draw_plant(Rehearsal(arm=chain_arm(3, n_elastic=0)), seed=1)
    arm = chain_arm(2)
    on_base = replace(arm, points=tuple(replace(point, link="base") for point in arm.points))
    with pytest.raises(PlantError, match="wanted a test point on a moving link, got none"):
        rehearsal_plan(on_base)


QUICK = {"bearing", "coupling", "released_joint", "hit_direction", "wrong_point"}
LIVE = [name for name in (*LIBRARY, *OUTSIDE) if name not in NOT_LIVE]


@pytest.mark.parametrize(
    ("n", "name"),
    [
        pytest.param(n, name, marks=() if n == 1 and name in QUICK else pytest.mark.long)
        for n in (1, 4)
        for name in LIVE
    ],
)
def test_an_effect_is_hidden_in_a_small_arm_or_refused_by_its_name(n, name):
    rehearsal = Rehearsal(arm=chain_arm(n), hidden=((name, "medium"),))
    told = []
    try:
        _, effects = draw_plant(rehearsal, seed=4)
        told = [effect["name"] for effect in json.loads(json.dumps(effects))]
    except PlantError as error:
        told = [word for word in (name, "wanted") if word in str(error)][:1]
    assert told in ([name], ["wanted"])


def test_effects_to_hide_are_read_and_every_fault_is_named_at_once():
    assert parse_hidden(["bearing", "payload:faint"])[1] == ("payload", "faint")
    with pytest.raises(PlantError) as caught:
        parse_hidden(["bering", "payload:huge", "exponential_window", "delay:nan"])
    for wanted in ("'bering'", "'huge'", "'exponential_window'", "'nan'"):
        assert wanted in str(caught.value)


def test_a_rehearsal_is_handed_over_whole(tmp_path):
    arm = with_generic_can(load_arm("ur5"))
    plan = rehearsal_plan(arm)
    given = Rehearsal(arm=arm, plan=plan, hidden=(("delay", 0.3), ("rotor", 0.3)))
    write_rehearsal(given, tmp_path / "r.json")
    read = read_rehearsal(tmp_path / "r.json")
    assert (read.arm.sha256, read.plan.text, read.hidden) == (arm.sha256, plan.text, given.hidden)
    (tmp_path / "r.json").write_text("{}", encoding="utf-8")
    with pytest.raises(PlantError, match="armodal sim --arm"):
        read_rehearsal(tmp_path / "r.json")


@pytest.mark.parametrize("n", EVERY)
def test_the_bus_tells_the_angles_of_one_to_nine_joints(n):
    names = [f"axis {i}" for i in range(n)]
    mapping = generic_mapping(names)
    decoder, messages = CanDecoder(mapping), JointMessages(mapping, names)
    angles = np.radians(np.linspace(-170.0, 170.0, n) if n > 1 else [12.3456])
    heard = {}
    for frame in SlcanParser().feed(messages.lines(angles, moving=False, counter=7)):
        assert isinstance(frame, CanFrame)
        update = decoder.decode(frame)
        heard |= update.joints_rad
    assert update.held is True
    # Half a count of 1e-4 degree.
    assert [heard[name] for name in names] == pytest.approx(angles, abs=np.radians(0.51e-4))
    assert messages.per_cycle == (n + 1) // 2


def test_ten_joints_are_too_many_for_the_generic_description():
    with pytest.raises(CanError, match="wanted 1 to 9 joints, got 10"):
        generic_mapping([f"axis {i}" for i in range(10)])


def test_the_bus_is_that_of_the_arm_file_where_it_has_one():
    arm = load_arm(ARMS_DIRECTORY / "examples" / "rv4frl-cia402.toml")
    names = [joint.name for joint in arm.joints]
    messages, decoder = JointMessages(arm.can, names), CanDecoder(arm.can)
    angles, heard = np.radians([10.0, -20.0, 30.0, -40.0, 50.0, -60.0]), {}
    for moving in (False, True):
        for frame in SlcanParser().feed(messages.lines(angles, moving=moving, counter=1)):
            update = decoder.decode(frame)
            heard |= update.joints_rad
        assert update.held is not moving
    # Half a count of the coarsest gear.
    coarse = max(signal.scale_rad for signal in arm.can.joints)
    assert [heard[name] for name in names] == pytest.approx(angles, abs=0.51 * coarse)
    assert ENCODER_STEP_RAD > ENCODER_NOISE_RAD  # the bus is finer than the encoders' noise


def test_a_sealed_ledger_tells_nothing_at_a_glance_and_all_when_asked(tmp_path):
    plant = build_plant(load_plant("rv4frl").truth)
    effect = {"name": "payload", "place": "flange", "parameters": {"mass_kg": 0.123456}}
    path = tmp_path / "ledger.jsonl"
    for seed in (4, 5):  # started twice in one folder
        writer = LedgerWriter(path, plant, seed=seed, time_scale=1.0, effects=[effect], sealed=True)
        writer.note("hit", 1.0, point="3")
        writer.close()
    text = path.read_text(encoding="utf-8")
    assert [secret for secret in ("payload", "0.123456", "20789") if secret in text] == []
    record = read_ledger(path)
    assert record.truth.seed == 5
    assert record.truth.effects == (effect,)
    assert record.truth.joint("joint_1").k_n_m_per_rad == 20789.0
    assert [event["point"] for event in record.of("hit")] == ["3"]


@pytest.mark.long
def test_an_arm_of_four_joints_runs_as_a_process_with_its_truth_sealed(tmp_path):
    arm = with_generic_can(chain_arm(4))
    wanted = Rehearsal(arm=arm, hidden=(("hammer_gain", "medium"),))
    with start_laboratory(wanted, seed=3, directory=tmp_path / "lab") as laboratory:
        sealed = laboratory.truth_sha256
    assert len(sealed) == 64
    truth = read_ledger(laboratory.ledger).truth
    assert [effect["name"] for effect in truth.effects] == ["hammer_gain"]
    assert laboratory.failure() is None


CRASHING = """
import json, sys
ready = {"board": "", "can": "", "operator": "o", "ledger": "l", "time_scale": 1.0,
         "input_range_v": 5.0, "truth_sha256": ""}
if sys.argv[1] == "later":
    print(json.dumps(ready), flush=True)
[][1]
"""


def lose_the_board_of(laboratory):
    while laboratory.alive:
        pass
    raise DeviceLostError("the board is gone; check cable and power")


def test_a_laboratory_that_crashes_says_why_and_nobody_blames_a_cable():
    command = [sys.executable, "-c", CRASHING]
    with pytest.raises(DeviceLostError, match="exit code 1: IndexError: list index out of range"):
        launch([*command, "at once"])
    with (
        pytest.raises(DeviceLostError, match="IndexError") as caught,
        launch([*command, "later"]) as running,
    ):
        running.wait()
    assert "not of a device" in str(caught.value)
    with pytest.raises(DeviceLostError, match="IndexError"), launch([*command, "later"]) as running:
        lose_the_board_of(running)


def test_a_laboratory_that_is_killed_is_no_fault_of_the_simulation(tmp_path):
    arm = with_generic_can(chain_arm(1))
    with start_laboratory(Rehearsal(arm=arm), directory=tmp_path / "lab") as laboratory:
        os.kill(laboratory.pid, signal.SIGKILL)
        with pytest.raises(DeviceLostError, match="ended from outside by signal 9"):
            laboratory.wait()


def test_a_laboratory_of_any_arm_is_asked_for_by_a_file_and_told_its_faults(tmp_path, monkeypatch):
    """Without its process: what it is begun with, and what it makes of that."""
    monkeypatch.setattr(lab, "launch", lambda command, *, temporary: command)
    rehearsal = Rehearsal(arm=load_arm("ur5"))
    faults = ("board-silence", "can-silence")
    command = start_laboratory(rehearsal, seed=4, directory=tmp_path / "lab", faults=faults)
    made = []

    def run(laboratory, *, watch_stdin):
        made.append(laboratory)
        laboratory.close()

    monkeypatch.setattr(program, "run", run)
    arguments = [word for word in command[3:] if word != "--watch-stdin"]
    assert program.parse(arguments).fault == list(faults)
    assert program.main(arguments) == 0
    (laboratory,) = made
    ledger = laboratory.ready()["ledger"]
    names = [joint.name for joint in read_ledger(ledger).truth.joints]
    # Those that give way: of the last one the file has no stiffness.
    assert names == [joint.name for joint in rehearsal.arm.joints if joint.stiffness is not None]
    assert not Path(ledger).read_text(encoding="utf-8").startswith("{")  # it is sealed
