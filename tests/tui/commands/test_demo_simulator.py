"""The demo's corrected arm in MuJoCo, beside what was measured in the posture for validation."""

from __future__ import annotations

import pytest

from armodal.tui.command_parts.demo_simulator import (
    simulator_lines,
    simulator_table,
    through_the_simulator,
)
from armodal.tui.commands.export import export_model

pytest.importorskip("mujoco")


@pytest.fixture(scope="module")
def found(session, identified, tmp_path_factory):
    """Corrected by what was identified: joints, and the axis that the file does not have."""
    folder = tmp_path_factory.mktemp("demo")
    told = {"software": "armodal test", "session_sha256": "c" * 64}
    export_model(session, identified, folder / "model.toml", **told)
    return through_the_simulator(session, identified, folder / "model.toml", folder)


def worst(found, when):
    """Of the modes that the arm has."""
    have = [row for row in found["modes"] if row[f"{when}_hz"] is not None]
    return max(abs(row[f"{when}_hz"] / row["measured_hz"] - 1.0) for row in have)


def test_only_the_posture_for_validation_is_looked_at(found, session):
    (held_out,) = (p.name for p in session.header.plan.postures if p.validation)
    assert {row["posture"] for row in found["modes"]} == {held_out}


def test_the_corrected_arm_is_nearer_to_what_was_measured_than_the_plain_one(found):
    assert worst(found, "after") < worst(found, "before") / 2.0
    said, model = simulator_lines(found)
    assert f"the plain arm is off by up to {100 * worst(found, 'before'):.1f} %" in said
    assert found["model"] in model


def test_a_mode_that_the_plain_arm_has_not_is_told_as_none(found):
    lacking = found | {"modes": [found["modes"][0] | {"before_hz": None}]}
    table = simulator_table(lacking)
    assert table.row_count == 1
    assert [next(iter(column.cells)) for column in table.columns][2:4] == ["none", ""]


def test_that_there_is_no_simulator_is_one_line():
    assert simulator_lines({"skipped": "install mujoco"}) == ["no simulator: install mujoco"]
