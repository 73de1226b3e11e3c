"""Refuse a checkout without symbolic links, where only an empty package would be built."""

from pathlib import Path

from setuptools import setup

missing = [p for p in Path("armodal").iterdir() if p.is_file() and p.suffix == ""]
if missing:
    names = ", ".join(sorted(p.name for p in missing))
    raise SystemExit(
        f"armodal: wanted symbolic links in armodal/, found plain files: {names}. "
        "Check out again with git config core.symlinks true, or install the sdist or a wheel."
    )
setup()
