"""The sums of a picture while it is made: samples in batches of pixels and passes, merged without loss of digits."""

from __future__ import annotations

from typing import Any

import numpy as np

from lenstrace.scene.picture import relative_noise


class Tally:
    """Of every pixel the mean of its samples, the sum of squared deviations from it, and how many they are."""

    def __init__(self, pixels: int, dtype: Any) -> None:
        """A picture of so many pixels, none of them sampled."""
        self.mean, self._spread = np.zeros((pixels, 3), dtype), np.zeros((pixels, 3), dtype)
        self.count = np.zeros(pixels, np.int32)
        self.rays = 0

    def add(self, first: int, mean: np.ndarray, spread: np.ndarray, number: int, rays: int) -> None:
        """`number` samples more of the pixels from `first` on: their mean and spread, (N, 3).

        Source: T. Chan, G. Golub, R. LeVeque, Stanford STAN-CS-79-773 (1979), Eq. (2.1).
        """
        here = slice(first, first + len(mean))
        before = self.count[here, None].astype(mean.dtype)
        change, share = mean - self.mean[here], number / (before + number)
        self.mean[here] += change * share
        self._spread[here] += spread + change**2 * before * share
        self.count[here] += number
        self.rays += rays

    def standard_error(self) -> np.ndarray:
        """(pixels, 3), of the means; inf for a pixel of fewer than two samples."""
        count = self.count[:, None].astype(self._spread.dtype)
        error = np.sqrt(self._spread / np.maximum(count * (count - 1), 1))
        error[self.count < 2] = np.inf
        return error

    def noise(self) -> float:
        """See `Picture.noise`."""
        return relative_noise(self.mean, self.standard_error())
