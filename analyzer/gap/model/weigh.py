"""How far a prediction may be from a measurement: noise, discrepancy, and each mounting's errors.

The errors of a mounting are a matrix on its three axes, I + E, and what its sensor's place and its
hits' are off by. The rows of E are a channel's own, with columns N (prediction along each axis,
times its prior); place and hits change the three channels together, with columns S. All are
integrated out in closed form,

    chi^2 = r'(W - W S (S'W S + I)^-1 S'W) r ,    W = I - N (N'N + I)^-1 N' ,

and likewise for every product of residual and derivative. As a sum of squares: with A'A = I - W and
B'B the rest, what errors take off a product of x and z is (Ax)'(Az) + (Bx)'(Bz).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.priors import (
    BASE_GAIN_STD,
    MOUNTING_GAIN,
    MOUNTING_GAIN_LEAST,
)
from armodal.protocols.arm.records import Tolerances

__all__ = ["Discrepancy", "Quadratic", "Weighing", "error_rows", "stacked"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Discrepancy:
    """What a right model may still be off, as a standard deviation of the complex FRF.

    sqrt((local |y|)^2 + (overall rms)^2 + (quiet typical)^2) sqrt(1 + (f / corner)^2): rms over
    the channel's band, typical the median of all channels'. What hardly moves, such as a point of
    the base, is reached by what no model of the arm holds: floor, cable, air.
    """

    local: float = 0.010
    overall: float = 0.005
    quiet: float = 0.004
    corner_hz: float = 50.0

    def variance(self, lines: PostureLines) -> Array:
        """(m, 3, L) of a posture's channels."""
        f = lines.s_rad_s.imag / (2.0 * np.pi)
        power = np.abs(lines.values) ** 2
        # A channel across all motion still lies on a sensor that moves: half from the mounting.
        own = np.mean(power, axis=-1, keepdims=True)
        mounting = np.mean(own, axis=1, keepdims=True)
        rms2 = (own + mounting) / 2.0
        typical2 = float(np.median(own))
        growth = 1.0 + (f / self.corner_hz) ** 2
        return np.asarray(
            (self.local**2 * power + self.overall**2 * rms2 + self.quiet**2 * typical2) * growth
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Quadratic:
    """Misfit about a point, of a posture or several: chi^2 / 2, gradient, Gauss-Newton matrix."""

    cost: float
    gradient: Array  # (n,)
    curvature: Array  # (n, n)


class Weighing:
    """Weights of one posture's lines."""

    def __init__(
        self,
        lines: PostureLines,
        tolerances: Tolerances,
        discrepancy: Discrepancy,
        *,
        places: ComplexArray | None = None,
        on_base: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        """Weigh lines.

        Parameters
        ----------
        places
            (m, 3, k, L): what k further errors of a mounting change, each by its deviation.
        on_base
            (m,) Mountings on the base.
        """
        self.lines = lines
        # A complex residual of variance v has two real parts of v / 2 each.
        self.scale = np.sqrt(2.0 / (lines.variance + discrepancy.variance(lines)))
        tilt = tolerances.sensor_tilt_rad
        gain = max(MOUNTING_GAIN * tolerances.sensor_gain, MOUNTING_GAIN_LEAST)
        # Rows: recorded channel; columns: true axis.
        m = len(lines.sensor_point)
        gains = np.full(m, gain)
        if on_base is not None:
            gains[on_base] = np.hypot(gain, BASE_GAIN_STD)
        self.prior = np.where(np.eye(3, dtype=bool), gains[:, None, None], tilt)
        if places is None:
            places = np.zeros((m, 3, 0, lines.s_rad_s.size), dtype=np.complex128)
        self.places = stacked(places * self.scale[:, :, None])  # (m, 3, k, 2L)

    @property
    def n(self) -> int:
        """Number of real residuals."""
        return 2 * self.lines.values.size

    def cost_by_mounting(self, y: ComplexArray) -> Array:
        """(m,) chi^2 / 2 of every mounting of a prediction, its errors integrated out."""
        r = self._residual(y)
        return np.asarray(0.5 * np.sum(r * self._taken_off(y, r[..., None])[..., 0], axis=(1, 2)))

    def cost_by_axis(self, y: ComplexArray) -> Array:
        """(m, 3, 3, 2) chi^2 / 2 of each recorded channel if it were each true axis, +1 or -1."""
        m = y.shape[0]
        result = np.empty((m, 3, 3, 2))
        for axis in range(3):
            # The channel's own gain belongs to that axis now, its tilts to the others.
            prior = np.broadcast_to(np.roll(self.prior[:, 0], axis, axis=-1)[:, None], (m, 3, 3))
            A = _own_rows(self.scale, prior, y)
            for side, sign in enumerate((1.0, -1.0)):
                r = stacked((self.lines.values - sign * y[:, axis, None]) * self.scale)
                Nr = np.matmul(A, r[..., None])[..., 0]
                result[:, :, axis, side] = 0.5 * (np.sum(r * r, axis=-1) - np.sum(Nr * Nr, axis=-1))
        return result

    def gain_slopes(self, y: ComplexArray) -> tuple[Array, Array]:
        """(m, 3) slope and curvature of chi^2 / 2 by each channel's log gain."""
        d = stacked(y * self.scale)
        alone = d[:, :, :, None] * np.eye(3)[:, None]  # (m, 3, 2L, 3): of one channel each
        clean = self._taken_off(y, alone)
        slope = -np.einsum("mil,milk->mk", self._residual(y), clean)
        return slope, np.einsum("milk,milk->mk", alone, clean)

    def own_slopes(self, y: ComplexArray, dy: ComplexArray) -> tuple[Array, Array]:
        """(m, k) slope and (m, k, k) curvature of chi^2 / 2 by what acts on one mounting alone.

        `dy` (k, m, 3, L).
        """
        J = stacked(dy * self.scale).transpose(1, 2, 3, 0)  # (m, 3, 2L, k)
        clean = self._taken_off(y, J)
        slope = -np.einsum("milk,mil->mk", clean, self._residual(y))
        return slope, np.einsum("milk,milj->mkj", J, clean)

    def cleaned(self, y: ComplexArray) -> ComplexArray:
        """Residual (m, 3, L), weighted, after the best mounting errors are taken off."""
        left = self._taken_off(y, self._residual(y)[..., None])[..., 0]
        return np.ascontiguousarray(left).view(np.complex128)

    def sensitivities(self, y: ComplexArray, dy: ComplexArray) -> tuple[Array, Array, Array]:
        """Weighted derivatives, raw and with mounting errors integrated out, and the residual.

        Returns
        -------
        J, clean : (n, m, 3, 2L)
            clean is M J and J'clean the curvature, M the matrix of chi^2.
        r : (m, 3, 2L)
            M times the residual.
        """
        J = stacked(dy * self.scale.astype(dy.real.dtype))  # (n, m, 3, 2L)
        columns = np.ascontiguousarray(J.transpose(1, 2, 3, 0))
        clean = self._taken_off(y, columns).transpose(3, 0, 1, 2)
        return J, clean, self._taken_off(y, self._residual(y)[..., None].astype(J.dtype))[..., 0]

    def _residual(self, y: ComplexArray) -> Array:
        return stacked((self.lines.values - y) * self.scale)

    def _taken_off(self, y: ComplexArray, x: Array) -> Array:
        """Columns x (m, 3, 2L, n) less what mounting errors about a prediction take off."""
        rows = error_rows(self.scale, self.prior, self.places, y)
        A, B = (of.astype(x.dtype, copy=False) for of in rows)
        left = x - np.matmul(A.swapaxes(-1, -2), np.matmul(A, x))
        m, n = len(x), x.shape[-1]
        B = B.reshape(m, B.shape[1], x[0, ..., 0].size)
        shared = np.matmul(B.swapaxes(-1, -2), np.matmul(B, x.reshape(m, -1, n)))
        return np.asarray(left - shared.reshape(x.shape))


def error_rows(scale: Array, prior: Array, places: Array, y: ComplexArray) -> tuple[Array, Array]:
    """A (m, 3, 3, 2L), of each channel alone, and B (m, k, 3, 2L), of the three together."""
    A = _own_rows(scale, prior, y)
    left = places - np.matmul(np.matmul(places, A.swapaxes(-1, -2)), A)  # (m, 3, k, 2L)
    m, _, k, length = places.shape
    S, WS = (of.swapaxes(1, 2).reshape(m, k, 3 * length) for of in (places, left))
    B = np.matmul(_root_of_inverse(np.matmul(S, WS.swapaxes(-1, -2))), WS)
    return A, B.reshape(m, k, 3, length)


def _own_rows(scale: Array, prior: Array, y: ComplexArray) -> Array:
    """(m, 3, 3, 2L) of each channel's own errors; `y` as all three see it."""
    N = stacked(scale[:, :, None] * y[:, None] * prior[..., None])  # (m, 3, 3, 2L)
    return np.asarray(np.matmul(_root_of_inverse(np.matmul(N, N.swapaxes(-1, -2))), N))


def stacked(z: ComplexArray) -> Array:
    """Real and imaginary parts in turn along the last axis."""
    return np.ascontiguousarray(z).view(z.real.dtype)


def _root_of_inverse(gram: Array) -> Array:
    """(..., k, k) R with R'R = (gram + I)^-1, which is never near singular."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(gram + np.eye(gram.shape[-1]))))
