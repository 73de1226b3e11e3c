"""FRFs of a posture as MATLAB variables (version 5), written by scipy.

freq_hz    (n_freq)
frf        (n_resp, n_ref, n_freq), and coherence and variance alike
form       "receptance", "mobility" or "accelerance"
responses, references   lists such as {'1:x', '1:y'}
response_directions, reference_directions   (n, 3)
unit       "SI"
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.io

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.units import SI
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["write_mat"]


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
        "averages": float(frf.n_hits[frf.measured].min()),
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
