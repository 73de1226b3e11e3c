"""Read-only copies of arrays for records that cannot change."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

__all__ = ["frozen_array"]

ScalarT = TypeVar("ScalarT", bound=np.generic)


def frozen_array(values: npt.ArrayLike, dtype: type[ScalarT]) -> npt.NDArray[ScalarT]:
    """Copy `values` into a C-ordered array of `dtype` that refuses to be written.

    >>> a = frozen_array([1, 2], np.float64)
    >>> a.flags.writeable
    False
    """
    array = np.array(values, dtype=dtype, order="C")
    array.setflags(write=False)
    return array
