"""Mean, standard deviation, extremes and quantiles of a stream, in memory that does not grow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Moments", "moments_of"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Moments:
    """What is kept of a stream of arrays, element by element."""

    count: int
    mean: Array
    sum_of_squares: Array  # of the deviations from the mean
    lowest: Array
    highest: Array

    @property
    def std(self) -> Array:
        """Standard deviation over the stream (divided by count)."""
        return np.asarray(np.sqrt(self.sum_of_squares / self.count))

    def joined(self, other: Moments) -> Moments:
        """Return the moments of both streams together.

        References
        ----------
        T. F. Chan, G. H. Golub, R. J. LeVeque, The American Statistician 37 (1983) 242.
        """
        count = self.count + other.count
        apart = other.mean - self.mean
        return Moments(
            count=count,
            mean=self.mean + apart * (other.count / count),
            sum_of_squares=self.sum_of_squares
            + other.sum_of_squares
            + apart**2 * (self.count * other.count / count),
            lowest=np.minimum(self.lowest, other.lowest),
            highest=np.maximum(self.highest, other.highest),
        )


def moments_of(values: Array, axis: int) -> Moments:
    """Return the moments of an array along one axis."""
    mean = values.mean(axis=axis, keepdims=True)
    return Moments(
        count=values.shape[axis],
        mean=mean.squeeze(axis),
        sum_of_squares=np.square(values - mean).sum(axis=axis),
        lowest=values.min(axis=axis),
        highest=values.max(axis=axis),
    )
