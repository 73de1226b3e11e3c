"""A plain plate as a session of given FRFs, with or without places of its points."""

from dataclasses import replace

import numpy as np
from support.drifting import TWO_HZ, drifting
from support.manifests import manifest, posture, run
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.given_frfs import with_variances
from armodal.analyzer.modal import fit_modes
from armodal.protocols.foreign.uff_records import (
    DataKind,
    FunctionKind,
    UffFile,
    UffFunction,
    UffHeader,
    UffNodes,
)
from armodal.protocols.foreign.uff_write import SI_UNITS, write_uff
from armodal.protocols.frf_records import FrfForm

FREQ = np.arange(1, 600) * 0.25
F_HZ, DAMPING = np.array([30.0, 61.0, 110.0]), np.array([0.01, 0.008, 0.012])


def plate_session(folder, *, places=True, n_points=6):
    """Three modes at two rows of points, along z; returns the session."""
    rng = np.random.default_rng(1)
    x, y = np.repeat(np.arange(n_points // 2), 2) / 2.0, np.tile([0.0, 0.4], n_points // 2)
    shapes = np.stack([1.0 - x, (1.0 - x) * (2.0 - 10.0 * y), x**2 - 0.4], axis=0)
    poles = poles_of(F_HZ, DAMPING)
    residues = shapes[:, :, None] * shapes[:, :1, None] / (2j * poles.imag[:, None, None])
    clean = modal_frf(poles, residues, FREQ, FrfForm.ACCELERANCE)[:, 0]
    size = 0.01 * np.sqrt(np.mean(np.abs(clean) ** 2, axis=-1, keepdims=True) / 2.0)
    values = clean + size * (rng.normal(size=clean.shape) + 1j * rng.normal(size=clean.shape))
    functions = tuple(
        UffFunction(
            kind=FunctionKind.FREQUENCY_RESPONSE,
            response_node=i + 1,
            response_direction=3,
            reference_node=1,
            reference_direction=3,
            abscissa=FREQ,
            abscissa_kind=DataKind.FREQUENCY,
            values=values[i],
            even=True,
            numerator=DataKind.ACCELERATION,
            denominator=DataKind.EXCITATION_FORCE,
        )
        for i in range(n_points)
    )
    position = np.stack([x, y, np.zeros(n_points)], axis=1)
    nodes = UffNodes(number=np.arange(1, n_points + 1), position=position) if places else None
    content = UffFile(
        header=UffHeader(model="plate", description="", program="armodal test"),
        units=SI_UNITS,
        nodes=nodes,
        trace_lines=(),
        functions=functions,
        shapes=(),
    )
    write_uff(content, folder / "plate.uff")
    return with_variances(run(manifest(folder, posture(["plate.uff"]))))


def moving_fit():
    """FRFs at eight points whose resonances a sensor's mass moves, and their modes: seconds."""
    made = drifting(np.random.default_rng(1), 2.0, nominal_hz=TWO_HZ)
    frf = replace(made.frf, posture="one")
    return frf, fit_modes(frf)
