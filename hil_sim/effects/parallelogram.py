"""A bar beside a link that makes a parallelogram with it: outside the library."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Self

import numpy as np
from pydantic import model_validator

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, loss_s, plain, unit
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.newton_euler import point_jacobian
from armodal.hil_sim.truth import NotNegative, Positive, Vector
from armodal.protocols.errors import PlantError

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["HIDES", "Parallelogram"]

BAR = 0.6  # of the far joint's stiffness, where bar and tail are square


class Parallelogram(BaseEffect):
    """A springy bar from a crank beside `joint` to a tail of the link beyond the joint after it.

    The crank is held by a drive so that it always lies along the tail: the bar stays parallel to
    the link between both joints. It resists the turn of the far link against the link that
    carries `joint`, the more the nearer tail and bar are to a right angle. Half of its mass swings
    with the tail.
    """

    kind: Literal["parallelogram"]
    joint: str
    joint_after: str
    tail_m: Vector  # from the joint after, far link's frame
    stiffness_n_per_m: Positive
    damping_n_s_per_m: NotNegative
    mass_kg: NotNegative = 0.0

    @model_validator(mode="after")
    def _has_tail(self) -> Self:
        if np.linalg.norm(self.tail_m) == 0.0:
            raise ValueError("tail_m must not be zero")
        return self

    def act(self, terms: LinearTerms) -> None:
        """Add the bar's spring along its line, and its mass."""
        near, far = terms.bodies[self.joint], terms.bodies[self.joint_after]
        if near >= far:
            raise PlantError(
                f"effects: {self.joint_after!r} must come after {self.joint!r}; exchange them"
            )
        tail = terms.at.R[far] @ np.array(self.tail_m)
        foot, head = terms.at.hinge_m[near], terms.at.hinge_m[far]
        along = (head - foot) / np.linalg.norm(head - foot)
        v_tail = terms.full(point_jacobian(terms.at, far, head + tail))[:3]
        v_crank = np.zeros_like(v_tail)
        if near > 0:
            v_crank = terms.full(point_jacobian(terms.at, near - 1, foot + tail))[:3]
        row = along @ (v_tail - v_crank)
        terms.spring(row[None, :], self.stiffness_n_per_m, self.damping_n_s_per_m)
        terms.M = terms.M + 0.5 * self.mass_kg * v_tail.T @ v_tail


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A bar beside the second link, from a crank to the third link's tail."""
    near, far = places.elastic[1:3]
    axis = np.array(places.joints[far]["axis"])
    tail = np.cross(axis, unit(rng))
    tail *= 0.1 / np.linalg.norm(tail)
    k = places.joints[far]["stiffness_n_m_per_rad"] * BAR * magnitude * about(rng) / 0.1**2
    table = {
        "kind": "parallelogram",
        "joint": near,
        "joint_after": far,
        "tail_m": plain(tail),
        "stiffness_n_per_m": float(k),
        "damping_n_s_per_m": float(loss_s(rng) * k),
        "mass_kg": float(rng.uniform(0.5, 1.5)),
    }
    place = [near, far]
    return hidden("parallelogram_bar", place, table, stiffness_n_per_m=float(k))


HIDES = {"parallelogram_bar": Hides(hide=hide, since=0, sized=True)}
