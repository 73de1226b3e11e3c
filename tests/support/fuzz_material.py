"""Valid files of every kind, to begin fuzzing from."""

from pathlib import Path

import numpy as np
from support.decoders import make_decoders
from support.fault_runs import run_seed
from support.foreign_samples import chain_file, whole_file

from armodal.protocols.foreign.uff_write import write_uff
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm
from armodal.protocols.session.journal import decode_journal, session_of


def decoders_in(folder):
    """Return every decoder by its name, with files of a session in the simulated laboratory."""
    folder = Path(folder)
    rng = np.random.default_rng(4)
    journal = run_seed(0, script=((), ())).journal
    session = session_of(decode_journal(journal))
    uff = [chain_file(folder / "chain.uff", lines=40).read_bytes()]
    for binary in (False, True):
        write_uff(whole_file(rng, n=9), folder / "whole.uff", binary=binary)
        uff.append((folder / "whole.uff").read_bytes())
    return make_decoders(folder, journal, session, (frf_of(session, rng),), tuple(uff))


def frf_of(session, rng):
    """FRFs of the session's first posture: noise, in the right places."""
    posture = session.header.plan.postures[0]
    shape = (3, 1, 6)
    return FrequencyResponse(
        posture=posture.name,
        form=FrfForm.ACCELERANCE,
        freq_hz=np.arange(1, 7) * 0.81,
        decay_rad_s=2.8,
        values=rng.normal(size=shape) + 1j * rng.normal(size=shape),
        coherence=rng.uniform(size=shape),
        variance=np.full(shape, np.inf),
        n_hits=np.full((3, 1), 3, dtype=np.int64),
        responses=tuple(
            Dof(point="2", label=label, direction=axis)
            for label, axis in zip("xyz", np.eye(3), strict=True)
        ),
        references=(Dof(point="1", label="hit", direction=np.array([0.0, 0.6, -0.8])),),
        joints_rad=posture.joints_rad,
    )
