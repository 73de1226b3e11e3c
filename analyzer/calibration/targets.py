"""What the inertias have to meet: figures with the margin each is known to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analyzer.workspace.batch import ArmBatch
from analyzer.workspace.spectrum import elastic_joints, spectrum

__all__ = ["FrequencyTarget", "MomentTarget", "Target", "TotalMassTarget", "ZeroTarget"]

Array = npt.NDArray[np.float64]

_STEP_RAD = 1e-4  # of the slope beside a zero; M_ij changes over radians


@dataclass(frozen=True, slots=True, kw_only=True)
class MomentTarget:
    """Moment of inertia about a joint in a posture: M_ii (file 002, Eq. 8)."""

    joint: int
    joints_rad: Array
    value_kg_m2: float
    margin_kg_m2: float
    source: str

    def values(self, batch: ArmBatch) -> Array:
        """Moment of inertia of an arm, (1,)."""
        return np.asarray(batch.mass(self.joints_rad[None])[self.joint, self.joint])

    def pulls(self, batch: ArmBatch, base_mass_kg: float) -> Array:
        """Deviation over margin, (1,)."""
        del base_mass_kg
        return (self.values(batch) - self.value_kg_m2) / self.margin_kg_m2


@dataclass(frozen=True, slots=True, kw_only=True)
class ZeroTarget:
    """Angle of a joint at which the coupling of two vanishes: M_ij = 0 (file 002, Fig. 5)."""

    pair: tuple[int, int]
    swept: int
    joints_rad: Array  # at the zero
    margin_rad: float
    source: str

    def values(self, batch: ArmBatch) -> Array:
        """How far the arm's zero lies from the wanted angle, to first order, (1,) rad."""
        i, j = self.pair
        q = np.repeat(self.joints_rad[None], 3, axis=0)
        q[1, self.swept] -= _STEP_RAD
        q[2, self.swept] += _STEP_RAD
        coupling = batch.mass(q)[i, j]
        slope = (coupling[2] - coupling[1]) / (2 * _STEP_RAD)
        return np.array([-coupling[0] / slope])

    def pulls(self, batch: ArmBatch, base_mass_kg: float) -> Array:
        """Deviation over margin, (1,)."""
        del base_mass_kg
        return self.values(batch) / self.margin_rad


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyTarget:
    """Frequencies and damping of an arm's modes in a posture, with its joints as described.

    A figure that is not known is NaN.
    """

    joints_rad: Array
    f_hz: Array  # (n_modes,)
    f_margin_hz: float
    damping_ratio: Array  # (n_modes,)
    damping_margin: float
    source: str

    def values(self, batch: ArmBatch) -> Array:
        """Frequencies, then damping ratios, (2 n_modes,)."""
        modes = spectrum(batch, self.joints_rad[None], elastic_joints(batch.arm))
        n = len(self.f_hz)
        return np.concatenate([modes.f_hz[0, :n], modes.damping_ratio[0, :n]])

    def pulls(self, batch: ArmBatch, base_mass_kg: float) -> Array:
        """Deviations over margins of the figures that are known."""
        del base_mass_kg
        wanted = np.concatenate([self.f_hz, self.damping_ratio])
        margin = np.repeat([self.f_margin_hz, self.damping_margin], len(self.f_hz))
        known = ~np.isnan(wanted)
        return np.asarray(((self.values(batch) - wanted) / margin)[known])


@dataclass(frozen=True, slots=True, kw_only=True)
class TotalMassTarget:
    """Mass of the whole arm, base included."""

    value_kg: float
    margin_kg: float
    source: str

    def pulls(self, batch: ArmBatch, base_mass_kg: float) -> Array:
        """Deviation over margin, (1,)."""
        total = base_mass_kg + sum(joint.link.mass_kg for joint in batch.arm.joints)
        return np.array([(total - self.value_kg) / self.margin_kg])


Target = MomentTarget | ZeroTarget | FrequencyTarget | TotalMassTarget
