"""An effect that an arm file holds, as what a module of this folder makes its table of.

A module that knows effects of arm files offers

    OF_FILE    the effect's name in the file: a function of its `FileEffect` that returns a `Twin`

An effect that no module names is refused by the laboratory.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import AddedEffect, Arm, Joint

__all__ = ["FileEffect", "Twin", "Unlike", "of_the_test", "three"]

Array = npt.NDArray[np.float64]
Table = dict[str, Any]
T = TypeVar("T")


class Unlike(Exception):  # noqa: N818 - it is told as a reason, and never raised further
    """What an effect of the file has and the laboratory has not."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileEffect:
    """An effect of an arm file with its true sizes.

    sizes : of the file's parameters by their names, drawn within the deviations. One that the file
        lacks is told to the user by its name
    loss_s : damping over stiffness of what the file tells none
    turned : (3, 3) for each link and the base, from its frame in the arm file to the plant's
    """

    arm: Arm
    effect: AddedEffect
    sizes: Mapping[str, float]
    loss_s: float
    turned: Mapping[str, Array]

    @property
    def joint(self) -> Joint:
        """The joint that the effect's place names."""
        return self._found(j for j in self.arm.joints if j.name == self.effect.place)

    @property
    def joints(self) -> tuple[Joint, Joint]:
        """Both joints of a place such as `joint_1 and joint_2`."""
        pairs = ((a, b) for a in self.arm.joints for b in self.arm.joints)
        place = self.effect.place
        return self._found((a, b) for a, b in pairs if f"{a.name} and {b.name}" == place)

    def _found(self, fitting: Iterator[T]) -> T:
        for one in fitting:
            return one
        raise Unlike("joint of that name")

    def vector(self, key: str, of: str) -> Array:
        """(3,) from the sizes `key`_x, _y, _z, in the plant's frame of a link."""
        own = np.array([self.sizes.get(f"{key}_{axis}", 0.0) for axis in "xyz"])
        return np.asarray(self.turned[of] @ own)

    def line(self) -> tuple[Array, Array]:
        """Nearest point and unit direction (3,) of a line of a link, in the plant's frame."""
        told, R = self.effect.description, self.turned[str(self.effect.description["link"])]
        u, at = (R @ three(told[key]) for key in ("direction", "point_m"))
        u = u / np.linalg.norm(u)
        return at - (at @ u) * u, np.asarray(u)

    def spring(self, compliance: str, loss: str | None = None) -> dict[str, float]:
        """Keys of a turning spring: one over the size, and its damping where a size tells it."""
        k = 1.0 / self.sizes[compliance]
        loss_s = self.loss_s if loss is None else self.sizes.get(loss, 0.0)
        return {"stiffness_n_m_per_rad": k, "damping_n_m_s_per_rad": loss_s * k}


@dataclass(frozen=True, slots=True, kw_only=True)
class Twin:
    """What becomes of a plant's tables.

    tables : `[[effects]]` that are added
    replaces : ordinary errors that they stand in place of, by kind and joint
    damping : of joints, in place of their own; N m s/rad
    """

    tables: Sequence[Table] = ()
    replaces: Sequence[tuple[str, str]] = ()
    damping: Mapping[str, float] = field(default_factory=dict)


def of_the_test(_: FileEffect) -> Twin:
    """Nothing: it is of a session, not of the arm. The laboratory has sensors of its own."""
    return Twin()


def three(values: object) -> Array:
    """(3,) of a description.

    Raises
    ------
    KeyError
        If it holds no numbers.
    """
    if not isinstance(values, Sequence):
        raise KeyError("three numbers")
    return np.array([float(value) for value in values])
