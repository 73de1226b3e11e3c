"""The policy of a page: its own scripts by their hash, nothing else."""

import base64
import hashlib

import pytest

from armodal.analyzer.report.policy import under_policy

PAGE = (
    '<!doctype html><html><head><meta charset="utf-8"></head><body><script>draw("a < b")</script>'
    '<script type="text/javascript">\nmore()\n</script></body></html>'
)


def digest(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def test_every_script_of_the_page_is_allowed_by_its_hash_and_nothing_inline_else():
    page = under_policy(PAGE)
    policy = page.partition('http-equiv="Content-Security-Policy" content="')[2].partition('"')[0]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    scripts = ('draw("a < b")', "\nmore()\n")
    assert rules["script-src"].split() == [f"'sha256-{digest(script)}'" for script in scripts]
    assert rules["default-src"] == "'none'"
    assert page.index("Content-Security-Policy") < page.index("<script>")


def test_a_page_without_scripts_runs_none():
    assert "script-src 'none'" in under_policy('<head><meta charset="utf-8"></head>')


def test_a_page_without_a_place_for_it_is_refused():
    with pytest.raises(ValueError, match="wanted a page with"):
        under_policy("<html></html>")
