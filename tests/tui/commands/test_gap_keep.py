"""What a new arm file holds beside what was named."""

from __future__ import annotations

import os
from dataclasses import replace
from hashlib import sha256
from types import SimpleNamespace

import numpy as np
import pytest
from support.made_gap_fits import made_fit
from support.small_case import small_case
from typer.testing import CliRunner

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.corrected.modes import corrected_modes
from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.analyzer.corrected.to_file import as_correction
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.records import EffectFound, GapResult, Interval, Verdict
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter, PastSession
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmError, ArmodalError
from armodal.tui.cli import app
from armodal.tui.command_parts.gap_results import check_arm_out, keep_gap


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """A session of an arm whose file has a payload and a rotor added before."""
    plain = small_case(8, "ur5").session()
    evidence = EffectEvidence(
        gain_nats=200.0,
        held_out_gain_nats=20.0,
        confidence=0.99,
        session_sha256="0" * 64,
        created="2026-01-01T00:00:00+00:00",
    )
    sizes = {
        "payload": {"payload": 0.5, "payload_radius_of_gyration": 0.05}
        | {f"payload_moment_{axis}": 0.01 for axis in "xyz"},
        "rotor": {"rotor": 0.5},
    }
    before = tuple(
        AddedEffect(
            name=name,
            place=place,
            parameters=tuple(
                EffectParameter(name=key, unit="", value=v, std=0.1 * v, low=0.8 * v, high=1.2 * v)
                for key, v in sizes[name].items()
            ),
            description={},
            evidence=evidence,
        )
        for name, place in (("payload", "flange"), ("rotor", "elbow"))
    )
    path = tmp_path_factory.mktemp("arm") / "arm.toml"
    path.write_text(text_with_effects(plain.header.arm, before), encoding="utf-8")
    arm = load_arm(path)
    return replace(plain, header=replace(plain.header, arm=arm))


SERVO = {"servo compliance elbow": 2e-5, "servo rotor elbow": 0.4, "servo loss elbow": 3e-4}


def named(name, place):
    units = {"compliance": "rad/(N m)", "rotor": "kg m²", "loss": "s"}
    effect = EffectFound(
        name=name,
        title=name,
        place=place,
        parameters={
            key: Interval(unit=units[key.split()[1]], value=v, std=0.1 * v, low=0.8 * v, high=2 * v)
            for key, v in SERVO.items()
        },
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
    hypothesis = Hypothesis(ordinary=ordinary, instances=instances)
    space = hypothesis.space()
    filed = {"payload flange": 0.5, "payload radius of gyration flange": 0.05}
    filed |= {f"payload moment {axis} flange": 0.01 for axis in "xyz"}
    u = space.start({**SERVO, **filed})
    final = made_fit(hypothesis, cost=0.0, space=space, u=u)
    highest = SimpleNamespace(s_rad_s=np.array([2j * np.pi * 60.0]))
    outcome = SimpleNamespace(
        result=named("servo", "elbow"),
        final=final,
        stages=[SimpleNamespace(lines=[highest])],
        sessions=(3, 4),  # what has levels; the first two were left out
    )
    path, *more = (tmp_path / f"session-{n}.h5" for n in range(1, 5))
    for own in (path, *more):
        own.write_bytes(f"only its hash counts here: {own.name}".encode())
    written = keep_gap(session, path, outcome, None, more)
    arm = load_arm(written["arm_file"])
    fitted_to = [sha256(own.read_bytes()).hexdigest() for own in more[1:]]
    assert [past.session_sha256 for past in arm.history] == fitted_to
    assert arm.effects[-1].evidence.session_sha256 == fitted_to[0]
    assert [(e.name, e.place) for e in arm.effects] == [("payload", "flange"), ("servo", "elbow")]
    # The file's own model has the modes of the fit, whose bearings and losses it does not have.
    fitted, own = as_correction(final), correction_of(arm)
    q = np.full(len(arm.joints), 0.7)
    wanted, found = (
        corrected_modes(corrected_posture(c, stand(c, q)), below_hz=60.0) for c in (fitted, own)
    )
    # What is left: an even part of the compliance of bearings has no place in the file.
    assert found.f_hz == pytest.approx(wanted.f_hz, rel=0.02)
    assert found.damping_ratio == pytest.approx(wanted.damping_ratio, rel=0.1)


@pytest.mark.parametrize("link", [None, os.symlink, os.link])
def test_the_arm_file_that_is_read_is_not_the_one_to_write(session, tmp_path, link):
    """A result of before that is gone on with."""
    path, own = tmp_path / "s.h5", tmp_path / "s.arm.toml"
    path.write_bytes(b"no session: what reads it fails otherwise")
    before = result_text(session)
    own.write_text(before)
    given = own
    if link is not None:
        given = tmp_path / "mine.toml"
        link(own, given)
    result = CliRunner().invoke(app, ["gap", str(path), "--arm", str(given)])
    assert isinstance(result.exception, ArmError)
    assert "wanted another arm file to write than --arm, got" in str(result.exception)
    assert "--arm-out" in str(result.exception)
    assert own.read_text() == before


def result_text(session):
    """An arm file as this command leaves it, by its history."""
    past = PastSession(session_sha256="0" * 64, by="armodal gap", created="2026-01-01T00:00:00Z")
    arm = session.header.arm
    return text_with_effects(arm, arm.effects, past=[past])


@pytest.mark.parametrize("text", ["edited by hand", None])
def test_an_arm_file_of_the_users_beside_the_session_stays_as_it_is(session, tmp_path, text):
    """One that cannot be read, or the session's own; what this command wrote is written again."""
    path, own = tmp_path / "s.h5", tmp_path / "s.arm.toml"
    path.write_bytes(b"only its hash counts here")
    hypothesis = Hypothesis(ordinary=Ordinary(superset=Superset(session.header.arm), postures=()))
    space = hypothesis.space()
    final = made_fit(hypothesis, cost=0.0, space=space, u=space.start(SERVO))
    highest = SimpleNamespace(s_rad_s=np.array([2j * np.pi * 60.0]))
    outcome = SimpleNamespace(
        result=named("servo", "elbow"),
        final=final,
        stages=[SimpleNamespace(lines=[highest])],
        sessions=(1,),
    )
    users = session.header.arm.text if text is None else text
    own.write_text(users)
    written = keep_gap(session, path, outcome, None)
    assert written["arm_file"] == tmp_path / "s.corrected.arm.toml"
    assert own.read_text() == users
    own.unlink()
    again = [keep_gap(session, path, outcome, None)["arm_file"] for _ in range(2)]
    assert again == [own, own]


def test_another_arm_file_to_write_is_free_to_be_named_once(tmp_path):
    path, own = tmp_path / "s.h5", tmp_path / "s.arm.toml"
    own.write_text("edited by hand")
    check_arm_out(path, str(own), tmp_path / "free.toml")
    check_arm_out(path, "ur5", None)
    check_arm_out(path, None, None)
    with pytest.raises(ArmError, match="is there already; give --arm-out another name"):
        check_arm_out(path, None, own)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("--html", "s.gap.json"), "wanted another file for --html than the result beside s.h5"),
        (("--html", "s.arm.toml"), "wanted another file for --html than the arm file"),
        (("--html", "a", "--arm-out", "a"), "wanted another file for --html than the arm file"),
        (("--arm-out", "s.gap.json"), "wanted another file for --arm-out than the result beside"),
        (("--arm", "own.toml", "--html", "own.toml"), "to write than what is read, got own.toml"),
    ],
)
def test_no_result_is_written_over_another_or_over_the_arm_file(given, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.h5").write_bytes(b"no session: what reads it fails otherwise")
    (tmp_path / "own.toml").write_text("edited by hand")
    result = CliRunner().invoke(app, ["gap", "s.h5", *given])
    assert isinstance(result.exception, ArmodalError)
    assert said in str(result.exception)
    assert (tmp_path / "own.toml").read_text() == "edited by hand"
