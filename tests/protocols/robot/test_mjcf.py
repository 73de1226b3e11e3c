"""MJCF against MuJoCo's own kinematics and masses."""

from __future__ import annotations

import numpy as np
import pytest

from armodal.protocols.robot.chain import cut_chain
from armodal.protocols.robot.read import read_robot
from armodal.protocols.robot.remarks import Remarks

mujoco = pytest.importorskip("mujoco")

MJCF = """<mujoco><compiler angle="degree"/><default><geom density="1500"/></default><worldbody>
<body name="base" pos="0 0 0.1"><geom type="box" size="0.1 0.1 0.1"/>
<body name="one" pos="0 0 0.2" euler="0 30 0"><joint name="j1" axis="0 0 1" pos="0.02 0 0"
 range="-100 100" limited="true"/><geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.05"/>
<body name="two" pos="0.3 0 0"><joint name="j2" axis="0 1 0" pos="0 0.01 0"/>
<geom type="cylinder" size="0.04 0.1" pos="0 0 0.1"/>
<body name="cover" pos="0 0 0.2"><geom type="sphere" size="0.05"/></body>
<body name="slide" pos="0 0.1 0"><joint name="j3" type="slide" axis="1 0 0" range="0 1"
 limited="true"/><geom type="box" size="0.02 0.02 0.02"/></body>
</body></body></body></worldbody></mujoco>"""


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(MJCF)
    return path


def test_links_stand_and_weigh_as_mujoco_has_them(path):
    said = Remarks()
    chain = cut_chain(read_robot(path, said), said)
    assert said.of("fault") == ()
    assert [body.name for body in chain.bodies] == ["one", "two"]
    assert [part.link.name for part in chain.bodies[1].parts] == ["two", "cover", "slide"]
    assert any("j3: is prismatic: held at 0 mm" in str(note) for note in said.of("note"))
    assert any("j2: is continuous" in str(guess) for guess in said.of("guess"))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    q = np.array([0.4, -0.7])
    data.qpos[:2] = q
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    T = np.eye(4)
    for angle, body in zip(q, chain.bodies, strict=True):
        turn = np.eye(4)
        x, y, z = body.joint.axis
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn[:3, :3] = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        T = T @ body.T_parent_joint @ turn
        for part in body.parts:
            own, placed = part.link.inertial, T @ part.T_body_link
            there = data.body(part.link.name)
            center = placed[:3, :3] @ own.center_m + placed[:3, 3]
            np.testing.assert_allclose(center, there.xipos, atol=1e-12)
            R = there.ximat.reshape(3, 3)
            principal = model.body(part.link.name).inertia
            np.testing.assert_allclose(
                placed[:3, :3] @ own.inertia_kg_m2 @ placed[:3, :3].T,
                R @ np.diag(principal) @ R.T,
                atol=1e-12,
            )


@pytest.mark.parametrize(
    "text", ["<mujoco><worldbody><body/>", "<mujoco><geom type='x'/></mujoco>"]
)
def test_a_file_that_does_not_compile_is_one_fault(text, tmp_path):
    path = tmp_path / "a.xml"
    path.write_text(text)
    said = Remarks()
    assert read_robot(path, said) is None
    assert [fault.where for fault in said.of("fault")] == ["file"]
