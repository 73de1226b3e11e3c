"""Gears of a wrist: one joint's turn works on the next one's drive."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.released_joint import released
from armodal.hil_sim.linear import LinearTerms
from armodal.protocols.errors import PlantError

__all__ = ["OF_FILE", "WristCoupling"]


class WristCoupling(BaseEffect):
    """The drive of `driven` runs through the hollow shaft of `driver`, whose turn winds it.

    The spring of `driven` is stretched by its own turn plus `ratio` times the driver's. The drives
    hold, so where the driver gives way by its spring the driven link turns back by its ratio.
    """

    winds_springs: ClassVar[bool] = True
    kind: Literal["wrist_coupling"]
    driver: str
    driven: str
    ratio: float

    def act(self, terms: LinearTerms) -> None:
        """Wind the spring by both turns.

        Raises
        ------
        PlantError
            If both are one joint, or something else already stretches the driven spring.
        """
        plain = terms.row(self.driven)
        if self.driver == self.driven or not np.array_equal(terms.stretch[self.driven], plain):
            raise PlantError(
                f"effects: the spring of {self.driven!r} cannot be wound by {self.driver!r}; name "
                "two joints, and no servo or other coupling on the driven one"
            )
        row = plain + self.ratio * terms.row(self.driver)
        change = np.outer(row, row) - np.outer(plain, plain)
        spring = terms.springs[self.driven]
        terms.K = terms.K + spring.k * change
        terms.C = terms.C + spring.c * change
        terms.stretch[self.driven] = row


def _of_file(own: FileEffect) -> Twin:
    driver, driven = (joint.name for joint in own.joints)
    gears = {
        "kind": "wrist_coupling",
        "driver": driver,
        "driven": driven,
        "ratio": own.sizes["wrist_ratio"],
    }
    spring, *losses = released(driven, own)
    return Twin(tables=[spring, gears, *losses], replaces=[("released_joint", driven)])


OF_FILE = {"wrist_coupling": _of_file}
