"""Put the studies of several makers into one table of what was reached and wanted.

    python bench/gap_study_figures.py FOLDER... [--diagram PICTURE.svg]

FOLDER holds `study-MAKER-SEED.jsonl` as `armodal gap-study --out FOLDER` keeps them. Studies of one
maker at several commits are counted together.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path

from armodal.study.claims import claims
from armodal.study.kept_lines import Line, kept_lines
from armodal.study.page import as_markdown
from armodal.study.reliability import reliability, reliability_svg
from armodal.study.tables import confidence_table


def main() -> None:
    """Print the tables, draw the diagram."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--diagram", type=Path)
    given = parser.parse_args()
    studies: dict[str, list[Line]] = {}
    for path in sorted(p for folder in given.folders for p in folder.glob("study-*-*.jsonl")):
        maker = path.stem.split("-")[1]
        studies.setdefault(maker, []).extend(kept_lines(path, "number"))
    bins = reliability([x for own in studies.values() for x in own])
    print(as_markdown(claims(studies)), end="\n\n")
    print(as_markdown(confidence_table([asdict(own) for own in bins])))
    if given.diagram is not None:
        given.diagram.write_text(reliability_svg(bins), encoding="utf-8")


if __name__ == "__main__":
    main()
