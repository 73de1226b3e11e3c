"""A universal file read dataset by dataset; what is not read is told by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from armodal.protocols.foreign.uff_blocks import Block, read_foreign_bytes, split_blocks
from armodal.protocols.foreign.uff_fields import floats, integers, record
from armodal.protocols.foreign.uff_functions import function_58
from armodal.protocols.foreign.uff_geometry import (
    elements,
    joined_nodes,
    nodes_15,
    nodes_2411,
    systems_2420,
    trace_line,
)
from armodal.protocols.foreign.uff_records import (
    UffFile,
    UffFunction,
    UffHeader,
    UffNodes,
    UffShape,
    UffTraceLine,
    UffUnits,
)
from armodal.protocols.foreign.uff_shapes import shape_55

__all__ = ["read_uff", "uff_from_bytes"]

_ABSOLUTE_ZERO = 273.15


@dataclass(slots=True)
class _Found:
    """What has been read so far."""

    header: UffHeader | None = None
    units: UffUnits | None = None
    nodes: list[UffNodes] = field(default_factory=list)
    trace_lines: list[UffTraceLine] = field(default_factory=list)
    functions: list[UffFunction] = field(default_factory=list)
    shapes: list[UffShape] = field(default_factory=list)
    skipped: list[int] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def read_uff(path: str | Path) -> UffFile:
    """Read a universal file.

    Raises
    ------
    ForeignFileError
        With the dataset's number, if the file is truncated, damaged or not one.
    """
    path = Path(path)
    return uff_from_bytes(read_foreign_bytes(path), path.name)


def uff_from_bytes(data: bytes, origin: str) -> UffFile:
    """Read the bytes of a universal file; `origin` names it in messages."""
    found = _Found()
    blocks, notes = split_blocks(data, origin)
    found.notes += notes
    for block in blocks:
        reader = _READERS.get(block.type)
        if reader is None:
            found.skipped.append(block.type)
        else:
            reader(block, origin, found)
    return UffFile(
        header=found.header,
        units=found.units,
        nodes=joined_nodes(found.nodes, origin),
        trace_lines=tuple(found.trace_lines),
        functions=tuple(found.functions),
        shapes=tuple(found.shapes),
        skipped=tuple(found.skipped),
        notes=tuple(dict.fromkeys(found.notes)),
    )


def _read_15(block: Block, origin: str, found: _Found) -> None:
    found.nodes.append(nodes_15(block, origin))


def _read_2411(block: Block, origin: str, found: _Found) -> None:
    found.nodes.append(nodes_2411(block, origin))


def _read_82(block: Block, origin: str, found: _Found) -> None:
    found.trace_lines.append(trace_line(block, origin, found.notes))


def _read_2412(block: Block, origin: str, found: _Found) -> None:
    found.trace_lines += elements(block, origin)


def _read_2420(block: Block, origin: str, found: _Found) -> None:
    others = systems_2420(block, origin)
    if others:
        found.notes.append(
            f"dataset 2420: {others} coordinate systems are not the global one; positions and "
            "directions are taken in the global one"
        )


def _read_151(block: Block, _: str, found: _Found) -> None:
    if found.header is not None:
        found.notes.append("a second header (dataset 151) is passed over")
        return
    found.header = UffHeader(
        model=record(block, 0).strip(),
        description=record(block, 1).strip(),
        program=record(block, 5).strip(),
    )


def _read_164(block: Block, origin: str, found: _Found) -> None:
    head = record(block, 0)
    clean = Block(block.number, 164, (head[:10],))
    (code,) = integers(clean, 0, (10,), origin, "units code")
    values = floats(block, block.lines[1:], 25, origin, "unit factors")
    if len(values) < 2 or not (np.isfinite(values[:2]).all() and (values[:2] > 0.0).all()):
        came = ", ".join(f"{value:g}" for value in values[:2]) or "none"
        raise block.refuse(origin, "unit factors above 0", came)
    units = UffUnits(
        code=code,
        description=head[10:30].strip(),
        length=float(values[0]),
        force=float(values[1]),
        temperature=float(values[2]) if len(values) > 2 else 1.0,
        temperature_offset=float(values[3]) if len(values) > 3 else _ABSOLUTE_ZERO,
    )
    same = found.units is None or (found.units.length, found.units.force) == (
        units.length,
        units.force,
    )
    if not same:
        raise block.refuse(origin, "one set of units in a file", "a second, different one")
    found.units = units


def _read_58(block: Block, origin: str, found: _Found) -> None:
    found.functions.append(function_58(block, origin))


def _read_55(block: Block, origin: str, found: _Found) -> None:
    shape = shape_55(block, origin)
    if shape is None:
        found.skipped.append(55)
    else:
        found.shapes.append(shape)


_READERS: dict[int, Callable[[Block, str, _Found], None]] = {
    15: _read_15,
    55: _read_55,
    58: _read_58,
    82: _read_82,
    151: _read_151,
    164: _read_164,
    781: _read_2411,
    2411: _read_2411,
    2412: _read_2412,
    2420: _read_2420,
}
