"""`armodal gap --simulator mujoco`: what it wants."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmodalError, ForeignFileError
from armodal.tui.cli import app
from armodal.tui.command_parts.gap_motion import show_motion


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("s.h5", "--simulator=mujoco"), "wanted --model with your MJCF and --arm with the"),
        (("s.h5", "--simulator=gazebo", "--model=m.xml", "--arm=rv4frl"), "--simulator mujoco"),
        (("--simulator=mujoco", "--model=m.xml", "--arm=rv4frl"), "wanted a session for the gap"),
        (
            ("s.h5", "--simulator=mujoco", "--model=m.xml", "--arm=rv4frl"),
            "got one without [[effects]]",
        ),
        (("s.h5", "--motion=l.csv"), "wanted --simulator mujoco and --model with your MJCF"),
        (("s.h5", "--topic=encoder=/a"), "wanted --simulator mujoco and --model with your MJCF"),
        (("s.h5", "--simulator=mujoco", "--budget=2"), "wanted --budget with the search only"),
    ],
)
def test_a_user_s_mistake_is_one_message(arguments, message):
    result = CliRunner().invoke(app, ["gap", *arguments])
    assert isinstance(result.exception, ArmodalError), result.output
    assert message in str(result.exception)


def test_topics_are_told_once_by_role():
    with pytest.raises(ForeignFileError, match="got nothing, =/a, encoder=/c") as told:
        show_motion(
            load_arm("rv4frl"),
            load_arm("rv4frl"),
            Path("m.xml"),
            Path("l.mcap"),
            ["encoder=/b", "nothing", "=/a", "encoder=/c"],
            None,
            as_json=False,
        )
    assert "7=/imu/data" in str(told.value)
