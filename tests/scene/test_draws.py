"""Random numbers of the renderer: uniform, independent of order, and Sobol's as even as they must be."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy import stats

from lenstrace.scene.draws import FIRST_BOUNCE, Draws, Sampler

COUNT = 1 << 16


def draws(samples, sampler=Sampler.INDEPENDENT, pixel=3, key=11):
    words = jnp.asarray(samples, jnp.uint32)
    return Draws(jnp.full(words.shape, pixel, jnp.uint32), words, jnp.asarray(key, jnp.uint32), sampler)


@pytest.mark.parametrize("sampler", Sampler)
@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_numbers_are_uniform(sampler, dtype):
    for numbers in draws(np.arange(COUNT), sampler).four(FIRST_BOUNCE, dtype):
        numbers = np.asarray(numbers)
        assert numbers.dtype == dtype
        assert numbers.min() >= 0
        assert numbers.max() < 1
        assert stats.kstest(numbers, "uniform").pvalue > 1e-3


def test_numbers_of_another_pixel_purpose_or_key_are_not_related():
    base = draws(np.arange(COUNT)).four(2, jnp.float64)[0]
    others = [
        draws(np.arange(COUNT)).four(3, jnp.float64)[0],
        draws(np.arange(COUNT), pixel=4).four(2, jnp.float64)[0],
        draws(np.arange(COUNT), key=12).four(2, jnp.float64)[0],
        draws(np.arange(1, COUNT + 1)).four(2, jnp.float64)[0],
        *draws(np.arange(COUNT)).four(2, jnp.float64)[1:],
    ]
    for other in others:
        # the standard deviation of a correlation of N pairs is 1 / sqrt(N)
        assert abs(np.corrcoef(base, other)[0, 1]) < 4 / np.sqrt(COUNT)


@pytest.mark.parametrize("pair", [(0, 1), (2, 3)])
@pytest.mark.parametrize("bits", [4, 6, 8])
def test_first_powers_of_two_fill_every_elementary_interval_once(pair, bits):
    """(0, m, 2)-nets: of 2^m points one lies in each box of 2^-k by 2^-(m - k)."""
    numbers = draws(np.arange(1 << bits), Sampler.SOBOL).four(FIRST_BOUNCE, jnp.float64)
    x, y = (np.asarray(numbers[i]) for i in pair)
    for k in range(bits + 1):
        boxes = np.floor(x * 2**k) * 2 ** (bits - k) + np.floor(y * 2 ** (bits - k))
        assert len(np.unique(boxes)) == 1 << bits


def slope(sampler, numbers=(16, 64, 256, 1024), pixels=400):
    """Of the root mean square error of the integral of a smooth function against the number of points, log by log."""
    errors = []
    for number in numbers:
        pixel, sample = np.divmod(np.arange(pixels * number), number)
        word = Draws(
            jnp.asarray(pixel, jnp.uint32), jnp.asarray(sample, jnp.uint32), jnp.asarray(5, jnp.uint32), sampler
        )
        x, y = (np.asarray(each).reshape(pixels, number) for each in word.four(FIRST_BOUNCE, jnp.float64)[:2])
        estimates = np.mean(np.sin(np.pi * x) * np.exp(y), axis=1)
        errors.append(np.sqrt(np.mean((estimates - 2 / np.pi * (np.e - 1)) ** 2)))
    return np.polyfit(np.log(numbers), np.log(errors), 1)[0]


def test_errors_fall_as_they_should():
    """-1/2 at random, -3/2 for scrambled nets on smooth functions. Source: A. Owen, Ann. Statist. 25, 1541 (1997)."""
    assert slope(Sampler.INDEPENDENT) == pytest.approx(-0.5, abs=0.05)
    assert slope(Sampler.SOBOL) == pytest.approx(-1.45, abs=0.15)
