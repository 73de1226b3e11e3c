"""Read an arm file with the URDF and the CAN database it names.

The format is specified in `docs/arm-file.md`.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.can_section import can_mapping
from armodal.protocols.arm.dh import dh_transform
from armodal.protocols.arm.effect_section import added_effect
from armodal.protocols.arm.file_model import ArmFile, JointTable, MassesTable, PointTable
from armodal.protocols.arm.masses import filled_masses, replaced_links, table_link
from armodal.protocols.arm.records import (
    Arm,
    Estimate,
    InertialLink,
    InertialStd,
    Joint,
    KeepOut,
    PastSession,
    Point,
    Tolerances,
)
from armodal.protocols.arm.urdf import Chain, UrdfJoint, read_urdf
from armodal.protocols.arrays import frozen_array
from armodal.protocols.can_database import DBC_DIRECTORY
from armodal.protocols.errors import ArmError
from armodal.protocols.toml_reader import parse_toml, read_text, refuse, validate

__all__ = ["ARMS_DIRECTORY", "BASE", "arm_from_texts", "load_arm", "shipped_arms"]

ARMS_DIRECTORY = Path(__file__).parent / "arms"
BASE = "base"

_ARM_LIMIT = 512 * 1024
_URDF_LIMIT = 4 * 1024 * 1024
_DBC_LIMIT = 4 * 1024 * 1024


def shipped_arms() -> tuple[str, ...]:
    """Return the names of the arms that come with armodal."""
    return tuple(sorted(path.stem for path in ARMS_DIRECTORY.glob("*.toml")))


def load_arm(source: str | Path) -> Arm:
    """Load an arm file, or a shipped arm by its name.

    Parameters
    ----------
    source
        A path, or a shipped arm's name such as "rv4frl" (a string with neither folder nor
        `.toml`). The URDF and DBC it names lie beside it, or are shipped ones.

    Raises
    ------
    ArmError
        If a file cannot be read, or a value is not possible; the message has the key's path.
    """
    path = Path(source)
    if isinstance(source, str) and path.suffix != ".toml" and path.name == source:
        if source not in shipped_arms():
            raise ArmError(
                f"arm {source!r}: wanted a path to an arm file or one of the shipped arms "
                f"{', '.join(shipped_arms())}"
            )
        path = ARMS_DIRECTORY / f"{source}.toml"
    text = read_text(path, what="arm file", limit_bytes=_ARM_LIMIT, error=ArmError)
    origin = f"arm file {path.name}"
    file = _file(text, origin)
    urdf_text = database_text = None
    if file.urdf is not None:
        urdf_text = _beside(path, file.urdf, ARMS_DIRECTORY, "urdf", _URDF_LIMIT)
    if file.can is not None:
        database_text = _beside(path, file.can.database, DBC_DIRECTORY, "can.database", _DBC_LIMIT)
    return arm_from_texts(text, urdf_text=urdf_text, database_text=database_text, origin=origin)


@lru_cache(maxsize=8)  # of sessions and journals, the same few arms are read again and again
def arm_from_texts(
    text: str,
    *,
    urdf_text: str | None,
    database_text: str | None,
    origin: str = "arm file",
) -> Arm:
    """Build the arm from the texts a session keeps: `text`, `urdf_text`, `can.database_text`.

    Raises
    ------
    ArmError
        As `load_arm`; also if a text the arm file names is not given.
    """
    file = _file(text, origin)
    if (file.urdf is None) != (urdf_text is None):
        refuse(ArmError, origin, "urdf", wanted="the text of the URDF it names", got=file.urdf)
    chain = None
    if urdf_text is not None:
        try:
            chain = read_urdf(urdf_text, replaced=replaced_links(file))
        except ArmError as problem:
            raise ArmError(f"{origin}: urdf {file.urdf}: {problem}") from problem
    joints = _joints(file, chain, origin)
    link_names = [BASE, *(joint.link.name for joint in joints)]
    for index, name in enumerate(link_names):
        if name in link_names[:index]:
            refuse(ArmError, origin, "joints", wanted="link names that differ", got=name)
    points = tuple(_point(table, i, link_names, origin) for i, table in enumerate(file.points))
    _check_groups(file, origin)
    can = None
    if file.can is not None:
        if database_text is None:
            refuse(ArmError, origin, "can.database", wanted="the database's text", got=None)
        names = [joint.name for joint in joints]
        can = can_mapping(file.can, database_text=database_text, joints=names, origin=origin)
    t = file.tolerances
    return Arm(
        name=file.name,
        source=file.source if file.masses is None else f"{file.source} {_told(file.masses)}",
        joints=joints,
        gravity_m_s2=frozen_array(file.gravity_m_s2, np.float64),
        points=points,
        groups={name: tuple(ids) for name, ids in file.groups.items()},
        tolerances=Tolerances(
            mass=t.mass,
            inertia=t.inertia,
            center_m=t.center_m,
            encoder_offset_rad=math.radians(t.encoder_offset_deg),
            sensor_tilt_rad=math.radians(t.sensor_tilt_deg),
            sensor_gain=t.sensor_gain,
            hammer_gain=t.hammer_gain,
            hit_direction_rad=math.radians(t.hit_direction_deg),
            moving_mass=t.moving_mass,
            usual=tuple(
                key
                for key, of in type(t).model_fields.items()
                if key not in t.model_fields_set and of.default is not None
            ),
        ),
        can=can,
        text=text,
        urdf_text=urdf_text,
        sha256=_sha256(text, urdf_text, database_text if file.can is not None else None),
        history=tuple(
            PastSession(session_sha256=own.session_sha256, by=own.by, created=own.created)
            for own in file.history
        ),
        effects=tuple(
            added_effect(table, path=f"effects[{i}]", links=link_names, origin=origin)
            for i, table in enumerate(file.effects)
        ),
        keep_outs=tuple(
            KeepOut(
                name=table.name,
                low_m=frozen_array(table.low_m, np.float64),
                high_m=frozen_array(table.high_m, np.float64),
            )
            for table in file.keep_outs
        ),
    )


@lru_cache(maxsize=8)
def _file(text: str, origin: str) -> ArmFile:
    data = parse_toml(text, origin=origin, error=ArmError)
    return validate(ArmFile, data, origin=origin, error=ArmError)


def _beside(arm_path: Path, name: str, shipped: Path, key: str, limit_bytes: int) -> str:
    """Read a file by its plain name, from beside the arm file or from the shipped ones."""
    for folder in (arm_path.parent, shipped):
        if (folder / name).is_file():
            return read_text(folder / name, what=key, limit_bytes=limit_bytes, error=ArmError)
    return refuse(
        ArmError,
        f"arm file {arm_path.name}",
        key,
        wanted="the name of a file beside the arm file, or of a shipped one",
        got=name,
    )


def _joints(file: ArmFile, chain: Chain | None, origin: str) -> tuple[Joint, ...]:
    masses = filled_masses(file, origin)
    names = [table.name for table in file.joints]
    if chain is not None:
        wanted = [joint.name for joint in chain.joints]
        if names != wanted:
            text = f"the URDF's joints from the base outwards, {', '.join(wanted)}"
            refuse(ArmError, origin, "joints", wanted=text, got=names)
        return tuple(
            _urdf_joint(table, joint, masses[i], f"joints[{i}]", origin)
            for i, (table, joint) in enumerate(zip(file.joints, chain.joints, strict=True))
        )
    if len(set(names)) != len(names):
        refuse(ArmError, origin, "joints", wanted="joint names that differ", got=names)
    return tuple(
        _dh_joint(table, masses[i], f"joints[{i}]", origin) for i, table in enumerate(file.joints)
    )


def _urdf_joint(
    table: JointTable, joint: UrdfJoint, mass_kg: float | None, path: str, origin: str
) -> Joint:
    if table.dh is not None:
        refuse(ArmError, origin, f"{path}.dh", wanted="it left to the URDF", got="a table")
    link = joint.link
    if table.link is not None:
        if table.link.name != joint.link_name:
            wanted = f"the URDF's link, {joint.link_name}"
            refuse(ArmError, origin, f"{path}.link.name", wanted=wanted, got=table.link.name)
        link = table_link(table.link, mass_kg, link, f"{path}.link", origin)
    if link is None:
        refuse(ArmError, origin, f"{path}.link", wanted="the inertials of this link", got=None)
    low, high = joint.range_rad
    if table.range_deg is not None:
        narrowed = math.radians(table.range_deg[0]), math.radians(table.range_deg[1])
        # A hundredth of a degree, the rounding of radians printed in a URDF.
        if narrowed[0] < low - 2e-4 or narrowed[1] > high + 2e-4:
            text = f"within the URDF's {math.degrees(low):.2f} to {math.degrees(high):.2f}"
            refuse(ArmError, origin, f"{path}.range_deg", wanted=text, got=table.range_deg)
        low, high = narrowed
    elif not math.isfinite(low):
        text = "a range, since the URDF's joint is continuous"
        refuse(ArmError, origin, f"{path}.range_deg", wanted=text, got=None)
    return _joint(table, joint.T_parent_joint, joint.axis, (low, high), link)


def _dh_joint(table: JointTable, mass_kg: float | None, path: str, origin: str) -> Joint:
    dh, link, limits = table.dh, table.link, table.range_deg
    if dh is None or link is None or limits is None:
        missing = next(k for k in ("dh", "link", "range_deg") if getattr(table, k) is None)
        text = "a value, since the file names no URDF"
        refuse(ArmError, origin, f"{path}.{missing}", wanted=text, got=None)
    T = dh_transform(
        alpha_rad=math.radians(dh.alpha_deg),
        a_m=dh.a_m,
        theta_offset_rad=math.radians(dh.theta_offset_deg),
        d_m=dh.d_m,
    )
    range_rad = math.radians(limits[0]), math.radians(limits[1])
    axis = frozen_array([0.0, 0.0, 1.0], np.float64)
    body = table_link(link, mass_kg, None, f"{path}.link", origin)
    return _joint(table, T, axis, range_rad, body)


def _told(masses: MassesTable) -> str:
    if masses.total_kg is None:
        return f"Masses: volume times {masses.density_kg_m3:g} kg/m³ ({masses.source})."
    return f"Masses: {masses.total_kg:g} kg shared by volume ({masses.source})."


def _joint(
    table: JointTable,
    T_parent_joint: npt.NDArray[np.float64],
    axis: npt.NDArray[np.float64],
    range_rad: tuple[float, float],
    link: InertialLink,
) -> Joint:
    k, c, std = table.stiffness_n_m_per_rad, table.damping_n_m_s_per_rad, table.inertial_std
    return Joint(
        name=table.name,
        T_parent_joint=T_parent_joint,
        axis=axis,
        range_rad=range_rad,
        link=link,
        stiffness=None if k is None else Estimate(value=k.value, std=k.std, source=k.source),
        damping=None if c is None else Estimate(value=c.value, std=c.std, source=c.source),
        inertial_std=None
        if std is None
        else InertialStd(
            mass=std.mass, inertia=std.inertia, center_m=std.center_m, guessed=std.guessed
        ),
    )


def _point(table: PointTable, index: int, links: Sequence[str], origin: str) -> Point:
    if table.link not in links:
        text = f"one of the links {', '.join(links)}"
        refuse(ArmError, origin, f"points[{index}].link", wanted=text, got=table.link)
    z = np.array(table.normal) / math.hypot(*table.normal)
    x = np.array(table.x_axis) - z * np.dot(z, table.x_axis)
    x /= np.linalg.norm(x)
    return Point(
        id=table.id,
        link=table.link,
        position_m=frozen_array(table.position_m, np.float64),
        R_link_sensor=frozen_array(np.column_stack([x, np.cross(z, x), z]), np.float64),
    )


def _check_groups(file: ArmFile, origin: str) -> None:
    ids = [point.id for point in file.points]
    for index, name in enumerate(ids):
        if name in ids[:index]:
            refuse(ArmError, origin, f"points[{index}].id", wanted="an id of its own", got=name)
    for group, members in file.groups.items():
        for index, member in enumerate(members):
            if member not in ids or member in members[:index]:
                path = f"groups.{group}[{index}]"
                refuse(ArmError, origin, path, wanted="the id of a point, once", got=member)


def _sha256(*texts: str | None) -> str:
    """Digest of the texts with their lengths, so that none can run into the next."""
    digest = hashlib.sha256()
    for text in texts:
        data = b"" if text is None else text.encode("utf-8")
        digest.update(len(data).to_bytes(8, "big") + data)
    return digest.hexdigest()
