"""Geometry in a universal file: nodes of 15, 781 and 2411, lines of 82 and the elements of 2412."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.uff_blocks import Block
from armodal.protocols.foreign.uff_fields import (
    floats,
    integers,
    node_numbers,
    record,
    refuse_short,
)
from armodal.protocols.foreign.uff_records import UffNodes, UffTraceLine

__all__ = ["elements", "joined_nodes", "nodes_15", "nodes_2411", "systems_2420", "trace_line"]

_BEAMS = {11, 21, 22, 23, 24}  # elements with a record of cross sections before their nodes
_MOST_NODES = 100_000
_MOST_ELEMENTS = 100_000


def nodes_15(block: Block, origin: str) -> UffNodes:
    """Read dataset 15: 4I10, 3E13.5 a node."""
    rows = [line.expandtabs().rstrip() for line in block.lines if line.strip()]
    table = []
    for row in rows:
        parts = row.split()
        if len(parts) != 7:  # numbers that touch
            parts = [row[i : i + 10] for i in range(0, 40, 10)]
            parts += [row[i : i + 13] for i in (40, 53, 66)]
        if any(len(part.split()) != 1 for part in parts):
            raise block.refuse(origin, "seven numbers for each node", "another number of them")
        table.append(" ".join(parts))
    values = floats(block, table, 13, origin, "node").reshape(-1, 7)
    return _nodes(block, values[:, 0], values[:, 4:], origin)


def nodes_2411(block: Block, origin: str) -> UffNodes:
    """Read dataset 2411 or 781: 4I10, then 3D25.16, for each node."""
    rows = [line for line in block.lines if line.strip()]
    if len(rows) % 2:
        raise block.refuse(origin, "two records for each node", str(len(rows)))
    heads = floats(block, rows[::2], 10, origin, "node numbers")
    values = floats(block, rows[1::2], 25, origin, "positions")
    n = len(rows) // 2
    if heads.size != 4 * n or values.size != 3 * n:
        raise block.refuse(origin, "four and three numbers for each node", "another number of them")
    return _nodes(block, heads.reshape(n, 4)[:, 0], values.reshape(n, 3), origin)


def _nodes(
    block: Block,
    number: npt.NDArray[np.float64],
    position: npt.NDArray[np.float64],
    origin: str,
) -> UffNodes:
    if not np.isfinite(position).all():
        raise block.refuse(origin, "positions in finite numbers", "NaN or infinity")
    return UffNodes(
        number=node_numbers(block, origin, number), position=frozen_array(position, np.float64)
    )


def joined_nodes(parts: Sequence[UffNodes], origin: str) -> UffNodes | None:
    """Return all nodes of a file; a node given twice has to be the same."""
    if not parts:
        return None
    places: dict[int, npt.NDArray[np.float64]] = {}
    for part in parts:
        for number, position in zip(part.number.tolist(), part.position, strict=True):
            if number in places and not np.array_equal(places[number], position):
                raise ForeignFileError(
                    f"{origin}: nodes: wanted one position of node {number}, two different ones "
                    "came; export the geometry again"
                )
            places[number] = position
    return UffNodes(
        number=frozen_array(list(places), np.int64),
        position=frozen_array(list(places.values()), np.float64),
    )


def trace_line(block: Block, origin: str, notes: list[str]) -> UffTraceLine:
    """Read dataset 82; zeros that fill up the last record are a note."""
    if len(block.lines) < 2:
        raise refuse_short(block, origin, 2)
    number, announced, _ = integers(block, 0, (10, 10, 10), origin, "trace line")
    values = floats(block, block.lines[2:], 10, origin, "nodes of a trace line")
    nodes = node_numbers(block, origin, values)
    if len(nodes) < announced or nodes[max(announced, 0) :].any():
        raise block.refuse(origin, f"{announced} nodes", str(len(nodes)))
    if len(nodes) > announced:
        notes.append("trace lines are filled up with zeros, which are passed over")
    return UffTraceLine(
        number=number,
        name=record(block, 1).strip(),
        nodes=frozen_array(nodes[:announced], np.int64),
    )


def elements(block: Block, origin: str) -> list[UffTraceLine]:
    """Read dataset 2412 as a closed line around each element's corners."""
    lines: list[UffTraceLine] = []
    at = 0
    while at < len(block.lines):
        if not record(block, at).strip():
            at += 1
            continue
        head = integers(block, at, (10,) * 6, origin, "an element")
        number, kind, count = head[0], head[1], head[5]
        at += 2 if kind in _BEAMS else 1
        if not 1 <= count <= _MOST_NODES or len(lines) >= _MOST_ELEMENTS:
            raise block.refuse(origin, "an element of 1 node or more", f"{count} nodes")
        rows = (count + 7) // 8
        values = floats(block, block.lines[at : at + rows], 10, origin, "nodes of an element")
        nodes = node_numbers(block, origin, values)
        if len(nodes) != count:
            raise block.refuse(origin, f"{count} nodes of element {number}", str(len(nodes)))
        ring = nodes if count < 3 else np.append(nodes, nodes[0])
        lines.append(
            UffTraceLine(
                number=number, name=f"element {number}", nodes=frozen_array(ring, np.int64)
            )
        )
        at += rows
    return lines


def systems_2420(block: Block, origin: str) -> int:
    """Return how many coordinate systems of dataset 2420 are not the global Cartesian one."""
    others = 0
    for at in range(2, len(block.lines) - 5, 6):
        kind = integers(block, at, (10, 10, 10), origin, "a coordinate system")[1]
        values = floats(block, block.lines[at + 2 : at + 6], 25, origin, "a coordinate system")
        identity = np.vstack([np.eye(3), np.zeros((1, 3))]).reshape(-1)
        others += kind != 0 or not np.array_equal(values, identity)
    return others
