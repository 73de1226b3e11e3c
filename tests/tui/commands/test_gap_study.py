"""A study's options, looked at before hours of work."""

import pytest
from typer.testing import CliRunner

from armodal.protocols.errors import ArmodalError
from armodal.tui.cli import app


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("--maker", "frame", "--pairs", "3", "--whole"), "wanted --pairs, --whole with"),
        (("--official", "--seed", "3"), "wanted --seed with a study that is not official only"),
        (("--page", "nowhere/page.md"), "there is no folder nowhere"),
    ],
)
def test_what_a_study_would_not_use_is_refused_before_it_begins(given, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["gap-study", "--out", "study", *given])
    assert isinstance(result.exception, ArmodalError)
    assert said in str(result.exception)
    assert not (tmp_path / "study").exists()
