"""The arm of an imported session: the manifest's own, with the points only the files know."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.files import BASE, arm_from_texts, load_arm
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm
from armodal.protocols.arm.urdf import read_urdf
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ArmError, ForeignFileError
from armodal.protocols.foreign.manifest import NO_ARM, Manifest, PostureTable
from armodal.protocols.foreign.measured import Content, ToldDof
from armodal.protocols.foreign.placement import HIT, RESPONSE, Placement, point_name
from armodal.protocols.foreign.session_texts import NewPoint, bare_arm_text, points_text
from armodal.protocols.toml_reader import read_text

__all__ = ["MeasuredPosture", "imported_arm", "placement_of"]

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]

_URDF_LIMIT = 4 * 2**20
_SAME_PLACE_M = 5e-3  # a test point measured with a ruler


@dataclass(frozen=True, slots=True)
class MeasuredPosture:
    """One posture of the manifest with what its files hold."""

    table: PostureTable
    contents: tuple[Content, ...]


def placement_of(manifest: Manifest, arm: Arm, table: PostureTable) -> Placement:
    """Return where a posture's nodes and directions lie, or refuse its joint angles."""
    angles = np.radians(table.joints_deg)
    if len(angles) != len(arm.joints):
        raise ForeignFileError(
            f"{manifest.origin}: posture {table.name!r}: joints_deg: wanted {len(arm.joints)} "
            f"joint angles for arm {arm.name!r}, got {len(angles)}"
        )
    return Placement(
        arm=arm,
        joints_rad=frozen_array(angles, np.float64),
        axes=table.axes or manifest.file.axes,
        nodes=manifest.file.nodes,
    )


def imported_arm(manifest: Manifest, postures: Sequence[MeasuredPosture], said: list[str]) -> Arm:
    """Return the manifest's arm with the points that only the files know."""
    if manifest.file.arm == NO_ARM:
        return _structure(manifest, postures, said)
    source = manifest.arm_source()
    if isinstance(source, Path) and source.suffix.lower() == ".urdf":
        return _urdf_arm(manifest, source, postures, said)
    arm = load_arm(source)
    added = _new_points(manifest, arm, postures, said)
    if manifest.file.sensor_mass_kg is None:
        said.append("the sensor's mass is not told (sensor_mass_kg): none is in the model")
    if not added:
        return arm
    database = None if arm.can is None else arm.can.database_text
    return arm_from_texts(
        arm.text.rstrip("\n") + "\n" + points_text(added),
        urdf_text=arm.urdf_text,
        database_text=database,
        origin=manifest.origin,
    )


def _structure(manifest: Manifest, postures: Sequence[MeasuredPosture], said: list[str]) -> Arm:
    """A structure without joints: its points are the files' nodes, on the base."""
    if any(posture.table.joints_deg for posture in postures):
        raise ForeignFileError(f'{manifest.origin}: joints_deg is for an arm, arm is "{NO_ARM}"')
    places = _places(postures)
    names: dict[str, NewPoint] = {}
    unplaced: list[str] = []
    for dof, fallback, axes in _dofs(postures):
        name = point_name(dof.node, manifest.file.nodes, fallback)
        if name in names and fallback == HIT:
            continue
        position = places.get(dof.node or "")
        if name not in names and position is None:
            unplaced.append(name)
        R = np.eye(3) if axes is None else axes
        place = np.zeros(3) if position is None else position
        if name not in names or fallback == RESPONSE:
            names[name] = NewPoint(id=name, link=BASE, position_m=place, R_link_sensor=R)
    if unplaced:
        said.append(
            f"the position of {len(unplaced)} point(s) is not told (no dataset 15): shapes can be "
            "compared, not drawn"
        )
    text = bare_arm_text(NO_ARM, None, list(names.values()), unplaced)
    return arm_from_texts(text, urdf_text=None, database_text=None, origin=manifest.origin)


def _urdf_arm(
    manifest: Manifest, path: Path, postures: Sequence[MeasuredPosture], said: list[str]
) -> Arm:
    text = read_text(path, what="URDF", limit_bytes=_URDF_LIMIT, error=ArmError)
    try:
        chain = read_urdf(text)
    except ArmError as error:
        raise ArmError(f"{path.name}: {error}") from error
    # A first arm with one point on its base, to have its kinematics; then with the files' points.
    here = NewPoint(id="base", link=BASE, position_m=np.zeros(3), R_link_sensor=np.eye(3))
    name = "".join(c if c.isascii() and c.isalnum() else "-" for c in chain.name).strip("-")[:64]
    name = name if name and name != NO_ARM else "imported"
    bare = arm_from_texts(
        bare_arm_text(name, chain, [here], []),
        urdf_text=text,
        database_text=None,
        origin=path.name,
    )
    added = _new_points(manifest, bare, postures, said)
    said.append(f"{path.name}: a URDF tells no stiffness: the joints are believed rigid")
    return arm_from_texts(
        bare_arm_text(name, chain, [here, *added], []),
        urdf_text=text,
        database_text=None,
        origin=path.name,
    )


def _new_points(
    manifest: Manifest, arm: Arm, postures: Sequence[MeasuredPosture], said: list[str]
) -> list[NewPoint]:
    """Points of dataset 15 on the links the manifest names; others have to be the arm's own."""
    known = {point.id: point for point in arm.points}
    added: dict[str, NewPoint] = {}
    for posture in postures:
        placement = placement_of(manifest, arm, posture.table)
        places = _places([posture])
        for dof, fallback, _ in _dofs([posture]):
            if dof.node is None:
                continue
            name = point_name(dof.node, manifest.file.nodes, fallback)
            position = places.get(dof.node)
            link = manifest.file.links.get(dof.node)
            if name in known:
                own = known[name]
                if position is not None:
                    _compare(name, position, own.link, own.position_m, placement, said)
                continue
            if link is None or position is None:
                raise ForeignFileError(
                    f"{manifest.origin}: node {dof.node}: wanted a test point of arm "
                    f"{arm.name!r}, it has no {name!r}; map it with `nodes`, or give its link with "
                    "`links` and its position with dataset 15"
                )
            local = _in_link(position, link, placement, manifest.origin)
            if name in added:
                if float(np.linalg.norm(added[name].position_m - local)) > _SAME_PLACE_M:
                    said.append(f"point {name}: postures place it apart; the first one holds")
                continue
            added[name] = NewPoint(id=name, link=link, position_m=local, R_link_sensor=np.eye(3))
    return list(added.values())


def _in_link(
    position: Vector,
    link: str,
    placement: Placement,
    origin: str,
) -> Vector:
    """Position of a node in its link's frame."""
    if placement.axes == "link":
        return position
    try:
        T = link_pose(placement.arm, link, placement.joints_rad)
    except KeyError as error:
        names = ", ".join([BASE, *(joint.link.name for joint in placement.arm.joints)])
        raise ForeignFileError(f"{origin}: links: wanted one of {names}, got {link!r}") from error
    local: Vector = T[:3, :3].T @ (position - T[:3, 3])
    return local


def _compare(
    name: str,
    position: Vector,
    link: str,
    own: Vector,
    placement: Placement,
    said: list[str],
) -> None:
    """Say where the file's geometry is not that of the arm."""
    local = _in_link(position, link, placement, name)
    distance = float(np.linalg.norm(local - own))
    if distance > _SAME_PLACE_M:
        said.append(
            f"point {name}: dataset 15 places it {1e3 * distance:.0f} mm from where the arm file "
            "does; the arm file holds"
        )


def _dofs(
    postures: Sequence[MeasuredPosture],
) -> Iterator[tuple[ToldDof, str, Matrix | None]]:
    """Every degree of freedom: itself, its part, and for hits the sensor's axes."""
    for posture in postures:
        for content in posture.contents:
            for frf in content.frfs:
                yield frf.response, RESPONSE, None
                if posture.table.hit_point is None:
                    yield frf.reference, HIT, None
            for hit in content.hits:
                for dof in hit.responses:
                    same = [one.direction for one in hit.responses if one.node == dof.node]
                    yield dof, RESPONSE, _frame(same)
                if posture.table.hit_point is None:
                    yield hit.hit, HIT, None
        if posture.table.hit_point is not None:
            yield ToldDof(posture.table.hit_point, None), HIT, None


def _frame(
    directions: list[Vector | None],
) -> Matrix | None:
    """Right-handed axes whose first columns are the directions told; None without."""
    told = [d for d in directions if d is not None]
    if not told or len(told) != len(directions):
        return None
    given = np.stack(told[:3], axis=1)
    Q, R = np.linalg.qr(np.concatenate([given, np.eye(3)], axis=1))
    Q = Q * np.where(np.diag(R[:, :3]) < 0.0, -1.0, 1.0)
    Q[:, 2] = np.cross(Q[:, 0], Q[:, 1])
    frame: Matrix = Q
    return frame


def _places(
    postures: Sequence[MeasuredPosture],
) -> dict[str, Vector]:
    """Positions of the nodes that any file places, m."""
    places: dict[str, Vector] = {}
    for posture in postures:
        for content in posture.contents:
            if content.nodes is not None:
                for number, position in zip(
                    content.nodes.number.tolist(), content.nodes.position, strict=True
                ):
                    places.setdefault(str(number), position)
    return places
