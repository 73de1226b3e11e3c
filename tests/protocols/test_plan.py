from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan import PLANS_DIRECTORY, load_plan, plan_from_text, shipped_plans
from armodal.protocols.plan_model import exact_rate
from armodal.protocols.plan_records import Mode

ARM = load_arm("rv4frl")
TEXT = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")

# Paper 000, Table 2.
TABLE_2 = {
    "test 1": [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0],
    "test 2": [-25.0, 0.0, 98.0, 0.0, -9.0, 0.0],
    "test 3": [-25.0, -80.0, 155.0, 2.0, -75.0, 0.0],
}


def test_the_shipped_plan_is_the_test_of_the_paper() -> None:
    plan = load_plan("rv4frl-three-postures", ARM)
    assert plan.mode is Mode.ROVING_RESPONSE
    assert (plan.fixed_point, plan.hits_per_point) == ("1", 3)
    assert plan.sampling.rate_hz == Fraction(51200, 31)
    assert round(float(plan.sampling.rate_hz)) == 1652
    assert plan.sampling.samples == 2048
    tests = [posture for posture in plan.postures if not posture.validation]
    assert [posture.name for posture in tests] == list(TABLE_2)
    for posture in tests:
        np.testing.assert_array_equal(posture.joints_rad, np.radians(TABLE_2[posture.name]))
        assert posture.points == tuple(str(n) for n in range(1, 19))


def test_validation_postures_are_others_with_six_points_one_on_each_moving_link() -> None:
    plan = load_plan("rv4frl-three-postures", ARM)
    checks = [posture for posture in plan.postures if posture.validation]
    assert len(checks) == 2
    links = {joint.link.name for joint in ARM.joints}
    for posture in checks:
        assert len(posture.points) == 6
        assert {ARM.point(point).link for point in posture.points} == links
        for test in plan.postures:
            if not test.validation:
                # Joints 2 to 5 make the inertia a hit meets; joint 1 only turns it.
                difference = np.abs(posture.joints_rad[1:5] - test.joints_rad[1:5])
                assert np.degrees(difference.max()) > 30.0


def test_every_shipped_plan_loads_with_unit_directions() -> None:
    assert "rv4frl-roving-hammer" in shipped_plans()
    for name in shipped_plans():
        for posture in load_plan(name, load_arm(name.split("-")[0])).postures:
            if posture.hit_direction is not None:
                # Normalised in float64.
                assert np.linalg.norm(posture.hit_direction) == pytest.approx(1.0, abs=1e-15)
                assert not posture.hit_direction.flags.writeable


def test_the_roving_hammer_hits_along_the_normals() -> None:
    plan = load_plan("rv4frl-roving-hammer", ARM)
    assert plan.mode is Mode.ROVING_HAMMER
    assert all(posture.hit_direction is None for posture in plan.postures)


def test_a_plan_is_rebuilt_from_its_text() -> None:
    plan = load_plan("rv4frl-three-postures", ARM)
    again = plan_from_text(plan.text, ARM)
    assert again.sha256 == plan.sha256
    assert again.sampling == plan.sampling
    assert [p.points for p in again.postures] == [p.points for p in plan.postures]


@pytest.mark.parametrize(
    ("written", "rate"),
    [
        ("51200/31", Fraction(51200, 31)),
        ("1652.5", Fraction(3305, 2)),
        (1024, Fraction(1024)),
        (1652.5, Fraction(3305, 2)),
    ],
)
def test_rates_are_exact(written: float | str, rate: Fraction) -> None:
    assert exact_rate(written) == rate


ALL = '["1", "2", "3", "4", "5", "6", "7",'


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("armodal-plan-1", "armodal-arm-1", "format: wanted 'armodal-plan-1', got"),
        ('arm = "rv4frl"', 'arm = "viper"',
         "arm: wanted rv4frl, the arm that is given, got 'viper'"),
        ('mode = "roving-response"', 'mode = "roving"',
         "mode: wanted 'roving-response' or 'roving-hammer', got 'roving'"),
        ('fixed_point = "1"', 'fixed_point = "19"', "fixed_point: wanted a point of the arm (1, 2"),
        ('fixed_point = "1"', "fixed_point = 1", "fixed_point: wanted a string, got 1"),
        ("hits_per_point = 3", "hits_per_point = 0", "hits_per_point: wanted greater than or"),
        ("max_attempts = 12", "max_attempts = 2",
         "the file: wanted max_attempts of at least hits_per_point"),
        ("max_attempts = 12", "max_tries = 12", "max_tries: wanted one of the keys"),
        ('"51200/31"', '"51200/0"', "sampling.rate_hz: wanted a rate from 1 to 1000000 Hz"),
        ('"51200/31"', '"1/2"', "sampling.rate_hz: wanted a rate from 1 to 1000000 Hz"),
        ('"51200/31"', '"-5"', "sampling.rate_hz: wanted a rate from 1 to 1000000 Hz"),
        ('"51200/31"', "nan", "sampling.rate_hz: wanted a rate from 1 to 1000000 Hz"),
        ('"51200/31"', "true", "sampling.rate_hz: wanted a rate from 1 to 1000000 Hz"),
        ('"51200/31"', "[1024]", "sampling.rate_hz: wanted a rate from 1 to 1000000 Hz"),
        ('"51200/31"', "1e300", "sampling.rate_hz: wanted a rate from 1 to 1000000 Hz"),
        ('"51200/31"', "1651.6129032258063", "sampling.rate_hz: wanted a rate"),
        ('"51200/31"', '"999999.999999999"', "sampling.rate_hz: wanted a rate"),
        ("samples = 2048 ", "samples = 2048.5 ", "sampling.samples: wanted an integer, got 2048.5"),
        ("samples = 2048 ", "samples = 10 ", "sampling.samples: wanted greater than or equal"),
        ("pretrigger = 100", "pretrigger = 2048", "sampling: wanted pretrigger below samples"),
        ("pretrigger = 100", "pretrigger = -1", "sampling.pretrigger: wanted"),
        ("level_n = 8.0", "level_n = 0.0", "trigger.level_n: wanted greater than 0, got 0.0"),
        ('slope = "rising"', 'slope = "up"', "trigger.slope: wanted 'rising' or 'falling'"),
        ("exponential_end = 0.03", "exponential_end = 1.5",
         "windows.exponential_end: wanted less than or equal to 1, got 1.5"),
        ("exponential_end = 0.03", "exponential_end = 0.0", "windows.exponential_end: wanted"),
        ("exponential_end = 0.03", "force_s = -1.0", "windows.force_s: wanted greater than 0"),
        ("mass_kg = 0.0093", "mass_kg = -0.0093", "sensor.mass_kg: wanted greater than or"),
        ("[-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]", "[-25.0, 90.0, 0.0, 0.0, 90.0]",
         "postures[0].joints_deg: wanted 6 joint angles, got [-25.0, 90.0, 0.0, 0.0, 90.0]"),
        ("[-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]", "[-25.0, 90.0, -1.0, 0.0, 90.0, 0.0]",
         ("postures[0].joints_deg[2]: wanted 0.00 to 164.00, the range of joint_3 (posture "
         "'test 1'), got -1.0")),
        ("[-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]", "[nan, 90.0, 0.0, 0.0, 90.0, 0.0]",
         "postures[0].joints_deg[0]: wanted a finite number, got nan"),
        ("tolerance_deg = 0.5", "tolerance_deg = 0.0",
         "postures[0].tolerance_deg: wanted greater than 0, got 0.0; postures[0] is 'test 1'"),
        (ALL, ALL.replace('"7"', '"0"'), "postures[0].points[6]: wanted a point of the arm"),
        (ALL, ALL.replace('"7"', '"6"'), "postures[0].points[6]: wanted each point once a posture"),
        ("[-0.383, -0.821, 0.423]", "[0.0, 0.0, 0.0]",
         "postures[0].hit_direction: wanted a direction, of any length but zero"),
        ("[-0.383, -0.821, 0.423]", "[0.0, 1.0]",
         "postures[0].hit_direction: wanted at least 3 items, got [0.0, 1.0]"),
        ('name = "test 2"', 'name = "test 1"',
         "postures[1].name: wanted a name of its own, got 'test 1'"),
        ("validation = true", "peaks_n = [20.0, 0.0]",
         "postures[3].peaks_n[1]: wanted greater than 0, got 0.0"),
        ("validation = true", "peaks_n = []", "postures[3].peaks_n: wanted at least 1 item"),
        ("validation = true", 'validation = "yes"', "postures[3].validation: wanted a boolean"),
    ],
)  # fmt: skip
def test_each_fault_is_refused_with_its_path(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in TEXT
    path = tmp_path / "p.toml"
    path.write_text(TEXT.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(PlanError) as caught:
        load_plan(path, ARM)
    assert str(caught.value).startswith(f"plan file p.toml: {said}")


def test_a_plan_of_validation_postures_alone_is_refused() -> None:
    text = TEXT.replace("\nhit_direction", "\nvalidation = true\nhit_direction", 3)
    with pytest.raises(PlanError, match="postures: wanted at least one posture that is not for"):
        plan_from_text(text, ARM)


def test_the_ends_of_a_range_are_inside_it() -> None:
    # 120 degrees is printed as 2.094395 rad in the URDF, a rounding below.
    text = TEXT.replace("[-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]", "[-240.0, 120.0, 0, -200, 120, 360]")
    plan = plan_from_text(text, ARM)
    assert plan.postures[0].joints_rad[1] == math.radians(120.0)


def test_an_unknown_shipped_plan_is_refused_with_the_known_ones() -> None:
    with pytest.raises(PlanError, match=r"one of the shipped plans .*rv4frl-three-postures"):
        load_plan("nothing", ARM)


values = st.one_of(st.floats(), st.integers(-(2**63), 2**63), st.just("true"), st.just('"9/0"'))


@settings(max_examples=examples(80))
@given(st.data())
def test_any_value_in_any_place_is_read_or_refused(data: st.DataObject) -> None:
    lines = TEXT.splitlines()
    places = [n for n, line in enumerate(lines) if " = " in line and not line.startswith("#")]
    place = data.draw(st.sampled_from(places))
    key = lines[place].split(" = ", 1)[0]
    lines[place] = f"{key} = {data.draw(values)}"
    try:
        plan = plan_from_text("\n".join(lines), ARM)
    except PlanError as error:
        told = str(error)
    else:
        told = f"plan file: {plan.name}"
    assert told.startswith("plan file: ")
