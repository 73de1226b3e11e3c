"""`armodal report` of a structure without an arm."""

import pytest
from support.command import armodal
from support.plain_hits import write_manifest


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hits")
    armodal("import", write_manifest(folder), "--out", folder / "s.h5")
    return folder / "s.h5"


def test_a_plain_structure_has_a_report(session, tmp_path):
    path = tmp_path / "r.html"
    code, out, _ = armodal("report", session, "--band", "5", "500", "--out", path)
    assert code == 0
    assert str(path) in out.replace("\n", "")
    html = path.read_text(encoding="utf-8")
    assert "2 modes from 20 to 45" in html
    assert "left out as unlike" in html  # the hit struck elsewhere
    assert "the band 5 to 500 Hz was asked for: above" in html  # more than the hits excite


def test_a_workspace_of_a_plain_structure_is_refused(session, tmp_path):
    path = tmp_path / "r.html"
    code, _, err = armodal("report", session, "--workspace", "100", "--out", path)
    assert code == 2
    assert "plain structure" in err.replace("\n", " ")
    assert not path.exists()
