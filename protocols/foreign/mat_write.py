"""FRFs of a posture as MATLAB variables (version 5), written by scipy, or as arrays of an NPZ file.

freq_hz    (n_freq)
frf        (n_resp, n_ref, n_freq), and coherence and variance E|error|^2 alike
form       "receptance", "mobility" or "accelerance"
responses, references   lists such as {'1:x', '1:y'}
response_directions, reference_directions   (n, 3)
unit       "SI"
averages   one number, or (n_resp, n_ref) where they differ
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.io

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.units import SI
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.os_words import os_words
from armodal.protocols.whole_file import whole_file

__all__ = ["write_mat", "write_npz"]


def write_mat(frf: FrequencyResponse, path: str | Path) -> None:
    """Write one posture's FRFs as MATLAB variables; the file appears whole.

    Raises
    ------
    ForeignFileError
        If the file cannot be written.
    """
    _write(
        Path(path),
        lambda file: scipy.io.savemat(
            file, _variables(frf, _cell), appendmat=False, do_compression=True, oned_as="row"
        ),
    )


def write_npz(frf: FrequencyResponse, path: str | Path) -> None:
    """Write one posture's FRFs as the same arrays in an NPZ file; it appears whole.

    Raises
    ------
    ForeignFileError
        If the file cannot be written.
    """
    _write(Path(path), lambda file: np.savez_compressed(file, **_variables(frf, np.array)))


def _write(path: Path, write: Callable[[Any], None]) -> None:
    try:
        with whole_file(path) as file:
            write(file)
    except OSError as error:
        raise ForeignFileError(
            f"{path}: cannot be written ({os_words(error)}); choose another place"
        ) from error


def _variables(frf: FrequencyResponse, texts: Callable[[list[str]], Any]) -> dict[str, Any]:
    variables: dict[str, Any] = {
        "freq_hz": frf.freq_hz,
        "frf": frf.values,
        "coherence": frf.coherence,
        "variance": frf.variance,
        "form": str(frf.form),
        "unit": SI,
        "responses": texts([f"{dof.point}:{dof.label}" for dof in frf.responses]),
        "references": texts([dof.point for dof in frf.references]),
        "response_directions": np.array([dof.direction for dof in frf.responses]),
        "reference_directions": np.array([dof.direction for dof in frf.references]),
        "averages": _averages(frf),
        "window_decay_rad_s": frf.decay_rad_s,
        "posture": frf.posture,
    }
    if frf.joints_rad is not None:
        variables["joints_rad"] = frf.joints_rad
    return variables


def _averages(frf: FrequencyResponse) -> float | npt.NDArray[np.float64]:
    """Averages of all FRFs, of each where they differ."""
    told = frf.n_hits[frf.measured]
    same = bool((told == told[0]).all())
    return float(told[0]) if same else frf.n_hits.astype(np.float64)


def _cell(words: list[str]) -> npt.NDArray[np.object_]:
    return np.array(words, dtype=np.object_)
