"""Work on a file in a process of its own: what comes back, and what is refused."""

from __future__ import annotations

import sys

import pytest

from armodal.protocols.apart import apart, bytes_allowed
from armodal.protocols.errors import ArmError, ForeignFileError

HERE = "support.worked_apart"
MOST_BYTES = 150_000_000


@pytest.fixture(autouse=True)
def _found_by_the_other_process(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", ":".join(path for path in sys.path if path))


def done(name, **arguments):
    return apart(f"{HERE}:{name}", arguments, most_bytes=MOST_BYTES, most_s=1, what="a.xml")


def test_what_is_returned_comes_back():
    assert done("said", text="ä\n", times=2) == "ä\nä\n"


def test_what_a_library_prints_is_not_the_answer():
    assert done("prints") == "answer"


def test_a_refusal_is_raised_as_it_was():
    with pytest.raises(ForeignFileError, match="wanted another"):
        done("refuses")


@pytest.mark.parametrize(
    "name",
    ["takes_memory", pytest.param("takes_time", marks=pytest.mark.long), "crashes", "fails"],
)
@pytest.mark.skipif(sys.platform != "linux", reason="bounds a process as Linux does")
def test_what_takes_too_much_or_crashes_is_refused(name):
    with pytest.raises(ArmError, match=r"a\.xml: wanted a file that is read within 1 s"):
        done(name)


def test_a_text_that_names_other_files_may_take_more():
    assert bytes_allowed("<mujoco/>") == MOST_BYTES
    assert bytes_allowed('<mesh file="a.stl"/>') > MOST_BYTES
