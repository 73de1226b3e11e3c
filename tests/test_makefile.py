"""A target that is also a folder is made whatever lies there."""

from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_no_folder_keeps_a_target_from_being_made():
    lines = (ROOT / "Makefile").read_text(encoding="utf-8").splitlines()
    targets = {line.split(":")[0] for line in lines if line[:1].isalpha() and ":" in line}
    (phony,) = (line.split()[1:] for line in lines if line.startswith(".PHONY:"))
    assert "docs" in targets  # a folder, too
    assert {name for name in targets if (ROOT / name).is_dir()} <= set(phony)
