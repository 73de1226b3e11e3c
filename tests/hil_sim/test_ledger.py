from contextlib import closing

import numpy as np
import pytest
from support.synthetic_laboratory import known_arm

from armodal.hil_sim.ledger import LedgerWriter, read_ledger
from armodal.protocols.errors import PlantError


@pytest.fixture
def ledger(tmp_path):
    path = tmp_path / "ledger.jsonl"
    with closing(LedgerWriter(path, known_arm().plant, seed=5, time_scale=16.0)) as writer:
        writer.note("hit", 1.5, at_sample=np.float64(3.25), direction=np.array([0.0, 1.0, 0.0]))
        writer.note("mount", 2.5, point="2")
    return path


def test_the_truth_is_that_of_the_plant(ledger):
    truth = read_ledger(ledger).truth
    assert (truth.plant, truth.seed, truth.time_scale) == ("known", 5, 16.0)
    assert [j.name for j in truth.joints] == ["joint_1", "joint_2", "joint_3"]
    assert truth.joint("joint_2").k_n_m_per_rad == 2e4
    with pytest.raises(KeyError):
        truth.joint("joint_6")


def test_the_axis_is_told_in_base_and_link(ledger):
    axis = read_ledger(ledger).truth.axis
    # Origins of links 1 and 2 at 0.1 m and a further 0.2 m of height.
    np.testing.assert_allclose(axis.point_base_m, [0.01, 0.02, 0.33], atol=1e-15)
    np.testing.assert_allclose(axis.direction_base, [0.0, 0.6, 0.8])
    np.testing.assert_allclose(axis.point_link_m, [0.01, 0.02, 0.03])
    assert (axis.link, axis.k_n_m_per_rad, axis.c_n_m_s_per_rad) == ("link_2", 6e4, 10.0)
    assert not axis.point_base_m.flags.writeable


def test_events_come_back_in_order(ledger):
    record = read_ledger(ledger)
    assert [e["event"] for e in record.events] == ["hit", "mount"]
    assert record.of("hit")[0]["direction"] == [0.0, 1.0, 0.0]


def test_a_torn_last_line_is_left_out(ledger):
    whole = read_ledger(ledger)
    with ledger.open("a") as file:
        file.write('{"event": "hit", "lab')
    assert read_ledger(ledger).events == whole.events


@pytest.mark.parametrize("text", ["", "\n", "{}\n", "no json\n", '{"truth": {"axis": null}}\n'])
def test_what_is_no_ledger_is_refused(tmp_path, text):
    path = tmp_path / "other.jsonl"
    path.write_text(text)
    with pytest.raises(PlantError, match="wanted the ledger"):
        read_ledger(path)


def test_a_missing_ledger_is_refused(tmp_path):
    with pytest.raises(PlantError, match="wanted the ledger"):
        read_ledger(tmp_path / "none.jsonl")
