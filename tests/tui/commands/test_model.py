"""`armodal model diff` and `armodal model check`."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from support.added import any_of, axis
from typer.testing import CliRunner

from armodal.analyzer.corrected.check import CheckedPosture
from armodal.analyzer.corrected.diff import arm_changes
from armodal.hil_sim.study import make_case
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import KeepOut, PastSession
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmodalError
from armodal.tui.cli import app
from armodal.tui.commands import model

RV = load_arm("rv4frl")
PAST = PastSession(session_sha256="a" * 64, by="armodal gap", created="2026-01-01T00:00:00+00:00")


def run(*arguments):
    return CliRunner().invoke(app, ["model", *map(str, arguments)])


@pytest.fixture
def changed(tmp_path):
    path = tmp_path / "arm.toml"
    stiffer = replace(RV.joints[0].stiffness, value=2.0 * RV.joints[0].stiffness.value)
    text = text_with_effects(
        RV, [axis("shoulder"), any_of(RV, "rotor")], stiffness={"joint_1": stiffer}, past=[PAST]
    )
    path.write_text(text, encoding="utf-8")
    return path


def test_what_changed_is_told_in_words_and_numbers(changed):
    value = json.loads(run("diff", "rv4frl", changed, "--json").stdout)
    words = [c["words"] for c in value["changes"] if c["words"]]
    assert "added: link_axis (shoulder), 99 % sure" in words
    assert f"from session {'a' * 12} by armodal gap, 2026-01-01T00:00:00+00:00" in words
    numbers = {c["what"]: (c["before"], c["after"]) for c in value["changes"] if not c["words"]}
    before, after = numbers["stiffness of joint_1"]
    assert after == pytest.approx(2.0 * before)
    assert numbers["link_axis (shoulder): axis_compliance"] == (None, 1e-5)
    assert "+100.00 %" in run("diff", "rv4frl", changed).stdout
    assert "taken out: rotor (joint_1)" in run("diff", changed, "rv4frl").stdout


def test_every_part_of_an_arm_that_differs_is_told():
    joint = RV.joints[1]
    skewed = joint.link.inertia_kg_m2.copy()
    skewed[0, 1] = skewed[1, 0] = skewed[0, 1] + 0.05
    renamed = replace(RV.joints[2].link, name="other")
    point = replace(RV.points[0], R_link_sensor=RV.points[0].R_link_sensor[:, [1, 2, 0]])
    joints = (
        RV.joints[0],
        replace(joint, link=replace(joint.link, inertia_kg_m2=skewed)),
        replace(RV.joints[2], link=renamed),
        *RV.joints[3:],
    )
    box = KeepOut(name="table", low_m=np.zeros(3), high_m=np.ones(3))
    other = replace(RV, joints=joints, points=(point, *RV.points[1:]), groups={}, keep_outs=(box,))
    told = {change.what for change in arm_changes(RV, other)}
    assert f"inertia xy of {joint.link.name}" in told
    assert "links come: other" in told
    assert f"sensors stand otherwise at points {point.id}" in told
    assert "groups of points differ" in told
    assert "boxes that the arm stays out of differ" in told
    assert arm_changes(RV, RV) == ()


def test_one_file_beside_itself_did_not_change(changed):
    assert json.loads(run("diff", changed, changed, "--json").stdout)["changes"] == []
    assert "nothing changed" in run("diff", changed, changed).stdout


def test_an_arm_file_remembers_its_sessions_and_grows_older(changed):
    again = text_with_effects(
        load_arm(changed), load_arm(changed).effects, past=[replace(PAST, session_sha256="b" * 64)]
    )
    changed.write_text(again, encoding="utf-8")
    assert [own.session_sha256[0] for own in load_arm(changed).history] == ["a", "b"]
    value = json.loads(run("check", changed, "--json").stdout)
    assert {row["session_sha256"][0] for row in value["known"]} == {"a", "b", "0"}
    assert all(row["days"] > 100.0 for row in value["known"])
    assert "give sessions of the arm" in run("check", changed).stdout
    assert "no session is behind this arm file" in run("check", "rv4frl").stdout


@pytest.fixture(scope="module")
def measured():
    """One posture of a case without anything hidden."""
    session = make_case(seed=8, arm="ur5").session()
    first = session.header.plan.postures[0].name
    return replace(session, hits=tuple(hit for hit in session.hits if hit.posture == first))


@pytest.mark.long
def test_postures_of_a_session_are_set_beside_the_arm_file(measured, tmp_path, monkeypatch):
    monkeypatch.setattr(model, "read_session", lambda _: measured)
    path = tmp_path / "s.h5"
    path.write_bytes(b"only its hash counts here")
    value = json.loads(run("check", "ur5", path, "--json").stdout)
    rows = value["sessions"][str(path)]
    (row,) = rows
    assert row["posture"] == measured.header.plan.postures[0].name
    assert not row["known"]
    assert 2 <= row["n_paired"] <= row["n_measured"]
    # What is believed of stiffness is off by its own deviation, some ten per cent of frequency.
    assert row["f_error"] < 0.3
    found = (CheckedPosture(**row), CheckedPosture(**{**row, "validation": True}))
    monkeypatch.setattr(model, "check_posture_rows", lambda *_, **__: found)
    said = run("check", "ur5", path).stdout
    assert "validation" in said
    assert "postures it was not fitted to" in said
    stiff = replace(
        found[0], n_paired=0, f_error=None, damping_error=None, within=0
    )  # no mode as low as those measured
    monkeypatch.setattr(model, "check_posture_rows", lambda *_, **__: (stiff,))
    assert "none of its modes is as low" in " ".join(run("check", "ur5", path).stdout.split())


@pytest.mark.long
def test_a_session_of_another_arm_is_refused(measured, tmp_path, monkeypatch):
    monkeypatch.setattr(model, "read_session", lambda _: measured)
    path = tmp_path / "s.h5"
    path.write_bytes(b"only its hash counts here")
    other = run("check", "viper_s650", path)
    assert "does not match the session" in str(other.exception)


def test_a_time_without_its_zone_is_refused(changed):
    text = changed.read_text().replace(
        'by = "armodal gap"\ncreated = "2026-01-01T00:00:00+00:00"',
        'by = "armodal gap"\ncreated = "2026-01-01"',
    )
    changed.write_text(text)
    result = run("check", changed)
    assert isinstance(result.exception, ArmodalError)
    assert "history[0].created" in str(result.exception)
    assert "with its zone" in str(result.exception)
