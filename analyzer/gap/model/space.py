"""The parameters of a hypothesis: what each may be, and how sure one is before measuring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

__all__ = ["Parameter", "Space"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A number the fit may change: a Gaussian prior, and bounds that nature sets."""

    name: str
    unit: str  # of the SI; empty for a pure number and for a logarithm
    mean: float
    std: float
    low: float = -np.inf
    high: float = np.inf
    start: float | None = None  # the mean, if not given
    untold: float | None = None  # what an arm file means that lacks it; None: it may not
    farthest: float = np.inf  # deviations from the mean that a fit tries, though nature allows more

    @property
    def first(self) -> float:
        """Return where a fit begins."""
        return self.mean if self.start is None else self.start


class Space:
    """An ordered set of parameters; its vectors count prior standard deviations from the mean.

    `least` and `most` are nature's bounds; `low` and `high` are within them, as far as a fit tries.
    """

    def __init__(self, parameters: Sequence[Parameter]) -> None:
        self.parameters = tuple(parameters)
        self.index = {p.name: i for i, p in enumerate(self.parameters)}
        self.mean = np.array([p.mean for p in self.parameters])
        self.std = np.array([p.std for p in self.parameters])
        farthest = np.array([p.farthest for p in self.parameters])
        self.least = (np.array([p.low for p in self.parameters]) - self.mean) / self.std
        self.most = (np.array([p.high for p in self.parameters]) - self.mean) / self.std
        self.low, self.high = np.maximum(self.least, -farthest), np.minimum(self.most, farthest)

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self.parameters)

    def start(self, known: Mapping[str, float] | None = None) -> Array:
        """Return the vector a fit begins with, `known` values first."""
        known = known or {}
        values = np.array([known.get(p.name, p.first) for p in self.parameters])
        return np.asarray(np.clip((values - self.mean) / self.std, self.low, self.high))

    def values(self, u: Array) -> dict[str, float]:
        """Return the physical value of every parameter at a vector."""
        return dict(zip(self.index, (self.mean + self.std * u).tolist(), strict=True))

    def with_changes(self, changes: Mapping[str, Parameter], more: Sequence[Parameter]) -> Space:
        """Return a space with some priors replaced and some parameters added."""
        kept = [
            replace(changes[p.name], name=p.name) if p.name in changes else p
            for p in self.parameters
        ]
        return Space([*kept, *more])
