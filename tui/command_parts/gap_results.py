"""`armodal gap`: the verdict as a table for people and an object for machines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from armodal.analyzer.arm.same_parts import check_same_parts
from armodal.analyzer.corrected.to_file import arm_with, filed
from armodal.analyzer.gap.add import added_effects, joint_estimates
from armodal.analyzer.gap.records import (
    EffectFound,
    GapResult,
    Hidden,
    PostureGap,
    RivalRow,
    Verdict,
)
from armodal.analyzer.gap.workflow import GapOutcome
from armodal.analyzer.report import gap_path, gap_to_json
from armodal.analyzer.report.effect_words import (
    certainty,
    chance,
    effect_sentence,
    hidden_in_words,
    mechanics_of,
    weight,
)
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm, PastSession
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmError, SessionError
from armodal.protocols.session.records import Session
from armodal.protocols.text_file import replace_text
from armodal.tui.command_parts.narrow_table import narrow_table

_BY = "armodal gap"  # in the history of arm files

__all__ = ["check_arm_out", "check_results", "gap_json", "gap_tables", "keep_gap", "with_arm"]


def check_arm_out(session_path: Path | None, arm: str | None, arm_out: Path | None) -> None:
    """Refuse, before the work, an arm file that `keep_gap` must not replace.

    Parameters
    ----------
    session_path
        None for a laboratory's, whose arm is never a file.
    arm
        Path of the arm file that is read, or a shipped arm's name; None for the session's own.
    arm_out
        What the user named; None for the file beside the session.

    Raises
    ------
    ArmError
        If `arm_out` is there already, or the file beside the session is `arm`, by whatever name.
    """
    if arm_out is not None:
        if arm_out.exists():
            raise ArmError(f"{arm_out} is there already; give --arm-out another name")
        return
    if session_path is None or arm is None:
        return
    path, read = _beside(session_path), Path(arm)
    if path.exists() and read.exists() and path.samefile(read):
        raise ArmError(
            f"wanted another arm file to write than --arm, got {path} for both; it is left as it "
            "is: name the file to write with --arm-out"
        )


def check_results(session_path: Path | None, arm_out: Path | None, html: Path | None) -> None:
    """Refuse, before the work, to write one result over another.

    Raises
    ------
    SessionError
        If the page, the arm file and the result beside the session are not three files.
    """
    if session_path is None:
        results = {"the arm file": arm_out}
    else:
        results = {
            f"the result beside {session_path.name}": gap_path(session_path),
            "the arm file": arm_out or _beside(session_path),
        }
    for option, other in (("--html", html), ("--arm-out", arm_out)):
        for what, path in results.items():
            if path is None or other is None or (option, what) == ("--arm-out", "the arm file"):
                continue
            if path.resolve() == other.resolve():
                raise SessionError(
                    f"wanted another file for {option} than {what}, got {other} for both; give "
                    f"{option} another name"
                )


def _beside(session_path: Path) -> Path:
    """Where a new arm file goes: not over one of that name that is no result of this command."""
    path = session_path.with_suffix(".arm.toml")
    if not path.exists() or _is_result(path):
        return path
    return session_path.with_suffix(".corrected.arm.toml")


def _is_result(path: Path) -> bool:
    """Whether an arm file was last changed by a gap analysis."""
    try:
        history = load_arm(path).history
    except ArmError:
        return False
    return bool(history) and history[-1].by == _BY


def keep_gap(
    session: Session,
    session_path: Path,
    outcome: GapOutcome,
    arm_out: Path | None,
    more: Sequence[Path] = (),
) -> dict[str, Path]:
    """Write the result beside the session and, if the verdict is a name, a new arm file.

    `more` are files of further tests: the arm file remembers those that were fitted to.

    Returns
    -------
    what was written, by key: `result`, `arm_file`

    Raises
    ------
    ArmError
        If the arm file is there already.
    SessionError
        If a file cannot be written.
    """
    written = {"result": gap_path(session_path)}
    replace_text(written["result"], gap_to_json(outcome.result))
    if outcome.result.verdict is Verdict.NAMED:
        path = arm_out or _beside(session_path)
        arm = session.header.arm
        if arm_out is not None and path.exists():
            raise ArmError(f"{path} is there already; give --arm-out another name")
        given = (session_path, *more)
        digests = [sha256(given[n - 1].read_bytes()).hexdigest() for n in outcome.sessions]
        digest = digests[0]
        now = datetime.now(UTC).isoformat(timespec="seconds")
        # What the arm file had before stays, unless it no longer earned its place.
        earning = {
            (i.effect.name, i.place or "whole arm") for i in outcome.final.hypothesis.instances
        }
        added = added_effects(outcome.result, session_sha256=digest, created=now)
        known = {(e.name, e.place) for e in added}
        before = [e for e in arm.effects if (e.name, e.place) in earning - known]
        source = f"armodal gap, session {digest[:12]}"
        stiffness = joint_estimates(outcome.result, source)
        named = arm_with(arm, (*before, *added), stiffness)
        top_hz = float(outcome.stages[-1].lines[0].s_rad_s[-1].imag) / (2.0 * np.pi)
        values = filed(outcome.final, named, known, source, top_hz=top_hz)
        text = text_with_effects(
            arm,
            values.effects,
            stiffness=values.stiffness,
            damping=values.damping,
            past=[PastSession(session_sha256=d, by=_BY, created=now) for d in digests],
        )
        replace_text(path, text)
        written["arm_file"] = path
    return written


def with_arm(session: Session, arm: Arm) -> Session:
    """Return the session with another belief about its arm: the same joints and points.

    Raises
    ------
    ArmError
        If joints, links or points are not those that were measured.
    """
    check_same_parts(session.header.arm, arm)
    return replace(session, header=replace(session.header, arm=arm))


def gap_json(result: GapResult, written: Mapping[str, Path]) -> dict[str, Any]:
    """The result as plain values, and the files of `keep_gap`; no arm file is null."""
    found = asdict(result)
    found["verdict"] = result.verdict.value
    for row in (*found["effects"], *found["rivals"]):
        intervals = row.pop("parameters")
        row["parameters"] = {name: value["value"] for name, value in intervals.items()}
        row["units"] = {name: value["unit"] for name, value in intervals.items()}
        row["std"] = {name: value["std"] for name, value in intervals.items()}
        row["interval_95"] = {name: [v["low"], v["high"]] for name, v in intervals.items()}
    files = {"arm_file": None, **{key: str(path) for key, path in written.items()}}
    return found | files


def gap_tables(result: GapResult) -> list[RenderableType]:
    """The result for people, what matters first; what has long words is a list and no table."""
    parts: list[RenderableType] = [_effect_lines(effect) for effect in result.effects]
    if result.rivals:
        parts.append(_rival_lines(result.rivals))
    table = narrow_table(
        "Stiffness over what stands", ("joint", "  k N m/rad", "  ± std", "  range")
    )
    for row in result.joint_stiffness_ranges:
        table.add_row(
            row.joint,
            f"{row.k_n_m_per_rad:.0f}",
            f"{row.k_std:.0f}",
            f"  {row.low:.0f} to {row.high:.0f}",
        )
    parts += [table, _gap_table(result.gap_before, result.gap_after)]
    if result.hidden and not result.effects:
        parts.append(_hidden_lines(result.hidden))
    return parts


def _hidden_lines(hidden: Sequence[Hidden]) -> Text:
    """How large what was not found could be: of each effect the place where most could hide."""
    lines = ["What could hide (95 %), where most of each could; all places are in the report:"]
    of_a_kind: dict[tuple[str, str], Hidden] = {}
    for row in sorted(hidden, key=lambda row: row.largest):
        of_a_kind[row.title or row.name, row.unit] = row
    for (title, _), most in sorted(of_a_kind.items()):
        name, size = hidden_in_words(most.parameter, most.largest, most.unit)
        place = f" ({most.place})" if most.place else ""
        lines.append(f"  {title}{place}: {most.words or name} {size}")
    return Text("\n".join([*lines, ""]))


def _effect_lines(effect: EffectFound) -> Text:
    """What was named, in the words of mechanics."""
    lines = [effect_sentence(effect), f"  certainty {certainty(effect.confidence)}"]
    lines += [f"  by chance {chance(effect.false_name_probability)}"]
    lines += [f"  {what}: {words}" for what, words in mechanics_of(effect)]
    return Text("\n".join([*lines, ""]))


def _rival_lines(rivals: Sequence[RivalRow]) -> Text:
    """Rivals of the last step, best first."""
    lines = ["Last round (how often chance looks as clear; weight over the first):"]
    for rival in rivals:
        stands = "stands" if rival.standing else "does not stand"
        size = "" if rival.material else ", not told to be large enough"
        lines.append(
            f"  {rival.title} ({rival.place}): by chance {chance(rival.false_name_probability)}, "
            f"weight {weight(rival.odds)}; {stands}{size}"
        )
    return Text("\n".join([*lines, ""]))


def _gap_table(before: tuple[PostureGap, ...], after: tuple[PostureGap, ...]) -> Table:
    table = narrow_table(
        "Gap: FRF error, and the worst frequency, before and after",
        ("posture", "", "  before", "  after", "  expected", "  f before", "  f after"),
    )
    table.caption = (
        "expected: what scatter and a right model's allowance would leave; an error after that "
        "is far above it says that something is still missing"
    )
    for old, new in zip(before, after, strict=True):
        table.add_row(
            old.posture,
            "  not fitted" if old.held_out else "  fitted",
            f"{100 * old.frf_error:.2f} %",
            f"{100 * new.frf_error:.2f} %",
            f"{100 * new.floor:.2f} %",
            _worst_frequency(old),
            _worst_frequency(new),
        )
    return table


def _worst_frequency(gap: PostureGap) -> str:
    errors = [abs(m.model_hz / m.measured_hz - 1.0) for m in gap.modes]
    return f"{100 * max(errors):.2f} %" if errors else "-"
