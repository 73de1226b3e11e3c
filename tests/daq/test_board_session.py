"""What a plan asks of a board."""

from dataclasses import replace

import pytest

from armodal.daq.board_session import configuration_for, measured_mask
from armodal.protocols.board.records import Slope
from armodal.protocols.plan_records import Trigger


@pytest.mark.parametrize(
    ("rising", "scale", "slope", "level_counts"),
    [
        (True, 1e-4, Slope.RISING, 80_000),
        (True, -1e-4, Slope.FALLING, -80_000),
        (False, 1e-4, Slope.FALLING, -80_000),
        (False, -1e-4, Slope.RISING, 80_000),
    ],
)
def test_an_inverting_channel_turns_slope_and_level_over(
    fakes, plan, rising, scale, slope, level_counts
):
    channels = fakes["dictionary"]().channels
    channels = (replace(channels[0], scale=scale), *channels[1:])
    wanted = replace(plan, trigger=Trigger(level_n=8.0, rising=rising))
    found = configuration_for(wanted, channels, measured_mask(channels), stream=False)
    assert (found.slope, found.trigger_level_counts) == (slope, level_counts)
