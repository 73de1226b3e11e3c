"""Links whose mass is not given but filled: by volume from a density or from a total mass.

As file 002, section 2, does it: uniform density, so that a link's mass is its share of the volume.
Volumes, and how the mass is spread within each link, stand in the arm file, and so does the source.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.file_model import ArmFile, JointTable, LinkTable, MassesTable
from armodal.protocols.arm.inertial import physical_link
from armodal.protocols.arm.records import InertialLink
from armodal.protocols.errors import ArmError
from armodal.protocols.toml_reader import refuse

__all__ = ["filled_masses", "replaced_links", "table_link"]

Array = npt.NDArray[np.float64]


def filled_masses(file: ArmFile, origin: str) -> list[float | None]:
    """Mass of every moving link that the `masses` table fills, kg; None for all without it.

    Raises
    ------
    ArmError
        If a link has no volume, or has one without the table that would turn it into a mass.
    """
    if file.masses is None:
        for i, table in enumerate(file.joints):
            if table.link is not None and table.link.volume_m3 is not None:
                refuse(
                    ArmError,
                    origin,
                    f"joints[{i}].link.volume_m3",
                    wanted="a table [masses] with total_kg or density_kg_m3 to make it a mass",
                    got=table.link.volume_m3,
                )
        return [None] * len(file.joints)
    volumes = [_volume(table, i, origin) for i, table in enumerate(file.joints)]
    density = _density(file.masses, volumes)
    return [density * volume for volume in volumes]


def _volume(table: JointTable, index: int, origin: str) -> float:
    volume = None if table.link is None else table.link.volume_m3
    if volume is None:
        refuse(
            ArmError,
            origin,
            f"joints[{index}].link.volume_m3",
            wanted="a volume for every moving link, since [masses] fills their masses",
            got=None if table.link is None or table.link.mass_kg is None else "mass_kg",
        )
    return volume


def _density(masses: MassesTable, volumes: Sequence[float]) -> float:
    if masses.density_kg_m3 is not None:
        return masses.density_kg_m3
    base = masses.base_volume_m3 or 0.0
    return (masses.total_kg or 0.0) / (base + sum(volumes))


def replaced_links(file: ArmFile) -> frozenset[str]:
    """Links of a URDF whose inertials the arm file gives in full, so that the URDF needs none."""
    return frozenset(
        table.link.name
        for table in file.joints
        if table.link is not None and table.link.center_m is not None
    )


def table_link(
    link: LinkTable, mass_kg: float | None, urdf: InertialLink | None, path: str, origin: str
) -> InertialLink:
    """The link a table describes, its mass given in the table or filled.

    Parameters
    ----------
    mass_kg
        The filled mass; None where the table gives one.
    urdf
        The URDF's link: its centre and its spread of mass serve where the table gives none.

    Raises
    ------
    ArmError
        If neither the table nor a URDF says how the mass is spread, or no body can be like it.
    """
    mass = link.mass_kg if mass_kg is None else mass_kg
    if mass is None:
        refuse(ArmError, origin, f"{path}.mass_kg", wanted="a mass, or [masses]", got=None)
    if link.center_m is not None:
        center, inertia = np.array(link.center_m), _inertia(link, mass)
    elif urdf is not None:
        center, inertia = urdf.center_m, urdf.inertia_kg_m2 * (mass / urdf.mass_kg)
    else:
        wanted = "the centre of mass, since no URDF gives it"
        refuse(ArmError, origin, f"{path}.center_m", wanted=wanted, got=None)
    try:
        return physical_link(link.name, mass, center, inertia)
    except ArmError as problem:
        raise ArmError(f"{origin}: {path}: {problem}") from problem


def _inertia(link: LinkTable, mass_kg: float) -> Array:
    """Inertia about the centre of mass in link axes, kg m²."""
    if link.box_m is not None:
        square = np.array(link.box_m) ** 2
        return np.diag(square.sum() - square) * mass_kg / 12.0
    if link.inertia_over_mass_m2 is not None:
        return _symmetric(link.inertia_over_mass_m2) * mass_kg
    return _symmetric(link.inertia_kg_m2 or [0.0] * 6)


def _symmetric(six: Sequence[float]) -> Array:
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
