"""A base plate that rocks and shifts on its floor."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from armodal.hil_sim.assembly import Assembly, Inertial, Segment, Spring
from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, loss_s
from armodal.hil_sim.effects.interface_loss import loss_of_file
from armodal.hil_sim.newton_euler import Body
from armodal.hil_sim.truth import Positive, Truth, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Base", "BaseSpring"]

_RADII_2_M2 = (
    0.01,
    0.01,
    0.015,
)  # of gyration, squared, where a file tells none: a plate of some 0.2 m

WAYS = ("shift_x", "shift_y", "shift_z", "rock_x", "rock_y", "rock_z")

ROCKING = 0.08  # of the arm's own joint compliance
SHIFT_M2 = 2.5e-3  # m / N per rad / N m


class BaseSpring(Truth):
    """One way for the base to move: along or about an axis of the base frame."""

    way: Literal["shift_x", "shift_y", "shift_z", "rock_x", "rock_y", "rock_z"]
    stiffness: Positive  # N / m or N m / rad
    damping: Annotated[float, Field(ge=0.0)]  # N s / m or N m s / rad


class Base(BaseEffect):
    """The base on springs, with its own mass; it rocks about lines through `pivot_m`.

    Test points on the base ride on it.
    """

    kind: Literal["base"]
    pivot_m: Vector
    mass_kg: Positive
    center_m: Vector
    inertia_kg_m2: Annotated[tuple[float, ...], Field(strict=False, min_length=6, max_length=6)]
    springs: Annotated[tuple[BaseSpring, ...], Field(strict=False, min_length=1)]

    @model_validator(mode="after")
    def _names_each_way_once(self) -> Self:
        ways = [spring.way for spring in self.springs]
        if len(set(ways)) != len(ways):
            raise ValueError("springs must name each way once")
        return self

    def assemble(self, assembly: Assembly) -> Assembly:
        """Put the base with its hinges before the first joint."""
        if "base" in assembly.carrier:
            return assembly
        xx, xy, xz, yy, yz, zz = self.inertia_kg_m2
        mass = Inertial(
            mass_kg=self.mass_kg,
            center_m=np.array(self.center_m),
            inertia_kg_m2=np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
        )
        segments: list[Segment] = []
        for spring in sorted(self.springs, key=lambda s: WAYS.index(s.way)):
            number = WAYS.index(spring.way)
            body = Body(
                name=f"base {spring.way}",
                origin_m=np.zeros(3),
                R_parent_body=np.eye(3),
                hinge_m=np.array(self.pivot_m),
                axis=np.eye(3)[number % 3],
                mass_kg=0.0,
                center_m=np.zeros(3),
                inertia_kg_m2=np.zeros((3, 3)),
                slides=number < 3,
            )
            segments.append(
                Segment(
                    label=body.name, body=body, spring=Spring(k=spring.stiffness, c=spring.damping)
                )
            )
        segments[-1] = segments[-1].loaded(mass)
        return replace(
            assembly,
            segments=(*segments, *assembly.segments),
            carrier={**assembly.carrier, "base": segments[-1].label},
        )


def _of_file(own: FileEffect) -> Twin:
    mass = max(own.sizes["mass"], 1e-3)
    radii_2_m2 = _RADII_2_M2
    if "radius" in own.sizes:  # of a disc; a body of none would have no inertia
        square = max(own.sizes["radius"], 1e-3) ** 2
        radii_2_m2 = (square / 4.0, square / 4.0, square / 2.0)
    xx, yy, zz = (mass * square for square in radii_2_m2)
    ways = [way for way in WAYS if own.sizes[way] > 0.0]
    table = {
        "kind": "base",
        "pivot_m": (0.0, 0.0, own.sizes.get("pivot", 0.0)),
        "mass_kg": mass,
        "center_m": tuple(own.sizes.get(of, 0.0) for of in ("aside_x", "aside_y", "height")),
        "inertia_kg_m2": (xx, 0.0, 0.0, yy, 0.0, zz),
        "springs": tuple(
            {
                "way": way,
                "stiffness": 1.0 / own.sizes[way],
                "damping": own.loss_s / own.sizes[way],
            }
            for way in ways
        ),
    }
    hinges = {f"base {way}": 1.0 / own.sizes[way] for way in ways}
    lossy = loss_of_file(own.sizes.get("loss_factor", 0.0), hinges)
    return Twin(tables=[table, *lossy], replaces=[("base", "")])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """The base rocks, and shifts in half of the cases."""
    rock = ROCKING * places.compliance * magnitude * np.array([about(rng), about(rng)])
    shift = SHIFT_M2 * rock * np.array([about(rng), about(rng)])
    ways = {f"rock_{axis}": 1.0 / c for axis, c in zip("xy", rock, strict=True)}
    if rng.random() < 0.5:
        ways |= {f"shift_{axis}": 1.0 / c for axis, c in zip("xy", shift, strict=True)}
    mass = float(rng.uniform(8.0, 25.0))
    lost = loss_s(rng)
    table = {
        "kind": "base",
        "pivot_m": (0.0, 0.0, float(rng.uniform(-0.05, 0.02))),
        "mass_kg": mass,
        "center_m": (0.0, 0.0, 0.08),
        "inertia_kg_m2": (0.015 * mass, 0.0, 0.0, 0.015 * mass, 0.0, 0.02 * mass),
        "springs": tuple(
            {"way": way, "stiffness": float(k), "damping": float(lost * k)}
            for way, k in ways.items()
        ),
    }
    units = {way: "n_m_per_rad" if way.startswith("rock") else "n_per_m" for way in ways}
    parameters = {f"{way}_{units[way]}": float(k) for way, k in ways.items()}
    return hidden("base", "base", table, base_mass_kg=mass, **parameters)


def _about_line_found(true: TrueEffect) -> float:
    """How soft it is about the level line that was found."""
    p = true.parameters
    cross = p.get("rock_xy_n_m_per_rad", 0.0)
    rocking = np.array([[p["rock_x_n_m_per_rad"], cross], [cross, p["rock_y_n_m_per_rad"]]])
    line = np.asarray(true.found.get("rock_x_about", (1.0, 0.0)), dtype=np.float64)[:2]
    return float(line @ np.linalg.solve(rocking, line))


OF_FILE = {"base": _of_file}
COMPARED = {"base": Compared(size=_about_line_found)}
HIDES = {"base": Hides(hide=hide, since=1)}
