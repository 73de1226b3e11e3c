"""What a cutter does to a tool that moves: forces by the change of chip thickness.

Teeth at the angle phi, measured from the normal y of the feed x towards it, feel

    F = -a H(phi) (u(t) - u(t - T)) ,   T the time between teeth,

with a the axial depth, u the tool in x and y, and H of the cutting coefficients (Altintas,
Manufacturing Automation, 2nd ed. (2012), section 4.5; Insperger and Stepan, Semi-Discretization for
Time-Delay Systems (2011), section 5.4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import ArmError

__all__ = ["Cutter", "oriented", "tooth_stiffness"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cutter:
    """An end mill and its cut."""

    teeth: int
    tangential_n_per_m2: float  # cutting coefficient
    radial_n_per_m2: float
    immersion: float  # radial depth over diameter, above 0 to 1
    down: bool  # down-milling; else up-milling

    def __post_init__(self) -> None:
        """Refuse what no cutter is."""
        if self.teeth < 1 or not self.tangential_n_per_m2 > 0.0 or self.radial_n_per_m2 < 0.0:
            raise ArmError(
                "wanted a cutter of at least one tooth with a positive tangential and a radial "
                f"cutting coefficient, got {self.teeth} teeth, {self.tangential_n_per_m2:g} and "
                f"{self.radial_n_per_m2:g} N/m²"
            )
        if not 0.0 < self.immersion <= 1.0:
            raise ArmError(
                "wanted a radial immersion above 0 and at most 1 (radial depth over diameter), got "
                f"{self.immersion:g}"
            )

    @property
    def angles_rad(self) -> tuple[float, float]:
        """Return where a tooth enters and leaves."""
        if self.down:
            return float(np.arccos(2.0 * self.immersion - 1.0)), float(np.pi)
        return 0.0, float(np.arccos(1.0 - 2.0 * self.immersion))


def oriented(cutter: Cutter) -> Array:
    """Return (2, 2) the mean of H over a turn, over N K_t / (4 pi), sign turned.

    Altintas and Budak, CIRP Annals 44 (1995) 357, Eq. (13): alpha.
    """
    r = cutter.radial_n_per_m2 / cutter.tangential_n_per_m2

    def at(phi: float) -> Array:
        c, s = np.cos(2.0 * phi), np.sin(2.0 * phi)
        return 0.5 * np.array(
            [
                [c - 2.0 * r * phi + r * s, -s - 2.0 * phi + r * c],
                [-s + 2.0 * phi + r * c, -c - 2.0 * r * phi - r * s],
            ]
        )

    start, end = cutter.angles_rad
    return np.asarray(at(end) - at(start))


def tooth_stiffness(cutter: Cutter, n_steps: int, n_inside: int = 20) -> Array:
    """Return (n_steps, 2, 2) H over one tooth's period, mean of each step, N/m per m of depth."""
    n = n_steps * n_inside
    turn = 2.0 * np.pi / cutter.teeth
    first = (np.arange(n) + 0.5) / n * turn
    start, end = cutter.angles_rad
    total = np.zeros((n, 2, 2))
    for tooth in range(cutter.teeth):
        phi = np.mod(first + tooth * turn, 2.0 * np.pi)
        cuts = (phi > start) & (phi < end)
        c, s = np.cos(phi), np.sin(phi)
        along = cutter.tangential_n_per_m2 * c + cutter.radial_n_per_m2 * s
        across = cutter.radial_n_per_m2 * c - cutter.tangential_n_per_m2 * s
        own = np.array([[s * along, c * along], [s * across, c * across]])
        total += np.moveaxis(own, 2, 0) * cuts[:, None, None]
    return np.asarray(total.reshape(n_steps, n_inside, 2, 2).mean(axis=1))
