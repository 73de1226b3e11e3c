from __future__ import annotations

import dataclasses
import math

import pytest

from armodal.daq.clock import SystemClock
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.errors import SessionError

IMPOSSIBLE = [0.0, -1.0, math.inf, math.nan]


@pytest.mark.parametrize("time_scale", IMPOSSIBLE)
def test_a_time_scale_that_no_clock_can_have_is_refused_with_the_settings(
    arm, plan, tmp_path, time_scale
):
    settings = AcquisitionSettings(
        board_port="", can_channel="", arm=arm, plan=plan, journal=tmp_path / "s.journal"
    )
    with pytest.raises(SessionError, match=f"above 0, got {time_scale}"):
        dataclasses.replace(settings, time_scale=time_scale)


@pytest.mark.parametrize("time_scale", IMPOSSIBLE)
def test_a_clock_that_stands_still_is_an_error_a_user_can_be_told(time_scale):
    with pytest.raises(SessionError, match="time scale"):
        SystemClock(scale=time_scale)
