"""Refuse what no rigid body can have: negative masses, impossible inertias."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import InertialLink
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ArmError

__all__ = ["merge_bodies", "physical_link"]

# Files print inertias with three or more digits; a thin plate meets the triangle exactly.
_ROUNDING = 1e-3
_LARGEST = 1e6  # kg, m, kg m^2: beyond any arm


def physical_link(
    name: str, mass_kg: float, center_m: npt.ArrayLike, inertia_kg_m2: npt.ArrayLike
) -> InertialLink:
    """Return the link, having checked that a body with these values can exist.

    Parameters
    ----------
    inertia_kg_m2
        (3, 3), symmetric, about the centre of mass, in link axes.

    Raises
    ------
    ArmError
        If the mass is not positive, or the inertia is not positive definite, or one principal
        moment exceeds the sum of the other two (more than the rounding of the file).
    """
    center = frozen_array(center_m, np.float64)
    inertia = np.array(inertia_kg_m2, dtype=np.float64)
    if not 0.0 < mass_kg < _LARGEST:
        raise ArmError(f"link {name}: wanted a mass above 0 kg, got {mass_kg}")
    if not (np.abs(center) < _LARGEST).all() or not (np.abs(inertia) < _LARGEST).all():
        raise ArmError(f"link {name}: wanted finite centre and inertia of an arm's size")
    principal = np.linalg.eigvalsh(inertia)
    moments = ", ".join(f"{moment:.4g}" for moment in principal)
    if principal[0] <= 0.0:
        raise ArmError(
            f"link {name}: wanted a positive definite inertia, got principal moments {moments} "
            "kg m^2"
        )
    if principal[2] > (principal[0] + principal[1]) * (1.0 + _ROUNDING):
        raise ArmError(
            f"link {name}: wanted principal moments of which none exceeds the sum of the other "
            f"two, got {moments} kg m^2: no body has such an inertia"
        )
    inertia = 0.5 * (inertia + inertia.T)
    return InertialLink(
        name=name,
        mass_kg=float(mass_kg),
        center_m=center,
        inertia_kg_m2=frozen_array(inertia, np.float64),
    )


def merge_bodies(
    name: str, bodies: list[tuple[float, npt.NDArray[np.float64], npt.NDArray[np.float64]]]
) -> InertialLink:
    """Join bodies (mass, centre (3,), inertia (3, 3) about the centre) that move as one."""
    mass = sum(body[0] for body in bodies)
    if mass <= 0.0:
        raise ArmError(f"link {name}: wanted a mass above 0 kg, got {mass}")
    center = sum((m * c for m, c, _ in bodies), start=np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for body_mass, body_center, body_inertia in bodies:
        d = body_center - center
        inertia += body_inertia + body_mass * (d @ d * np.eye(3) - np.outer(d, d))
    return physical_link(name, mass, center, inertia)
