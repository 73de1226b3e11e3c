"""A spring cylinder beside a joint that carries a part of the weight."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import model_validator

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.file_law import spring_of
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, plain
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import NotNegative, Part, Positive, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "GravityCompensator", "lever_arms"]

_EYE_M = 0.22  # of the shorter lever of a cylinder of the file; its stiffness goes with it

Array = npt.NDArray[np.float64]

COMPENSATOR = 0.35  # of the joint's stiffness, where the cylinder is square to its lever


def lever_arms(axis: Array, anchor: Array, eye: Array) -> tuple[float, float, float]:
    """Length of a cylinder, and its first and second derivative by the joint's angle.

    Both ends as seen from a point on the axis, about which the eye turns. With a and b their parts
    across the axis, L' = -a (axis x b) / L and L'' = (a b - L'^2) / L.
    """
    a = anchor - axis * (axis @ anchor)
    b = eye - axis * (axis @ eye)
    length = float(np.linalg.norm(eye - anchor))
    first = float(-a @ np.cross(axis, b)) / length
    second = (float(a @ b) - first**2) / length
    return length, first, second


class GravityCompensator(BaseEffect):
    """A cylinder from the link before a joint to the joint's link, with a spring inside.

    It pulls with `tension_n` at length `length_m` and when longer by a part of its stiffness more
    (`grows`: a spring by all of it), or with the same tension in every posture where no length is
    given (a gas cylinder on its supply, stiff only for quick motion). What its torque carries the
    drive does not; its stiffness about the joint, k L'^2 + F L'', changes with the posture.
    """

    kind: Literal["gravity_compensator"]
    joint: str
    anchor_m: Vector  # on the link before, from the joint, that link's axes
    eye_m: Vector  # on the joint's link, its frame
    tension_n: float
    length_m: Positive | None = None
    grows: Part = 1.0
    stiffness_n_per_m: NotNegative
    damping_n_s_per_m: NotNegative = 0.0

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if np.allclose(self.anchor_m, self.eye_m):
            raise ValueError("anchor_m and eye_m must differ")
        return self

    def act(self, terms: LinearTerms) -> None:
        """Add stiffness and damping about the joint, and take its torque from the drive."""
        i, body = terms.index(self.joint), terms.bodies[self.joint]
        R_before = terms.at.R[body - 1] if body else np.eye(3)
        length, first, second = lever_arms(
            terms.at.axis[body],
            R_before @ np.array(self.anchor_m),
            terms.at.R[body] @ np.array(self.eye_m),
        )
        tension = self.tension_n
        if self.length_m is not None:
            tension += self.grows * self.stiffness_n_per_m * (length - self.length_m)
        terms.K[i, i] += self.stiffness_n_per_m * first**2 + tension * second
        terms.C[i, i] += self.damping_n_s_per_m * first**2
        terms.load[self.joint] += tension * first


def _of_file(own: FileEffect) -> Twin:
    """A cylinder with one end at the joint's height.

    The file has its stiffness times the shorter lever squared, over the joint's; the levers' ratio
    and the angle between them while the joint stands at zero; how far apart the ends are along the
    axis; and how it is stretched at a right angle, and pulls more when longer.
    """
    joint = own.joint
    axis = own.turned[joint.link.name] @ np.asarray(joint.axis)
    ratio = float(np.exp(own.sizes["compensator_ln_ratio"]))
    angle = own.sizes["compensator_angle"]
    eye_m = _EYE_M / min(1.0, ratio)
    across = np.linalg.svd(axis[None])[2][1]
    turned = np.cos(angle) * across - np.sin(angle) * np.cross(axis, across)
    k = own.sizes["compensator_stiffness"] * spring_of(own) / _EYE_M**2
    aside = own.sizes.get("compensator_aside", 0.0)
    right_m = eye_m * float(np.sqrt(1.0 + ratio**2 + aside))
    table = {
        "kind": "gravity_compensator",
        "joint": joint.name,
        "anchor_m": tuple(ratio * eye_m * turned + np.sqrt(aside) * eye_m * axis),
        "eye_m": tuple(eye_m * across),
        "tension_n": k * own.sizes.get("compensator_stretch", 0.0) * right_m,
        "length_m": right_m,
        "grows": own.sizes.get("compensator_growth", 0.0),
        "stiffness_n_per_m": k,
        "damping_n_s_per_m": own.sizes.get("compensator_loss", 0.0) * k,
    }
    return Twin(tables=[table])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A gas cylinder beside the joint that lifts, as stiff as when its valve is shut."""
    joint = places.elastic[min(1, len(places.elastic) - 1)]
    link = places.joints[joint]
    k = link["stiffness_n_m_per_rad"]
    axis = np.array(link["axis"])
    reach = places.reach(link["name"])
    along = reach - axis * (axis @ reach)
    along /= np.linalg.norm(along)
    lever = 0.35 * float(np.linalg.norm(reach))
    square = np.cross(axis, along) * float(rng.choice([-1.0, 1.0]))
    stiffness = float(COMPENSATOR * k * magnitude * about(rng) / lever**2)
    anchor, eye = lever * 1.4 * (square - 0.3 * along), lever * along
    table = {
        "kind": "gravity_compensator",
        "joint": joint,
        "anchor_m": plain(anchor),
        "eye_m": plain(eye),
        "tension_n": float(rng.uniform(500.0, 1500.0)),
        "stiffness_n_per_m": stiffness,
        "damping_n_s_per_m": 1e-4 * stiffness,
    }
    return hidden(
        "gravity_compensator",
        joint,
        table,
        stiffness_n_per_m=stiffness,
        anchor_m=places.in_file(places.before(link["name"]), anchor),
        eye_m=places.in_file(link["name"], eye),
    )


def _where_square(true: TrueEffect) -> float:
    """Where it stands square to the shorter of its levers: at home the eye's."""
    p = true.parameters
    lever_m = p.get("shorter_lever_m", np.linalg.norm(p["eye_m"]))
    joint_n_m_per_rad = true.believed_n_m_per_rad[true.place]
    return float(p["stiffness_n_per_m"] * lever_m**2 / joint_n_m_per_rad)


OF_FILE = {"gravity_compensator": _of_file}
COMPARED = {"gravity_compensator": Compared(size=_where_square)}
HIDES = {"gravity_compensator": Hides(hide=hide, since=2, sized=True)}
