"""What of a hypothesis in one posture, or in several, does not depend on frequency."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.geometry import skew
from armodal.analyzer.gap.model.line_arrays import as_single

__all__ = ["Pieces", "System"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pieces:
    """A link's mass in P pieces along a line, each moving by itself."""

    shares: Array  # (P,) of the mass
    offsets_m: Array  # (P, 3) of each centre from the link's; their mean by mass is zero
    motion: Array  # (P, 6, n); stacked, with postures before

    def split(self, inertia: npt.NDArray[np.floating[Any]]) -> Array:
        """(..., P, 6, 6) spatial inertias of the pieces: together they are the link's (..., 6, 6).

        Linear in the link's: what the offsets add to the tensor, the pieces themselves have less.
        """
        mass = inertia[..., None, :1, :1]
        moment = inertia[..., None, 3:, :3]  # the cross product with the first moment
        apart = skew(self.offsets_m)
        square = apart @ apart
        square = square - np.tensordot(self.shares, square, axes=1)
        found = np.repeat(inertia[..., None, :, :], len(apart), axis=-3)
        found[..., 3:, :3] += mass * apart
        found[..., :3, 3:] -= mass * apart
        found[..., 3:, 3:] -= moment @ apart + apart @ moment + mass * square
        found *= self.shares[:, None, None]
        return np.asarray(found)


@dataclass(frozen=True, slots=True, kw_only=True)
class System:
    """What of a hypothesis in one posture does not depend on frequency; n coordinates.

    Stacked (`analyzer.gap.model.systems`): of P postures, the first axis of every array.
    """

    mass: Array  # (n, n) without the accelerometer
    damping: Array  # (n, n)
    stiffness: Array  # (n, n)
    loss: Array  # (n, n): K + h(s) loss, `hysteresis.lost_by_power`
    loss_power: Array  # () of frequency, by which that loss grows: 0 to 1
    relaxing: Array  # (r, n, n) of each drive: K + z(s) relaxing, `hysteresis.relaxed`
    relaxing_rad_s: Array  # (r,) where each loses most
    compliance: Array  # (n,) rad/(N m) or m/N; NaN for a coordinate on a spring
    compliance_loss_s: Array  # (n,)
    compliance_loss_factor: Array  # (n,) beside it, the same at all frequencies
    link_motion: Array  # (n_links, 6, n)
    base_motion: Array  # (6, n)
    pieces: dict[int, Pieces]  # of links that give way along their length
    moved: Array  # (m, 3, n) the sensor's motion in base
    seen: Array  # (m, 3, n) the sensor's motion along its axes
    tilted: Array  # (m, 3, n) what gravity adds on them
    turned: Array  # (m, 3, n) the sensor's rotation along them
    mix: Array  # (m, 3, 3) from true axes to recorded channels
    hit: Array  # (n_hits, 3, n) motion of the hit places in base
    hit_turned: Array  # (n_hits, 3, n) rotation there
    force: Array  # (n_hits, 3)
    log_scale: Array  # () of all responses
    delay_s: Array  # () of the responses behind the force
    sensor_mass_kg: Array  # ()
    decay_rad_s: Array  # () by which all records fall that nobody wrote down

    def alone(self, posture: int) -> System:
        """Return one of stacked systems, without their axis."""
        found: dict[str, Any] = {
            f.name: getattr(self, f.name)[posture] for f in fields(self) if f.name != "pieces"
        }
        pieces = {
            link: replace(own, motion=own.motion[posture]) for link, own in self.pieces.items()
        }
        return System(**found, pieces=pieces)

    def in_single(self) -> System:
        """Return the system in single precision."""
        arrays = (f.name for f in fields(self) if f.name != "pieces")
        pieces = {
            link: replace(own, motion=as_single(own.motion)) for link, own in self.pieces.items()
        }
        return replace(
            self, pieces=pieces, **{name: as_single(getattr(self, name)) for name in arrays}
        )

    def moving(self) -> npt.NDArray[np.int64]:
        """Return the coordinates that are not locked in every posture; stacked."""
        return np.flatnonzero((self.compliance != 0.0).any(axis=0))

    def among(self, coordinates: npt.NDArray[np.int64]) -> System:
        """Return the system with some of its coordinates alone, the others locked."""
        square = np.ix_(coordinates, coordinates)
        matrices = {
            name: getattr(self, name)[..., square[0], square[1]]
            for name in ("mass", "damping", "stiffness", "loss", "relaxing")
        }
        rows = {name: getattr(self, name)[..., coordinates] for name in _BY_COORDINATE}
        pieces = {
            link: replace(own, motion=own.motion[..., coordinates])
            for link, own in self.pieces.items()
        }
        return replace(self, **matrices, **rows, pieces=pieces)


_BY_COORDINATE = (  # arrays of a system whose last axis are its coordinates
    "compliance",
    "compliance_loss_s",
    "compliance_loss_factor",
    "link_motion",
    "base_motion",
    "moved",
    "seen",
    "tilted",
    "turned",
    "hit",
    "hit_turned",
)
