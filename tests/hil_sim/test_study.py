import json
from dataclasses import replace
from hashlib import sha256

import numpy as np
import pytest

from hil_sim.study import (
    LIBRARY,
    OUTSIDE,
    STUDY_ARMS,
    draw_study,
    make_case,
    sealed,
    study_arm,
    write_case,
)
from hil_sim.study.measure import measured
from hil_sim.study.model_error import plant_of_tables
from protocols.errors import PlantError
from protocols.session.hdf5 import read_session


def short(case, points=2):
    """A case's session, of the first posture's first points alone."""
    posture = case.plan.postures[0]
    plan = replace(case.plan, postures=(replace(posture, points=posture.points[:points]),))
    return measured(plant_of_tables(case.plant_tables()), case.arm, plan, 1)


@pytest.mark.parametrize("arm", STUDY_ARMS)
@pytest.mark.parametrize("effect", [*LIBRARY, *OUTSIDE])
def test_every_effect_of_every_size_makes_a_plant_that_comes_to_rest(arm, effect):
    for magnitude in ("clear", "faint"):
        case = make_case(11, arm, effect, magnitude)
        (truth,) = json.loads(case.open_truth())["effects"]
        assert truth["name"] == effect
    session = short(case, points=1)
    assert np.abs(session.hits[0].counts).max() > 0


def test_the_seed_decides_everything():
    cases = [make_case(seed, "bench57", "bearing") for seed in (3, 3, 4)]
    assert cases[0].truth_sha256 == cases[1].truth_sha256 != cases[2].truth_sha256
    first, again, other = (short(case).hits for case in cases)
    assert np.array_equal(first[-1].counts, again[-1].counts)
    assert not np.array_equal(first[-1].counts, other[-1].counts)


def test_the_session_tells_nothing_of_the_truth():
    case = make_case(3, "bench57", "released_joint")
    session = short(case)
    assert session.header.arm.sha256 == study_arm("bench57").arm.sha256
    assert session.header.arm.joints[5].stiffness is None
    text = repr(session.header) + repr(session.hits[0].verdict)
    assert "released" not in text


def test_a_null_has_no_effect_but_errors():
    truth = json.loads(make_case(3, "ur5").open_truth())
    assert truth["verdict"] == "nothing_detectable"
    assert truth["effects"] == []
    believed = {joint.name: joint for joint in study_arm("ur5").arm.joints}
    for name, joint in truth["joints"].items():
        off = joint["stiffness_n_m_per_rad"] / believed[name].stiffness.value
        assert 0.0 < abs(np.log(off)) <= 0.3  # cut at two deviations of 15 %


@pytest.mark.parametrize("arm", STUDY_ARMS)
def test_no_channel_of_a_null_is_overdriven_at_the_highest_level(arm):
    case = make_case(5, arm)
    posture = case.plan.postures[0]
    plan = replace(case.plan, postures=(posture,))
    levels = study_arm(arm).ladder_n[-1:]
    session = measured(plant_of_tables(case.plant_tables()), case.arm, plan, 1, levels)
    assert max(np.abs(hit.counts).max() for hit in session.hits) < 0.8 * 2**23


def test_a_study_mixes_and_repeats():
    specs = draw_study(7, nulls=4, effects=15, pairs=2, outside=2)
    assert specs == draw_study(7, nulls=4, effects=15, pairs=2, outside=2)
    assert [spec.number for spec in specs] == list(range(1, 24))
    assert sum(not spec.kinds for spec in specs) == 4
    assert {spec.arm for spec in specs} == {"bench57", "ur5"}
    assert sum(len(spec.kinds) == 2 for spec in specs) == 2


def test_files_of_a_case_hold_session_arm_and_hashed_truth(tmp_path):
    case = make_case(3, "bench57", "payload", number=8)
    files = write_case(case, tmp_path)
    assert files.session.name == "case-0008.h5"
    assert sha256(files.truth.read_bytes()).hexdigest() == files.truth_sha256
    assert len(read_session(files.session).hits) == 270


def test_unknown_names_are_refused_with_those_wanted():
    for how in (("bench57", "gremlin"), ("bench57", "base", "huge"), ("r2d2",)):
        with pytest.raises(PlantError, match="wanted one of"):
            make_case(1, *how)
    assert sealed(draw_study(1)[0]).number == 1
