"""Frequency responses in the session file: one NXdata a posture, magnitude in front.

The complex values stand beside the magnitude and are what is read back.
"""

from __future__ import annotations

from collections.abc import Sequence

import h5py
import numpy as np

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import SessionError
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm
from armodal.protocols.session.hdf5_tree import Tree, add_array, add_group, add_text, add_texts

__all__ = ["check_frf", "frf_name", "read_frf_groups", "write_frf_groups"]

GIVEN = "given"  # origin of an FRF matrix that came without hits
DERIVED = "hits"

UNITS = {
    FrfForm.RECEPTANCE: "m/N",
    FrfForm.MOBILITY: "m/(N s)",
    FrfForm.ACCELERANCE: "m/(N s^2)",
}
MAX_FRFS = 1000
_UNIT_TOLERANCE = 1e-6


def frf_name(index: int) -> str:
    """Return the name of the group of the FRF matrix at `index`, counted from 0.

    >>> frf_name(0)
    'frf_001'
    """
    return f"frf_{index + 1:03d}"


def write_frf_groups(
    entry: h5py.Group, derived: Sequence[FrequencyResponse], given: Sequence[FrequencyResponse]
) -> None:
    """Write `frf_count` and one NXdata a posture, those without hits first."""
    frfs = [*given, *derived]
    add_array(entry, "frf_count", np.array(len(frfs), dtype=np.int64))
    for index, frf in enumerate(frfs):
        unit = UNITS[frf.form]
        group = add_group(
            entry,
            frf_name(index),
            "NXdata",
            signal="magnitude",
            axes=[".", ".", "freq_hz"],
            freq_hz_indices=2,
        )
        add_text(group, "title", f"{frf.form} at {frf.posture}, magnitude")
        add_text(group, "posture", frf.posture)
        add_text(group, "form", frf.form)
        add_text(group, "origin", GIVEN if index < len(given) else DERIVED)
        name = f"{frf.form} ({unit})"
        spectrum = {"interpretation": "spectrum"}
        add_array(group, "magnitude", np.abs(frf.values), units=unit, long_name=name, **spectrum)
        add_array(group, "values", frf.values, units=unit, **spectrum)
        add_array(group, "coherence", frf.coherence, units="1", **spectrum)
        add_array(group, "variance", frf.variance, units=f"({unit})^2", **spectrum)
        add_array(group, "freq_hz", frf.freq_hz, units="Hz", long_name="frequency (Hz)")
        decay = np.array(frf.decay_rad_s, dtype=np.float64)
        add_array(group, "decay_rad_s", decay, units="rad/s")
        add_array(group, "n_hits", frf.n_hits)
        if frf.joints_rad is not None:
            add_array(group, "joints_rad", frf.joints_rad, units="rad")
        _write_dofs(add_group(group, "responses", "NXcollection"), frf.responses)
        _write_dofs(add_group(group, "references", "NXcollection"), frf.references)


def read_frf_groups(entry: Tree, *, given_only: bool = False) -> tuple[FrequencyResponse, ...]:
    """Read every FRF matrix of the file, or only those that came without hits."""
    count = entry.integer("frf_count", 0, MAX_FRFS)
    names = [frf_name(index) for index in range(count)]
    if given_only:
        names = [name for name in names if _origin(entry, name) == GIVEN]
    return tuple(_read_frf(entry, name) for name in names)


def _origin(entry: Tree, name: str) -> str:
    group = entry.group(name)
    if not group.has("origin"):  # optional: a file without it derived all from hits
        return DERIVED
    origin = group.text("origin", limit=64)
    if origin not in {GIVEN, DERIVED}:
        group.refuse("origin", f"{GIVEN!r} or {DERIVED!r}", repr(origin))
    return origin


def check_frf(frf: FrequencyResponse) -> None:
    """Raise SessionError unless the arrays of `frf` agree with one another."""
    shape = (len(frf.responses), len(frf.references), len(frf.freq_hz))
    for name in ("values", "coherence", "variance"):
        if getattr(frf, name).shape != shape:
            raise SessionError(
                f"FRFs of {frf.posture!r}: {name} of shape {shape} (responses, references, "
                f"lines) were wanted, {getattr(frf, name).shape} came"
            )
    if frf.n_hits.shape != shape[:2]:
        raise SessionError(
            f"FRFs of {frf.posture!r}: n_hits of shape {shape[:2]} were wanted, "
            f"{frf.n_hits.shape} came"
        )
    lines = frf.freq_hz
    if not (np.isfinite(lines).all() and (lines > 0).all() and (np.diff(lines) > 0).all()):
        raise SessionError(f"FRFs of {frf.posture!r}: lines that rise from above 0 Hz were wanted")
    for dof in (*frf.responses, *frf.references):
        length = float(np.linalg.norm(dof.direction))
        if not abs(length - 1) <= _UNIT_TOLERANCE:
            raise SessionError(
                f"FRFs of {frf.posture!r}: the direction of {dof.point} {dof.label} has length "
                f"{length:g}, a unit vector was wanted"
            )


def _read_frf(entry: Tree, name: str) -> FrequencyResponse:
    group = entry.group(name)
    form = group.text("form", limit=64)
    if form not in set(FrfForm):
        group.refuse("form", f"one of {', '.join(FrfForm)}", repr(form))
    responses = _read_dofs(group.group("responses"))
    references = _read_dofs(group.group("references"))
    freq_hz = group.finite("freq_hz", (None,))
    matrix = (len(responses), len(references))
    lines = (*matrix, len(freq_hz))
    joints = group.finite("joints_rad", (None,)) if group.has("joints_rad") else None
    frf = FrequencyResponse(
        posture=group.text("posture", limit=1024),
        form=FrfForm(form),
        freq_hz=frozen_array(freq_hz, np.float64),
        decay_rad_s=float(group.finite("decay_rad_s", ())),
        values=frozen_array(group.array("values", np.complex128, lines), np.complex128),
        coherence=frozen_array(group.array("coherence", np.float64, lines), np.float64),
        variance=frozen_array(group.array("variance", np.float64, lines), np.float64),
        n_hits=frozen_array(group.array("n_hits", np.int64, matrix), np.int64),
        responses=responses,
        references=references,
        joints_rad=None if joints is None else frozen_array(joints, np.float64),
    )
    try:
        check_frf(frf)
    except SessionError as error:
        entry.refuse(name, "FRFs that agree in themselves", str(error))
    return frf


def _write_dofs(group: h5py.Group, dofs: Sequence[Dof]) -> None:
    add_texts(group, "point", [dof.point for dof in dofs])
    add_texts(group, "label", [dof.label for dof in dofs])
    directions = np.array([dof.direction for dof in dofs], dtype=np.float64)
    add_array(group, "direction", directions.reshape(len(dofs), 3))


def _read_dofs(group: Tree) -> tuple[Dof, ...]:
    points = group.texts("point")
    labels = group.texts("label", len(points))
    directions = group.finite("direction", (len(points), 3))
    return tuple(
        Dof(point=point, label=label, direction=frozen_array(direction, np.float64))
        for point, label, direction in zip(points, labels, directions, strict=True)
    )
