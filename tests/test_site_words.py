"""What the site's extensions make of commands and of symbols in prose."""

import re
import sys
from pathlib import Path

import pytest

EXTENSIONS = Path(__file__).parents[1] / "docs" / "_ext"


@pytest.fixture(autouse=True)
def extensions(monkeypatch):
    monkeypatch.setattr(sys, "path", [str(EXTENSIONS), *sys.path])


def test_options_stand_in_code_on_every_page_of_a_command():
    from command_pages import command_pages  # noqa: PLC0415 - beside the site's configuration

    for name, text in command_pages().items():
        prose = re.sub(r"^```.*?^```|`[^`]*`", "", text, flags=re.DOTALL | re.MULTILINE)
        assert not re.search(r"(?<![\w-])--\w|Example:", prose), name
        rows = [line for line in prose.splitlines() if line.startswith("|")]
        assert {len(re.findall(r"(?<!\\)\|", row)) for row in rows} <= {3}, name


def test_indices_and_powers_are_set_and_names_stay():
    pytest.importorskip("sphinx")
    from readable import pieces_of  # noqa: PLC0415 - likewise

    said = "M_jj^¼, |H_(k+1)|, Jᵀ_v, e^(-at), 2e-6 on 2026-11-27; link_axis, n_samples, x_axis"
    pieces = [(node.tagname, node.astext()) for node in pieces_of(said)]
    assert [text for kind, text in pieces if kind == "subscript"] == ["jj", "k+1", "v"]
    assert [text for kind, text in pieces if kind == "superscript"] == ["¼", "-at"]
    assert [text for kind, text in pieces if kind == "inline"] == ["2e-6", "2026-11-27"]
    assert pieces[-1] == ("#text", "; link_axis, n_samples, x_axis")


def test_no_line_of_a_page_is_a_comment_to_myst():
    pages = EXTENSIONS.parent.rglob("*.md")
    lines = [(page.name, line) for page in pages for line in page.read_text("utf-8").split("\n")]
    assert [found for found in lines if found[1].lstrip().startswith("%")] == []
