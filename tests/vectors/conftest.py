"""The scripts here are run by tests, not collected."""

collect_ignore_glob = ["board_*.py", "make_*.py"]
