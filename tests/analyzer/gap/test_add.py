"""What a scan placed comes back from an arm file as it was named: sensors' faults, axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import file_key, instances_of_file
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.effects.channel_gain import at_point
from armodal.analyzer.gap.effects.sensor_axes import turned_sensor
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter
from armodal.protocols.errors import ArmError

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


@pytest.mark.parametrize("before", [(), ("k1", "k2")])
def test_an_axis_comes_back_with_the_points_before_it(ordinary, before):
    direction, point = np.array([0.0, 0.6, 0.8]), np.array([0.02, 0.0, 0.0])
    instance = link_axis.at_axis(ordinary, 2, direction, point, before=before)
    values = {p.name: p.mean for p in instance.parameters}
    where = instance.describe(values)
    vectors = {k: tuple(v) if isinstance(v, list) else v for k, v in where.items()}
    described = told(ordinary, replace(instance, describe=lambda _: vectors))
    assert described.key == instance.key
    assert described.pieces == instance.pieces
    assert described.describe(values)["link"] == where["link"]
    assert described.describe(values).get("points_before") == where.get("points_before")
    np.testing.assert_allclose(described.describe(values)["direction"], direction, atol=1e-12)
    np.testing.assert_allclose(described.describe(values)["point_m"], point, atol=1e-12)


def test_a_parameter_in_another_unit_is_refused(ordinary):
    """A file may leave the unit out; one that says degrees would be read as radians."""
    offset = next(i for i in all_instances(ordinary) if i.effect.name == "encoder_offset")
    parameter = EffectParameter(name="encoder", unit="", value=0.5, std=0.1, low=0.3, high=0.7)
    plain = AddedEffect(
        name=offset.effect.name,
        place=offset.place,
        parameters=(parameter,),
        description={},
        evidence=EVIDENCE,
    )
    said = replace(plain, parameters=(replace(parameter, unit="rad"),))
    for effect in (plain, said):
        arm = replace(ordinary.arm, effects=(effect,))
        _, values = instances_of_file(Ordinary(superset=Superset(arm), postures=("p",)))
        assert values == {offset.size: 0.5}
    arm = replace(
        ordinary.arm,
        effects=(replace(plain, parameters=(replace(parameter, unit="deg"),)),),
    )
    with pytest.raises(ArmError, match=r"wanted 'encoder' .* in 'rad', got 'deg'"):
        instances_of_file(Ordinary(superset=Superset(arm), postures=("p",)))


@pytest.mark.parametrize("axes", ["y", "x+z", "xyz", "xyz+x"])
def test_gains_at_a_point_come_back(ordinary, axes):
    described = told(ordinary, at_point(ordinary, axes, "k2"))
    assert described.owned == tuple(f"ln gain {own} at k2" for own in axes.split("+"))
    keys = {file_key(name, described.place) for name in described.owned}
    assert len(keys) == len(described.owned)


@pytest.mark.parametrize("axes", ["", "z+x", "xx", "w", "x, z"])
def test_gains_of_no_axes_of_a_sensor_are_refused(ordinary, axes):
    with pytest.raises(ArmError, match="not one the library has there"):
        told(ordinary, at_point(ordinary, "y", "k2"), axis=axes)


def test_a_point_the_arm_does_not_have_is_refused(ordinary):
    instance = at_point(ordinary, "y", "k2")
    with pytest.raises(ArmError, match="not one the library has there"):
        told(ordinary, instance, sensor_point="nowhere")
