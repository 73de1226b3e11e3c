"""Files made to take much of decoders of robots, logs, packets and small files; see `bombs.py`."""

from __future__ import annotations

from support.bombs import bomb

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
