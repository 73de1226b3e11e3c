"""Universal files read by pyuff, each dataset checked before and after.

pyuff trusts what it is given: a cut number is a smaller number, a surplus value another line, a
strange character in an identification line shifts the lines behind it, and the bytes of a closing
line inside binary data end the dataset. So the file is taken apart here
(`protocols.foreign.uff_blocks`), each dataset is handed to pyuff's own reader as clean text, and
what comes back is counted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from pyuff.datasets.dataset_15 import _extract15 as extract_15
from pyuff.datasets.dataset_55 import _extract55 as extract_55
from pyuff.datasets.dataset_58 import _extract58 as extract_58
from pyuff.datasets.dataset_82 import _extract82 as extract_82
from pyuff.datasets.dataset_151 import _extract151 as extract_151
from pyuff.datasets.dataset_164 import _extract164 as extract_164

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.uff_blocks import (
    HEADER_LINES_58,
    MOST_VALUES,
    Block,
    read_foreign_bytes,
    split_blocks,
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

__all__ = ["read_uff", "uff_from_bytes"]

_MOST_SURPLUS = 5  # numbers that may pad the last line
_LARGEST_NODE = 2**31


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


def read_uff(path: str | Path) -> UffFile:
    """Read a universal file: datasets 15, 55, 58, 58b, 82, 151 and 164; others are told.

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
    readers: dict[int, Callable[[Block, str, _Found], None]] = {
        15: _read_15,
        55: _read_55,
        58: _read_58,
        82: _read_82,
        151: _read_151,
        164: _read_164,
    }
    for block in split_blocks(data, origin):
        reader = readers.get(block.type)
        if reader is None:
            found.skipped.append(block.type)
        else:
            reader(block, origin, found)
    return UffFile(
        header=found.header,
        units=found.units,
        nodes=_joined(found.nodes, origin),
        trace_lines=tuple(found.trace_lines),
        functions=tuple(found.functions),
        shapes=tuple(found.shapes),
        skipped=tuple(found.skipped),
    )


def _by_pyuff(
    extract: Callable[[Any], dict[str, Any]], block: Block, origin: str, content: Any
) -> dict[str, Any]:
    """Have pyuff read one dataset; whatever it raises becomes one ForeignFileError."""
    try:
        return extract(content)
    except Exception as error:  # pyuff raises bare Exception throughout
        raise block.refuse(
            origin, "the records of this type", f"something pyuff cannot read ({error})"
        ) from error


def _text(block: Block, *, plain: int = 0, fortran: bool = False) -> str:
    """Return the dataset as pyuff takes it; `plain` lines of free text are blanked."""
    numbers = [line.expandtabs().rstrip() for line in block.lines[plain:]]
    if fortran:
        numbers = [line.replace("D", "E").replace("d", "e") for line in numbers]
    lines = ["    -1", f"{block.type:6d}", *["NONE"] * plain, *filter(None, numbers)]
    if not all(line.isascii() for line in lines):
        lines = [line.encode("ascii", "replace").decode() for line in lines]
    return "\n".join(lines) + "\n"


def _read_15(block: Block, origin: str, found: _Found) -> None:
    rows = [line for line in block.lines if line.strip()]
    if any(len(line.split()) != 7 for line in rows):
        raise block.refuse(origin, "seven numbers for each node", "another number of them")
    raw = _by_pyuff(extract_15, block, origin, _separated(block))
    number = _whole(block, origin, raw["node_nums"], "node number")
    position = np.array([raw["x"], raw["y"], raw["z"]], dtype=np.float64).T
    if not np.isfinite(position).all():
        raise block.refuse(origin, "positions in finite numbers", "NaN or infinity")
    found.nodes.append(
        UffNodes(number=number, position=frozen_array(position.reshape(-1, 3), np.float64))
    )


def _separated(block: Block) -> str:
    """Return dataset 15 with a blank between all fields (pyuff joins the lines as they are)."""
    text = _text(block, fortran=True).splitlines()
    return "\n".join([*text[:2], *(f" {line}" for line in text[2:])])


def _read_82(block: Block, origin: str, found: _Found) -> None:
    if len(block.lines) < 2:
        raise block.refuse(origin, "a trace line", "too few lines")
    name = block.lines[1].strip()
    lines = (block.lines[0], "NONE", *(f" {line}" for line in block.lines[2:]))
    clean = Block(block.number, 82, lines)
    raw = _by_pyuff(extract_82, clean, origin, _text(clean))
    nodes = _whole(block, origin, raw["nodes"], "node number")
    announced = int(raw["n_nodes"])
    if len(nodes) != announced:
        raise block.refuse(origin, f"{announced} nodes", str(len(nodes)))
    found.trace_lines.append(UffTraceLine(number=int(raw["trace_num"]), name=name, nodes=nodes))


def _read_151(block: Block, origin: str, found: _Found) -> None:
    if len(block.lines) < 7:
        raise block.refuse(origin, "seven records", str(len(block.lines)))
    clean = Block(block.number, 151, tuple(line.strip("\r") or "NONE" for line in block.lines))
    raw = _by_pyuff(extract_151, clean, origin, _text(clean))
    found.header = UffHeader(
        model=raw["model_name"], description=raw["description"], program=raw["program"]
    )


def _read_164(block: Block, origin: str, found: _Found) -> None:
    raw = _by_pyuff(extract_164, block, origin, _text(block))
    units = UffUnits(
        code=int(raw["units_code"]),
        description=raw["units_description"],
        length=float(raw["length"]),
        force=float(raw["force"]),
        temperature=float(raw["temp"]),
        temperature_offset=float(raw["temp_offset"]),
    )
    if not all(np.isfinite(x) and x > 0.0 for x in (units.length, units.force)):
        came = f"{units.length}, {units.force}"
        raise block.refuse(origin, "unit factors above 0", came)
    if found.units is not None and found.units != units:
        raise block.refuse(origin, "one set of units in a file", "a second, different one")
    found.units = units


def _read_58(block: Block, origin: str, found: _Found) -> None:
    if len(block.lines) < HEADER_LINES_58:
        raise block.refuse(origin, f"{HEADER_LINES_58} header records", str(len(block.lines)))
    head = Block(block.number, 58, block.lines[:HEADER_LINES_58])
    record_7 = head.lines[6]
    try:
        kind, points, spacing = (int(record_7[i : i + 10]) for i in (0, 10, 20))
    except ValueError as error:
        raise block.refuse(origin, "whole numbers in record 7", record_7[:30]) from error
    if kind not in {2, 4, 5, 6} or spacing not in {0, 1} or not 0 < points <= MOST_VALUES:
        came = f"{kind}, {points}, {spacing}"
        raise block.refuse(origin, "ordinate type, number of points and spacing", came)
    per_point = (2 if kind >= 5 else 1) + (0 if spacing else 1)
    raw = _by_pyuff(extract_58, block, origin, _content_58(block, head, kind))
    x = np.asarray(raw["x"], dtype=np.float64)
    values = np.asarray(raw["data"])
    surplus = (len(values) - points) * per_point
    if len(values) < points or surplus > _MOST_SURPLUS or len(x) < points:
        came = str(len(values))
        raise block.refuse(origin, f"{points} values, as record 7 announces,", came)
    found.functions.append(
        UffFunction(
            kind=int(raw["func_type"]),
            response_node=_node(block, origin, raw["rsp_node"]),
            response_direction=_direction(block, origin, raw["rsp_dir"]),
            reference_node=_node(block, origin, raw["ref_node"]),
            reference_direction=_direction(block, origin, raw["ref_dir"]),
            abscissa=frozen_array(x[:points], np.float64),
            values=frozen_array(values[:points], np.complex128)
            if kind >= 5
            else frozen_array(values[:points], np.float64),
            even=bool(spacing),
            numerator=int(raw["ordinate_spec_data_type"]),
            denominator=int(raw["orddenom_spec_data_type"]),
            numerator_unit=_label(raw["ordinate_axis_units_lab"]),
            denominator_unit=_label(raw["orddenom_axis_units_lab"]),
            abscissa_kind=int(raw["abscissa_spec_data_type"]),
            version=int(raw["ver_num"]),
            identification=tuple(line.strip() for line in head.lines[:5]),
        )
    )


def _content_58(block: Block, head: Block, kind: int) -> bytes:
    """Return the dataset as pyuff takes it: clean header, then text or little-endian float64."""
    header = _text(head, plain=5).splitlines()
    if len(header) != 2 + HEADER_LINES_58:  # a blank record, which pyuff reads as zeros
        header = ["    -1", "    58", *["NONE"] * 5, *(line or " " for line in head.lines[5:])]
    if block.binary is not None:
        header[1] = f"    58b{1:6d}{2:6d}{11:12d}{len(block.binary):12d}"
        wide = 4 if kind in {2, 4} else 6
        header[8] = f"{wide:10d}" + header[8][10:]
        return ("\n".join(header) + "\n").encode("ascii", "replace") + block.binary
    body = _text(Block(block.number, 58, block.lines[HEADER_LINES_58:]), fortran=True)
    lines = body.splitlines()[2:]
    return ("\n".join([*header, *lines]) + "\n").encode("ascii", "replace")


def _read_55(block: Block, origin: str, found: _Found) -> None:
    if len(block.lines) < 8:
        raise block.refuse(origin, "eight header records", str(len(block.lines)))
    clean = Block(block.number, 55, block.lines)
    raw = _by_pyuff(extract_55, clean, origin, _text(clean, plain=5, fortran=True))
    if raw["analysis_type"] not in {2, 3, 7}:
        found.skipped.append(55)
        return
    node = _whole(block, origin, raw["node_nums"], "node number")
    columns = [np.asarray(raw[name]) for name in ("r1", "r2", "r3")]
    if any(len(column) != len(node) for column in columns):
        raise block.refuse(origin, f"values for {len(node)} nodes", str(len(columns[0])))
    values = np.stack(columns, axis=-1)
    if not np.isfinite(values).all():
        raise block.refuse(origin, "a shape in finite numbers", "NaN or infinity")
    identification = tuple(line.strip() for line in block.lines[:5])
    complex_mode = raw["analysis_type"] in {3, 7}
    pole = complex(raw["eig"]) if complex_mode else None
    size = 0.0 if pole is None else abs(pole)
    found.shapes.append(
        UffShape(
            mode=int(raw["mode_n"]),
            node=node,
            shape=frozen_array(values, np.complex128)
            if np.iscomplexobj(values)
            else frozen_array(values, np.float64),
            f_hz=float(raw["freq"]) if pole is None else size / (2.0 * np.pi),
            damping_ratio=float(raw["modal_damp_vis"])
            if pole is None
            else (-pole.real / size if size else 0.0),
            pole_rad_s=pole,
            modal_mass=float(raw["modal_m"]) if pole is None else 0.0,
            modal_a=complex(raw["modal_a"]) if complex_mode else 0.0,
            identification=identification,
        )
    )


def _joined(parts: list[UffNodes], origin: str) -> UffNodes | None:
    """All nodes of the file; a node given twice has to be the same."""
    if not parts:
        return None
    places: dict[int, npt.NDArray[np.float64]] = {}
    for part in parts:
        for number, position in zip(part.number.tolist(), part.position, strict=True):
            if number in places and not np.array_equal(places[number], position):
                raise ForeignFileError(
                    f"{origin}: dataset 15: wanted one position of node {number}, two different "
                    "ones came; export the geometry again"
                )
            places[number] = position
    return UffNodes(
        number=frozen_array(list(places), np.int64),
        position=frozen_array(list(places.values()), np.float64),
    )


def _whole(block: Block, origin: str, values: Any, what: str) -> npt.NDArray[np.int64]:
    numbers = np.asarray(values, dtype=np.float64).reshape(-1)
    if not (np.isfinite(numbers).all() and (numbers == np.round(numbers)).all()):
        raise block.refuse(origin, f"whole numbers as {what}", "others")
    if (np.abs(numbers) > _LARGEST_NODE).any():
        raise block.refuse(origin, f"a {what} below 2^31", "a larger one")
    return frozen_array(numbers.astype(np.int64), np.int64)


def _node(block: Block, origin: str, value: int) -> int:
    if not 0 <= value < _LARGEST_NODE:
        raise block.refuse(origin, "a node number from 0", str(value))
    return int(value)


def _direction(block: Block, origin: str, value: int) -> int:
    if not -6 <= value <= 6:
        raise block.refuse(origin, "a direction from -6 to 6", str(value))
    return int(value)


def _label(text: str) -> str:
    return "" if text.strip().upper() == "NONE" else text.strip()
