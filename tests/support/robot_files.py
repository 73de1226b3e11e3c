"""Robot descriptions in the manner of makers' own, written by tests, faults included."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

ALUMINIUM = 1200.0  # kg/m³ over the hull: castings with motors in them


@dataclass
class LinkText:
    """A box from the joint along `end`, and the next joint there."""

    name: str
    box_m: tuple[float, float, float]
    center_m: tuple[float, float, float]
    next_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mass_kg: float | None = None
    inertial: str | None = None  # whole element, instead of the box's own
    mesh: str | None = None
    scale: str = "1 1 1"
    axis: str = "0 0 1"
    kind: str = "revolute"
    limit: tuple[float, float] = (-2.5, 2.5)
    extra: str = ""  # inside the joint

    def element(self, *, with_inertial: bool = True) -> str:
        x, y, z = self.center_m
        shape = f'<box size="{" ".join(map(str, self.box_m))}"/>'
        origin = f'<origin xyz="{x} {y} {z}"/>'
        if self.mesh:
            shape, origin = f'<mesh filename="{self.mesh}" scale="{self.scale}"/>', "<origin/>"
        return (
            f'<link name="{self.name}">'
            + (self.inertial_text() if with_inertial else "")
            + f"<visual>{origin}<geometry>{shape}</geometry></visual>"
            + f"<collision>{origin}<geometry>{shape}</geometry></collision></link>"
        )

    def mass(self) -> float:
        return self.mass_kg or ALUMINIUM * float(np.prod(self.box_m))

    def inertial_text(self) -> str:
        if self.inertial is not None:
            return self.inertial
        a, b, c = (self.mass() * side**2 / 12.0 for side in self.box_m)
        x, y, z = self.center_m
        return (
            f'<inertial><origin xyz="{x} {y} {z}"/><mass value="{self.mass():.6g}"/>'
            f'<inertia ixx="{b + c:.6g}" iyy="{a + c:.6g}" izz="{a + b:.6g}" ixy="0" ixz="0" '
            'iyz="0"/></inertial>'
        )


@dataclass
class RobotText:
    links: list[LinkText]
    name: str = "tester"
    with_inertials: bool = True
    more: list[str] = field(default_factory=list)

    def urdf(self) -> str:
        rows = [f'<robot name="{self.name}">']
        rows.append(
            '<link name="base_link"><collision><origin xyz="0 0 0.05"/><geometry>'
            '<box size="0.2 0.2 0.1"/></geometry></collision></link>'
        )
        parent, at = "base_link", (0.0, 0.0, 0.1)
        for number, link in enumerate(self.links, start=1):
            low, high = link.limit
            limit = f'<limit lower="{low}" upper="{high}" effort="100" velocity="1"/>'
            rows.append(
                f'<joint name="joint_{number}" type="{link.kind}">'
                f'<origin xyz="{at[0]} {at[1]} {at[2]}"/><parent link="{parent}"/>'
                f'<child link="{link.name}"/><axis xyz="{link.axis}"/>'
                f"{limit if link.kind != 'continuous' else ''}{link.extra}</joint>"
            )
            rows.append(link.element(with_inertial=self.with_inertials))
            parent, at = link.name, link.next_m
        rows.append(
            f'<link name="tool0"/><joint name="flange_tool0" type="fixed"><origin xyz="{at[0]} '
            f'{at[1]} {at[2]}"/><parent link="{parent}"/><child link="tool0"/></joint>'
        )
        return "\n".join([*rows, *self.more, "</robot>", ""])

    def write(self, path: Path) -> Path:
        path.write_text(self.urdf(), encoding="utf-8")
        return path


def six_joints() -> RobotText:
    """An upright arm with a spherical wrist."""
    return RobotText(
        [
            LinkText("shoulder", (0.16, 0.16, 0.2), (0.0, 0.0, 0.1), (0.0, 0.0, 0.2)),
            LinkText(
                "upper_arm", (0.12, 0.1, 0.45), (0.0, 0.13, 0.2), (0.0, 0.0, 0.4), axis="0 1 0"
            ),
            LinkText("elbow", (0.14, 0.12, 0.14), (0.0, 0.0, 0.0), (0.09, 0.0, 0.0), axis="0 1 0"),
            LinkText("forearm", (0.28, 0.1, 0.1), (0.16, 0.0, 0.0), (0.32, 0.0, 0.0), axis="1 0 0"),
            LinkText("wrist", (0.1, 0.08, 0.08), (0.03, 0.0, 0.0), (0.09, 0.0, 0.0), axis="0 1 0"),
            LinkText(
                "flange", (0.03, 0.06, 0.06), (0.015, 0.0, 0.0), (0.03, 0.0, 0.0), axis="1 0 0"
            ),
        ]
    )


def five_joints() -> RobotText:
    """The same without its fourth joint."""
    robot = six_joints()
    elbow, forearm = robot.links[2], robot.links[3]
    elbow.box_m, elbow.center_m, elbow.next_m = (0.5, 0.1, 0.1), (0.2, 0.0, 0.0), (0.45, 0.0, 0.0)
    robot.links.remove(forearm)
    return robot


def seven_joints() -> RobotText:
    """The same with a roll in its upper arm."""
    robot = six_joints()
    upper = robot.links[1]
    upper.box_m, upper.center_m, upper.next_m = (0.12, 0.1, 0.2), (0.0, 0.0, 0.1), (0.0, 0.0, 0.25)
    roll = LinkText("roll", (0.1, 0.1, 0.14), (0.0, 0.0, 0.09), (0.0, 0.0, 0.25))
    robot.links.insert(2, roll)
    return robot


def scara() -> RobotText:
    """Two arms in a plane; the quill slides and turns."""
    return RobotText(
        [
            LinkText("arm_1", (0.4, 0.12, 0.1), (0.15, 0.0, 0.05), (0.3, 0.0, 0.1)),
            LinkText("arm_2", (0.35, 0.1, 0.15), (0.12, 0.0, 0.09), (0.25, 0.0, 0.05)),
            LinkText(
                "quill", (0.03, 0.03, 0.3), (0.0, 0.0, 0.0), kind="prismatic", limit=(-0.15, -0.01)
            ),
            LinkText("spindle", (0.04, 0.04, 0.02), (0.0, 0.0, -0.16), kind="continuous"),
        ]
    )


def box_stl(path: Path, size_m: tuple[float, float, float], *, without: int = 0) -> Path:
    """A binary STL of a box about the origin, some of its triangles left out."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    corners = corners * np.array(size_m)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))][without:]
    rows = b"".join(
        struct.pack("<12fH", 0, 0, 0, *corners[list(triangle)].ravel(), 0) for triangle in triangles
    )
    path.write_bytes(b"\0" * 80 + struct.pack("<I", len(triangles)) + rows)
    return path
