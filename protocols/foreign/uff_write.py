"""Universal files written by pyuff, and put right where its output loses or misstates a number.

pyuff turns NaN into 0 without a word, writes the first abscissa and its step with six digits
(off by 0.4 mHz at 800 Hz for a step of 51200/31/2048 Hz), announces half the bytes of complex
binary data and leaves the file of binary data open. Values that are not finite are therefore
refused, both fields of the header are written anew with as many digits as their 13 columns hold,
and of binary datasets pyuff makes the header only.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyuff

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.uff_blocks import HEADER_LINES_58
from armodal.protocols.foreign.uff_records import (
    UffFile,
    UffFunction,
    UffHeader,
    UffNodes,
    UffShape,
    UffTraceLine,
    UffUnits,
)
from armodal.protocols.os_words import os_words
from armodal.protocols.whole_file import whole_file

__all__ = ["SI_UNITS", "write_uff"]

SI_UNITS = UffUnits(code=1, description="SI", length=1.0, force=1.0)

_LONGEST_TRACE = 250
_WRITABLE = {0, 1, 2, 3, 4, 6, 9}


def write_uff(file: UffFile, path: str | Path, *, binary: bool = False) -> None:
    """Write datasets 151, 164, 15, 82, 58 and 55, in this order; the file appears whole.

    Parameters
    ----------
    file
        What to write.
    path
        Replaced when the new file is complete.
    binary
        Functions as 58b (exact float64) instead of text of 12 digits.

    Raises
    ------
    ForeignFileError
        If a value is not finite or has no place in the format, or the file cannot be written.
    """
    path = Path(path)
    try:
        with tempfile.TemporaryDirectory() as folder, whole_file(path) as out:
            scratch = Path(folder) / "one.uff"
            for content in _datasets(file, binary=binary):
                out.write(_by_pyuff(content, scratch))
    except OSError as error:
        raise ForeignFileError(
            f"{path}: cannot be written ({os_words(error)}); choose another place"
        ) from error


def _datasets(file: UffFile, *, binary: bool) -> Iterator[dict[str, Any]]:
    if file.header is not None:
        yield _header(file.header)
    if file.units is not None:
        yield _units(file.units)
    if file.nodes is not None:
        yield _nodes(file.nodes)
    for line in file.trace_lines:
        yield _trace_line(line)
    for function in file.functions:
        yield _function(function, binary=binary)
    for shape in file.shapes:
        yield _shape(shape)


def _by_pyuff(content: dict[str, Any], scratch: Path) -> bytes:
    """Return the bytes pyuff makes of one dataset, its header put right."""
    kind = content["type"]
    try:
        pyuff.UFF(str(scratch)).write_sets([{**content, "binary": 0}], mode="overwrite")
    except Exception as error:  # pyuff raises bare Exception throughout
        raise ForeignFileError(
            f"dataset {kind} cannot be written ({error}): a value has no place in its format"
        ) from error
    data = scratch.read_bytes()
    return _repaired_58(data, content) if kind == 58 else data


def _repaired_58(data: bytes, content: dict[str, Any]) -> bytes:
    lines = data.split(b"\n", 2 + HEADER_LINES_58)
    x, values = content["x"], content["data"]
    if content["abscissa_spacing"]:
        step = (x[-1] - x[0]) / (len(x) - 1)
        record = lines[8]
        lines[8] = record[:30] + _wide(x[0]) + _wide(step) + record[56:]
    if not content["binary"]:
        return b"\n".join(lines)
    columns = [values.real, values.imag] if np.iscomplexobj(values) else [values]
    if not content["abscissa_spacing"]:
        columns.insert(0, x)
    binary = np.stack(columns, axis=1).astype("<f8").tobytes()
    # Little endian (1), IEEE 754 (2), lines of the header, bytes behind it.
    fields = (HEADER_LINES_58, len(binary), 0, 0, 0, 0)
    lines[1] = b"    58b     1     2" + b"%12d%12d%6d%6d%12d%12d" % fields
    return b"\n".join(lines[:-1]) + b"\n" + binary + b"    -1\n"


def _wide(value: float) -> bytes:
    """Return a number in 13 columns, the first blank, with as many digits as fit.

    >>> _wide(51200 / 31 / 2048)
    b' 0.8064516129'
    """
    for digits in range(17, 0, -1):
        text = f"{value:.{digits}g}"
        if "." not in text and "e" not in text:
            text += ".0"
        if len(text) <= 12:
            return f"{text:>13}".encode()
    raise ForeignFileError(f"wanted an abscissa of at most 12 characters, got {value!r}")


def _header(header: UffHeader) -> dict[str, Any]:
    # Fixed dates: the same session makes the same file.
    dates = {
        f"{what}_{name}": text
        for name in ("db_created", "db_saved", "file_written")
        for what, text in (("date", "01-Jan-00"), ("time", "00:00:00"))
    }
    return {
        "type": 151,
        "model_name": _line(header.model),
        "description": _line(header.description),
        "db_app": _line(header.program),
        "program": _line(header.program),
        **dates,
    }


def _units(units: UffUnits) -> dict[str, Any]:
    return {
        "type": 164,
        "units_code": units.code,
        "units_description": _line(units.description)[:20],
        "temp_mode": 1,
        "length": units.length,
        "force": units.force,
        "temp": units.temperature,
        "temp_offset": units.temperature_offset,
    }


def _nodes(nodes: UffNodes) -> dict[str, Any]:
    _finite(nodes.position, "positions of nodes")
    x, y, z = nodes.position.T
    return {"type": 15, "node_nums": nodes.number.tolist(), "x": x, "y": y, "z": z}


def _trace_line(line: UffTraceLine) -> dict[str, Any]:
    if not 1 <= len(line.nodes) <= _LONGEST_TRACE or (np.diff(line.nodes) == 0).any():
        raise ForeignFileError(
            f"trace line {line.number}: wanted 1 to {_LONGEST_TRACE} nodes, none twice running, "
            f"got {len(line.nodes)}"
        )
    return {
        "type": 82,
        "trace_num": line.number,
        "n_nodes": len(line.nodes),
        "color": 0,
        "id": _line(line.name),
        "nodes": np.array(line.nodes),
    }


def _function(function: UffFunction, *, binary: bool) -> dict[str, Any]:
    what = f"function at node {function.response_node}"
    _finite(function.values, what)
    _finite(function.abscissa, f"{what}, abscissa")
    if function.kind not in _WRITABLE or len(function.values) < 2:
        raise ForeignFileError(
            f"{what}: wanted a function of two values or more of the types "
            f"{sorted(_WRITABLE)}, got {len(function.values)} of type {function.kind}"
        )
    return {
        "type": 58,
        "binary": int(binary),
        "func_type": function.kind,
        "ver_num": function.version,
        "rsp_node": function.response_node,
        "rsp_dir": function.response_direction,
        "ref_node": function.reference_node,
        "ref_dir": function.reference_direction,
        "x": np.array(function.abscissa),
        "data": np.array(function.values),
        "abscissa_spacing": int(function.even),
        "abscissa_spec_data_type": function.abscissa_kind,
        "abscissa_axis_units_lab": {17: "s", 18: "Hz"}.get(function.abscissa_kind, "NONE"),
        "ordinate_spec_data_type": function.numerator,
        "ordinate_axis_units_lab": _line(function.numerator_unit)[:20],
        "orddenom_spec_data_type": function.denominator,
        "orddenom_axis_units_lab": _line(function.denominator_unit)[:20],
        **_identification(function.identification),
    }


def _shape(shape: UffShape) -> dict[str, Any]:
    _finite(shape.shape, f"mode {shape.mode}, shape")
    r1, r2, r3 = np.array(shape.shape).T
    common = {
        "type": 55,
        "model_type": 1,
        "data_ch": 2,  # translations at nodes
        "spec_data_type": 8,  # displacement
        "load_case": 1,
        "mode_n": shape.mode,
        "node_nums": shape.node.tolist(),
        "r1": r1,
        "r2": r2,
        "r3": r3,
        **_identification(shape.identification),
    }
    if shape.pole_rad_s is not None:
        pole = shape.pole_rad_s
        eigenvalue = {"eig": pole, "modal_a": shape.modal_a, "modal_b": -pole * shape.modal_a}
        return {**common, "analysis_type": 3, **eigenvalue}
    return {
        **common,
        "analysis_type": 2,
        "freq": shape.f_hz,
        "modal_m": shape.modal_mass,
        "modal_damp_vis": shape.damping_ratio,
        "modal_damp_his": 0.0,
    }


def _identification(lines: Sequence[str]) -> dict[str, str]:
    padded = [*lines, *[""] * 5][:5]
    return {f"id{i + 1}": _line(text) for i, text in enumerate(padded)}


def _line(text: str) -> str:
    """Return text fit for a record of 80 columns: printable ASCII, never empty.

    >>> _line("Prüfling 1")
    'Pr?fling 1'
    """
    clean = "".join(c if " " <= c <= "~" else "?" for c in text)[:80].strip()
    return clean or "NONE"


def _finite(values: Any, what: str) -> None:
    if not np.isfinite(values).all():
        raise ForeignFileError(
            f"{what}: wanted finite numbers, got NaN or infinity, which the format cannot hold; "
            "leave it out"
        )
