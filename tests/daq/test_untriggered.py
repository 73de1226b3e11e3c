"""Pushes the trigger cannot see: told once, and only where the polarity explains them."""

import numpy as np
import pytest
from support.channels import channel

from armodal.daq.events import Preview
from armodal.daq.untriggered import UntriggeredPushes
from armodal.protocols.plan_records import Trigger

SCALE = 1e-3


def preview(low_n, high_n):
    lowest, highest = np.zeros((2, 64, 2), dtype=np.int32)
    lowest[30, 0], highest[30, 0] = round(low_n / SCALE), round(high_n / SCALE)
    lowest[:, 0] += 500  # the force's zero is no matter
    highest[:, 0] += 500
    return Preview(first_sample=0, n_samples=640, lowest=lowest, highest=highest)


def watch(*, rising=True, scale=SCALE):
    channels = (channel("hammer", "force", scale, 0.0), channel("a", "acceleration", 1.0, 0.0))
    return UntriggeredPushes(channels, Trigger(level_n=8.0, rising=rising))


@pytest.mark.parametrize(("rising", "scale"), [(True, SCALE), (False, -SCALE)])
def test_two_pushes_against_the_slope_are_told_once(rising, scale):
    watched = watch(rising=rising, scale=scale)
    told = [watched.told_by(preview(-60.0, 2.0)) for _ in range(4)]
    assert [bool(text) for text in told] == [False, True, False, False]
    assert "60 N" in told[1]
    assert "trigger.slope" in told[1]


@pytest.mark.parametrize(("low", "high"), [(-2.0, 60.0), (-60.0, 20.0), (-9.0, 1.0), (0.0, 0.0)])
def test_what_triggers_or_is_no_push_is_not_told(low, high):
    watched = watch()
    assert not any(watched.told_by(preview(low, high)) for _ in range(4))
