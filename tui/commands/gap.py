"""`armodal gap`: of a session, or with a laboratory on the line."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from armodal.analyzer.gap.add import is_of_one_posture
from armodal.analyzer.gap.decision.calibration import FALSE_NAME
from armodal.analyzer.gap.workflow import GapOutcome, find_gap
from armodal.analyzer.report import drawn_effects, gap_page
from armodal.hil_sim.study import (
    MAGNITUDES,
    STUDY_ARMS,
    CaseSpec,
    SealedCase,
    can_size,
    library,
    make_case,
    sealed,
    study_of,
)
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlanError, SessionError
from armodal.protocols.plan import load_plan
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.text_file import replace_text
from armodal.study.closed_loop import run_loop
from armodal.study.laboratory import SimulatedLaboratory
from armodal.tui.command_parts.gap_results import (
    check_arm_out,
    check_results,
    gap_json,
    gap_tables,
    keep_gap,
    with_arm,
)
from armodal.tui.command_parts.gap_simulator import show_simulator
from armodal.tui.command_parts.options import refuse_idle
from armodal.tui.command_parts.rehearsed import plan_to_rehearse
from armodal.tui.console import Json, out, print_json, print_note, say, say_next
from armodal.tui.output_file import check_output

__all__ = ["app"]

_DRAWN_FROM = 2  # version of the library of which the laboratory draws: a seed stays what it was

app = typer.Typer(add_completion=False)

# By parameter: what has a meaning only with a session, and only with --lab.
_OF_SESSION = ("more", "arm", "false_name")
_OF_LAB = ("lab_arm", "lab_plan", "hide", "magnitude", "seed", "budget", "folder")


@app.command("gap")
def gap_command(
    context: typer.Context,
    session: Annotated[Path | None, typer.Argument(help="Session file (.h5).")] = None,
    more: Annotated[
        list[Path] | None,
        typer.Option("--with", help="A further test of the same arm; repeatable."),
    ] = None,
    arm: Annotated[
        str | None,
        typer.Option("--arm", help="Arm file, or a shipped arm, instead of the session's own."),
    ] = None,
    arm_out: Annotated[
        Path | None,
        typer.Option("--arm-out", help="New arm file with the named effects; never overwritten."),
    ] = None,
    html: Annotated[Path | None, typer.Option("--html", help="Page to write.")] = None,
    lab: Annotated[
        bool, typer.Option("--lab", help="Drive the simulated laboratory, next tests included.")
    ] = False,
    lab_arm: Annotated[
        str, typer.Option(help="Arm of the laboratory: an arm file or a shipped arm.")
    ] = "bench57",
    lab_plan: Annotated[
        str | None,
        typer.Option(help="Plan of its test: fixed hammer, one validation posture."),
    ] = None,
    hide: Annotated[
        str | None, typer.Option(help="Effects it hides; drawn at random if not given.")
    ] = None,
    magnitude: Annotated[
        str, typer.Option(help="clear, medium, faint, or a part of clear: 0.3.")
    ] = "medium",
    seed: Annotated[int, typer.Option(min=0, help="Seed of the laboratory.")] = 1,
    budget: Annotated[int, typer.Option(min=0, help="Maximum number of further tests.")] = 2,
    simulator: Annotated[
        str | None,
        typer.Option(help="mujoco: the session's hits in your own simulator, before and after."),
    ] = None,
    model: Annotated[
        Path | None, typer.Option(help="With --simulator: your MJCF of the arm.")
    ] = None,
    motion: Annotated[
        Path | None,
        typer.Option(help="With --simulator: a log of motion (CSV, MCAP, rosbag) for the hits."),
    ] = None,
    topic: Annotated[
        list[str] | None,
        typer.Option(help="With --motion: ROLE=TOPIC, of encoder, command, a point; repeatable."),
    ] = None,
    false_name: Annotated[
        float,
        typer.Option(min=1e-4, max=0.5, help="Accepted probability of naming a wrong effect."),
    ] = FALSE_NAME,
    folder: Annotated[
        Path, typer.Option("--out", help="Folder for the laboratory's sessions; continued there.")
    ] = Path("gap-lab"),
    as_json: Json = False,
) -> None:
    """Find where model and measurement disagree, and name what is missing.

    The result is saved beside the session, where `armodal report` finds it; of the proposed next
    test `n` in `armodal review` makes a plan. With the new arm file as --arm and another as
    --arm-out it continues from there: nothing more should be missing. With --lab it drives the
    simulated laboratory and runs the tests it proposes.

    Example: armodal gap session.h5 --arm-out arm-with-axis.toml
    """
    if simulator is not None or model is not None or motion is not None or topic:
        refuse_idle(
            context,
            (*_OF_LAB, "more", "arm_out", "lab", "false_name"),
            here="--simulator",
            there="the search",
        )
        wanted = (session, arm, simulator, model, motion, topic or (), html)
        show_simulator(*wanted, as_json=as_json)
        return
    if lab == (session is not None):
        raise SessionError(
            "wanted either a session or --lab, got "
            f"{'both' if lab else 'neither'}; give one, such as `armodal gap demo/demo.h5`"
        )
    here, there = ("--lab", "a session") if lab else ("a session", "--lab")
    refuse_idle(context, _OF_SESSION if lab else _OF_LAB, here=here, there=there)
    check_arm_out(session, arm, arm_out)
    check_results(session, arm_out, html)
    read = [] if session is None else [session, *(more or ())]
    read += [] if arm is None else [Path(arm)]
    for path in (html, arm_out):
        if path is not None:
            check_output(path, *read)
    beside: dict[str, Any] = {}
    if session is None:
        (session, *more), outcome, beside = _with_laboratory(
            _case(lab_arm, lab_plan, hide, magnitude, seed), budget, folder
        )
        measured = read_session(session)
    else:
        measured = read_session(session)
        if arm is not None:
            measured = with_arm(measured, load_arm(arm))
        further = [read_session(path) for path in more or ()]
        outcome = find_gap(measured, more=further, false_name=false_name, tell=say)
    written = keep_gap(measured, session, outcome, arm_out, more or ())
    for effect in outcome.result.effects:
        if "arm_file" in written and is_of_one_posture(effect):
            say(f"{effect.title} ({effect.place}) is not in the arm file: no other session has it")
    if html is not None:
        replace_text(html, gap_page(outcome.result, session.name, _drawn(outcome)))
    if as_json:
        print_json(gap_json(outcome.result, written) | beside)
        return
    _print_result(outcome, beside)
    for key, path in written.items():
        out.print(f"{key} {path}")
    say_next(f"report {session}")


def _drawn(outcome: GapOutcome) -> str:
    """The arm with what was named, in the first posture."""
    effects = outcome.result.effects
    if not effects:
        return ""
    superset = outcome.final.hypothesis.ordinary.superset
    return drawn_effects(superset, outcome.stages[-1].lines[0].joints_rad, effects)


def _print_result(outcome: GapOutcome, beside: dict[str, Any]) -> None:
    result = outcome.result
    for test in beside.get("tests", ()):
        out.print(f"test {test['number']}: {test['words']}\n  {test['why']}")
    out.print(result.summary)
    out.print(f"where: {result.interface}")
    for table in gap_tables(result):
        out.print(table)
    for effect in result.effects:
        out.print(f"do now: {effect.remedy}")
    if result.next_test is not None:
        out.print(f"next test: {result.next_test.words}")
        out.print(f"  it {result.next_test.why}")
        if not beside:
            out.print("  `n` under Gap in `armodal review` plans it; give its session as --with")
    for note in result.notes:
        print_note(note)
    if beside:
        hidden = ", ".join(f"{e['name']} ({e['place']})" for e in beside["truth"]["effects"])
        out.print(f"in truth: {hidden or 'nothing was hidden'}")


def _case(arm: str, plan: str | None, hide: str | None, magnitude: str, seed: int) -> SealedCase:
    """Close a case of one of the study's arms, or of any other."""
    kind = hide or str(np.random.default_rng(seed).choice(library(_DRAWN_FROM)))
    size = _magnitude(magnitude)
    if arm in STUDY_ARMS and plan is None:
        return make_case(seed, arm, kind, size, ladder=True)
    the_arm = load_arm(arm)
    the_plan = plan_to_rehearse(the_arm) if plan is None else load_plan(plan, the_arm)
    if not can_size(the_plan):
        raise PlanError(
            f"plan {the_plan.name}: wanted a fixed hammer (roving-response) with a hit_direction "
            "in every posture and one posture for validation, got another; leave --lab-plan out, "
            "and the laboratory draws one"
        )
    spec = CaseSpec(
        number=1, arm=the_arm.name, seed=seed, kinds=(kind,), magnitude=size, ladder=True
    )
    return sealed(spec, study_of(the_arm, the_plan))


def _with_laboratory(
    case: SealedCase, budget: int, folder: Path
) -> tuple[tuple[Path, ...], GapOutcome, dict[str, Any]]:
    say(f"truth sealed as {case.truth_sha256}")
    loop = run_loop(SimulatedLaboratory(case=case), folder, budget=budget, tell=say)
    truth = json.loads(case.open_truth())
    beside = {
        "tests": list(loop.tests),
        "truth_sha256": case.truth_sha256,
        "truth": {"verdict": truth["verdict"], "effects": truth["effects"]},
    }
    return loop.sessions, loop.outcome, beside


def _magnitude(text: str) -> str | float:
    """A magnitude's name, or a part of clear: more than clear is past what some effects can be."""
    try:
        part = float(text)
    except ValueError:
        part = math.nan
    if text not in MAGNITUDES and not 0.0 < part <= 1.0:
        raise SessionError(
            f"--magnitude: wanted {', '.join(MAGNITUDES)}, or a number above 0 and at most 1 that "
            f"is times clear, got {text!r}; give one of these"
        )
    return text if text in MAGNITUDES else part
