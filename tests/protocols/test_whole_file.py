"""Files appear whole, and no link planted beside them is followed."""

from __future__ import annotations

import os

import pytest

from armodal.protocols.text_file import replace_text
from armodal.protocols.whole_file import whole_file


@pytest.mark.parametrize("link", [os.symlink, os.link])
def test_a_link_planted_where_it_is_written_first_is_not_followed(tmp_path, link):
    precious = tmp_path / "precious"
    precious.write_text("precious")
    path = tmp_path / "report.html"
    link(precious, tmp_path / f".report.html.{os.getpid()}.part")
    replace_text(path, "a report")
    assert precious.read_text() == "precious"
    assert path.read_text() == "a report"
    assert not path.is_symlink()


def test_a_link_in_its_place_is_replaced_and_not_followed(tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("precious")
    path = tmp_path / "report.html"
    path.symlink_to(precious)
    replace_text(path, "a report")
    assert (precious.read_text(), path.read_text()) == ("precious", "a report")


def test_what_is_not_written_to_its_end_leaves_the_older_file(tmp_path):
    path = tmp_path / "a"
    path.write_text("older")

    def interrupted():
        with whole_file(path) as file:
            file.write(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "older"
    assert list(tmp_path.iterdir()) == [path]
