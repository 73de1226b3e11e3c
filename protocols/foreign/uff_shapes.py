"""Dataset 55 of a universal file: a mode shape, real or complex."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.foreign.uff_blocks import Block
from armodal.protocols.foreign.uff_fields import floats, integers, node_numbers, refuse_short
from armodal.protocols.foreign.uff_records import UffShape

__all__ = ["shape_55"]

_NORMAL_MODE, _COMPLEX_MODES = 2, {3, 7}
_COMPLEX = 5  # data type


def shape_55(block: Block, origin: str) -> UffShape | None:
    """Read a mode shape; None for data at nodes that are none.

    Raises
    ------
    ForeignFileError
        If records are missing, or values are not finite.
    """
    if len(block.lines) < 8:
        raise refuse_short(block, origin, 8)
    _, analysis, _, _, data, per_node = integers(block, 5, (10,) * 6, origin, "kind of data")
    if analysis != _NORMAL_MODE and analysis not in _COMPLEX_MODES:
        return None
    if per_node not in {3, 6} or data not in {2, _COMPLEX}:
        raise block.refuse(origin, "3 or 6 real or complex values a node", f"{per_node} of {data}")
    told = floats(block, block.lines[6:7], 10, origin, "numbers of a mode")
    facts = floats(block, block.lines[7:8], 13, origin, "a mode's values")
    if len(told) < 4 or len(facts) < (4 if analysis in _COMPLEX_MODES else 3):
        raise block.refuse(origin, "mode number, eigenvalue and modal mass", "fewer numbers")
    node, values = _values(block, per_node * (2 if data == _COMPLEX else 1), origin)
    shape: npt.NDArray[np.float64] | npt.NDArray[np.complex128] = (
        frozen_array(values[:, :6:2] + 1j * values[:, 1:6:2], np.complex128)
        if data == _COMPLEX
        else frozen_array(values[:, :3], np.float64)
    )
    identification = tuple(line.strip() for line in block.lines[:5])
    mode = int(told[3])
    if analysis == _NORMAL_MODE:
        return UffShape(
            mode=mode,
            node=node,
            shape=shape,
            f_hz=float(facts[0]),
            damping_ratio=float(facts[2]),
            modal_mass=float(facts[1]),
            identification=identification,
        )
    pole = complex(facts[0], facts[1])
    size = abs(pole)
    return UffShape(
        mode=mode,
        node=node,
        shape=shape,
        f_hz=size / (2.0 * np.pi),
        damping_ratio=-pole.real / size if size else 0.0,
        pole_rad_s=pole,
        modal_a=complex(facts[2], facts[3]),
        identification=identification,
    )


def _values(
    block: Block, per_node: int, origin: str
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.float64]]:
    """Return nodes and their values: a record of the node, then 6E13.5 as often as needed."""
    rows = [line for line in block.lines[8:] if line.strip()]
    lines_a_node = 1 + (per_node + 5) // 6
    n = len(rows) // lines_a_node
    if len(rows) % lines_a_node:
        raise block.refuse(origin, f"{lines_a_node} records for each node", str(len(rows)))
    nodes = floats(block, rows[::lines_a_node], 10, origin, "node numbers")
    body = [row for i, row in enumerate(rows) if i % lines_a_node]
    values = floats(block, body, 13, origin, "a shape")
    if nodes.size != n or values.size != n * per_node or not np.isfinite(values).all():
        raise block.refuse(origin, f"{per_node} finite values for {n} nodes", str(values.size))
    return node_numbers(block, origin, nodes), values.reshape(n, per_node)
