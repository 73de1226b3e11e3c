"""`armodal shaper`: input shapers and notches for an arm's swings, robust over what is known."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from armodal.analyzer.acting.robust import (
    Candidate,
    ModeBox,
    candidates,
    mode_boxes,
    recommended,
)
from armodal.analyzer.acting.shaper_page import residual_figure, shaper_page, step_figure
from armodal.analyzer.corrected.posture_file import read_postures
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.protocols.text_file import replace_text
from armodal.tui.command_parts.options import ArmName, comma_numbers
from armodal.tui.console import Json, out, print_json, print_note
from armodal.tui.output_file import check_output

__all__ = ["app", "asked_postures"]

app = typer.Typer(add_completion=False)

PostureOption = Annotated[
    list[str] | None,
    typer.Option("--posture", help="Joint angles in degrees, separated by commas; repeatable."),
]
PathOption = Annotated[
    Path | None,
    typer.Option("--path", help="Text file: joint angles in degrees, one posture a line."),
]


def asked_postures(arm: Arm, posture: list[str] | None, path: Path | None) -> list[list[float]]:
    """Return the postures of options.

    Raises
    ------
    ArmError
        If there are none, or both options are given.
    """
    if (not posture) == (path is None):
        raise ArmError(
            "wanted postures by --posture or by --path, got "
            f"{'both' if posture else 'neither'}; give one, such as --posture=0,30,30,0,90,0"
        )
    if path is not None:
        return read_postures(path, len(arm.joints))
    return [comma_numbers(text, "--posture") for text in posture or ()]


def _json(own: Candidate) -> dict[str, Any]:
    found: dict[str, Any] = {
        "kind": own.kind,
        "residual": own.residual,
        "residual_by_mode": list(own.residual_by_mode),
        "duration_s": own.duration_s,
        "delay_s": own.delay_s,
    }
    if own.shaper is not None:
        found["amplitudes"] = own.shaper.amplitude.tolist()
        found["times_s"] = own.shaper.time_s.tolist()
    else:
        found["notches"] = [
            {
                "f_hz": n.f_hz,
                "zero_damping": n.zero_damping,
                "pole_damping": n.pole_damping,
            }
            for n in own.notches
        ]
    return found


def _tables(
    boxes: tuple[ModeBox, ...], every: tuple[Candidate, ...], best: Candidate
) -> list[Table]:
    modes = Table("mode", "f Hz", "damping %", title="What the modes may be (95 %, all postures)")
    for i, box in enumerate(boxes, start=1):
        low, high = box.damping_ratio
        modes.add_row(
            str(i),
            f"{box.f_hz[0]:.2f} to {box.f_hz[1]:.2f}",
            f"{100 * low:.2f} to {100 * high:.2f}",
        )
    table = Table("shaper", "left at most %", "longer by ms", "later by ms", "", title="Shapers")
    for own in every:
        table.add_row(
            own.kind,
            f"{100 * own.residual:.1f}",
            f"{1e3 * own.duration_s:.1f}",
            f"{1e3 * own.delay_s:.1f}",
            "take this" if own is best else "",
        )
    impulses = Table("time ms", "amplitude", title=f"{best.kind}: impulses")
    if best.shaper is not None:
        for t, a in zip(best.shaper.time_s, best.shaper.amplitude, strict=True):
            impulses.add_row(f"{1e3 * t:.3f}", f"{a:.5f}")
        return [modes, table, impulses]
    filters = Table("f Hz", "zero's damping", "pole's damping", title="notch: filters in a row")
    for n in best.notches:
        filters.add_row(f"{n.f_hz:.3f}", f"{n.zero_damping:.5f}", f"{n.pole_damping:.5f}")
    return [modes, table, filters]


@app.command("shaper")
def shaper_command(
    arm: ArmName,
    posture: PostureOption = None,
    path: PathOption = None,
    modes: Annotated[
        int, typer.Option(min=1, max=6, help="Number of modes to shape for, from the lowest.")
    ] = 1,
    limit: Annotated[
        float, typer.Option(min=0.0, max=100.0, help="Residual vibration allowed, %.")
    ] = 5.0,
    html: Annotated[Path | None, typer.Option(help="Page with the pictures to write.")] = None,
    as_json: Json = False,
) -> None:
    """Input shapers (ZV, MZV, EI, 2-hump) and notches for a set of postures or a path.

    Example: armodal shaper demo/demo.arm.toml --posture=0,30,30,0,90,0 --modes 2
    """
    the_arm = load_arm(arm)
    asked = asked_postures(the_arm, posture, path)
    if html is not None:
        check_output(html, *([] if path is None else [path]))
    boxes = mode_boxes(predict_arm(the_arm, asked), modes)
    every = candidates(boxes)
    best = recommended(every, limit / 100.0)
    notes = []
    if best.residual > limit / 100.0:
        notes.append(
            f"no shaper stays below {limit:g} %: the postures differ too much, or the arm is not "
            "known well enough; shape for fewer postures at a time, or measure it"
        )
    if html is not None:
        figures = [step_figure(boxes, best), residual_figure(boxes, every, limit / 100.0)]
        replace_text(html, shaper_page(the_arm.name, figures, notes))
    if as_json:
        rows = [{"f_hz": list(box.f_hz), "damping_ratio": list(box.damping_ratio)} for box in boxes]
        print_json(
            {
                "arm": the_arm.name,
                "postures": len(asked),
                "modes": rows,
                "shapers": [_json(own) for own in every],
                "recommended": best.kind,
                "notes": notes,
            }
        )
        return
    for table in _tables(boxes, every, best):
        out.print(table)
    for note in notes:
        print_note(note)
    if html is not None:
        out.print(f"page {html}")
    out.print("next: convolve the commanded path with these, and look at the residual vibration")
