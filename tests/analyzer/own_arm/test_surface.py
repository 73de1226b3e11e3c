"""Surfaces against closed forms of boxes, balls and capsules."""

from __future__ import annotations

import os

import numpy as np
import pytest
from support.robot_files import box_stl

from armodal.analyzer.own_arm.mesh_parts import separated_parts
from armodal.analyzer.own_arm.meshes import read_mesh, shape_triangles
from armodal.analyzer.own_arm.surface import Surface, filling
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.records import Shape


def surface_of(kind, size, T=None):
    return Surface(
        *shape_triangles(Shape(kind=kind, size_m=size, T_link_shape=np.eye(4) if T is None else T))
    )


def test_a_box_is_filled_as_its_closed_form_says():
    T = np.eye(4)
    T[:3, 3] = [0.3, -0.2, 0.5]
    box = surface_of("box", (0.2, 0.3, 0.5), T)
    found = box.hull_filling
    assert found.volume_m3 == pytest.approx(0.03, rel=1e-12)
    np.testing.assert_allclose(found.center_m, T[:3, 3], atol=1e-12)
    a, b, c = 0.04, 0.09, 0.25
    expected = np.diag([b + c, a + c, a + b]) / 12.0
    np.testing.assert_allclose(found.inertia_over_mass_m2, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "size", "volume"),
    [
        ("sphere", (0.1,), 4 / 3 * np.pi * 1e-3),
        ("cylinder", (0.1, 0.4), np.pi * 0.01 * 0.4),
        ("capsule", (0.1, 0.4), np.pi * 0.01 * 0.4 + 4 / 3 * np.pi * 1e-3),
    ],
)
def test_round_shapes_are_closed_and_a_little_inside_the_true_ones(kind, size, volume):
    drawn = surface_of(kind, size)
    assert drawn.open_edges == 0
    # 24 sides: the area is sin(2 pi/24) 24/(2 pi) = 0.989 of the circle's, less along a sphere.
    assert 0.97 * volume < drawn.hull_filling.volume_m3 < volume


def test_an_open_mesh_has_open_edges_and_its_hull_serves(tmp_path):
    open_box = Surface(*read_mesh(box_stl(tmp_path / "open.stl", (1.0, 1.0, 1.0), without=2)))
    assert open_box.open_edges > 0
    assert open_box.hull_filling.volume_m3 == pytest.approx(1.0, rel=1e-6)


def test_a_collada_file_in_inches_is_read_in_metres(tmp_path):
    mesh = tmp_path / "a.dae"
    mesh.write_text(DAE.format(unit='<unit meter="0.0254" name="inch"/>'))
    shape = Shape(kind="mesh", size_m=(1.0, 1.0, 1.0), T_link_shape=np.eye(4), file=mesh)
    assert Surface(*shape_triangles(shape)).size_m == pytest.approx(0.0254)


def test_a_file_of_two_materials_is_read_as_its_two_bodies(tmp_path):
    big, small = (surface_of("box", size) for size in ((0.2, 0.2, 0.2), (0.1, 0.1, 0.1)))
    lines, before = [], 1
    for name, box, off in (("cover", small, 0.5), ("robot", big, 0.0)):
        lines += [f"v {x + off} {y} {z}" for x, y, z in box.vertices_m]
        lines += [f"usemtl {name}"]
        lines += [f"f {a + before} {b + before} {c + before}" for a, b, c in box.triangles]
        before += len(box.vertices_m)
    mesh = tmp_path / "a.obj"
    mesh.write_text("\n".join(lines))
    read = Surface(*read_mesh(mesh))
    assert read.open_edges == 0
    corners = read.vertices_m[read.triangles]
    # The volume inside the triangles is that of both boxes, not of what strangers' corners enclose.
    assert filling(corners, np.zeros(3)).volume_m3 == pytest.approx(0.009, rel=1e-6)


def test_a_part_that_repeats_its_first_triangle_is_still_one_part():
    part = np.array([[0, 1, 2], [0, 1, 2], [0, 2, 3], [3, 1, 0]])
    right = np.concatenate([part, part + 4])
    np.testing.assert_array_equal(separated_parts(8, np.concatenate([part, part])), right)
    np.testing.assert_array_equal(separated_parts(8, right), right)
    assert separated_parts(9, np.concatenate([part, part])) is None


@pytest.mark.parametrize("content", [b"", b"solid a\nfacet", b"\0" * 84])
def test_a_broken_mesh_is_refused_in_plain_words(content, tmp_path):
    path = tmp_path / "a.stl"
    path.write_bytes(content)
    with pytest.raises(ArmError, match=r"mesh a\.stl: wanted") as refused:
        read_mesh(path)
    assert "assimp" not in str(refused.value)


DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{unit}<up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no such files")
def test_what_is_no_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.stl")
    with pytest.raises(ArmError, match="wanted a file"):
        read_mesh(tmp_path / "pipe.stl")


def test_a_mesh_of_another_kind_is_refused(tmp_path):
    (tmp_path / "a.gltf").write_text("{}", encoding="utf-8")
    with pytest.raises(ArmError, match="wanted STL, OBJ, DAE or PLY"):
        read_mesh(tmp_path / "a.gltf")
