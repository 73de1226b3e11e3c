"""Faults of the sensor come back from an arm file as they were named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analyzer.arm.superset import Superset
from analyzer.gap.add import instances_of_file
from analyzer.gap.effects.channel_gain import at_point
from analyzer.gap.effects.sensor_axes import turned_sensor
from analyzer.gap.ordinary import Ordinary
from protocols.arm.files import load_arm
from protocols.arm.records import AddedEffect, EffectEvidence
from protocols.errors import ArmError

EVIDENCE = EffectEvidence(
    gain_nats=200.0,
    held_out_gain_nats=20.0,
    confidence=0.99,
    session_sha256="0" * 64,
    created="2026-01-01T00:00:00+00:00",
)
SWAP = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


@pytest.fixture(scope="module")
def ordinary():
    return Ordinary(superset=Superset(load_arm("bench57")), postures=("p",))


def told(ordinary, instance, **changed):
    effect = AddedEffect(
        name=instance.effect.name,
        place=instance.place,
        parameters=(),
        description={**instance.describe({}), **changed},
        evidence=EVIDENCE,
    )
    arm = replace(ordinary.arm, effects=(effect,))
    again = Ordinary(superset=Superset(arm), postures=("p",))
    return instances_of_file(again)[0][0]


@pytest.mark.parametrize("point", [None, "k2"])
@pytest.mark.parametrize("matrix", [np.diag([1.0, -1.0, 1.0]), SWAP])
def test_turned_axes_come_back(ordinary, matrix, point):
    instance = turned_sensor(ordinary, matrix, point)
    again = told(ordinary, instance)
    assert again.key == instance.key
    assert again.describe({}) == instance.describe({})


def test_a_gain_at_one_point_comes_back(ordinary):
    instance = at_point(ordinary, "y", "k2")
    assert told(ordinary, instance).key == instance.key


def test_a_point_the_arm_does_not_have_is_refused(ordinary):
    instance = at_point(ordinary, "y", "k2")
    with pytest.raises(ArmError, match="not one the library has there"):
        told(ordinary, instance, sensor_point="nowhere")
