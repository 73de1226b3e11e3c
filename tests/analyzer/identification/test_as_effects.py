"""A structural axis of `identify` and the gap workflow's link_axis: one thing in the same words."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import axis

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.analyzer.gap.add import file_key, instances_of_file
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.identification.as_effects import identified_arm
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.rewrite import text_with_effects

TOLD = {"source": "a test", "session_sha256": "c" * 64, "created": "2026-01-01T00:00:00+00:00"}
Q_DEG = [11.0, 23.0, 63.0, -29.0, 34.0, 17.0]


@pytest.fixture
def of_identify(arm, identified):
    return identified_arm(arm, identified, **TOLD)


def test_both_have_one_name_and_one_set_of_words(of_identify):
    (effect,) = of_identify.effects
    of_gap = axis(effect.place)
    assert effect.name == of_gap.name == link_axis.WORDS.name
    assert effect.place == of_gap.place
    assert set(effect.description) == set(of_gap.description)
    # Every value that an arm file must have of the gap's axis is in identify's too, by its name.
    ordinary = Ordinary(superset=Superset(of_identify), postures=())
    (instance,), values = instances_of_file(ordinary)
    own = {file_key(p.name, instance.place): p.unit for p in instance.parameters}
    assert {p.name for p in effect.parameters} <= set(own)
    assert {p.unit for p in effect.parameters} == {"rad/(N m)", "s"}
    assert all(own[p.name] == p.unit for p in effect.parameters)
    assert values[instance.size] == effect.parameters[0].value


def test_either_is_written_into_an_arm_file_and_read_back_alike(arm, of_identify, tmp_path):
    """Written by identify, read by the gap's equations; and the other way round."""
    (effect,) = of_identify.effects
    same = axis(
        effect.place,
        compliance=effect.parameters[0].value,
        loss=effect.parameters[1].value,
        direction=effect.description["direction"],
        point_m=effect.description["point_m"],
    )
    found = []
    for number, own in enumerate((effect, same)):
        path = tmp_path / f"arm{number}.toml"
        path.write_text(text_with_effects(arm, [own]), encoding="utf-8")
        read = load_arm(path)
        found.append(predict_arm(read, [Q_DEG])[0].modes)
        (line,) = held_arm(read).axes  # where `identify` begins
        assert line.stiffness_n_m_per_rad == pytest.approx(1.0 / own.parameters[0].value)
        assert abs(line.direction @ np.array(own.description["direction"])) == pytest.approx(1.0)
    np.testing.assert_allclose(found[0].f_hz, found[1].f_hz, rtol=1e-12)
    np.testing.assert_allclose(found[0].damping_ratio, found[1].damping_ratio, rtol=1e-12)
    plain = predict_arm(replace(arm, effects=()), [Q_DEG])[0].modes
    assert len(found[0].f_hz) == len(plain.f_hz) + 1
