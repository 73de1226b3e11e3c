"""Hysteretic damping: a loss factor that hardly depends on frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
import numpy.typing as npt
import scipy
from pydantic import Field, model_validator

from armodal.hil_sim.effects.compared import told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin, Unlike
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.linear import LinearTerms, MaxwellElement
from armodal.hil_sim.truth import Interval, Positive
from armodal.protocols.arm.reference import STIFFNESS_AT_HZ

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = [
    "BAND_HZ",
    "ELEMENTS",
    "HIDES",
    "MOST_LOSS",
    "OF_FILE",
    "Hysteretic",
    "beside_a_spring",
    "loss_told",
]

Array = npt.NDArray[np.float64]

MOST_LOSS = 0.3  # loss factor: beyond it hardly a static spring is left beside the elements
BAND_HZ, ELEMENTS = (5.0, 200.0), 5  # in which five elements keep it within some per cent

HYSTERETIC_LOSS = 0.2


def relative_strengths(band_hz: tuple[float, float], n: int) -> tuple[Array, Array]:
    """Maxwell elements whose sum has a loss of 1 over a band.

    Returns
    -------
    rates_rad_s, strengths
        (n,) each: relaxation rates, evenly spaced in their logarithm from a third below to a
        third above the band, and stiffness of each element. The loss of an element is
        g w w_i / (w^2 + w_i^2); non-negative least squares over the band.
    """
    low, high = band_hz
    rates = 2.0 * np.pi * np.geomspace(low / 1.5, high * 1.5, n)
    w = 2.0 * np.pi * np.geomspace(low, high, 20 * n)
    loss = w[:, None] * rates / (w[:, None] ** 2 + rates**2)
    strengths, _ = scipy.optimize.nnls(loss, np.ones(len(w)))
    return rates, strengths


class Hysteretic(BaseEffect):
    """Joints (all that give way if none is named) with a constant loss factor over a band.

    Beside each joint's spring stand Maxwell elements. A causal material with a constant loss
    factor stiffens with frequency; the static spring is made softer, so that the stiffness equals
    the joint's own in the geometric middle of the band.
    """

    kind: Literal["hysteretic"]
    joints: Annotated[tuple[str, ...], Field(strict=False)] = ()
    loss_factor: Annotated[float, Field(gt=0.0, le=MOST_LOSS)]
    band_hz: Interval = BAND_HZ
    elements: Annotated[int, Field(ge=2, le=20)] = ELEMENTS
    replaces_viscous: bool = False
    reference_hz: Positive | None = None

    @model_validator(mode="after")
    def _has_band(self) -> Self:
        if not 0.0 < self.band_hz[0] < self.band_hz[1]:
            raise ValueError("band_hz must be [low, high] with 0 < low < high")
        return self

    def act(self, terms: LinearTerms) -> None:
        """Put Maxwell elements beside the joints' springs."""
        middle = self.reference_hz or float(np.sqrt(self.band_hz[0] * self.band_hz[1]))
        for name in self.joints or terms.springs:
            row = terms.stretch_of(name)
            k = terms.springs[name].k
            law = self.band_hz, self.elements
            beside_a_spring(terms, row, self.loss_factor * k, law, middle)
            if self.replaces_viscous:
                terms.C = terms.C - terms.springs[name].c * np.outer(row, row)


def beside_a_spring(
    terms: LinearTerms,
    row: Array,
    lossy: float,
    law: tuple[tuple[float, float], int],
    reference_hz: float,
) -> None:
    """Put Maxwell elements beside a spring, which keeps its stiffness at a frequency.

    Parameters
    ----------
    row
        (n,) by which it is stretched.
    lossy
        Loss factor times stiffness.
    law
        Band in Hz over which the factor is constant, and number of elements.
    """
    rates, strengths = relative_strengths(*law)
    w2 = (2.0 * np.pi * reference_hz) ** 2
    stored = float(np.sum(strengths * w2 / (w2 + rates**2)))
    terms.K = terms.K - lossy * stored * np.outer(row, row)
    terms.maxwell += [
        MaxwellElement(row=row, k=lossy * float(strength), rate_rad_s=float(rate))
        for rate, strength in zip(rates, strengths, strict=True)
    ]


def loss_told(factor: float) -> float:
    """Return the loss factor of a file's effect; refused where the laboratory has no such law."""
    if factor > MOST_LOSS:
        raise Unlike(f"loss factor beyond {MOST_LOSS:g}")
    return factor


def _of_file(own: FileEffect) -> Twin:
    names = [joint.name for joint in own.arm.joints]
    losses = {name: own.sizes.get(f"loss_{name}", 0.0) for name in names}
    tables = [
        {
            "kind": "hysteretic",
            "joints": (name,),
            "loss_factor": loss_told(loss),
            "reference_hz": STIFFNESS_AT_HZ,
        }
        for name, loss in losses.items()
        if loss > 0.0
    ]
    logarithms = {name: own.sizes.get(f"ln_c_{name}") for name in names}
    damping = {name: float(np.exp(ln_c)) for name, ln_c in logarithms.items() if ln_c is not None}
    return Twin(tables=tables, replaces=[("hysteretic", "")], damping=damping)


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Losses of the joints' drives that do not grow with frequency."""
    loss = float(HYSTERETIC_LOSS * magnitude * about(rng))
    table = {
        "kind": "hysteretic",
        "joints": tuple(places.elastic),
        "loss_factor": loss,
    }
    return hidden("hysteretic", places.elastic, table, loss_factor=loss)


OF_FILE = {"hysteretic": _of_file}
COMPARED = {"hysteretic": told("loss_factor")}
HIDES = {"hysteretic": Hides(hide=hide, since=1)}
