"""Two joints that pull on each other, as a wrist's belts and cables do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.linear import LinearTerms
from armodal.protocols.errors import PlantError

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Coupling"]

COUPLING = 0.4  # of the geometric mean of both stiffnesses


class Coupling(BaseEffect):
    """A stiffness between two joints' turns beside their own, and a damping likewise.

    Torques are K q with the joints' own stiffness on the diagonal and `cross` beside it.
    """

    kind: Literal["coupling"]
    joints: Annotated[tuple[str, str], Field(strict=False)]
    cross_stiffness_n_m_per_rad: float
    cross_damping_n_m_s_per_rad: float = 0.0

    def act(self, terms: LinearTerms) -> None:
        """Add the terms beside the diagonal.

        Raises
        ------
        PlantError
            If the springs would push instead of pull.
        """
        i, j = (terms.index(name) for name in self.joints)
        both = np.ix_((i, j), (i, j))
        flip = np.array([[0.0, 1.0], [1.0, 0.0]])
        terms.K[both] += self.cross_stiffness_n_m_per_rad * flip
        terms.C[both] += self.cross_damping_n_m_s_per_rad * flip
        for name, matrix in (("stiffness", terms.K[both]), ("damping", terms.C[both])):
            if i == j or np.linalg.eigvalsh(matrix)[0] < 0.0:
                raise PlantError(
                    f"effects: the cross {name} of {self.joints[0]} and {self.joints[1]} must be "
                    "between two joints and smaller than the geometric mean of their own; "
                    "correct the plant file"
                )


def _of_file(own: FileEffect) -> Twin:
    """Its sizes are parts of the geometric mean of both joints' springs and dampers in the file."""
    k, c = (
        float(np.sqrt(np.prod([1.0 if e is None else e.value for e in pair])))
        for pair in zip(*((j.stiffness, j.damping) for j in own.joints), strict=True)
    )
    table = {
        "kind": "coupling",
        "joints": tuple(joint.name for joint in own.joints),
        "cross_stiffness_n_m_per_rad": own.sizes["coupling"] * k,
        "cross_damping_n_m_s_per_rad": own.sizes.get("coupling_loss", 0.0) * c,
    }
    return Twin(tables=[table])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Two neighbouring joints, the wrist's where they give way."""
    pairs = list(zip(places.elastic, places.elastic[1:], strict=False))
    pairs = pairs[1:] or pairs  # the first joint turns all the others alike
    if not pairs:
        raise PlantError("coupling: wanted two joints with a stiffness, got fewer")
    pair = pairs[int(rng.integers(len(pairs)))]
    ends = [places.joints[name] for name in pair]
    part = float(rng.choice([-1.0, 1.0]) * COUPLING * magnitude * about(rng))
    k = part * np.sqrt(np.prod([end["stiffness_n_m_per_rad"] for end in ends]))
    c = part * np.sqrt(np.prod([end["damping_n_m_s_per_rad"] for end in ends]))
    table = {
        "kind": "coupling",
        "joints": pair,
        "cross_stiffness_n_m_per_rad": float(k),
        "cross_damping_n_m_s_per_rad": float(c),
    }
    return hidden("coupling", list(pair), table, cross_stiffness_n_m_per_rad=float(k))


def _by_believed_mean(true: TrueEffect) -> float:
    both = [true.believed_n_m_per_rad[joint] for joint in true.place]
    return float(true.parameters["cross_stiffness_n_m_per_rad"] / np.sqrt(np.prod(both)))


OF_FILE = {"coupling": _of_file}
COMPARED = {"coupling": Compared(size=_by_believed_mean)}
HIDES = {"coupling": Hides(hide=hide, since=1, sized=True, apart_from=("wrist_coupling",))}
