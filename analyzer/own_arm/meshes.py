"""Triangles of a robot description's shapes; files are read by coal's loader (assimp)."""

from __future__ import annotations

import re
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.mesh_parts import separated_parts
from armodal.protocols.apart import apart, most_bytes_beside, most_s_beside
from armodal.protocols.errors import ArmError, MissingPackageError
from armodal.protocols.robot.records import Shape

__all__ = ["coal", "prepare", "read_mesh", "shape_triangles", "tried"]

Array = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int64]

_ROUND = 24  # sides of a drawn cylinder: 1 % of its radius inside the true one
_LARGEST_BYTES = 200 * 2**20
_KINDS = (".stl", ".obj", ".dae", ".ply")  # the loader knows dozens, made for other things
_HEAD = 65536  # characters of a COLLADA file that hold its asset
_UNIT = re.compile(r"<unit\b[^>]*?\bmeter\s*=\s*[\"']\s*([0-9.]+(?:[eE][-+]?[0-9]+)?)\s*[\"']")


@cache
def coal() -> Any:
    """Return the library of shapes and collisions that comes with pinocchio."""
    try:
        return import_module("coal")
    except ImportError as error:
        raise MissingPackageError(
            f"wanted the package coal for meshes and collisions, it cannot be loaded: {error}. "
            "It comes with pinocchio: `pip install pin` on Linux and macOS"
        ) from error


def shape_triangles(shape: Shape) -> tuple[Array, Triangles]:
    """Vertices (n, 3) in m, link frame, and triangles (m, 3) that turn outwards.

    Raises
    ------
    ArmError
        If the mesh's file holds no triangles.
    """
    if shape.vertices_m is not None and shape.triangles is not None:
        vertices, triangles = shape.vertices_m, shape.triangles
    elif shape.kind == "mesh":
        if shape.file is None:
            raise ArmError(f"wanted the mesh {shape.named!r}, found no such file")
        vertices, triangles = read_mesh(shape.file)
        vertices = vertices * _unit_m(shape.file)
        vertices = vertices * np.array(shape.size_m)
    else:
        vertices, triangles = _drawn(shape.kind, shape.size_m)
    T = shape.T_link_shape
    return vertices @ T[:3, :3].T + T[:3, 3], triangles


def read_mesh(path: Path) -> tuple[Array, Triangles]:
    """Vertices (n, 3) in the file's units and triangles (m, 3).

    Raises
    ------
    ArmError
        If the file cannot be read, or holds no triangles.
    """
    kind, name = path.suffix.lower(), f"mesh {path.name}"
    if kind not in _KINDS:
        raise ArmError(f"{name}: wanted STL, OBJ, DAE or PLY, got another kind; convert it")
    if not path.is_file():
        raise ArmError(f"{name}: wanted a file, found none; check the path")
    size = path.stat().st_size
    if size > _LARGEST_BYTES:
        raise ArmError(f"{name}: wanted at most {_LARGEST_BYTES} bytes, got more")
    if kind != ".stl":  # whose triangles stand one after the other
        apart(
            f"{__name__}:tried",
            {"path": str(path)},
            most_bytes=most_bytes_beside(size),
            most_s=most_s_beside(size),
            what=name,
        )
    found = _loaded(path)
    vertices = np.array(found.vertices(), dtype=np.float64).reshape(-1, 3)
    each = map(found.tri_indices, range(found.num_tris))
    triangles = np.array([(t[0], t[1], t[2]) for t in each], dtype=np.int64).reshape(-1, 3)
    if len(triangles) < 4 or not np.isfinite(vertices).all():
        raise ArmError(
            f"mesh {path.name}: wanted triangles round a body, got {len(triangles)} triangles"
        )
    untangled = separated_parts(len(vertices), triangles)
    if untangled is None:
        raise ArmError(
            f"mesh {path.name}: wanted parts whose triangles can be told apart, got vertices that "
            "belong to none; export it as STL"
        )
    return vertices, untangled


def prepare() -> None:
    """Load the library, which takes memory of its own."""
    coal()


def tried(path: str) -> str:
    """Load a mesh, and let go of it."""
    _loaded(Path(path))
    return ""


def _loaded(path: Path) -> Any:
    library = coal()
    try:
        return library.MeshLoader(library.BV_OBBRSS).load(str(path), np.ones(3))
    except (ValueError, RuntimeError, OSError) as problem:
        raise ArmError(
            f"mesh {path.name}: wanted a mesh that can be read (STL, OBJ, DAE, PLY), got a broken "
            "or empty one"
        ) from problem


def _unit_m(path: Path) -> float:
    """Metres of a COLLADA file's unit, which the loader leaves to its caller; 1 for others."""
    if path.suffix.lower() != ".dae":
        return 1.0
    with path.open("r", encoding="utf-8", errors="replace") as file:
        found = _UNIT.search(file.read(_HEAD))
    return float(found.group(1)) if found else 1.0


def _drawn(kind: str, size_m: tuple[float, ...]) -> tuple[Array, Triangles]:
    if kind == "box":
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        vertices = 0.5 * corners * np.array(size_m)
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return vertices, np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
    radius = size_m[0]
    if kind == "sphere":
        angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, _ROUND // 2 + 1)
        return _turned(radius * np.cos(angles), radius * np.sin(angles))
    half = 0.5 * size_m[1]
    if kind == "capsule":
        angles = np.linspace(0.0, 0.5 * np.pi, _ROUND // 4 + 1)
        r, z = radius * np.cos(angles), radius * np.sin(angles) + half
        return _turned(np.concatenate([r[::-1], r]), np.concatenate([-z[::-1], z]))
    return _turned(np.array([0.0, radius, radius, 0.0]), np.array([-half, -half, half, half]))


def _turned(r: Array, z: Array) -> tuple[Array, Triangles]:
    """A profile from the lower pole to the upper one, turned about z."""
    angles = np.arange(_ROUND) * 2.0 * np.pi / _ROUND
    rings = [
        np.column_stack([ri * np.cos(angles), ri * np.sin(angles), np.full(_ROUND, zi)])
        for ri, zi in zip(r[1:-1], z[1:-1], strict=True)
    ]
    vertices = np.concatenate([[[0.0, 0.0, z[0]]], *rings, [[0.0, 0.0, z[-1]]]])
    last = len(vertices) - 1
    triangles = []
    for i in range(_ROUND):
        j = (i + 1) % _ROUND
        triangles.append((0, 1 + j, 1 + i))
        triangles.append((last, last - _ROUND + i, last - _ROUND + j))
        for ring in range(len(rings) - 1):
            a, b = 1 + ring * _ROUND, 1 + (ring + 1) * _ROUND
            triangles += [(a + i, a + j, b + j), (a + i, b + j, b + i)]
    return vertices, np.array(triangles)
