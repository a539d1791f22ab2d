"""A picture: linear radiance with its error and its cost; and how it becomes what a screen shows, in one place."""

from __future__ import annotations

import dataclasses

import jax.numpy as jnp
import numpy as np

from lenstrace.optics.colour import LUMINANCE, encoded, within_gamut


@dataclasses.dataclass(frozen=True)
class Picture:
    """What `render` gives.

    radiance:        (H, W, 3), linear RGB, the mean of the samples; row 0 is the upper one.
    standard_error:  (H, W, 3), of that mean, from the spread of the samples of each pixel; inf for a single sample.
                     With Sobol's points the true error is smaller.
    samples:         (H, W), how many were taken; fewer than asked for, or none, where the work was stopped.
    rays:            how many rays were traced, those to lights included.
    seconds, compile_seconds:  of tracing, and of compiling before it.
    interrupted:     whether Ctrl-C ended the work.
    notes:           what may surprise about the picture, such as a scene without a light.
    """

    radiance: np.ndarray
    standard_error: np.ndarray
    samples: np.ndarray
    rays: int
    seconds: float
    compile_seconds: float
    interrupted: bool = False
    notes: tuple[str, ...] = ()

    @property
    def rays_per_second(self) -> float:
        """Rays traced in a second, without compilation."""
        return self.rays / self.seconds if self.seconds > 0 else 0.0

    @property
    def mean_rgb(self) -> np.ndarray:
        """(3,), mean radiance of the pixels that have samples."""
        return np.mean(self.radiance[self.samples > 0], axis=0, dtype=float)

    @property
    def noise(self) -> float:
        """Mean standard error of the luminance of a pixel over the mean luminance; 0 where all is black."""
        return relative_noise(self.radiance, self.standard_error)

    @property
    def nan_pixels(self) -> int:
        """Pixels with a number that is none: always 0, or there is a mistake in this program."""
        return int(np.sum(~np.all(np.isfinite(self.radiance), axis=-1)))

    def screen(self, exposure: float = 0.0) -> np.ndarray:
        """(H, W, 3), 8-bit sRGB: radiance times 2^exposure, colours no screen has made paler, the rest clipped."""
        rgb = jnp.asarray(self.radiance, jnp.float32) * 2.0**exposure
        return np.asarray(jnp.round(255 * encoded(within_gamut(rgb)))).astype(np.uint8)


def relative_noise(radiance: np.ndarray, standard_error: np.ndarray) -> float:
    """Of a picture, see `Picture.noise`."""
    weights = np.array(LUMINANCE, radiance.dtype)
    error = np.mean(np.sqrt(standard_error**2 @ weights**2), dtype=float)
    mean = np.mean(radiance @ weights, dtype=float)
    return float(error / mean) if mean > 0 else 0.0
