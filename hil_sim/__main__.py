"""`python -m armodal.hil_sim`: run the simulated laboratory until it is told to stop."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from armodal.hil_sim.arm_in_cell import arm_in_cell
from armodal.hil_sim.cell import BlowT
from armodal.hil_sim.faults import Fault
from armodal.hil_sim.hand import Blow
from armodal.hil_sim.lab_process import LabOptions, LabProcess
from armodal.hil_sim.orphan import ends_with_stdin
from armodal.hil_sim.plant import load_plant
from armodal.hil_sim.rehearsal import read_rehearsal
from armodal.hil_sim.rehearsed_plant import draw_plant
from armodal.protocols.errors import ArmodalError

__all__ = ["main", "parse", "run"]


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="armodal.hil_sim",
        description="Simulated laboratory: prints its ports as one line of JSON, then runs.",
        epilog="example: python -m armodal.hil_sim --plant rv4frl --time-scale 16 --directory lab",
    )
    parser.add_argument("--plant", default="rv4frl", help="plant file or shipped name")
    parser.add_argument(
        "--rehearsal", type=Path, help="arm and plan as armodal sim hands them over, not a plant"
    )
    parser.add_argument("--seed", type=int, default=1, help="for everything random")
    parser.add_argument("--time-scale", type=float, default=1.0, help="lab seconds a second")
    parser.add_argument("--directory", type=Path, required=True, help="of socket and ledger")
    parser.add_argument(
        "--fault", action="append", default=[], help=f"one of {', '.join(Fault)}; repeatable"
    )
    parser.add_argument("--watch-stdin", action="store_true", help="stop when stdin ends")
    return parser.parse_args(arguments)


def options_of(given: argparse.Namespace) -> LabOptions:
    """Options of the process, its directory made if missing."""
    given.directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    return LabOptions(
        seed=given.seed,
        directory=given.directory.resolve(),
        time_scale=given.time_scale,
        faults=tuple(given.fault),
    )


def run(laboratory: LabProcess[BlowT], *, watch_stdin: bool) -> None:
    """Print the ready line and serve."""
    laboratory.obey_signals()
    sys.stdout.write(json.dumps(laboratory.ready()) + "\n")
    sys.stdout.flush()
    laboratory.serve(watch_stdin=watch_stdin)


def _made(given: argparse.Namespace) -> LabProcess[Blow]:
    options = options_of(given)
    if given.rehearsal is None:
        arm = arm_in_cell(load_plant(given.plant), seed=given.seed)
    else:
        wanted = read_rehearsal(given.rehearsal)
        plant, effects = draw_plant(wanted, given.seed)
        arm = arm_in_cell(plant, seed=given.seed, can=wanted.arm.can)
        options = replace(options, sealed=True, effects=tuple(effects))
    return LabProcess(arm, options)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the laboratory; exit code 2 for what the caller got wrong."""
    given = parse(arguments)
    try:
        with ends_with_stdin() if given.watch_stdin else nullcontext():
            laboratory = _made(given)
    except (ArmodalError, ValueError, OSError) as error:
        sys.stderr.write(f"hil_sim: {error}\n")
        return 2
    run(laboratory, watch_stdin=given.watch_stdin)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
