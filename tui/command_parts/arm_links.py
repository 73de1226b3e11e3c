"""The links of an arm as a table: mass, density over the hull, radii of gyration."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from rich.table import Table

from armodal.analyzer.own_arm.bodies import ArmBody

__all__ = ["link_rows", "link_table"]


def link_rows(bodies: Sequence[ArmBody], guessed: Collection[str]) -> list[dict[str, Any]]:
    """One row for the base and every moving body, as plain values."""
    rows = []
    for body in bodies:
        volume, inertial = body.seen.hull_filling.volume_m3, body.inertial
        row: dict[str, Any] = {
            "link": body.name,
            "size_m": body.seen.size_m,
            "hull_l": 1e3 * volume,
            "shape": "drawn" if body.drawn else "capsule",
            "inertial": "guessed" if body.name in guessed else "given",
            "mass_kg": None,
            "density_kg_m3": None,
            "gyration_m": None,
        }
        if inertial is None:
            row["inertial"] = "guessed" if body.name in guessed else "none"
        elif inertial.mass_kg > 0.0:
            moments = np.linalg.eigvalsh(inertial.inertia_kg_m2).clip(0.0)
            row |= {
                "mass_kg": inertial.mass_kg,
                "density_kg_m3": inertial.mass_kg / volume,
                "gyration_m": np.sqrt(moments / inertial.mass_kg).tolist(),
            }
        rows.append(row)
    return rows


def link_table(rows: Sequence[dict[str, Any]]) -> Table:
    """The rows for people."""
    table = Table(
        title="Links: mass over convex hull, largest radius of gyration, where the inertial is from"
    )
    for column in ("link", "size m", "hull l", "mass kg", "kg/m³", "gyration m", "inertial"):
        table.add_column(column, justify="left" if column in {"link", "inertial"} else "right")
    for row in rows:
        gyration = row["gyration_m"]
        table.add_row(
            row["link"],
            f"{row['size_m']:.3f}",
            f"{row['hull_l']:.3g}" + ("" if row["shape"] == "drawn" else " capsule"),
            "-" if row["mass_kg"] is None else f"{row['mass_kg']:.3g}",
            "-" if row["density_kg_m3"] is None else f"{row['density_kg_m3']:.0f}",
            "-" if gyration is None else f"{max(gyration):.3f}",
            row["inertial"],
        )
    return table
