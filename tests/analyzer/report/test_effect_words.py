"""A named effect in the words of mechanics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.lines_in_links import LineInLink
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.records import EffectFound, Interval
from armodal.analyzer.report.effect_words import (
    chance,
    effect_sentence,
    mechanics,
    size_in_words,
)
from armodal.protocols.arm.files import load_arm

COMPLIANCE = Interval(unit="rad/(N m)", value=1e-5, std=1e-7, low=9.8e-6, high=1.02e-5)
LOSS = Interval(unit="s", value=2e-4, std=4e-6, low=1.9e-4, high=2.1e-4)
TILT = Interval(unit="", value=0.01, std=0.001, low=0.008, high=0.012)
EFFECT = EffectFound(
    name="an_effect",
    title="An effect",
    place="",
    parameters={"gamma": COMPLIANCE},
    size="gamma",
    description={},
    confidence=0.999,
    gain=100.0,
    held_out_gain=10.0,
    signature="",
    confused_with=(),
    told_by="",
    remedy="",
)
AXIS = {"link": "shoulder", "direction": [0.96, 0.0, 0.28], "point_m": [-0.052, 0.018, 0.18]}


def words_of(parameters, description, **changes):
    given = {"size": "gamma", "place": "shoulder", "confused_with": (), "told_by": ""}
    told = mechanics(parameters=parameters, description=description, **{**given, **changes})
    return {name: words.replace("\N{NARROW NO-BREAK SPACE}", " ") for name, words in told}


def test_an_axis_is_told_by_stiffness_damping_direction_point_and_place():
    told = words_of({"gamma": COMPLIANCE, "loss": LOSS, "tilt": TILT}, AXIS)
    assert told["k"] == "100 000 ± 1 000 N m/rad (95 %: 98 000 to 102 000 N m/rad)"
    # c = k tau = 20; relative deviations of 1 % and 2 % add in squares.
    assert told["c"] == "20.00 ± 0.45 N m s/rad"
    assert told["axis"] == "direction +0.96 +0.00 +0.28, through -52 18 180 mm"
    assert told["place"].startswith("shoulder (in its frame")
    assert "tilt" not in told  # where the fit began is nobody's business


def test_what_swings_along_a_line_is_told_with_its_frequency():
    """ln 20 Hz ± 0.05: 20 ± 1 Hz; its turns and shifts are those of the line."""
    mass = Interval(unit="kg", value=2.0, std=0.1, low=1.8, high=2.2)
    ln_hz = Interval(
        unit="ln Hz", value=np.log(20.0), std=0.05, low=np.log(18.0), high=np.log(22.0)
    )
    swings = {"mass": mass, "ln frequency": ln_hz, "loss": LOSS}
    told = words_of(swings, AXIS, size="mass")
    assert told["mass"] == "2.00 ± 0.10 kg (95 %: 1.80 to 2.20 kg)"
    assert told["frequency"] == "20.0 ± 1.0 Hz (95 %: 18.0 to 22.0 Hz)"
    assert "loss" in told
    assert not {"k", "c"} & told.keys()


@pytest.mark.parametrize(
    ("title", "place", "words"),
    [
        (
            "Link is compliant about an axis of its own",
            "shoulder",
            "The shoulder is compliant about",
        ),
        ("Link bends along its length", "link_2", "link_2 bends along its length: stiff"),
        (
            "Motor's rotor inertia at a joint",
            "joint_1",
            "Motor's rotor inertia at a joint (joint_1): stiff",
        ),
        ("Hammer gain is wrong", "", "Hammer gain is wrong: stiff"),
    ],
)
def test_a_finding_names_the_link_that_gives_way(title, place, words):
    effect = replace(EFFECT, title=title, place=place)
    assert effect_sentence(effect).startswith(words)


def test_what_an_effect_was_confused_with_is_told_and_that_there_is_nothing_too():
    told = words_of({"gamma": COMPLIANCE}, {}, confused_with=("A", "B"), told_by="a hit across")
    assert told["could be confused with"] == "A; B"
    assert told["told apart by"] == "a hit across"
    assert "no other effect" in words_of({"gamma": COMPLIANCE}, {})["could be confused with"]


def test_an_effect_without_an_axis_has_every_parameter_told():
    described = {"points": ["1", "2"], "softest_about": [0.0, 1.0], "from_m": [0.5, 1.0]}
    told = words_of({"gamma": COMPLIANCE, "tilt": TILT}, described)
    assert told["tilt"] == "0.0100 ± 0.0010 (95 %: 0.00800 to 0.0120)"
    assert told["points"] == "1, 2"
    assert told["softest about"] == "0, 1"
    assert told["from"] == "0.5, 1 m"
    assert told["place"] == "shoulder"


def test_tilts_of_a_bearing_are_told_as_stiffnesses():
    none = Interval(unit="rad/(N m)", value=1e-7, std=1e-7, low=0.0, high=4e-7)
    tilts = {"bearing a joint_2": COMPLIANCE, "bearing b joint_2": none}
    words = {"bearing a joint_2": "tilt stiffness about direction a"}
    told = words_of(tilts, {}, size="bearing a joint_2", words=words)
    assert told["tilt stiffness about direction a"].startswith("100 000 ± 1 000 N m/rad")
    # Of what may give way by nothing only the least stiffness is known: 1 / 4e-7.
    assert told["k bearing b joint_2"] == "at least 2 500 000 N m/rad (95 %)"


def test_the_softer_of_two_tilts_says_how_soft_a_bearing_is():
    none = Interval(unit="rad/(N m)", value=1e-7, std=1e-7, low=0.0, high=4e-7)
    tilts = {"tilt a": none, "tilt b": COMPLIANCE}
    words = {"tilt b": "tilt stiffness about direction b"}
    effect = replace(EFFECT, parameters=tilts, size="tilt a", sizes=("tilt a", "tilt b"))
    assert size_in_words(effect).startswith("stiffness 100")
    told = size_in_words(replace(effect, words=words))
    assert told.startswith("tilt stiffness about direction b 100")


def test_a_link_that_bends_all_along_is_told_by_its_bending_stiffness():
    """1/EI = 1e-5 rad/(N m²) is 100 kN m²."""
    bends = replace(COMPLIANCE, unit="rad/(N m²)")
    told = words_of({"bending compliance arm": bends}, {}, size="bending compliance arm")
    assert told["bending stiffness arm"] == "100 000 ± 1 000 N m² (95 %: 98 000 to 102 000 N m²)"


def test_what_only_shapes_an_effect_is_not_told_to_people():
    told = words_of({"gamma": COMPLIANCE, "taper": TILT}, {}, details=("taper",))
    assert "k" in told
    assert "taper" not in told


def test_a_logarithm_is_told_as_the_factor_it_is_of():
    reads = Interval(unit="", value=np.log(1.2), std=0.01, low=np.log(1.18), high=np.log(1.22))
    told = words_of({"ln hammer": reads}, {}, size="ln hammer")
    assert told["hammer"] == "1.200 ± 0.012 times (95 %: 1.18 to 1.22 times)"
    effect = replace(EFFECT, title="Hammer gain is wrong", parameters={"ln hammer": reads})
    sentence = effect_sentence(replace(effect, size="ln hammer"))
    assert sentence == "Hammer gain is wrong: 1.200 ± 0.012 times (95 %: 1.18 to 1.22 times)."


@pytest.mark.parametrize("seed", range(5))
def test_a_moved_axis_is_given_by_its_point_nearest_the_origin_of_its_link(seed):
    random = np.random.default_rng(seed)
    begun = random.normal(size=3)
    begun /= np.linalg.norm(begun)
    ordinary = Ordinary(superset=Superset(load_arm("bench57")), postures=("p",))
    line = LineInLink(ordinary, 1, begun, random.normal(size=3), of="axis")
    told = line.describe(dict(zip(line.moves, random.normal(size=4), strict=True)))
    direction, point = np.array(told["direction"]), np.array(told["point_m"])
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    assert direction.max() == np.abs(direction).max()
    assert direction @ point == pytest.approx(0.0, abs=1e-12)  # rounding of products near 1


@pytest.mark.parametrize(
    ("probability", "words"),
    [
        (None, "not known"),
        (1.0, "100 %"),
        (0.25, "25 %"),
        (0.034, "3.4 %"),
        (4e-4, "0.04 %"),
    ],
)
def test_chance_is_told_as_far_as_replicas_tell_it(probability, words):
    assert chance(probability) == words
