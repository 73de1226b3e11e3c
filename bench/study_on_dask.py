"""The gap study on a Dask cluster: any executor whose workers can import the project will do.

Dask is no dependency of the project: install it beside (`pip install distributed`).

    python bench/study_on_dask.py --scheduler tcp://host:8786 --out study --seed 6
    python bench/study_on_dask.py --out study --seed 6          # a cluster on this machine
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from armodal.hil_sim.study import draw_study
from armodal.study.page import study_page
from armodal.study.run import run_study, seal_hashes
from armodal.study.summary import study_summary
from armodal.study.tables import study_tables


def main() -> int:
    """Seal, print the hashes, judge, print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scheduler", help="Dask scheduler's address; none starts one here")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--nulls", type=int, default=150)
    parser.add_argument("--effects", type=int, default=150)
    parser.add_argument("--pairs", type=int, default=30)
    parser.add_argument("--outside", type=int, default=30)
    parser.add_argument("--tests", type=int, default=2)
    wanted = parser.parse_args()
    try:
        from distributed import Client  # noqa: PLC0415 - not among the pinned packages
    except ImportError:
        print("this needs Dask: pip install distributed", file=sys.stderr)
        return 2
    specs = draw_study(
        wanted.seed,
        nulls=wanted.nulls,
        effects=wanted.effects,
        pairs=wanted.pairs,
        outside=wanted.outside,
        ladder=True,
    )
    wanted.out.mkdir(parents=True, exist_ok=True)
    with Client(wanted.scheduler) as client:
        executor = client.get_executor()
        hashes = seal_hashes(specs, executor)
        for number, digest in hashes.items():
            print(f"case {number}: truth sealed as {digest}", file=sys.stderr)
        path = wanted.out / f"study-{wanted.seed}.jsonl"
        lines = run_study(specs, hashes, path, executor, tests=wanted.tests)
    print(study_page(study_tables(study_summary(lines)), " ".join(sys.argv)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
