"""Logs of motion: what is read, and what is told of a faulty one."""

import numpy as np
import pytest

from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.read_motion import read_motion_log

N = 300


def columns(arm, kinds=("encoder",)):
    names = ["time_s"]
    names += [f"{joint.name}_{kind}_deg" for kind in kinds for joint in arm.joints]
    return names + [f"acc_1_{axis}_m_s2" for axis in "xyz"]


def written(folder, names, values=None, lines=()):
    rng = np.random.default_rng(1)
    if values is None:
        values = np.column_stack([0.002 * np.arange(N), rng.normal(size=(N, len(names) - 1))])
        for joint in load_arm("rv4frl").joints:
            for i, name in enumerate(names):
                if name.startswith(joint.name):
                    values[:, i] += np.rad2deg(np.mean(joint.range_rad))
    rows = [",".join(repr(float(v)) for v in row) for row in values]
    for number, text in lines:
        rows[number - 2] = text
    path = folder / "log.csv"
    path.write_text("\n".join([",".join(names), *rows]) + "\n", encoding="utf-8")
    return path, values


def test_angles_and_accelerations_come_back_and_unused_columns_are_told(arm, tmp_path):
    names = [*columns(arm, ("command", "encoder")), "battery_v"]
    path, values = written(tmp_path, names)
    log = read_motion_log(path, arm)
    assert log.rate_hz == pytest.approx(500.0)
    np.testing.assert_array_equal(log.command_rad, np.deg2rad(values[:, 1:7]))
    np.testing.assert_array_equal(log.encoder_rad, np.deg2rad(values[:, 7:13]))
    np.testing.assert_array_equal(log.angles_rad, log.encoder_rad)
    np.testing.assert_array_equal(log.acceleration_m_s2["1"], values[:, 13:16])
    assert log.unused == ("battery_v",)


def test_commands_serve_where_there_is_no_encoder(arm, tmp_path):
    path, values = written(tmp_path, columns(arm, ("command",)))
    log = read_motion_log(path, arm)
    assert log.encoder_rad is None
    np.testing.assert_array_equal(log.angles_rad, np.deg2rad(values[:, 1:7]))


def refused(path, arm):
    with pytest.raises(ForeignFileError) as told:
        read_motion_log(path, arm)
    return str(told.value)


def test_all_columns_that_lack_are_named_at_once(arm, tmp_path):
    names = [name.replace("joint_3_encoder_deg", "joint_3_rad") for name in columns(arm)]
    names = [name.replace("time_s", "stamp").replace("_m_s2", "_g") for name in names]
    said = refused(written(tmp_path, names)[0], arm)
    for what in (
        "a column time_s",
        "without joint_3_encoder_deg",
        "acc_POINT_x_m_s2",
        "joint_3_rad",
    ):
        assert what in said


def test_faulty_rows_and_a_clock_that_jumps_are_told_by_line(arm, tmp_path):
    names = columns(arm)
    said = refused(written(tmp_path, names, lines=[(7, "1,2"), (9, ",".join("x" * 10))])[0], arm)
    assert "got others in lines 7, 9;" in said
    _, values = written(tmp_path, names)
    values[100:, 0] += 0.5
    assert "others in line 102: a jump of the clock" in refused(
        written(tmp_path, names, values)[0], arm
    )
    values[:, 0] = 0.0
    assert "a time_s that grows" in refused(written(tmp_path, names, values)[0], arm)


def test_angles_in_another_unit_are_told_by_joint(arm, tmp_path):
    path, values = written(tmp_path, columns(arm))
    values[:, 2:4] *= 1000.0
    written(tmp_path, columns(arm), values)
    said = refused(path, arm)
    assert "joint_2 within" in said
    assert "joint_3 within" in said
    assert "joint_4" not in said


def test_a_file_that_is_short_empty_or_not_there_is_one_message(arm, tmp_path):
    path, values = written(tmp_path, columns(arm))
    written(tmp_path, columns(arm), values[:20])
    assert "at least 200 rows, got 20" in refused(path, arm)
    path.write_text("", encoding="utf-8")
    assert "got the columns none" in refused(path, arm)
    assert "log of motion" in refused(tmp_path / "none.csv", arm)


RTDE = [
    "timestamp",
    *(f"target_q_{i}" for i in range(6)),
    *(f"actual_q_{i}" for i in range(6)),
    "robot_mode",
    *(f"actual_tool_accelerometer_{i}" for i in range(3)),
]


def rtde_table(folder, arm, separator):
    rng = np.random.default_rng(1)
    values = np.column_stack([152.5 + 0.008 * np.arange(N), rng.normal(size=(N, 16))])
    values[:, 1:13] *= 1e-4
    values[:, 1:13] += np.tile([np.mean(joint.range_rad) for joint in arm.joints], 2)
    path = folder / "robot_data.csv"
    rows = [separator.join(RTDE), *(separator.join(map(repr, row)) for row in values.tolist())]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path, values


@pytest.mark.parametrize("separator", [" ", ","])
def test_a_table_of_universal_robots_rtde_client_is_read_in_its_own_units(arm, tmp_path, separator):
    path, values = rtde_table(tmp_path, arm, separator)
    log = read_motion_log(path, arm, {"1": "actual_tool_accelerometer"})
    assert log.rate_hz == pytest.approx(125.0)
    np.testing.assert_allclose(log.command_rad, values[:, 1:7], rtol=1e-15)
    np.testing.assert_allclose(log.encoder_rad, values[:, 7:13], rtol=1e-15)
    np.testing.assert_array_equal(log.acceleration_m_s2["1"], values[:, 14:])
    assert log.unused == ("robot_mode",)


def test_of_an_rtde_table_it_is_asked_where_the_accelerometer_is(arm, tmp_path):
    path, _ = rtde_table(tmp_path, arm, " ")
    assert "--topic POINT=actual_tool_accelerometer" in refused(path, arm)
    with pytest.raises(ForeignFileError, match="got it with a CSV log: encoder=actual_q"):
        read_motion_log(path, arm, {"encoder": "actual_q"})
