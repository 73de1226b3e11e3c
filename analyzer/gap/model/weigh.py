"""How far a prediction may be from a measurement: noise, discrepancy, and each mounting's errors.

The errors of a mounting are a matrix on its three axes, I + E. They are integrated out in closed
form, per channel with columns N (prediction along each axis, times its prior):

    chi^2 = r'r - r'N (N'N + I)^-1 N'r ,

and likewise for every product of residual and derivative.
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

__all__ = ["Discrepancy", "Quadratic", "Weighing", "nuisance", "stacked"]

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
        """(m, 3) chi^2 / 2 of every channel of a prediction, mountings integrated out."""
        r, N = self._residual(y), self._nuisance(y)
        Nr = np.einsum("milk,mil->mik", N, r)
        return np.asarray(
            0.5 * (np.sum(r * r, axis=-1) - np.sum(Nr * _solved(N, Nr[..., None])[..., 0], axis=-1))
        )

    def cost_by_axis(self, y: ComplexArray) -> Array:
        """(m, 3, 3, 2) chi^2 / 2 of each recorded channel if it were each true axis, +1 or -1."""
        m = y.shape[0]
        result = np.empty((m, 3, 3, 2))
        for axis in range(3):
            # The channel's own gain belongs to that axis now, its tilts to the others.
            prior = np.broadcast_to(np.roll(self.prior[:, 0], axis, axis=-1)[:, None], (m, 3, 3))
            N = stacked(self.scale[:, :, None] * y[:, None] * prior[..., None]).swapaxes(-1, -2)
            for side, sign in enumerate((1.0, -1.0)):
                r = stacked((self.lines.values - sign * y[:, axis, None]) * self.scale)
                Nr = np.einsum("milk,mil->mik", N, r)
                solved = _solved(N, Nr[..., None])[..., 0]
                result[:, :, axis, side] = 0.5 * (
                    np.sum(r * r, axis=-1) - np.sum(Nr * solved, axis=-1)
                )
        return result

    def gain_slopes(self, y: ComplexArray) -> tuple[Array, Array]:
        """(m, 3) slope and curvature of chi^2 / 2 by each channel's log gain."""
        r, N = self._residual(y), self._nuisance(y)
        d = stacked(y * self.scale)
        right = np.stack(
            [np.einsum("milk,mil->mik", N, r), np.einsum("milk,mil->mik", N, d)], axis=-1
        )
        solved = _solved(N, right)
        slope = -np.sum(d * r, axis=-1) + np.sum(right[..., 1] * solved[..., 0], axis=-1)
        curve = np.sum(d * d, axis=-1) - np.sum(right[..., 1] * solved[..., 1], axis=-1)
        return slope, curve

    def own_slopes(self, y: ComplexArray, dy: ComplexArray) -> tuple[Array, Array]:
        """(m, k) slope and (m, k, k) curvature of chi^2 / 2 by what acts on one mounting alone.

        `dy` (k, m, 3, L).
        """
        r, N = self._residual(y), self._nuisance(y)
        J = stacked(dy * self.scale).transpose(1, 2, 3, 0)  # (m, 3, 2L, k)
        right = np.matmul(N.swapaxes(-1, -2), np.concatenate([J, r[..., None]], axis=-1))
        clean = np.matmul(N, _solved(N, right))
        slope = -np.einsum("milk,mil->mk", J, r - clean[..., -1])
        curve = np.einsum("milk,milj->mkj", J, J - clean[..., :-1])
        return slope, curve

    def cleaned(self, y: ComplexArray) -> ComplexArray:
        """Residual (m, 3, L), weighted, after the best mounting errors are taken off."""
        r, N = self._residual(y), self._nuisance(y)
        Nr = np.einsum("milk,mil->mik", N, r)
        left = r - np.einsum("milk,mik->mil", N, _solved(N, Nr[..., None])[..., 0])
        return np.ascontiguousarray(left).view(np.complex128)

    def sensitivities(self, y: ComplexArray, dy: ComplexArray) -> tuple[Array, Array, Array]:
        """Weighted derivatives, raw and with mounting errors integrated out, and the residual.

        Returns
        -------
        J, clean : (n, m, 3, 2L)
            clean is W J and J'clean the curvature, W = I - N (N'N + I)^-1 N'.
        r : (m, 3, 2L)
            W times the residual.
        """
        N = self._nuisance(y)
        J = stacked(dy * self.scale.astype(dy.real.dtype))  # (n, m, 3, 2L)
        solve = np.matmul(
            np.linalg.inv(np.matmul(N.swapaxes(-1, -2), N) + np.eye(N.shape[-1])),
            N.swapaxes(-1, -2),
        ).astype(J.dtype)
        own = N.astype(J.dtype)

        def cleaned(rows: Array) -> Array:  # (m, 3, n, 2L)
            taken = np.matmul(np.matmul(rows, solve.swapaxes(-1, -2)), own.swapaxes(-1, -2))
            return np.asarray(rows - taken)

        by_channel = np.ascontiguousarray(J.transpose(1, 2, 0, 3))
        clean = cleaned(by_channel).transpose(2, 0, 1, 3)
        r = cleaned(self._residual(y)[:, :, None].astype(J.dtype))[:, :, 0]
        return J, clean, r

    def _residual(self, y: ComplexArray) -> Array:
        return stacked((self.lines.values - y) * self.scale)

    def _nuisance(self, y: ComplexArray) -> Array:
        return nuisance(self.scale, self.prior, self.places, y)


def nuisance(scale: Array, prior: Array, places: Array, y: ComplexArray) -> Array:
    """(m, 3, 2L, 3 + k) columns of the mounting's errors."""
    N = stacked(scale[:, :, None] * y[:, None] * prior[..., None])  # (m, 3, 3, 2L)
    return np.concatenate([N, places.astype(N.dtype, copy=False)], axis=2).swapaxes(-1, -2)


def stacked(z: ComplexArray) -> Array:
    """Real and imaginary parts in turn along the last axis."""
    return np.ascontiguousarray(z).view(z.real.dtype)


def _solved(N: Array, right: Array) -> Array:
    gram = np.matmul(N.swapaxes(-1, -2), N) + np.eye(N.shape[-1])  # never near singular
    return np.asarray(np.matmul(np.linalg.inv(gram), right))
