"""MATLAB files (version 5 to 7.2) of FRFs or of a single hit, read and written by scipy.

A file holds either `time`, `force` and accelerations, or

    freq_hz    (n_freq)
    frf        (n_resp, n_ref, n_freq) or, with one reference, (n_resp, n_freq)
    coherence  the same shape, optional
    form       "receptance", "mobility" or "accelerance"
    responses, references   lists such as {'1:x', '1:y'}
    response_directions, reference_directions   (n, 3), optional
    unit       "SI"
"""

from __future__ import annotations

import io
import math
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.io

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.arrays_measured import MOST_NUMBERS, signals_content
from armodal.protocols.foreign.mat_elements import plain_variables
from armodal.protocols.foreign.measured import (
    Content,
    ForeignFrf,
    Hints,
    ToldDof,
    check_coherence,
    check_frf_values,
    parse_dof,
)
from armodal.protocols.foreign.uff_blocks import read_foreign_bytes
from armodal.protocols.foreign.uff_records import DataKind
from armodal.protocols.foreign.units import SI, signal_scale
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["mat_content", "write_mat"]

_FRF_NAMES = {"frf", "freq_hz"}
_KIND_OF_FORM = {
    FrfForm.RECEPTANCE: DataKind.DISPLACEMENT,
    FrfForm.MOBILITY: DataKind.VELOCITY,
    FrfForm.ACCELERANCE: DataKind.ACCELERATION,
}


def mat_content(path: Path, hints: Hints) -> Content:
    """Return the FRFs or the hit of a MATLAB file.

    Raises
    ------
    ForeignFileError
        If the file is damaged, too large, of version 7.3, or lacks a variable.
    """
    origin = path.name
    variables = _load(path)
    if set(variables) >= _FRF_NAMES:
        return _frfs(variables, hints, origin)
    signals: dict[str, npt.NDArray[np.float64]] = {}
    for name, value in variables.items():
        if value.dtype.kind in "fiu" and value.ndim == 2 and value.size > 1:
            rows = np.asarray(value, dtype=np.float64)
            rows = rows if rows.shape[0] <= rows.shape[1] else rows.T
            for i, row in enumerate(rows[:32]):
                signals[name if len(rows) == 1 else f"{name} {i + 1}"] = row
    if not signals:
        raise ForeignFileError(
            f"{origin}: wanted the variables freq_hz and frf, or time, force and accelerations, "
            f"got {', '.join(variables)[:200] or 'none'}; rename them"
        )
    return signals_content(signals, hints, origin)


def _load(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Load the variables of a file, their sizes known before."""
    content = read_foreign_bytes(path)
    data: Any = io.BytesIO(content)  # scipy reads streams too; its type stubs know names only
    if content[124:126] in {b"\x00\x02", b"\x02\x00"} or content[:4] == b"\x89HDF":
        raise ForeignFileError(
            f"{path.name}: wanted a MATLAB file up to version 7.2, got 7.3; save it with '-v7'"
        )
    try:
        names = plain_variables(content)
        listed = scipy.io.whosmat(data)
        numbers = sum(math.prod(int(n) for n in shape) for _, shape, _ in listed)
        if numbers <= MOST_NUMBERS and len(listed) <= 1000:
            data.seek(0)
            loaded = scipy.io.loadmat(data, variable_names=names)
            return {n: np.asarray(v) for n, v in loaded.items() if not n.startswith("__")}
    except Exception as error:  # scipy's reader raises whatever its parser meets
        raise ForeignFileError(
            f"{path.name}: wanted a MATLAB file, it cannot be read ({str(error)[:160]}); save it "
            "again with '-v7'"
        ) from error
    raise ForeignFileError(
        f"{path.name}: wanted at most {MOST_NUMBERS} numbers, got {numbers}; split the file"
    )


def _frfs(variables: dict[str, npt.NDArray[Any]], hints: Hints, origin: str) -> Content:
    freq = np.asarray(variables["freq_hz"]).reshape(-1)
    values = np.asarray(variables["frf"])
    if freq.dtype.kind not in "fiu" or values.dtype.kind != "c":
        raise ForeignFileError(f"{origin}: wanted real freq_hz and complex frf, got others")
    freq = freq.astype(np.float64)
    values = _matrix(values, len(freq))
    if values.ndim != 3 or values.shape[2] != len(freq):
        raise ForeignFileError(
            f"{origin}: wanted frf of shape (responses, references, {len(freq)}), got "
            f"{values.shape}"
        )
    form = hints.form or _form(variables, origin)
    factor, said = _factor(variables, form, hints, origin)
    responses = list(hints.responses) or _dofs(variables, "response", values.shape[0], origin)
    references = (
        [hints.reference]
        if hints.reference is not None
        else _dofs(variables, "reference", values.shape[1], origin)
    )
    if (len(responses), len(references)) != values.shape[:2]:
        raise ForeignFileError(
            f"{origin}: wanted names for {values.shape[0]} responses and {values.shape[1]} "
            f"references, got {len(responses)} and {len(references)}"
        )
    coherence = _coherence(variables, values.shape, origin)
    frfs = []
    for i, response in enumerate(responses):
        for j, reference in enumerate(references):
            where = f"{origin}: frf({i + 1}, {j + 1})"
            line = np.asarray(values[i, j], dtype=np.complex128) * factor
            keep = check_frf_values(freq, line, where)
            own = None
            if coherence is not None and not np.isnan(coherence[i, j]).all():
                check_coherence(coherence[i, j][keep], f"{where}, its coherence")
                own = frozen_array(np.clip(coherence[i, j][keep], 0.0, 1.0), np.float64)
            frfs.append(
                ForeignFrf(
                    origin=where,
                    form=form,
                    response=response,
                    reference=reference,
                    freq_hz=frozen_array(freq[keep], np.float64),
                    values=frozen_array(line[keep], np.complex128),
                    coherence=own,
                )
            )
    return Content(
        origin=origin,
        frfs=tuple(frfs),
        averages=_scalar(variables, "averages"),
        decay_rad_s=_scalar(variables, "window_decay_rad_s"),
        said=said,
    )


def _matrix(values: npt.NDArray[Any], n_lines: int) -> npt.NDArray[Any]:
    """Return (responses, references, lines); a table has one reference, and lines either way."""
    if values.ndim != 2:
        return values
    table = values if values.shape[1] == n_lines else values.T
    return table[:, None, :]


def _coherence(
    variables: dict[str, npt.NDArray[Any]], shape: tuple[int, ...], origin: str
) -> npt.NDArray[np.float64] | None:
    """Return the coherence in the FRF matrix's own shape, None where there is none."""
    told = variables.get("coherence")
    if told is None:
        return None
    matrix = _matrix(told, shape[2])
    if matrix.dtype.kind not in "fiu" or matrix.shape != shape:
        raise ForeignFileError(
            f"{origin}: wanted a real coherence of frf's shape {variables['frf'].shape}, got "
            f"{told.dtype} of {told.shape}; save it like frf, or leave it out"
        )
    return np.asarray(matrix, dtype=np.float64)


def _form(variables: dict[str, npt.NDArray[Any]], origin: str) -> FrfForm:
    told = _words(variables, "form")
    if len(told) != 1 or told[0] not in set(FrfForm):
        raise ForeignFileError(
            f"{origin}: form unknown: wanted the variable form, one of {', '.join(FrfForm)}, got "
            f"{told or 'none'}; say `form` in the manifest"
        )
    return FrfForm(told[0])


def _factor(
    variables: dict[str, npt.NDArray[Any]], form: FrfForm, hints: Hints, origin: str
) -> tuple[float, tuple[str, ...]]:
    if hints.response_unit is not None and hints.force_unit is not None:
        response = signal_scale(_KIND_OF_FORM[form], hints.response_unit, None, origin)
        force = signal_scale(DataKind.EXCITATION_FORCE, hints.force_unit, None, origin)
        return response.factor / force.factor, ()
    if _words(variables, "unit") == [SI]:
        return 1.0, ()
    said = f"{origin}: the units are not told; the numbers are taken as SI (m, s, N). Say `units` "
    return 1.0, (said + "in the manifest",)


def _dofs(
    variables: dict[str, npt.NDArray[Any]], what: str, count: int, origin: str
) -> list[ToldDof]:
    names = _words(variables, f"{what}s")
    if not names and count == 1:
        return [ToldDof(None, None)]
    dofs = [parse_dof(name, origin) for name in names]
    directions = variables.get(f"{what}_directions")
    if directions is not None:
        D = directions.astype(np.float64) if directions.dtype.kind in "fiu" else np.empty(0)
        length = np.linalg.norm(D, axis=-1)
        if D.shape != (len(dofs), 3) or not np.allclose(length, 1.0, atol=1e-3):
            raise ForeignFileError(f"{origin}: wanted {what}_directions of unit length, got others")
        dofs = [ToldDof(dof.node, d / n) for dof, d, n in zip(dofs, D, length, strict=True)]
    return dofs


def _words(variables: dict[str, npt.NDArray[Any]], name: str) -> list[str]:
    """Return a variable's texts: a char array, or a cell array of them."""
    value = variables.get(name)
    if value is None or value.dtype.kind not in "UO" or value.size > 100_000:
        return []
    words = []
    for item in value.reshape(-1):
        cell = np.asarray(item).reshape(-1)
        if cell.size == 1 and isinstance(cell[0], str):
            words.append(str(cell[0]).strip())
    return words


def _scalar(variables: dict[str, npt.NDArray[Any]], name: str) -> Any:
    value = variables.get(name)
    if value is None or value.size != 1 or value.dtype.kind not in "fiu":
        return None
    number = float(value.reshape(-1)[0])
    if not (np.isfinite(number) and number >= 0.0):
        return None
    return int(number) if name == "averages" else number


def write_mat(frf: FrequencyResponse, path: str | Path) -> None:
    """Write one posture's FRFs as MATLAB variables; the file appears whole.

    Raises
    ------
    ForeignFileError
        If the file cannot be written.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    variables: dict[str, Any] = {
        "freq_hz": frf.freq_hz,
        "frf": frf.values,
        "coherence": frf.coherence,
        "variance": frf.variance,
        "form": str(frf.form),
        "unit": SI,
        "responses": _cell([f"{dof.point}:{dof.label}" for dof in frf.responses]),
        "references": _cell([dof.point for dof in frf.references]),
        "response_directions": np.array([dof.direction for dof in frf.responses]),
        "reference_directions": np.array([dof.direction for dof in frf.references]),
        "averages": float(frf.n_hits.min()),
        "window_decay_rad_s": frf.decay_rad_s,
        "posture": frf.posture,
    }
    if frf.joints_rad is not None:
        variables["joints_rad"] = frf.joints_rad
    try:
        scipy.io.savemat(
            str(temporary), variables, appendmat=False, do_compression=True, oned_as="row"
        )
        temporary.replace(path)
    except OSError as error:
        raise ForeignFileError(
            f"{path}: cannot be written ({error}); choose another place"
        ) from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def _cell(words: list[str]) -> npt.NDArray[np.object_]:
    return np.array(words, dtype=np.object_)
