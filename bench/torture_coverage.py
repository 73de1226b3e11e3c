"""Fuzz every decoder with its coverage watched, five minutes each (`fuzz.py`).

    python bench/torture_coverage.py

Where atheris is not installed that is said, and nothing is fuzzed.
"""

from __future__ import annotations

import importlib.util
import sys

import fuzz

if __name__ == "__main__":
    if importlib.util.find_spec("atheris") is None:
        print("atheris is not installed (make fuzz installs it): nothing was fuzzed")
        sys.exit(0)
    sys.exit(fuzz.main())
