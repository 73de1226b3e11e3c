"""From physical signals at a fine rate to the board's counts: high pass, anti-alias, converter."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import scipy

from armodal.hil_sim.plant_file import PlantFile

__all__ = ["FULL_SCALE_COUNTS", "FrontEnd"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

FULL_SCALE_COUNTS = 2**23 - 1


class FrontEnd:
    """Hammer and accelerometer through their conditioning and the converter's filter.

    The filter is linear in phase and the same for all four channels; a sample comes out
    `filter_delay_samples` after the instant it stands for.
    """

    def __init__(self, truth: PlantFile, rate_hz: Fraction) -> None:
        self.oversampling = truth.board.oversampling
        self.fine_hz = float(rate_hz) * self.oversampling
        self.delay_samples = truth.board.filter_delay_samples
        taps = 2 * self.delay_samples * self.oversampling + 1
        # Kaiser 8.6: -90 dB; the transition ends at the board's Nyquist frequency.
        width = 3.6 / (2 * self.delay_samples)
        self._taps = scipy.signal.firwin(
            taps, (0.5 - width / 2) * 2 / self.oversampling, window=("kaiser", 8.6)
        )
        hammer, accelerometer, volts = truth.hammer, truth.accelerometer, truth.board.range_v
        self._corners_hz = (hammer.highpass_hz, *(accelerometer.highpass_hz,) * 3)
        force_gain = hammer.sensitivity_v_per_n * (1.0 + hammer.gain_error)
        self.counts_per_unit = (
            FULL_SCALE_COUNTS
            / volts
            * np.array([hammer.sensitivity_v_per_n, *(accelerometer.sensitivity_v_per_m_s2,) * 3])
        )
        # True counts per unit of true force and of true specific force (x, y, z).
        self._mixing = np.zeros((4, 4))
        self._mixing[0, 0] = FULL_SCALE_COUNTS / volts * force_gain
        self._mixing[1:, 1:] = (
            FULL_SCALE_COUNTS
            / volts
            * accelerometer.sensitivity_v_per_m_s2
            * np.array(accelerometer.response)
        )

    @property
    def span(self) -> int:
        """Fine samples the filter looks at behind the newest one."""
        return len(self._taps) - 1

    def sample(self, fine: Array, free: ComplexArray, ratio: ComplexArray, n: int) -> Array:
        """Counts, not yet rounded, of a fine-rate signal that goes on as free decay.

        Free decay needs no fine grid: each exponential passes the high pass and the filter as
        itself times a complex gain, and the high pass adds one decay of its own.

        Parameters
        ----------
        fine
            (n_fine, 4) force in N and specific force in m/s² at `fine_hz`, the first row at a
            sample instant; its last `span` rows are free decay already.
        free
            (n_modes, 4) amplitudes at the last fine row: the signal is the real part of their sum.
        ratio
            (n_modes,) factor of each from one fine row to the next.
        n
            Samples wanted in all.

        Returns
        -------
        (n, 4) float64
            One row a sample, the filter's delay included.
        """
        # What falls to less than half in a fine step is gone by the last row, and its powers
        # backwards over the filter's length would overflow.
        lasting = np.abs(ratio) > 0.5
        free, ratio = free[lasting], ratio[lasting]
        passed = np.empty_like(fine)
        tail = np.zeros((len(ratio) + 1, 4), dtype=np.complex128)
        head_n = (len(fine) - 1) // self.oversampling + 1
        fine_after = np.arange(head_n, n) * self.oversampling - (len(fine) - 1)
        after = np.zeros((max(n - head_n, 0), 4))
        for channel, corner_hz in enumerate(self._corners_hz):
            b, a = _highpass(corner_hz, self.fine_hz)
            passed[:, channel] = scipy.signal.lfilter(b, a, fine[:, channel])
            gain = (b[0] + b[1] / ratio) / (1.0 + a[1] / ratio)
            tail[:-1, channel] = gain * free[:, channel]
            tail[-1, channel] = passed[-1, channel] - tail[:-1, channel].sum().real
            ratios = np.append(ratio, -a[1])
            logs = np.log(ratios.astype(np.complex128))
            filtered = np.exp(-np.outer(logs, np.arange(len(self._taps)))) @ self._taps
            after[:, channel] = _decay(
                filtered * tail[:, channel], logs, fine_after, self.oversampling
            )
        head = scipy.signal.upfirdn(
            self._taps, passed @ self._mixing.T, down=self.oversampling, axis=0
        )
        sampled: Array = np.concatenate([head[:head_n], after @ self._mixing.T])
        return sampled

    def sample_all(self, fine: Array) -> Array:
        """Counts (n, 4), not yet rounded, of a signal given at the fine rate to its end."""
        passed = np.empty_like(fine)
        for channel, corner_hz in enumerate(self._corners_hz):
            b, a = _highpass(corner_hz, self.fine_hz)
            passed[:, channel] = scipy.signal.lfilter(b, a, fine[:, channel])
        n = (len(fine) - 1) // self.oversampling + 1
        sampled: Array = scipy.signal.upfirdn(
            self._taps, passed @ self._mixing.T, down=self.oversampling, axis=0
        )[:n]
        return sampled


@lru_cache(maxsize=32)
def _highpass(corner_hz: float, rate_hz: float) -> tuple[Array, Array]:
    """Coefficients of a first-order high pass."""
    b, a = scipy.signal.butter(1, corner_hz, "highpass", fs=rate_hz)
    return np.asarray(b), np.asarray(a)


def _decay(
    amplitudes: ComplexArray, logs: ComplexArray, steps: npt.NDArray[np.int_], stride: int
) -> Array:
    """Sum of exponentials at evenly spaced steps, its real part.

    Powers of a step within a block times powers of whole blocks: two short tables and a product.
    """
    n, block = len(steps), 128
    if n == 0:
        return np.zeros(0)
    inside = np.exp(np.outer(logs, stride * np.arange(block)))
    blocks = np.exp(np.outer(steps[::block], logs)) * amplitudes
    result: Array = (blocks @ inside).real.ravel()[:n]
    return result
