"""Random numbers for properties: a test draws a generator, whatever it makes of it must hold."""

import numpy as np
from hypothesis import strategies as st

__all__ = ["generators"]

generators = st.integers(0, 2**32 - 1).map(np.random.default_rng)
