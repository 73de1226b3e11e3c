"""Two joints that pull on each other, as a wrist's belts and cables do."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.linear import LinearTerms
from armodal.protocols.errors import PlantError

__all__ = ["Coupling"]


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
