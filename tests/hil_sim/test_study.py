import json
from dataclasses import replace
from hashlib import sha256

import numpy as np
import pytest
from support.laplace_frfs import laplace_frfs
from support.quick import every_but, few_quick
from support.small_case import SmallCase

from armodal.hil_sim.plant_file import PlantFile, load_plant_file
from armodal.hil_sim.small_motion import Mounting, linearise
from armodal.hil_sim.study import (
    LIBRARY,
    OUTSIDE,
    STUDY_ARMS,
    VERSION,
    CaseSpec,
    cases,
    draw_study,
    hiding,
    library,
    make_case,
    sealed,
    study_arm,
    write_case,
)
from armodal.hil_sim.study.cases import braked
from armodal.hil_sim.study.hiding import hide
from armodal.hil_sim.study.measure import measured
from armodal.hil_sim.study.model_error import erring_plant_tables, plant_of_tables
from armodal.hil_sim.study.places import ArmPlaces
from armodal.hil_sim.study.prominence import Bystander
from armodal.protocols.errors import PlantError
from armodal.protocols.plan_records import KnownMass
from armodal.protocols.session.hdf5 import read_session


def short(case, points=2):
    """A case's session, of the first posture's first points alone."""
    plan = few_points(case.plan, points)
    return measured(plant_of_tables(case.plant_tables()), case.arm, plan, 1)


def few_points(plan, points):
    """The plan with the first posture's first points alone."""
    posture = plan.postures[0]
    return replace(plan, postures=(replace(posture, points=posture.points[:points]),))


ONE, *OTHERS = STUDY_ARMS


@pytest.fixture(
    scope="module", params=[ONE, *(pytest.param(arm, marks=pytest.mark.long) for arm in OTHERS)]
)
def places(request):
    study = study_arm(request.param)
    return ArmPlaces(study, erring_plant_tables(study, 11))


@pytest.mark.parametrize("effect", every_but([*LIBRARY, *OUTSIDE], "friction", "softening"))
def test_every_effect_of_every_size_makes_a_plant_that_comes_to_rest(places, effect):
    make = LIBRARY.get(effect) or OUTSIDE[effect]
    posture = places.study.plan.postures[0]
    for size in (0.05, 0.25, 1.0):
        made = make(places, np.random.default_rng(3), size)
        assert made.name == effect
        effects = [*places.tables["effects"], *made.tables]
        plant = plant_of_tables(places.tables | {"effects": _one_bearing_a_joint(effects)})
        point = places.study.plan.fixed_point
        mounting = Mounting(point_id=point, R_link_sensor=plant.point(point).R_link_sensor)
        linearise(plant, posture.joints_rad, mounting)  # refuses an arm that does not


def _one_bearing_a_joint(effects):
    last = {e["joint"]: e for e in effects if e["kind"] == "bearing"}
    return [e for e in effects if e["kind"] != "bearing" or e is last[e["joint"]]]


@pytest.mark.long
def test_the_seed_decides_everything():
    cases = [make_case(seed, "bench57", "channel_gain") for seed in (3, 3, 4)]
    hashes = []
    for case in cases:
        hashes.append(case.truth_sha256)
        hide.cache_clear()  # made anew, not kept
    assert hashes[0] == hashes[1] != hashes[2]
    first, again, other = (short(case).hits for case in cases)
    assert np.array_equal(first[-1].counts, again[-1].counts)
    assert not np.array_equal(first[-1].counts, other[-1].counts)


SEED = 0x5EED1E55


@pytest.fixture(scope="module")
def header_of_a_null():
    case = make_case(SEED, "bench57")
    return case.session(few_points(case.plan, 1)).header


@pytest.mark.parametrize("kind", ["wrong_point", "bearing", "exponential_window"])
def test_the_session_tells_nothing_of_the_truth(kind, header_of_a_null):
    case = make_case(SEED, "bench57", kind)
    session, again = (case.session(few_points(case.plan, 1), run=run) for run in (0, 1))
    assert session.header.arm.sha256 == study_arm("bench57").arm.sha256
    text = repr(session.header) + repr(session.hits[0].verdict)
    for secret in (f"{SEED:x}", str(SEED), kind):
        assert secret not in text
    ids = {header.session_id for header in (session.header, again.header, header_of_a_null)}
    assert len(ids) == 3
    for header in (session.header, again.header):
        hidden = replace(header, session_id=header_of_a_null.session_id)
        assert repr(hidden) == repr(header_of_a_null)


def test_a_null_has_no_effect_but_errors():
    truth = json.loads(make_case(3, "ur5").open_truth())
    assert truth["verdict"] == "nothing_detectable"
    assert truth["effects"] == []
    believed = {joint.name: joint for joint in study_arm("ur5").arm.joints}
    for name, joint in truth["joints"].items():
        off = joint["stiffness_n_m_per_rad"] / believed[name].stiffness.value
        assert 0.0 < abs(np.log(off)) <= 0.3  # cut at two deviations of 15 %


@pytest.mark.parametrize("arm", few_quick(STUDY_ARMS, ONE))
def test_no_channel_of_a_null_is_overdriven_at_the_highest_level(arm):
    case = make_case(5, arm)
    posture = case.plan.postures[0]
    plan = replace(case.plan, postures=(posture,))
    levels = study_arm(arm).ladder_n[-1:]
    session = measured(plant_of_tables(case.plant_tables()), case.arm, plan, 1, levels)
    assert max(np.abs(hit.counts).max() for hit in session.hits) < 0.8 * 2**23


def test_hits_that_overdrive_the_sensor_are_made_again(monkeypatch):
    def seen_in_two(study, tables):
        """How far an effect stands out is looked at where it is learnt and foretold, once each."""
        first, *_, last = study.plan.postures
        return Bystander(replace(study, plan=replace(study.plan, postures=(first, last))), tables)

    monkeypatch.setattr(hiding, "Bystander", seen_in_two)
    monkeypatch.setattr(cases, "hide", hide.__wrapped__)  # nothing of it is kept
    # Freed joint 6 throws the hit block's corner about.
    case = make_case(5, "bench57", "released_joint", 4.0)
    posture = case.plan.postures[0]
    plan = replace(case.plan, postures=(replace(posture, points=("t1",)),))
    session = case.session(plan, levels_n=(400.0,))
    peak = np.max(np.abs(session.hits[0].counts))
    assert 0.4 * 2**23 < peak < 0.95 * 2**23


def test_another_test_of_the_same_case_has_other_noise_and_may_carry_a_known_mass():
    case = make_case(5, "bench57")
    posture = case.plan.postures[0]
    plan = replace(case.plan, postures=(replace(posture, points=("l1",)),), hits_per_point=1)
    heavy = KnownMass(link="flange", mass_kg=3.0, center_m=np.zeros(3))
    counts = [
        case.session(plan, **how).hits[0].counts
        for how in ({}, {}, {"run": 1}, {"known_mass": heavy}, {"brakes": True})
    ]
    same = [np.array_equal(counts[0], other) for other in counts[1:]]
    # Without a servo that gives way brakes change nothing.
    assert same == [True, False, False, True]


def test_brakes_hold_rotors_and_nothing_else(places):
    made = LIBRARY["servo"](places, np.random.default_rng(3), 0.5)
    free = places.tables | {"effects": [*places.tables["effects"], *made.tables]}
    held = braked(free)
    assert held["effects"][:-1] == free["effects"][:-1]
    key = "servo_stiffness_n_m_per_rad"
    assert held["effects"][-1][key] == 1000.0 * free["effects"][-1][key]


@pytest.mark.long
def test_a_clear_effect_stands_three_times_above_the_floor():
    clear = make_case(5, "bench57", "coupling")
    (effect,) = json.loads(clear.open_truth())["effects"]
    assert effect["clear_stands_out"] >= 3.0
    session = clear.session()
    nothing = make_case(5, "bench57")
    bystander = Bystander(study_arm("bench57"), nothing.plant_tables())
    # Noise, tilts and swings of the measurement itself leave the floor near one allowance: seven
    # arms had 0.79 to 1.03.
    floor = bystander.held_out(laplace_frfs(nothing.session(), bystander.s))
    assert floor == pytest.approx(1.0, abs=0.3)
    # What is told without measuring is right to a fifth: it was 1 % low to 11 % high on these.
    measured = bystander.held_out(laplace_frfs(session, bystander.s))
    assert measured == pytest.approx(effect["clear_stands_out"], rel=0.2)


def test_medium_and_faint_are_half_and_a_quarter_of_clear():
    cases = [make_case(5, "bench57", "delay", size) for size in ("clear", "medium", "faint", 1.5)]
    late = [json.loads(c.open_truth())["effects"][0]["parameters"]["delay_s"] for c in cases]
    assert np.array(late) / late[0] == pytest.approx([1.0, 0.5, 0.25, 1.5])


def test_a_study_mixes_and_repeats():
    specs = draw_study(7, nulls=4, effects=15, pairs=2, outside=2)
    assert specs == draw_study(7, nulls=4, effects=15, pairs=2, outside=2)
    assert [spec.number for spec in specs] == list(range(1, 24))
    assert sum(not spec.kinds for spec in specs) == 4
    assert {spec.arm for spec in specs} == {"bench57", "ur5"}
    assert sum(len(spec.kinds) == 2 for spec in specs) == 2


def test_every_kind_is_drawn_in_every_size_on_every_arm():
    for names in (library(1), library(VERSION)):
        specs = draw_study(8, nulls=0, effects=6 * len(names), outside=6, library=names)
        single = {(s.kinds, s.magnitude, s.arm) for s in specs if len(s.kinds) == 1}
        assert len(single) == 6 * len(names) + 2 * len(OUTSIDE)


def test_files_of_a_case_hold_session_arm_and_hashed_truth(tmp_path):
    case = SmallCase(CaseSpec(number=8, arm="bench57", seed=3, kinds=("delay",), magnitude="clear"))
    files = write_case(case, tmp_path)
    assert files.session.name == "case-0008.h5"
    assert sha256(files.truth.read_bytes()).hexdigest() == files.truth_sha256
    assert len(read_session(files.session).hits) == 3 * 6 * case.plan.hits_per_point


@pytest.mark.parametrize("effect", ["exponential_window", "wrong_point", "friction", "one_sided"])
def test_the_plant_file_of_a_case_is_the_same_plant(tmp_path, effect):
    case = make_case(3, "ur5", effect)
    path = tmp_path / "plant.toml"
    path.write_text(case.plant_text(), encoding="utf-8")
    assert load_plant_file(path) == PlantFile.model_validate(case.plant_tables())


def test_unknown_names_are_refused_with_those_wanted():
    for how in (("bench57", "gremlin"), ("bench57", "base", "huge"), ("r2d2",)):
        with pytest.raises(PlantError, match="wanted one of"):
            make_case(1, *how)
    assert sealed(draw_study(1)[0]).number == 1
