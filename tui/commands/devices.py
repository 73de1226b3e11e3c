"""`armodal devices`: what is there to measure with, and what is missing."""

from __future__ import annotations

from dataclasses import asdict

import typer
from rich.table import Column, Table

from armodal.daq.devices import find_devices
from armodal.tui.console import Json, err, out, print_json

__all__ = ["app"]

app = typer.Typer(add_completion=False)

_USES = {
    "serial": "--board or --can",
    "can": "--can",
    "sound": "source of a front-end file",
    "ni": "source of a front-end file",
    "opendaq": "source of a front-end file",
}


@app.command("devices")
def devices_command(as_json: Json = False) -> None:
    """List boards, CAN adapters, sound cards, NI and openDAQ devices, and what is missing.

    None is opened. A Universal Robots controller is given by its address (--ur), a file to
    replay by its front-end file.

    Example: armodal devices
    """
    found, missing = find_devices()
    if as_json:
        print_json({"found": [asdict(d) for d in found], "missing": [asdict(m) for m in missing]})
        return
    table = Table("device", Column("address", overflow="fold"), "given as", "describes itself as")
    for device in found:
        table.add_row(device.kind, device.address, _USES[device.kind], device.description)
    if found:
        out.print(table)
    else:
        out.print("no device was found")
    for lacks in missing:
        out.print(f"{lacks.kind}: {lacks.message}")
    err.print(
        "next: armodal check board PORT, or write a front-end file (docs/front-ends.md)"
        if found
        else "next: plug a board in, or armodal sim for the simulated laboratory"
    )
