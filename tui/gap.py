"""`armodal gap`: the verdict as a table for people and an object for machines."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from rich.table import Table

from analyzer.gap.records import GapResult, PostureGap

__all__ = ["gap_json", "gap_tables"]


def gap_json(result: GapResult) -> dict[str, Any]:
    """The result as plain values."""
    found = asdict(result)
    found["verdict"] = result.verdict.value
    for effect in found["effects"]:
        effect["std"] = {name: value["std"] for name, value in effect["parameters"].items()}
    return found


def gap_tables(result: GapResult) -> list[Table]:
    """The result as tables, what matters first."""
    tables = []
    if result.effects:
        table = Table("effect", "place", "parameter", "value", "± std", "sure", title="Named")
        for effect in result.effects:
            for name, value in effect.parameters.items():
                table.add_row(
                    effect.title,
                    effect.place,
                    name,
                    f"{value.value:.4g}",
                    f"{value.std:.2g}",
                    f"{100 * effect.confidence:.0f} %",
                )
        tables.append(table)
    if result.rivals:
        table = Table("rival", "place", "gain", "behind", "stands", "matters", title="Rivals")
        for rival in result.rivals:
            table.add_row(
                rival.title,
                rival.place,
                f"{rival.gain:.1f}",
                f"{rival.behind:.1f}",
                "yes" if rival.standing else "",
                "yes" if rival.material else "no",
            )
        tables.append(table)
    table = Table("joint", "k N m/rad", "± std", "range", title="Stiffness over what stands")
    for row in result.joint_stiffness_ranges:
        table.add_row(
            row.joint,
            f"{row.k_n_m_per_rad:.0f}",
            f"{row.k_std:.0f}",
            f"{row.low:.0f} to {row.high:.0f}",
        )
    tables.append(table)
    tables.append(_gap_table(result.gap_before, result.gap_after))
    return tables


def _gap_table(before: tuple[PostureGap, ...], after: tuple[PostureGap, ...]) -> Table:
    table = Table("posture", "", "FRF before", "after", "floor", "frequency before", "after")
    table.title = "Gap"
    for old, new in zip(before, after, strict=True):
        table.add_row(
            old.posture,
            "held out" if old.held_out else "fitted",
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
