"""What the inertias have to meet: figures with the margin each is known to.

A target names the postures it needs; `pulls` gets the mass matrices there and says how many
margins the arm is off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from armodal.analyzer.workspace.spectrum import ElasticJoints, spectrum_of_mass
from armodal.protocols.errors import EstimateError

__all__ = ["FrequencyTarget", "MomentTarget", "Target", "TotalMassTarget", "ZeroTarget"]

Array = npt.NDArray[np.float64]

_STEP_RAD = 1e-4  # of the slope beside a zero; M_ij changes over radians
_NO_SLOPE = 1e-9  # of the largest moment a radian: rounding over the step is 1e-12 of it


class Target(Protocol):
    """A figure, or a few of one source."""

    @property
    def source(self) -> str:
        """Where the figure comes from."""

    @property
    def postures(self) -> Array:
        """Postures (k, n_joints) whose mass matrices it needs."""

    def pulls(self, mass: Array, total_mass_kg: float) -> Array:
        """Deviations over margins.

        Parameters
        ----------
        mass
            (n_joints, n_joints, k), kg m², in the target's postures.
        total_mass_kg
            Of the whole arm, base included.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class MomentTarget:
    """Moment of inertia about a joint in a posture: M_ii (file 002, Eq. 8)."""

    joint: int
    joints_rad: Array
    value_kg_m2: float
    margin_kg_m2: float
    source: str

    @property
    def postures(self) -> Array:
        """The posture, (1, n_joints)."""
        return self.joints_rad[None]

    def pulls(self, mass: Array, total_mass_kg: float) -> Array:
        """Deviation over margin, (1,)."""
        del total_mass_kg
        return np.asarray((mass[self.joint, self.joint] - self.value_kg_m2) / self.margin_kg_m2)


@dataclass(frozen=True, slots=True, kw_only=True)
class ZeroTarget:
    """Angle of a joint at which the coupling of two vanishes: M_ij = 0 (file 002, Fig. 5)."""

    pair: tuple[int, int]
    swept: int
    joints_rad: Array  # at the zero
    margin_rad: float
    source: str

    @property
    def postures(self) -> Array:
        """The zero and a small step to both sides of it, (3, n_joints)."""
        q = np.repeat(self.joints_rad[None], 3, axis=0)
        q[1, self.swept] -= _STEP_RAD
        q[2, self.swept] += _STEP_RAD
        return q

    def pulls(self, mass: Array, total_mass_kg: float) -> Array:
        """How far the arm's zero is from the angle, to first order, over the margin, (1,).

        Raises
        ------
        EstimateError
            If the swept joint does not change the coupling.
        """
        del total_mass_kg
        coupling = mass[self.pair]
        slope = (coupling[2] - coupling[1]) / (2 * _STEP_RAD)
        if abs(slope) <= _NO_SLOPE * float(np.abs(mass).max()):
            i, j = (joint + 1 for joint in self.pair)
            raise EstimateError(
                f"target '{self.source}': wanted a swept joint that changes the coupling of joints "
                f"{i} and {j}, got joint {self.swept + 1}, which does not; only joints beyond the "
                "first of the two do: correct the swept joint, or leave the target out"
            )
        return np.array([-coupling[0] / slope / self.margin_rad])


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyTarget:
    """Frequencies and damping of an arm's first modes in a posture.

    A figure that is not known is NaN.
    """

    elastic: ElasticJoints
    joints_rad: Array
    f_hz: Array  # (n_modes,)
    f_margin_hz: float
    damping_ratio: Array  # (n_modes,)
    damping_margin: float
    source: str

    @property
    def postures(self) -> Array:
        """The posture, (1, n_joints)."""
        return self.joints_rad[None]

    def values(self, mass: Array) -> Array:
        """Frequencies, then damping ratios, (2 n_modes,) at mass matrices (n, n, 1)."""
        modes = spectrum_of_mass(mass, self.elastic)
        n = len(self.f_hz)
        return np.concatenate([modes.f_hz[0, :n], modes.damping_ratio[0, :n]])

    def pulls(self, mass: Array, total_mass_kg: float) -> Array:
        """Deviations over margins of the figures that are known."""
        del total_mass_kg
        wanted = np.concatenate([self.f_hz, self.damping_ratio])
        margin = np.repeat([self.f_margin_hz, self.damping_margin], len(self.f_hz))
        known = ~np.isnan(wanted)
        return np.asarray(((self.values(mass) - wanted) / margin)[known])


@dataclass(frozen=True, slots=True, kw_only=True)
class TotalMassTarget:
    """Mass of the whole arm, base included."""

    n_joints: int
    value_kg: float
    margin_kg: float
    source: str

    @property
    def postures(self) -> Array:
        """None, (0, n_joints)."""
        return np.empty((0, self.n_joints))

    def pulls(self, mass: Array, total_mass_kg: float) -> Array:
        """Deviation over margin, (1,)."""
        del mass
        return np.array([(total_mass_kg - self.value_kg) / self.margin_kg])
