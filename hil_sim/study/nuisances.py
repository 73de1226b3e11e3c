"""What a careful analyst leaves uncertain in an arm, each with its deviation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from armodal.hil_sim.study.model_error import Tables

__all__ = ["WIDEST", "Nuisance", "nuisances"]

WIDEST = 3.0  # deviations that a nuisance with a prior may go
STIFFNESS, DAMPING = 0.3, 0.4  # of the logarithm; so wide that they bind nothing
MASS, CENTER_M, INERTIA = 0.05, 0.003, 0.06
ENCODER_DEG = 0.15


@dataclass(frozen=True, slots=True)
class Nuisance:
    """`apply` gives the tables with the nuisance at a value in deviations; `bound` its largest."""

    apply: Callable[[Tables, float], Tables]
    bound: float


def nuisances(tables: Tables) -> list[Nuisance]:
    """Springs, dampers, bodies, weak bearings, encoders and losses, one after the other."""
    return [*_of_links(tables), *_of_effects(tables)]


def _of_links(tables: Tables) -> Iterator[Nuisance]:
    for i, link in enumerate(tables["links"]):
        if link["stiffness_n_m_per_rad"] is not None:
            yield Nuisance(_scaled(i, "stiffness_n_m_per_rad", STIFFNESS), np.inf)
            yield Nuisance(_scaled(i, "damping_n_m_s_per_rad", DAMPING), np.inf)
        yield Nuisance(_scaled(i, "mass_kg", MASS), WIDEST)
        yield Nuisance(_scaled(i, "inertia_kg_m2", INERTIA), WIDEST)
        for axis in range(3):
            yield Nuisance(_shifted(i, axis), WIDEST)


def _of_effects(tables: Tables) -> Iterator[Nuisance]:
    for i, effect in enumerate(tables["effects"]):
        if effect["kind"] == "bearing":
            for way in range(2):
                yield Nuisance(_looser(i, way), WIDEST)
        elif effect["kind"] == "encoder_offset":
            yield Nuisance(_added(i, "offset_deg", ENCODER_DEG), WIDEST)
        elif effect["kind"] == "hysteretic":
            yield Nuisance(_added(i, "loss_factor", 0.5 * effect["loss_factor"]), 1.9)


def _scaled(number: int, key: str, deviation: float) -> Callable[[Tables, float], Tables]:
    def apply(tables: Tables, value: float) -> Tables:
        factor = float(np.exp(deviation * value))
        old = tables["links"][number][key]
        new = tuple(factor * v for v in old) if isinstance(old, tuple) else factor * old
        return _changed(tables, "links", number, key, new)

    return apply


def _shifted(number: int, axis: int) -> Callable[[Tables, float], Tables]:
    def apply(tables: Tables, value: float) -> Tables:
        center = np.array(tables["links"][number]["center_m"])
        center[axis] += CENTER_M * value
        return _changed(tables, "links", number, "center_m", tuple(center.tolist()))

    return apply


def _looser(number: int, way: int) -> Callable[[Tables, float], Tables]:
    """A deviation doubles the compliance; none is left of it below minus one."""

    def apply(tables: Tables, value: float) -> Tables:
        k = np.array(tables["effects"][number]["stiffness_n_m_per_rad"])
        k[way] /= max(1.0 + value, 0.05)
        return _changed(tables, "effects", number, "stiffness_n_m_per_rad", tuple(k.tolist()))

    return apply


def _added(number: int, key: str, deviation: float) -> Callable[[Tables, float], Tables]:
    def apply(tables: Tables, value: float) -> Tables:
        new = tables["effects"][number][key] + deviation * value
        return _changed(tables, "effects", number, key, new)

    return apply


def _changed(tables: Tables, part: str, number: int, key: str, value: Any) -> Tables:
    rows = list(tables[part])
    rows[number] = rows[number] | {key: value}
    return tables | {part: rows}
