"""Fits made by hand: a structure, and a covariance of its parameters as one wants it."""

import numpy as np
from support.small_fit import state_of

from armodal.analyzer.identification.frf_fit import FrfFit
from armodal.analyzer.identification.parameters import ParameterNames
from armodal.analyzer.identification.scatter import ParameterScatter

N_CLUSTERS = 11  # equal ones: ten degrees of freedom


def made_fit(superset, structure, covariance=None, postures=("test 1",)):
    """Return a fit that found `structure`, with a covariance shared by eleven equal mountings."""
    names = ParameterNames.of(superset.arm, structure, postures)
    n = len(names.names)
    covariance = np.zeros((n, n)) if covariance is None else np.asarray(covariance, dtype=float)
    return FrfFit(
        state=state_of(structure, len(postures)),
        parameters=names,
        scatter=ParameterScatter(
            covariance=covariance,
            cluster_share=np.broadcast_to(np.eye(n) / N_CLUSTERS, (N_CLUSTERS, n, n)),
        ),
        cost=1.0,
        relative_residual=np.zeros(len(postures)),
        iterations=1,
    )
