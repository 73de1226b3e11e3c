"""What a link that bends and one that twists have in common: a line, cuts and a loss."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.compared import TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin, three
from armodal.hil_sim.effects.hidden import Hidden, about, hidden, loss_s, plain
from armodal.hil_sim.effects.interface_loss import loss_of_file
from armodal.hil_sim.pieces import slice_label, sliced
from armodal.hil_sim.truth import NotNegative, Positive, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["SlicedLink", "all_along", "slices_of_file", "yield_per_length"]

Array = npt.NDArray[np.float64]
Part = Annotated[float, Field(gt=0.0, lt=1.0)]

_CUTS_OF_FILE = 9  # of a file's link: they give the deflection of its tip to 0.3 %
CUTS = 8  # of a link: none where one of two to four points stands, and its tip is right to 0.4 %


class SlicedLink(BaseEffect):
    """A link as rigid pieces along a line, each hinged to the one before it.

    A stiffness per length is spread over n cuts, stiffness n / L each, in the middles of n equal
    lengths or where `cut_at` has them, parts of the length. The line may bow: a parabola whose
    middle stands `bow_m` beside that of its ends. `softness` tells how much of the whole yield each
    cut has, where not all have alike.
    """

    link: str
    from_m: Vector
    to_m: Vector
    bow_m: Vector = (0.0, 0.0, 0.0)
    cuts: Annotated[int, Field(ge=1, le=12)] = 3
    cut_at: tuple[Part, ...] = ()
    softness: tuple[Positive, ...] = ()
    loss: NotNegative  # damping / stiffness, s

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if np.allclose(self.from_m, self.to_m):
            raise ValueError("from_m and to_m must differ")
        if self.softness and len(self.softness) != self.cuts:
            raise ValueError(f"wanted a softness for each of {self.cuts} cuts")
        if self.cut_at and (len(self.cut_at) != self.cuts or (np.diff(self.cut_at) <= 0.0).any()):
            raise ValueError(f"wanted cut_at with {self.cuts} places, one beyond the other")
        return self

    @property
    def along(self) -> Array:
        """Return (3,) the unit vector of the line."""
        line = np.array(self.to_m) - np.array(self.from_m)
        return np.asarray(line / np.linalg.norm(line))

    def hinged(
        self,
        assembly: Assembly,
        stiffnesses_n_m2: tuple[float, ...],
        directions: tuple[Array, ...],
        word: str,
    ) -> Assembly:
        """Cut the link again and again, by a hinge along each direction, each with its own."""
        start, end = np.array(self.from_m), np.array(self.to_m)
        bow = np.array(self.bow_m)
        bow -= self.along * (self.along @ bow)
        whole_k = np.array(stiffnesses_n_m2) / float(np.linalg.norm(end - start))
        softness = np.array(self.softness or np.ones(self.cuts))
        each_k = np.outer(softness.sum() / softness, whole_k)
        springs = [[Spring(k=k, c=k * self.loss) for k in cut] for cut in each_k.tolist()]
        places = self.cut_at or (np.arange(self.cuts) + 0.5) / self.cuts
        cuts = list(zip(places, springs, strict=True))
        return sliced(assembly, self.link, (start, end, bow), directions, cuts, word)


def slices_of_file(
    own: FileEffect,
    kind: str,
    stiffness: str,
    word: str,
    softer: tuple[float, ...] = (1.0,),
    **more: object,
) -> Twin:
    """A link that bends or twists along its line; where none is told, along that to the next joint.

    `stretch` is the part of the line that is soft, `place` about where (all of it has none), and
    `taper` ln of softness at the stretch's end over that at its start, `middle` that at its middle
    over that of both ends. Each cut has hinges of `word`, so much `softer` than the told stiffness
    each; `more` stands in the table.
    """
    names = [joint.link.name for joint in own.arm.joints]
    link, told = own.effect.place, own.effect.description
    at = names.index(link)
    if "from_m" in told:
        start, end = three(told["from_m"]), three(told["to_m"])
    elif at + 1 == len(names):
        raise KeyError("a joint behind it")
    else:
        start, end = np.zeros(3), np.asarray(own.arm.joints[at + 1].T_parent_joint[:3, 3])
    place, stretch, taper, middle = (
        own.sizes.get(f"{kind}_{name}", otherwise)
        for name, otherwise in (("place", 0.5), ("stretch", 1.0), ("taper", 0.0), ("middle", 0.0))
    )
    along = (np.arange(_CUTS_OF_FILE) + 0.5) / _CUTS_OF_FILE
    cut_at = 0.5 + (1.0 - stretch) * (place - 0.5) + stretch * (along - 0.5)
    softness = np.exp(taper * along + middle * np.minimum(2.0 * along, 2.0 - 2.0 * along))
    table = {
        "kind": kind,
        "link": link,
        "from_m": tuple(own.turned[link] @ start),
        "to_m": tuple(own.turned[link] @ end),
        "bow_m": tuple(own.turned[link] @ three(told.get("bow_m", (0.0, 0.0, 0.0)))),
        "cuts": _CUTS_OF_FILE,
        "cut_at": tuple(cut_at.tolist()),
        "softness": tuple(softness.tolist()),
        "loss": own.sizes.get(f"{kind}_loss", 0.0),
        stiffness: 1.0 / own.sizes[f"{kind}_compliance"],
        **more,
    }
    whole_k = 1.0 / (own.sizes[f"{kind}_compliance"] * float(np.linalg.norm(end - start)))
    hinges = {
        slice_label(word, i, way, link): float(whole_k * softness.sum() / soft / by)
        for i, soft in enumerate(softness, 1)
        for way, by in enumerate(softer, 1)
    }
    lossy = loss_of_file(own.sizes.get(f"{kind}_loss_factor", 0.0), hinges)
    return Twin(tables=[table, *lossy])


def all_along(
    kind: str, key: str, part: float, places: ArmPlaces, rng: np.random.Generator
) -> Hidden:
    """A long link whose whole compliance is a part of the arm's own."""
    link = _long_link(places, rng)
    start, end = places.tube(link)
    stiffness = float(np.linalg.norm(end - start) / (part * places.compliance * about(rng)))
    table = {
        "kind": kind,
        "link": link,
        "from_m": plain(start),
        "to_m": plain(end),
        "cuts": CUTS,
        key: stiffness,
        "loss": loss_s(rng),
    }
    return hidden(f"link_{kind}", link, table, **{key: stiffness})


def yield_per_length(stiffness: str, true: TrueEffect) -> float:
    """Return 1/(N m2); of one hinge by the length of the line found, which has both sides' turn."""
    p = true.parameters
    if not true.found or "hinge_n_m_per_rad" not in p:
        return float(1.0 / p[stiffness])
    start, end = (np.asarray(true.found[at], dtype=np.float64) for at in ("from_m", "to_m"))
    return float(1.0 / (p["hinge_n_m_per_rad"] * np.linalg.norm(end - start)))


def _long_link(places: ArmPlaces, rng: np.random.Generator) -> str:
    """One of the two links that are most longer than wide."""
    return str(rng.choice(sorted(places.structural(), key=places.longer_than_wide)[-2:]))
