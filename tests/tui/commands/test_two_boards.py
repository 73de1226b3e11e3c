"""Two boards for one session are refused, not one of them left out in silence."""

import pytest
from typer.testing import CliRunner

from armodal.protocols.errors import SessionError
from armodal.tui.cli import app


@pytest.mark.parametrize(
    "command",
    [
        ["acquire", "rv4frl-three-postures", "--by-hand", "0.2"],
        ["run", "rv4frl-three-postures", "--by-hand", "0.2"],
    ],
    ids=lambda command: command[0],
)
def test_two_boards_are_refused_with_both_names(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asked = [*command, "--board", "/dev/ttyACM0", "--board", "/dev/ttyACM1"]
    error = CliRunner().invoke(app, asked).exception
    assert isinstance(error, SessionError)
    assert "wanted one --board, got /dev/ttyACM0, /dev/ttyACM1" in str(error)
    assert "connect all sensors to one board" in str(error)
    assert not list(tmp_path.iterdir())
