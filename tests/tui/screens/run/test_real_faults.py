"""What goes wrong in the laboratory, seen in a real terminal: a silent bus, an unplugged board."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import pytest
from support.run_by_hand import first_accepted_hit
from support.terminal import Terminal, armodal

from armodal.hil_sim.lab import start_laboratory
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan
from armodal.protocols.session.journal import load_journal
from armodal.tui.operators import ScriptedOperator

pytestmark = pytest.mark.usefixtures("real_time")
TIME_SCALE = 8.0
PLAN_NAME = "rv4frl-three-postures"


def plug_in(link: Path, process: int, other_port: str) -> None:
    """Point the link to the line a laboratory's board has now, as udev does for a real one."""
    held = {str(fd.readlink()) for fd in Path(f"/proc/{process}/fd").iterdir() if fd.is_symlink()}
    (line,) = (name for name in held if name.startswith("/dev/pts/") and name != other_port)
    link.unlink(missing_ok=True)
    link.symlink_to(line)


@pytest.mark.long
def test_a_silent_bus_and_an_unplugged_board_are_said_and_nothing_is_lost(tmp_path: Path):
    journal, board = tmp_path / "f.journal", tmp_path / "board"
    arm = load_arm("rv4frl")
    plan = load_plan(PLAN_NAME, arm)
    with (
        start_laboratory("rv4frl", seed=2, time_scale=TIME_SCALE) as laboratory,
        closing(ScriptedOperator(laboratory.operator, arm, plan, time_scale=TIME_SCALE)) as hand,
    ):

        def fault(name: str, *, active: bool) -> None:
            hand.ask({"do": "fault", "name": name, "active": active})

        plug_in(board, laboratory.pid, laboratory.can)
        command = armodal("run", PLAN_NAME, "--session", str(journal), "--board", str(board))
        command += ["--can", laboratory.can, "--time-scale", str(TIME_SCALE)]
        with Terminal(command) as terminal:
            first_accepted_hit(terminal, hand, plan)

            fault("can-silence", active=True)
            terminal.until("Stay away from the arm", 20.0, "POSTURE UNKNOWN", "CAN cable")
            fault("can-silence", active=False)
            # On a busy machine the bus may fall silent once more; then it is asked again, rightly.
            for _ in range(3):
                if "hits at point 1" in terminal.until("Enter: yes, it is|hits at point 1", 20.0):
                    break
                terminal.keys("Enter")
                terminal.until("hits at point 1|Stay away from the arm", 10.0)
            terminal.until("hits at point 1", 10.0)

            fault("unplug", active=True)
            again = "r: try again and go on at the same point"
            terminal.until("Every accepted hit is safe", 30.0, "Plug it in again", again)
            fault("unplug", active=False)
            plug_in(board, laboratory.pid, laboratory.can)
            terminal.keys("r")
            terminal.until("Enter: yes, it is|Mount the sensor at point 1", 60.0, "point 1")
            terminal.keys("q")
            terminal.until("ended 0", 30.0)
    assert len(load_journal(journal).accepted()) == 1
