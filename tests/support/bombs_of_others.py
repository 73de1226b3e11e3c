"""Files made to take much of decoders of robots, logs, packets and small files; see `bombs.py`."""

from __future__ import annotations

import io
import sqlite3
from contextlib import closing
from pathlib import Path

from support.bombs import BOMBS, bomb

_XACRO = b'<?xml version="1.0"?><robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'


def _xacro(body: bytes) -> bytes:
    return _XACRO + body + b"</robot>"


@bomb(("robot",), ".xacro")
def macros_of_macros() -> bytes:
    parts = [b'<xacro:macro name="m0"><link name="l"/></xacro:macro>']
    parts += [
        b'<xacro:macro name="m%d">' % i + b"<xacro:m%d/>" % (i - 1) * 10 + b"</xacro:macro>"
        for i in range(1, 8)
    ]
    return _xacro(b"".join(parts) + b"<xacro:m7/>")


@bomb(("robot",), ".xacro")
def a_text_of_a_gigabyte() -> bytes:
    return _xacro(b"<xacro:property name='a' value=\"${'a'*10**9}\"/><link name='${a}'/>")


@bomb(("robot",), ".xacro")
def a_power_of_a_power() -> bytes:
    return _xacro(b"<xacro:property name='a' value=\"${10**10**9}\"/><link name='${a}'/>")


@bomb(("robot",), ".xacro")
def a_macro_within_itself() -> bytes:
    return _xacro(b'<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>')


def _mjcf(before: bytes, body: bytes = b'<body><geom size=".1"/></body>') -> bytes:
    return b"<mujoco>" + before + b"<worldbody>" + body + b"</worldbody></mujoco>"


@bomb(("robot",), ".xml")
def thirty_million_copies() -> bytes:
    copies = (
        b'<replicate count="30000000" offset="1 0 0"><body><geom size=".1"/></body></replicate>'
    )
    return _mjcf(b"", copies)


@bomb(("robot",), ".xml")
def copies_of_copies() -> bytes:
    copies = b'<replicate count="1000" offset="1 0 0">' * 3
    return _mjcf(b"", copies + b'<body><geom size=".1"/></body>' + b"</replicate>" * 3)


@bomb(("robot",), ".xml")
def a_billion_keyframes() -> bytes:
    joint = b'<body><joint/><geom size=".1"/></body>'
    return _mjcf(b'<size nkey="1000000000"/>', joint)


@bomb(("robot",), ".xml")
def numbers_of_the_user() -> bytes:
    return _mjcf(b'<size nuser_body="400000000"/>')


@bomb(("robot",), ".xml")
def a_grid_of_millions() -> bytes:
    grid = b'<flexcomp name="f" type="grid" count="2000 2000 50" spacing="1 1 1" dim="3"/>'
    return _mjcf(b"", grid)


@bomb(("robot",), ".urdf")
def many_shapes() -> bytes:
    shape = b'<visual><geometry><sphere radius="1"/></geometry></visual>'
    return b'<robot name="r"><link name="a">' + shape * 15_000 + b"</link></robot>"


_COLUMNS = b"time_s," + b",".join(b"joint_%d_encoder_deg" % i for i in range(1, 7))


@bomb(("motion",), ".csv")
def large_rows_of_ones() -> bytes:
    return _COLUMNS + b",acc_1_x_m_s2,acc_1_y_m_s2,acc_1_z_m_s2\n" + b"1\n" * 49_000_000


@bomb(("motion",), ".csv")
def a_hundred_thousand_names() -> bytes:
    return b",".join(b"c%d" % i for i in range(100_000)) + b"\n"


@bomb(("motion",), ".csv")
def a_name_without_end() -> bytes:
    return b'time_s,"' + b"a" * 500_000 + b"\n"


@bomb(("gap result",), ".json")
def a_list_of_ones() -> bytes:
    return b'{"effects":[' + b"1," * 400_000 + b"1]}"


@bomb(("gap result",), ".json")
def keys_unknown() -> bytes:
    return b"{" + b",".join(b'"k%d":1' % i for i in range(80_000)) + b"}"


@bomb(("sensor memory",), ".json")
def many_wrong_sensors() -> bytes:
    sensors = b",".join(b'"a%d":1' % i for i in range(80_000))
    return b'{"format":"armodal-sensors-1","sensors":{' + sensors + b"}}"


@bomb(("postures",), ".txt")
def large_lines_of_letters() -> bytes:
    return b"a\n" * 9_900_000


@bomb(("postures",), ".txt")
def large_line_of_numbers() -> bytes:
    return b"1," * 9_900_000


@bomb(("mesh",), ".stl")
def triangles_that_are_not_there() -> bytes:
    return bytes(80) + (2**32 - 1).to_bytes(4, "little") + bytes(500)


@bomb(("mesh",), ".obj")
def many_faces_of_one_point() -> bytes:
    return b"v 0 0 0\n" + b"f 1 1 1\n" * 100_000


@bomb(("front end", "mqtt", "sensors"), ".toml")
def small_files_of_tables() -> bytes:
    return b"[[channels]]\n" * 4_000


def _packed_mcap(text: bytes, compression: str) -> bytes:
    """An MCAP file whose only message is a JSON text after half a gigabyte of blanks."""
    from mcap.writer import CompressionType, Writer  # noqa: PLC0415 - an extra

    stream = io.BytesIO()
    file = Writer(stream, chunk_size=2**30, compression=CompressionType[compression])
    file.start()
    schema = file.register_schema("sensor_msgs/Imu", "jsonschema", b"{}")
    channel = file.register_channel("/a", "json", schema)
    file.add_message(channel, 1, text, 1)
    file.finish()
    return stream.getvalue()


@bomb(("motion",), ".mcap")
def blanks_in_an_mcap() -> bytes:
    return _packed_mcap(b" " * 250_000_000 + b"{}", "LZ4")


@bomb(("motion",), ".mcap")
def an_array_of_nothing() -> bytes:
    """A message of which a billion empty ones are said to lie in it."""
    from mcap.writer import Writer  # noqa: PLC0415 - an extra

    stream = io.BytesIO()
    file = Writer(stream)
    file.start()
    line = b"=" * 80
    text = b"a/Row[1000000000] header\n" + line + b"\nMSG: a/Row\na/Leaf one\n"
    text += line + b"\nMSG: a/Leaf\nuint8[0] no\n"
    schema = file.register_schema("sensor_msgs/msg/Imu", "ros2msg", text)
    channel = file.register_channel("/a", "cdr", schema)
    file.add_message(channel, 1, b"\x00\x01\x00\x00" + bytes(64), 1)
    file.finish()
    return stream.getvalue()


def _endless_view(path: Path) -> None:
    """A bag whose version is the count of rows without end."""
    with closing(sqlite3.connect(path)) as db:
        db.execute("CREATE TABLE topics(id, name, type, serialization_format)")
        db.execute("CREATE TABLE messages(id, topic_id, timestamp, data)")
        db.execute(
            "CREATE VIEW schema AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i+1 FROM n) "
            "SELECT count(*) AS schema_version FROM n"
        )
        db.commit()


BOMBS["a_bag_without_end"] = ("motion",), ".db3", _endless_view


@bomb(("mesh",), ".ply")
def vertices_that_are_not_there() -> bytes:
    head = b"ply\nformat binary_little_endian 1.0\nelement vertex 400000000\n"
    head += b"property float x\nproperty float y\nproperty float z\nelement face 1\n"
    return head + b"property list uint int vertex_indices\nend_header\n" + bytes(100)


@bomb(("mesh",), ".obj")
def a_face_of_many_corners() -> bytes:
    return b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf " + b"1 2 3 " * 100_000 + b"\n"


@bomb(("mesh",), ".dae")
def nodes_of_nodes() -> bytes:
    """A tetrahedron ten times in a node, and that ten times in another, and so on."""
    return collada(nodes=9)


def collada(nodes: int) -> bytes:
    """A tetrahedron in a node, and each of the others ten times the one before."""
    inner = [b'<node id="m0"><instance_geometry url="#g"/></node>']
    inner += [
        b'<node id="m%d">' % i + b'<instance_node url="#m%d"/>' % (i - 1) * 10 + b"</node>"
        for i in range(1, nodes)
    ]
    axes = b"".join(b'<param name="%c" type="float"/>' % axis for axis in b"XYZ")
    return (
        b'<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" '
        b'version="1.4.1"><asset><unit meter="1"/></asset><library_geometries><geometry id="g">'
        b'<mesh><source id="s"><float_array id="f" count="12">0 0 0 1 0 0 0 1 0 0 0 1'
        b'</float_array><technique_common><accessor source="#f" count="4" stride="3">' + axes +
        b'</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" '
        b'source="#s"/></vertices><triangles count="4"><input semantic="VERTEX" source="#v" '
        b'offset="0"/><p>0 1 2 0 2 3 0 3 1 1 3 2</p></triangles></mesh></geometry>'
        b"</library_geometries><library_nodes>" + b"".join(inner) +
        b'</library_nodes><library_visual_scenes><visual_scene id="VS"><node id="n">'
        b'<instance_node url="#m%d"/>' % (nodes - 1) + b"</node></visual_scene>"
        b"</library_visual_scenes><scene>"
        b'<instance_visual_scene url="#VS"/></scene></COLLADA>'
    )  # fmt: skip
