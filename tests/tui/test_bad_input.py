"""A user's mistakes and a laboratory's mishaps: one message, exit code 2, nothing lost."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from functools import partial

import pytest
from support.acquired_here import start_here
from support.command import armodal
from support.fault_runs import run_seed

from armodal.daq.events import HitJudged
from armodal.daq.settings import AcquisitionSettings
from armodal.hil_sim.lab import start_laboratory
from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan import PLANS_DIRECTORY, load_plan
from armodal.protocols.session.hdf5 import read_session, write_session
from armodal.protocols.session.journal import read_journal
from armodal.protocols.session.recovery import rebuild
from armodal.tui import operators
from armodal.tui.commands import acquire as acquire_command
from armodal.tui.operators import ScriptedOperator, acquire

pytestmark = pytest.mark.usefixtures("real_time")
TIME_SCALE = 8.0


@pytest.fixture
def acquiring_here(monkeypatch):
    """What is refused is refused without a process of its own, too."""
    monkeypatch.setattr(operators, "start_process", start_here)


def is_one_message(said, *words):
    assert said.returncode == 2, said.stderr
    assert "Traceback" not in said.stderr
    assert said.stderr.count("armodal:") == 1
    for word in words:
        assert word in " ".join(said.stderr.split())


@pytest.mark.parametrize("scale", ["0", "-1", "nan", "inf"])
@pytest.mark.parametrize(
    "command",
    [
        ["acquire", "rv4frl-three-postures", "--board", "b", "--can", "c"],
        ["run", "--sim"],
        ["sim"],
        ["demo"],
        ["check", "board", "b"],
    ],
)
def test_a_clock_that_cannot_run_is_refused_before_anything_is_begun(
    command, scale, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    said = armodal(*command, "--time-scale", scale)
    is_one_message(said, "time scale: wanted a finite number", "above 0")
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def small_plan(tmp_path):
    text = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")
    head = text[: text.index("[[postures]]")]
    path = tmp_path / "small.toml"
    path.write_text(
        head
        + '[[postures]]\nname = "test 1"\njoints_deg = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]\n'
        + 'tolerance_deg = 0.5\npoints = ["1", "5"]\nhit_direction = [-0.383, -0.821, 0.423]\n'
    )
    return path


@pytest.fixture(scope="module")
def session_files(tmp_path_factory):
    """A journal of a few hits, from a laboratory in this process, and the session file of it."""
    folder = tmp_path_factory.mktemp("session")
    journal, session = folder / "s.journal", folder / "s.h5"
    journal.write_bytes(run_seed(0, script=((), ())).journal)
    rebuild(journal, session, software="test")
    return journal, session


@pytest.mark.long
def test_a_roving_hammer_session_runs_over_real_ports(tmp_path):
    folder = tmp_path
    arm = load_arm("rv4frl")
    plan = load_plan("rv4frl-roving-hammer", arm)
    # One posture, two points: the hammer goes about, so its direction is the surface's normal.
    text = plan.text[: plan.text.index('points = ["1", "3"')] + 'points = ["1", "3"]\n'
    path = folder / "plan.toml"
    path.write_text(text)
    journal = folder / "s.journal"
    with start_laboratory(
        "rv4frl", seed=3, time_scale=TIME_SCALE, directory=folder / "lab"
    ) as laboratory:
        operator = ScriptedOperator(
            laboratory.operator, arm, load_plan(path, arm), time_scale=TIME_SCALE
        )
        settings = settings_of(laboratory, load_plan(path, arm), journal)
        finished = acquire(settings, operator, lambda event: None)
        operator.close()
    assert finished.complete
    rebuild(journal, folder / "s.h5", software="test")
    session = read_session(folder / "s.h5")
    assert session.complete
    assert {hit.hit_point for hit in session.accepted()} == {"1", "3"}
    assert {hit.sensor_point for hit in session.accepted()} == {"1"}


def settings_of(laboratory, plan, journal):
    return AcquisitionSettings(
        board_port=laboratory.board,
        can_channel=laboratory.can,
        arm=load_arm("rv4frl"),
        plan=plan,
        journal=journal,
        time_scale=TIME_SCALE,
        software="test",
    )


def acquired(laboratory, plan, journal):
    return armodal(
        "acquire",
        plan,
        "--board",
        laboratory.board,
        "--can",
        laboratory.can,
        "--operator",
        laboratory.operator,
        "--time-scale",
        TIME_SCALE,
        "--journal",
        journal,
    )


@pytest.mark.parametrize(
    ("fault", "word"),
    [
        pytest.param("board-garbage", "board", marks=pytest.mark.long),
        pytest.param("board-silence", "board", marks=pytest.mark.long),
        pytest.param("can-silence", "", marks=pytest.mark.long),
    ],
)
def test_a_device_that_does_not_talk_is_said(fault, word, small_plan, tmp_path, monkeypatch):
    impatient = partial(AcquisitionSettings, give_up_wall_s=0.0, can_timeout_s=0.1)
    monkeypatch.setattr(acquire_command, "AcquisitionSettings", impatient)
    with start_laboratory(
        "rv4frl", seed=1, time_scale=TIME_SCALE, directory=tmp_path / "lab", faults=(fault,)
    ) as laboratory:
        said = acquired(laboratory, small_plan, tmp_path / "s.journal")
    is_one_message(said, word)


@pytest.mark.long
def test_a_dictionary_that_changes_in_the_session_ends_it_and_keeps_what_was_accepted(
    small_plan, tmp_path
):
    """The supply of a sensor opens after the first accepted hit."""
    plan = load_plan(small_plan, load_arm("rv4frl"))
    journal = tmp_path / "s.journal"
    accepted = []
    with start_laboratory(
        "rv4frl", seed=1, time_scale=TIME_SCALE, directory=tmp_path / "lab"
    ) as laboratory:
        operator = ScriptedOperator(
            laboratory.operator, load_arm("rv4frl"), plan, time_scale=TIME_SCALE
        )

        def show(event):
            if isinstance(event, HitJudged) and event.hit.verdict.accepted:
                accepted.append(event.hit.number)
                if len(accepted) == 1:
                    operator.ask({"do": "fault", "name": "dictionary-change", "active": True})

        with pytest.raises(ArmodalError, match="dictionary"):
            acquire(settings_of(laboratory, plan, journal), operator, show)
        operator.close()
    kept = read_journal(journal)
    assert {hit.number for hit in kept.hits if hit.verdict.accepted} >= set(accepted)


def test_an_arm_with_a_negative_mass_is_refused_with_the_link(tmp_path):
    for name in ("rv4frl.toml", "rv4frl.urdf"):
        shutil.copy(ARMS_DIRECTORY / name, tmp_path / name)
    urdf = tmp_path / "rv4frl.urdf"
    text = urdf.read_text(encoding="utf-8")
    assert 'value="4.8924"' in text
    urdf.write_text(text.replace('value="4.8924"', 'value="-4.8924"'))
    said = armodal(
        "acquire",
        "rv4frl-three-postures",
        "--arm",
        tmp_path / "rv4frl.toml",
        "--board",
        "none",
        "--can",
        "none",
        "--journal",
        tmp_path / "j",
    )
    is_one_message(said, "link forearm", "mass above 0 kg", "-4.8924")
    assert not (tmp_path / "j").exists()


def test_a_posture_outside_its_joint_s_range_is_refused(small_plan, tmp_path):
    small_plan.write_text(small_plan.read_text().replace("[-25.0, 90.0,", "[-25.0, 190.0,"))
    said = armodal(
        "acquire", small_plan, "--board", "none", "--can", "none", "--journal", tmp_path / "j"
    )
    is_one_message(said, "joint_2", "190")
    assert not (tmp_path / "j").exists()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([], ["wanted where joint angles come from", "--can", "--ur", "--by-hand"]),
        (["--can", "none", "--by-hand", "0.2"], ["got --can none, --by-hand 0.2", "leave all but"]),
        (["--ur", "h", "--by-hand", "0"], ["got --ur h, --by-hand 0", "never mixed"]),
        (["--ur", "h", "--mqtt", "m.toml"], ["got --mqtt m.toml, --ur h", "never mixed"]),
        (["--mqtt", "none.toml"], ["MQTT file none.toml", "found none; check the path"]),
        (["--by-hand", "0"], ["above 0 and at most 10", "got 0"]),
        (["--by-hand", "nan"], ["above 0 and at most 10", "got nan"]),
        (["--by-hand", "0.6"], ["is closer than the 0.6 deg", "larger tolerance_deg"]),
    ],
)
@pytest.mark.usefixtures("acquiring_here")
def test_joint_angles_of_no_source_or_two_are_refused(given, words, small_plan, tmp_path):
    journal = tmp_path / "j"
    said = armodal("acquire", small_plan, "--board", "none", *given, "--journal", journal)
    is_one_message(said, *words)
    assert not journal.exists()


def test_two_boards_in_a_session_are_refused(small_plan, tmp_path):
    devices = ["--board", "a", "--board", "b", "--can", "none", "--journal", tmp_path / "j"]
    said = armodal("acquire", small_plan, *devices)
    is_one_message(said, "wanted one --board, got a, b", "two clocks")


@pytest.mark.usefixtures("acquiring_here")
def test_an_arm_without_a_bus_is_told_how_it_goes(tmp_path):
    devices = ["--board", "none", "--can", "none", "--journal", tmp_path / "j"]
    said = armodal("acquire", "ur5-five-postures", "--arm", "ur5", *devices)
    is_one_message(said, "arm ur5 has no [can] section", "--by-hand")


@pytest.mark.usefixtures("acquiring_here")
def test_a_session_by_another_plan_is_not_gone_on_with(session_files, small_plan, tmp_path):
    journal = tmp_path / "s.journal"
    shutil.copy(session_files[0], journal)
    before = journal.read_bytes()
    devices = ["--board", "none", "--can", "none"]  # refused before any is opened
    said = armodal("acquire", small_plan, *devices, "--journal", journal, "--resume")
    is_one_message(said, "plan")
    assert journal.read_bytes() == before


def test_a_truncated_journal_gives_back_every_whole_hit(session_files, tmp_path):
    whole = read_journal(session_files[0])
    torn = tmp_path / "torn.journal"
    data = session_files[0].read_bytes()
    torn.write_bytes(data[: len(data) - 100])
    said = armodal("recover", torn, "--json")
    assert said.returncode == 0
    assert '"dropped_bytes": 0' not in said.stdout
    assert len(read_session(tmp_path / "torn.h5").hits) >= len(whole.hits) - 1


def test_a_journal_damaged_in_its_middle_is_salvaged(session_files, tmp_path):
    whole = read_journal(session_files[0])
    data = bytearray(session_files[0].read_bytes())
    broken = tmp_path / "broken.journal"
    middle = 3 * len(data) // 4  # behind the header, which is the larger half
    broken.write_bytes(data[:middle] + bytes(50) + data[middle + 50 :])
    said = armodal("recover", broken, "--salvage", "--json")
    assert said.returncode == 0
    told = json.loads(said.stdout)
    assert len(told["dropped"]) == 1
    assert sum(told["sessions"][0]["hits"].values()) >= len(whole.hits) - 1
    said = armodal("recover", broken, "--salvage")
    assert "broken.salvaged-2.h5" in said.stderr.splitlines()[-1]
    is_one_message(armodal("recover", broken, "--salvage", "--out", "x.h5"), "--out")
    is_one_message(armodal("recover", broken, "--header", broken), "--salvage")


def test_a_journal_without_its_beginning_is_refused(session_files, tmp_path):
    torn = tmp_path / "torn.journal"
    torn.write_bytes(session_files[0].read_bytes()[:20])
    is_one_message(armodal("recover", torn))
    assert list(tmp_path.iterdir()) == [torn]


@pytest.mark.parametrize("part", [0.02, 0.3, 0.9, 0.999])
def test_a_truncated_session_file_is_refused(part, session_files, tmp_path):
    data = session_files[1].read_bytes()
    cut = tmp_path / "cut.h5"
    cut.write_bytes(data[: int(part * len(data))])
    is_one_message(armodal("fit", cut))


def test_a_session_without_hits_says_what_is_missing(session_files, tmp_path):
    session = read_session(session_files[1])
    empty = tmp_path / "empty.h5"
    write_session(replace(session, hits=()), empty)
    is_one_message(armodal("identify", empty), "accepted hits")


def test_an_output_that_cannot_be_written_is_said(session_files, tmp_path):
    said = armodal("report", session_files[1], "--out", tmp_path / "no" / "folder" / "r.html")
    is_one_message(said)


@pytest.mark.parametrize("command", [["run", "--sim"], ["review", "s.h5"]])
def test_an_app_without_a_terminal_is_one_message(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.h5").write_bytes(b"")
    said = armodal(*command)
    is_one_message(said, "wanted a terminal", "armodal --help")
    assert [path.name for path in tmp_path.iterdir()] == ["s.h5"]
