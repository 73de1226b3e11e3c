"""What a new arm file holds beside what was named."""

from __future__ import annotations

import os
from dataclasses import replace
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.records import EffectFound, GapResult, Interval, Verdict
from armodal.hil_sim.study import make_case
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmError
from armodal.tui.cli import app
from armodal.tui.commands.gap_results import check_arm_out, keep_gap


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """A session of an arm whose file has a payload and a rotor added before."""
    plain = make_case(seed=8, arm="ur5").session()
    evidence = EffectEvidence(
        gain_nats=200.0,
        held_out_gain_nats=20.0,
        confidence=0.99,
        session_sha256="0" * 64,
        created="2026-01-01T00:00:00+00:00",
    )
    parameter = EffectParameter(
        name="size", unit="rad/(N m)", value=0.5, std=0.1, low=0.3, high=0.7
    )
    before = tuple(
        AddedEffect(
            name=name,
            place=place,
            parameters=(parameter,),
            description={},
            evidence=evidence,
        )
        for name, place in (("payload", "flange"), ("rotor", "elbow"))
    )
    path = tmp_path_factory.mktemp("arm") / "arm.toml"
    path.write_text(text_with_effects(plain.header.arm, before), encoding="utf-8")
    arm = load_arm(path)
    return replace(plain, header=replace(plain.header, arm=arm))


def named(name, place):
    size = Interval(unit="rad/(N m)", value=1e-5, std=1e-6, low=8e-6, high=1.2e-5)
    effect = EffectFound(
        name=name,
        title=name,
        place=place,
        parameters={f"servo compliance {place}": size},
        size=f"servo compliance {place}",
        description={},
        confidence=1.0,
        gain=300.0,
        held_out_gain=30.0,
        signature="",
        confused_with=(),
        told_by="",
        remedy="",
    )
    return GapResult(
        verdict=Verdict.NAMED,
        summary="",
        effects=(effect,),
        rivals=(),
        hidden=(),
        joint_stiffness_ranges=(),
        gap_before=(),
        gap_after=(),
        where=(),
        interface="",
        gates=(),
        notes=(),
        misfit_per_line=0.5,
    )


def test_what_the_arm_file_had_stays_if_it_still_earns_its_place(session, tmp_path):
    ordinary = Ordinary(superset=Superset(session.header.arm), postures=())
    kept = {("payload", "flange"), ("servo", "elbow")}  # the rotor was taken out again
    instances = tuple(i for i in all_instances(ordinary) if i.key in kept)
    final = SimpleNamespace(hypothesis=SimpleNamespace(instances=instances))
    outcome = SimpleNamespace(result=named("servo", "elbow"), final=final)
    path = tmp_path / "session.h5"
    path.write_bytes(b"only its hash counts here")
    written = keep_gap(session, path, outcome, None)
    arm = load_arm(written["arm_file"])
    assert [(e.name, e.place) for e in arm.effects] == [("payload", "flange"), ("servo", "elbow")]


@pytest.mark.parametrize("link", [None, os.symlink, os.link])
def test_the_arm_file_that_is_read_is_not_the_one_to_write(tmp_path, link):
    path, own = tmp_path / "s.h5", tmp_path / "s.arm.toml"
    path.write_bytes(b"no session: what reads it fails otherwise")
    own.write_text("edited by hand")
    given = own
    if link is not None:
        given = tmp_path / "mine.toml"
        link(own, given)
    result = CliRunner().invoke(app, ["gap", str(path), "--arm", str(given)])
    assert isinstance(result.exception, ArmError)
    assert "wanted another arm file to write than --arm, got" in str(result.exception)
    assert "--arm-out" in str(result.exception)
    assert own.read_text() == "edited by hand"


def test_another_arm_file_to_write_is_free_to_be_named_once(tmp_path):
    path, own = tmp_path / "s.h5", tmp_path / "s.arm.toml"
    own.write_text("edited by hand")
    check_arm_out(path, str(own), tmp_path / "free.toml")
    check_arm_out(path, "ur5", None)
    check_arm_out(path, None, None)
    with pytest.raises(ArmError, match="is there already; give --arm-out another name"):
        check_arm_out(path, None, own)
