"""Cases by name: found effects, own streams, sizes in order, sealed truth."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from armodal.hil_sim.makers import ARMS, MAKERS, effects_of, make_case, write_case
from armodal.hil_sim.makers.frame.visibility import VISIBLE
from armodal.hil_sim.makers.mujoco.sizing import STANDS_OUT, size_to_stand_out
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan_records import KnownMass
from armodal.protocols.session.hdf5 import read_session

SEEN = {"mujoco": ("stands_out", STANDS_OUT), "frame": ("visible", VISIBLE)}


def told(case):
    return json.loads(case.open_truth())


def smallest(plan):
    return replace(plan, postures=(replace(plan.postures[0], points=("2",)),), hits_per_point=1)


def test_there_are_two_makers_and_five_arms():
    assert MAKERS == ("frame", "mujoco")
    assert ARMS == ("iiwa14", "kr210", "lrmate200id", "ur10e", "xarm7")


@pytest.mark.parametrize("maker", MAKERS)
def test_every_module_of_the_folder_is_an_effect(maker):
    names = effects_of(maker)
    assert {"payload", "bearing", "base", "link_axis", "servo", "hammer_gain"} <= set(names)
    assert list(names) == sorted(names)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("clay", 1, "ur10e"), "maker"),
        (("frame", 1, "ur3"), "arm"),
        (("frame", 1, "ur10e", "ghost"), "effect"),
        (("frame", 1, "ur10e", "payload", "huge"), "size class"),
        (("frame", 1, "ur10e", "released_joint"), "no place"),
        (("mujoco", 1, "ur10e", "released_joint"), "no place"),
    ],
)
def test_what_cannot_be_made_is_said(arguments, said):
    with pytest.raises(PlantError, match=said):
        make_case(*arguments)


@pytest.mark.parametrize("maker", MAKERS)
def test_a_null_hides_nothing_and_seals_what_it_is(maker):
    case = make_case(maker, 4, "xarm7")
    truth = told(case)
    assert truth["effects"] == []
    assert truth["verdict"] == "nothing_detectable"
    assert set(truth["joints"]) == {joint.name for joint in case.arm.joints}
    for joint in case.arm.joints:
        off = truth["joints"][joint.name]["stiffness_n_m_per_rad"] / joint.stiffness.value
        assert abs(np.log(off)) < 2.5 * joint.stiffness.std / joint.stiffness.value


@pytest.mark.parametrize("maker", MAKERS)
def test_a_rigid_wrist_is_believed_rigid(maker):
    case = make_case(maker, 4, "lrmate200id", wrist="rigid")
    assert [joint.name for joint in case.arm.joints if joint.stiffness is None] == ["J5", "J6"]
    assert set(told(case)["joints"]) == {"J1", "J2", "J3", "J4"}


@pytest.mark.parametrize("maker", MAKERS)
def test_a_known_mass_is_bolted_on_once(maker):
    """Whether the plan tells it, the call, or both."""
    case = make_case(maker, 4, "xarm7")
    plan = smallest(case.plan)
    body = KnownMass(link=case.arm.joints[-1].link.name, mass_kg=2.0, center_m=np.zeros(3))
    loaded = replace(plan, postures=(replace(plan.postures[0], known_mass=body),))
    told_by_call, by_plan, by_both, none = (
        case.session(its, known_mass=call).hits[0].counts
        for its, call in ((plan, body), (loaded, None), (loaded, body), (plan, None))
    )
    np.testing.assert_array_equal(by_plan, told_by_call)
    np.testing.assert_array_equal(by_both, told_by_call)
    assert np.any(none != told_by_call)


@pytest.mark.parametrize("effect", ["servo", "bearing"])
def test_brakes_hold_a_servo_of_the_frame_and_nothing_else(effect):
    case = make_case("frame", 7, "ur10e", effect)
    free, held = (
        case.session(smallest(case.plan), brakes=on).hits[0].counts for on in (False, True)
    )
    assert np.any(free != held) == (effect == "servo")


@pytest.mark.long
@pytest.mark.parametrize("maker", MAKERS)
def test_sizes_are_in_order_and_meet_their_class(maker):
    key, wanted = SEEN[maker]
    masses = []
    for size_class in ("faint", "medium", "clear"):
        (effect,) = told(make_case(maker, 9, "lrmate200id", "payload", size_class))["effects"]
        masses.append(effect["parameters"]["mass_kg"])
        # As near as the search goes, and a look more.
        assert abs(np.log(effect[key] / wanted[size_class])) < np.log(1.25)
    assert masses == sorted(masses)


@pytest.mark.long
@pytest.mark.parametrize("maker", MAKERS)
def test_an_effect_draws_from_its_own_stream(maker):
    """What is beside it changes neither the arm nor its place and shape."""
    alone = told(make_case(maker, 6, "lrmate200id", "payload"))
    both = told(make_case(maker, 6, "lrmate200id", ("hammer_gain", "payload")))
    assert both["effects"][1]["parameters"] == alone["effects"][0]["parameters"]
    assert both["joints"] == alone["joints"]
    assert alone["joints"] == told(make_case(maker, 6, "lrmate200id"))["joints"]


@pytest.mark.long
@pytest.mark.parametrize("maker", MAKERS)
def test_case_files_read_as_any_other(maker, tmp_path):
    case = make_case(maker, 2, "xarm7", "channel_gain")
    files = write_case(case, tmp_path)
    session = read_session(files.session)
    assert len(session.hits) == 5 * 18 * 3
    assert load_arm(files.arm).sha256 == session.header.arm.sha256
    assert json.loads(files.truth.read_text())["effects"][0]["name"] == "channel_gain"


@pytest.mark.long
@pytest.mark.parametrize("effect", ["friction", "backlash", "microslip"])
def test_level_matters_where_the_law_is_bent(effect):
    """FRFs of a soft and a hard hit differ by twice what aim and noise make of them."""
    case = make_case("mujoco", 8, "lrmate200id", effect)
    session = case.session(smallest(case.plan), levels_n=(10.0, 160.0))
    plain = make_case("mujoco", 8, "lrmate200id").session(
        smallest(case.plan), levels_n=(10.0, 160.0)
    )
    bent, straight = _level_change(session), _level_change(plain)
    assert bent > 2.0 * straight


def _level_change(session):
    scale = np.array([channel.scale for channel in session.header.dictionary.channels])
    t = np.arange(len(session.hits[0].counts)) / float(session.header.plan.sampling.rate_hz)
    kernel = np.exp(-np.outer(10.0 + 2j * np.pi * np.arange(10.0, 60.0), t))
    soft, hard = (kernel @ (hit.counts * scale) for hit in session.hits)
    soft, hard = (x[:, 1:] / x[:, :1] for x in (soft, hard))
    return float(np.linalg.norm(hard - soft) / np.linalg.norm(soft))


def test_the_search_meets_a_size_that_grows_by_any_power():
    for power in (0.5, 1.0, 2.0):
        size, found = size_to_stand_out(lambda x, p=power: 9.0 * x**p, (1e-3, 10.0), "clear")
        assert found == pytest.approx(9.0 * size**power)
        assert abs(np.log(found / STANDS_OUT["clear"])) < np.log(1.13)
