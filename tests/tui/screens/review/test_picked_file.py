import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.errors import SessionError
from armodal.tui.screens.review.picked_file import picked_path, read_picked, write_picked

EXACT = 1e-12  # rounding of a pole to frequency and damping and back


def told(rows="[]", form="armodal-picked-poles-1"):
    """Text of a picks file of another session."""
    return f'{{"format": "{form}", "session_id": "1", "postures": {{"a": {rows}}}}}'


@given(
    st.lists(
        st.tuples(st.floats(0.1, 1e4), st.floats(1e-4, 0.9)).map(
            lambda told: (
                2 * math.pi * told[0] * complex(-told[1], math.sqrt((1 - told[1]) * (1 + told[1])))
            )
        ),
        max_size=5,
    )
)
def test_picks_come_back_as_they_were_saved(session, tmp_path_factory, poles):
    path = picked_path(tmp_path_factory.mktemp("picks") / "s.h5")
    write_picked(path, session, {"test 1": tuple(poles)})
    back = read_picked(path, session)["test 1"]
    assert len(back) == len(poles)
    for pole, found in zip(poles, back, strict=True):
        assert abs(found - pole) <= EXACT * abs(pole)
    assert [file.name for file in path.parent.iterdir()] == ["s.picked.json"]


def test_no_file_is_no_picks(session, tmp_path):
    assert read_picked(tmp_path / "none.json", session) == {}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "\x00",
        told(form="other"),
        told(),
        told('[{"f_hz": -1, "damping_ratio": 0.1}]'),
        told('[{"f_hz": NaN, "damping_ratio": 0.1}]'),
        told('[{"f_hz": 10, "damping_ratio": 1.5}]'),
        told("3"),
    ],
)
def test_a_file_that_holds_no_picks_of_this_session_is_refused(session, tmp_path, text):
    path = tmp_path / "s.picked.json"
    path.write_text(text)
    with pytest.raises(SessionError, match="move it away"):
        read_picked(path, session)


def test_a_folder_that_is_gone_is_an_error_with_what_to_do(session, tmp_path):
    with pytest.raises(SessionError, match="check the folder"):
        write_picked(tmp_path / "gone" / "s.picked.json", session, {})
