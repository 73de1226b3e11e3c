"""What an identification says, as tables with the range and the method beside each value."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from armodal.protocols.printable import printable
from armodal.tui.fitting_table import FittingTable

__all__ = ["identification_view"]

_WHOLE, _ONE = "all FRFs", "one mode"
_METHODS = (
    "all FRFs: the whole arm fitted to every line; one mode: one joint alone beside it\n"
    "± model: one deviation of what the model leaves open; the range holds it"
)


def identification_view(found: dict[str, Any]) -> RenderableType:
    """Tables of the object `armodal identify --json` prints."""
    parts: list[RenderableType] = [_joints(found["joints"])]
    if found["structural"]:
        parts.append(_axes(found["structural"]))
    if found["validation"]:
        parts.append(_validation(found["validation"]))
    notes = [*found.get("notes", ()), *found.get("warnings", ())]
    if notes:
        parts.append(Text("\n".join(f"note: {printable(str(note), keep='')}" for note in notes)))
    return Group(*parts)


def _table(*columns: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, expand=False, padding=(0, 1), pad_edge=False)
    for column in columns:
        table.add_column(column, justify="left" if column == "method" else "right", no_wrap=True)
    return table


def _titled(title: str, table: Table, below: str = "") -> RenderableType:
    parts: list[RenderableType] = [Text(title, style="bold"), FittingTable(table)]
    return Group(*parts, Text(below + "\n", style="italic")) if below else Group(*parts)


def _joints(rows: list[dict[str, Any]]) -> RenderableType:
    table = _table("joint", "k", "95 % range", "± model", "c", "method")
    for row in rows:
        k, half = row["k_n_m_per_rad"], row["k_half_width_95"]
        table.add_row(
            Text(row["joint"]),
            f"{k:.0f}",
            f"{k - half:.0f} to {k + half:.0f}",
            f"{row['k_std_model']:.0f}",
            f"{row['c_n_m_s_per_rad']:.2f}±{row['c_std']:.2f}",
            _WHOLE,
        )
        one = row["k_one_joint_n_m_per_rad"]
        table.add_row("", "none" if one is None else f"{one:.0f}", "", "", "", _ONE)
    return _titled(
        "Joint stiffness k in N m/rad, damping c in N m s/rad",
        table,
        _METHODS,
    )


def _axes(rows: list[dict[str, Any]]) -> RenderableType:
    table = _table("link", "k", "95 % range", "direction", "point mm")
    for row in rows:
        k, half = row["k_n_m_per_rad"], row["k_half_width_95"]
        table.add_row(
            Text(row["link"]),
            f"{k:.0f}",
            f"{k - half:.0f} to {k + half:.0f}",
            " ".join(f"{value:+.2f}" for value in row["direction_link"]),
            " ".join(f"{1e3 * value:.0f}" for value in row["point_link_m"]),
        )
    return _titled("Structural axes, in the link's frame", table)


def _validation(rows: list[dict[str, Any]]) -> RenderableType:
    table = _table("posture", "mode", "predicted Hz", "measured Hz", "error %")
    for row in rows:
        measured = row["measured_hz"]
        table.add_row(
            Text(row["posture"]),
            str(row["mode"]),
            f"{row['predicted_hz']:.2f} ± {row['predicted_std_hz']:.2f}",
            "not found" if measured is None else f"{measured:.2f}",
            "-" if measured is None else f"{100 * (row['predicted_hz'] / measured - 1):+.2f}",
        )
    return _titled("Validation postures: predicted, then measured", table)
