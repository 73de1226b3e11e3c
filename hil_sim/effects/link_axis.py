"""A compliance axis inside a link, in any direction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, loss_s, plain, unit
from armodal.hil_sim.effects.interface_loss import loss_of_file
from armodal.hil_sim.truth import NotNegative, Positive, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "LinkAxis"]

AXIS = 0.38  # of the arm's own joint compliance


class LinkAxis(BaseEffect):
    """One hinge anywhere in a link; a part of its mass and some points may lie before it."""

    kind: Literal["link_axis"]
    link: str
    point_m: Vector
    direction: Vector
    stiffness_n_m_per_rad: Positive
    damping_n_m_s_per_rad: NotNegative
    mass_before: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0  # part of the link's mass
    points_before: Annotated[tuple[str, ...], Field(strict=False)] = ()
    name: str = ""  # of the hinge

    @model_validator(mode="after")
    def _has_direction(self) -> Self:
        if np.linalg.norm(self.direction) == 0.0:
            raise ValueError("direction must not be zero")
        return self

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link."""
        near = assembly.carrier_of(self.link)
        mass = near.inertial()
        return assembly.split(
            near.label,
            self.name or f"axis in {self.link}",
            hinge_m=np.array(self.point_m),
            axis=np.array(self.direction),
            spring=Spring(k=self.stiffness_n_m_per_rad, c=self.damping_n_m_s_per_rad),
            before=mass.share(self.mass_before),
            after=mass.share(1.0 - self.mass_before),
            points_before=self.points_before,
        )


def _of_file(own: FileEffect) -> Twin:
    told = own.effect.description
    link = str(told["link"])
    before = str(told.get("points_before", "")).split()
    point, direction = own.line()
    table = {
        "kind": "link_axis",
        "link": link,
        "name": f"axis of the file in {link}",
        "direction": tuple(direction),
        "point_m": tuple(point),
        "mass_before": own.sizes.get("axis_mass_before", 0.0) if before else 0.0,
        "points_before": tuple(before),
    }
    spring = own.spring("axis_compliance", "axis_loss")
    hinge = {str(table["name"]): spring["stiffness_n_m_per_rad"]}
    lossy = loss_of_file(own.sizes.get("axis_loss_factor", 0.0), hinge)
    return Twin(tables=[table | spring, *lossy])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """An axis in any direction, sometimes with a part of the link before it."""
    link = str(rng.choice(places.structural()))
    point, direction = places.somewhere(rng, link), unit(rng)
    k = 1.0 / (AXIS * places.compliance * magnitude * about(rng))
    near: tuple[str, ...] = ()
    table = {
        "kind": "link_axis",
        "link": link,
        "point_m": plain(point),
        "direction": plain(direction),
        "stiffness_n_m_per_rad": k,
        "damping_n_m_s_per_rad": loss_s(rng) * k,
    }
    if rng.random() < 0.3 and len(places.points[link]) > 2:
        nearest = min(places.points[link], key=lambda p: float(np.linalg.norm(p["position_m"])))
        near = (nearest["id"],)
        table |= {"mass_before": 0.25, "points_before": near}
    return hidden(
        "link_axis",
        link,
        table,
        compliance_rad_per_n_m=1.0 / k,
        point_m=places.in_file(link, point),
        direction=places.in_file(link, direction),
        points_before=list(near),
        mass_before=0.25 if near else 0.0,
    )


def _compliance(true: TrueEffect) -> float:
    return float(true.parameters["compliance_rad_per_n_m"])


def _described(true: TrueEffect) -> Mapping[str, object]:
    p = true.parameters
    line = {key: tuple(p[key]) for key in ("direction", "point_m")}
    return {"link": true.place, **line, "points_before": " ".join(p.get("points_before", ()))}


OF_FILE = {"link_axis": _of_file}
COMPARED = {"link_axis": Compared(size=_compliance, described=_described)}
HIDES = {"link_axis": Hides(hide=hide, since=1, sized=True)}
