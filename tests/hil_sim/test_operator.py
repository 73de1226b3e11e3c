import contextlib
import json
import os
import socket
import stat
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.host_side import OperatorLine
from support.synthetic_laboratory import PEAK_COUNTS, known_arm

from armodal.hil_sim.ledger import LedgerWriter, read_ledger
from armodal.hil_sim.operator import Operator, Workplace
from armodal.hil_sim.operator_socket import MAX_LINE, OperatorSocket
from armodal.hil_sim.streams import stream
from armodal.protocols.errors import PlantError


class Place:
    def __init__(self, bench, directory):
        arm = known_arm()
        self.bench = bench
        self.marked = []
        self.ledger_path = directory / "ledger.jsonl"
        self.ledger = LedgerWriter(self.ledger_path, arm.plant, seed=1, time_scale=1.0)
        self.operator = Operator(
            Workplace(
                cell=bench.cell,
                move_to=bench.controller.move_to,
                swing=arm.swing,
                ranges_rad=((-np.pi, np.pi),) * 6,
                points=frozenset(arm.plant.points),
                faults=bench.faults,
                ledger=self.ledger,
                mounted=arm.mounted,
                mark=lambda point, marking: self.marked.append((point, marking)),
            ),
            clock=bench.clock,
            streams=partial(stream, 2),
        )
        self.socket = OperatorSocket(
            directory / "operator.sock", self.operator.begin, clock=bench.clock
        )
        self.lines = []

    def connect(self):
        line = OperatorLine(self.socket.path)
        line.socket.settimeout(0.05)
        self.lines.append(line)
        return line

    def go_on(self, seconds, step_s=0.01):
        for _ in range(round(seconds / step_s)):
            self.bench.time.now_s += step_s
            self.bench.controller.step()
            self.bench.board.step()
            self.socket.step()

    def ask(self, line, request, seconds):
        line.socket.sendall(json.dumps(request).encode() + b"\n")
        self.go_on(seconds)
        return json.loads(line.file.readline())

    def close(self):
        for line in self.lines:
            line.close()
        self.socket.close()
        self.ledger.close()


@pytest.fixture
def place(bench, tmp_path):
    made = Place(bench, tmp_path)
    yield made
    made.close()


def test_only_the_owner_may_connect(place):
    assert stat.S_IMODE(place.socket.path.stat().st_mode) == 0o600


def test_a_posture_is_answered_when_the_arm_is_there(place):
    line = place.connect()
    joints = [30.0, 0, 0, 0, 0, 0]
    line.socket.sendall(json.dumps({"do": "posture", "name": "a", "joints_deg": joints}).encode())
    line.socket.sendall(b"\n")
    # 30 degrees at 1 rad/s peak take 1.875 x 0.52 s, and half a second to settle.
    place.go_on(1.4)
    with pytest.raises(TimeoutError):
        line.socket.recv(1)
    place.go_on(0.2)
    assert json.loads(line.socket.recv(4096))["done"] is True
    np.testing.assert_allclose(place.bench.cell.joints_rad, np.radians(joints))
    (event,) = read_ledger(place.ledger_path).of("posture")
    np.testing.assert_allclose(event["joints_rad"], np.radians(joints))


def test_a_mount_takes_a_few_seconds(place):
    line = place.connect()
    line.socket.sendall(b'{"do": "mount", "point": "2"}\n')
    place.go_on(2.9)
    assert place.bench.cell.point == "1"
    place.go_on(3.2)
    assert json.loads(line.file.readline()) == {"done": True, "do": "mount", "point": "2"}
    assert place.bench.cell.point == "2"


def test_a_point_is_marked_where_it_is_asked_for_with_axes_at_right_angles(place):
    line = place.connect()
    request = {"do": "mark", "point": "2", "position_m": [0.1, 0, 0.2]}
    request |= {"normal": [0, 0, 2.0], "x_axis": [3.0, 0, 1.0]}
    assert place.ask(line, request, 2.5) == {"done": True, "do": "mark", "point": "2"}
    ((point, marking),) = place.marked
    assert point == "2"
    assert marking.position_m == (0.1, 0.0, 0.2)
    np.testing.assert_allclose(marking.normal, [0.0, 0.0, 1.0])
    np.testing.assert_allclose(marking.x_axis, [1.0, 0.0, 0.0])
    (event,) = read_ledger(place.ledger_path).of("mark")
    assert event["position_m"] == [0.1, 0.0, 0.2]
    answer = place.ask(line, request | {"x_axis": [0, 0, 1.0]}, 0.1)
    assert "two directions that differ" in answer["error"]


def test_a_hit_lies_between_samples_and_is_answered_after_it(place):
    place.bench.cell.start_sampling(1000)
    line = place.connect()
    answer = place.ask(line, {"do": "hit", "point": "1", "direction": [0, 0, -2]}, 1.5)
    assert answer == {"done": True, "do": "hit", "point": "1"}
    ((at_sample, peak),) = place.bench.source.hits
    assert peak == PEAK_COUNTS
    assert at_sample % 1.0 != 0.0
    (event,) = read_ledger(place.ledger_path).of("hit")
    assert event["at_sample"] == at_sample
    assert event["wanted_direction"] == [0.0, 0.0, -1.0]


def test_a_hit_while_the_board_rests_leaves_no_sample(place):
    line = place.connect()
    assert place.ask(line, {"do": "hit", "point": "1", "direction": [1, 0, 0]}, 1.5)["done"]
    (event,) = read_ledger(place.ledger_path).of("hit")
    assert event["at_sample"] is None


def test_the_answers_keep_the_truth_to_themselves(place):
    place.bench.cell.start_sampling(1000)
    line = place.connect()
    answer = place.ask(line, {"do": "hit", "point": "1", "direction": [1, 0, 0]}, 1.5)
    assert set(answer) == {"done", "do", "point"}


@pytest.mark.parametrize(
    ("request_line", "words"),
    [
        (b"no json", "one line of JSON"),
        (b"[1, 2]", "wanted an object"),
        (b"\xff\xfe", "one line of JSON"),
        (b"[" * 60_000, "one line of JSON"),
        (b'{"do": "dance"}', "posture, mount, hit, hit-mass, mark or fault"),
        (b'{"do": ["mount"]}', "posture, mount, hit, hit-mass, mark or fault"),
        (b'{"do": "mount", "point": "99"}', "wanted a test point"),
        (b'{"do": "mount", "point": ["1"]}', "wanted a test point"),
        (b'{"do": "posture", "joints_deg": [1, 2]}', "list of 6 numbers"),
        (b'{"do": "posture", "joints_deg": [1, 2, 3, 4, 5, "x"]}', "list of 6 numbers"),
        (b'{"do": "posture", "joints_deg": [0, 0, 0, 0, 0, NaN]}', "list of 6 numbers"),
        (b'{"do": "posture", "joints_deg": [0, 0, 0, 0, 181, 0]}', "joint 5: wanted -180"),
        (b'{"do": "hit", "point": "1", "direction": [0, 0, 0]}', "not all zero"),
        (b'{"do": "hit", "point": "1"}', "list of 3 numbers"),
        (
            b'{"do": "hit", "point": "1", "direction": [0, 0, 1], "peak_n": 0}',
            "peak_n: wanted 0.1 to 10000, got 0",
        ),
        (b'{"do": "fault", "name": "flood"}', "wanted a fault"),
    ],
)
def test_a_malformed_request_gets_an_error_line_and_the_next_is_served(place, request_line, words):
    line = place.connect()
    line.socket.settimeout(60.0)
    for start in range(0, len(request_line), 4096):
        line.socket.sendall(request_line[start : start + 4096])
        place.go_on(0.01)
    line.socket.sendall(b"\n")
    place.go_on(0.1)
    assert words in json.loads(line.file.readline())["error"]
    assert place.ask(line, {"do": "fault", "name": "can-silence"}, 0.1)["done"]


@given(
    request=st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(max_size=5),
        lambda inner: (
            st.lists(inner, max_size=6)
            | st.dictionaries(
                st.sampled_from(["do", "point", "joints_deg", "direction", "name"]), inner
            )
        ),
        max_leaves=10,
    ),
    do=st.sampled_from(["posture", "mount", "hit", "other"]),
)
def test_any_json_is_begun_or_refused(request, do):
    operator = Operator(
        Workplace(
            cell=None,
            move_to=None,
            swing=None,
            ranges_rad=((-1.0, 1.0),) * 6,
            points=frozenset({"1"}),
            faults=None,
            ledger=None,
            mounted=None,
        ),
        clock=None,
        streams=partial(stream, 2),
    )
    if isinstance(request, dict):
        request = request | {"do": do}
    with contextlib.suppress(PlantError):
        operator.begin(request).close()


def test_an_endless_line_is_cut_off(place):
    line = place.connect()
    line.socket.settimeout(60.0)
    for _ in range(MAX_LINE // 4096 + 2):
        try:
            line.socket.sendall(b"x" * 4096)
        except OSError:
            break
        place.go_on(0.01)
    assert "error" in json.loads(line.file.readline())
    assert place.ask(place.connect(), {"do": "fault", "name": "can-silence"}, 0.1)["done"]


def test_a_second_client_is_told_to_come_back(place):
    first, second = place.connect(), place.connect()
    place.go_on(0.05)
    assert "another client" in json.loads(second.file.readline())["error"]
    assert place.ask(first, {"do": "fault", "name": "can-silence"}, 0.1)["done"]


def test_an_answer_does_not_reach_the_next_client(place):
    first = place.connect()
    first.socket.sendall(b'{"do": "mount", "point": "2"}\n')
    place.go_on(0.1)
    first.close()
    place.go_on(0.1)
    second = place.connect()
    place.go_on(6.0)
    assert place.bench.cell.point == "2"
    with pytest.raises(TimeoutError):
        second.socket.recv(1)


def test_a_path_too_long_for_a_socket_is_refused(tmp_path, bench):
    with pytest.raises(PlantError, match="shorter path"):
        OperatorSocket(tmp_path / ("x" * 110), lambda request: None, clock=bench.clock)


def test_the_socket_is_gone_after_closing(bench, tmp_path):
    made = Place(bench, tmp_path)
    made.close()
    with socket.socket(socket.AF_UNIX) as client, pytest.raises(FileNotFoundError):
        client.connect(str(made.socket.path))


def test_a_socket_left_by_a_killed_laboratory_is_taken_over(tmp_path, bench):
    path = tmp_path / "operator.sock"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as dead:
        dead.bind(str(path))
    taken = OperatorSocket(path, lambda request: iter(()), clock=bench.clock)
    try:
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    finally:
        taken.close()


def test_a_living_laboratory_keeps_its_socket(tmp_path, bench):
    path = tmp_path / "operator.sock"
    living = OperatorSocket(path, lambda request: iter(()), clock=bench.clock)
    try:
        with pytest.raises(PlantError, match="another laboratory listens"):
            OperatorSocket(path, lambda request: iter(()), clock=bench.clock)
    finally:
        living.close()


def test_a_file_where_the_socket_should_be_is_left_alone(tmp_path, bench):
    path = tmp_path / "operator.sock"
    path.write_text("precious")
    with pytest.raises(PlantError, match="cannot listen"):
        OperatorSocket(path, lambda request: iter(()), clock=bench.clock)
    assert path.read_text() == "precious"


@pytest.mark.parametrize("there", [False, True])
def test_a_link_where_the_socket_should_be_is_not_followed(there, tmp_path, bench):
    elsewhere = tmp_path / "elsewhere.sock"
    if there:
        elsewhere.write_text("precious")
    path = tmp_path / "operator.sock"
    path.symlink_to(elsewhere)
    with pytest.raises(PlantError, match="cannot listen"):
        OperatorSocket(path, lambda request: None, clock=bench.clock)
    assert path.is_symlink()
    assert elsewhere.exists() == there


def test_the_socket_is_its_owners_alone_whatever_the_umask(tmp_path, bench):
    path = tmp_path / "operator.sock"
    before = os.umask(0)
    try:
        made = OperatorSocket(path, lambda request: iter(()), clock=bench.clock)
        assert os.umask(0) == 0  # as it was
    finally:
        os.umask(before)
    try:
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    finally:
        made.close()


def test_the_ledger_is_readable_by_its_user_only(tmp_path):
    path = tmp_path / "ledger.jsonl"
    LedgerWriter(path, known_arm().plant, seed=1, time_scale=1.0).close()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
