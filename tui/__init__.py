"""The command line and the terminal app: where all other packages meet."""

import os

# Matrices here are small: one BLAS thread is faster than many, and numpy reads this at import.
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")
