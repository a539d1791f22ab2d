"""What is said of results by waves that are less accurate than they look: distorted pupils, few samples, rounding."""

from __future__ import annotations

import dataclasses
import warnings

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import AccuracyWarning, Lens
from lenstrace.analysis.notes import rounding


def with_fields(lens: Lens, *y: float) -> Lens:
    return lens.replace(fields=dataclasses.replace(lens.fields, x=(0.0,) * len(y), y=y))


def test_no_contrast_of_a_pupil_too_distorted_for_a_transform(designs: dict[str, Lens]) -> None:
    lens = with_fields(designs["fisheye"], 0.0, 60.0)
    with pytest.warns(AccuracyWarning) as said:
        found = lenstrace.mtf(lens, [10.0], samples=64)
    assert np.isfinite(found.tangential[0]).all()
    for values in (found.tangential, found.sagittal, found.limit_tangential):
        assert np.isnan(values[1]).all()
    assert np.isnan(found.each_sagittal[1]).any()
    assert np.isfinite(found.limit_sagittal[0]).all()
    notes = [str(each.message) for each in said]
    assert found.notes == tuple(notes)
    assert "field (0, 60) deg: rays miss their nodes" in notes[0]
    assert "huygens" in notes[0]


def test_no_contrast_of_the_slab_in_a_program_either(designs: dict[str, Lens]) -> None:
    lens = designs["negative_index_slab"]

    @jax.jit
    def contrast(z: jax.Array) -> jax.Array:
        return lenstrace.mtf(lens.replace(thickness=z), [500.0], samples=16).tangential

    assert np.isnan(contrast(jnp.asarray(lens.thickness))).all()


def test_a_little_distortion_does_no_harm(designs: dict[str, Lens]) -> None:
    # rays miss their nodes by 0.0023; the judge is the spectrum of the sum of plane waves, which has no nodes
    lens = with_fields(designs["phone_lens"], float(designs["phone_lens"].fields.y[-1]))
    frequency = np.array([50.0, 100.0, 200.0])
    found = lenstrace.mtf(lens, frequency, samples=64)
    spread = lenstrace.psf(lens, samples=64, method="huygens")
    assert not found.notes
    light, place = np.asarray(spread.polychromatic[0]), np.asarray(spread.position)
    for axis, values in ((1, found.tangential), (0, found.sagittal)):
        line = light.sum(axis)
        waves = np.abs(np.exp(-2j * np.pi * frequency[:, None] * place) @ line) / line.sum()
        assert_allclose(values[0], waves, atol=0.01)


def test_too_few_samples_are_said_alike(designs: dict[str, Lens]) -> None:
    lens = with_fields(designs["double_gauss"], 14.0)
    for ask in (lenstrace.psf, lambda lens, samples: lenstrace.mtf(lens, [10.0], samples=samples)):
        with pytest.warns(AccuracyWarning, match="samples: the path changes by"):
            found = ask(lens, samples=10)
        assert "give more samples" in found.notes[0]


@pytest.mark.filterwarnings("ignore:samples")
def test_rounding_is_said(designs: dict[str, Lens]) -> None:
    lens = with_fields(designs["three_mirror_telescope"], 0.0)
    exact = lenstrace.wavefront(lens, samples=17)
    assert not exact.notes
    with pytest.warns(AccuracyWarning, match="rounding: in float32"):
        found = lenstrace.wavefront(lens.astype("float32"), samples=17)
    error = np.asarray(found.opd, float) - np.asarray(exact.opd)
    rms = float(np.sqrt(np.nanmean((error - np.nanmean(error)) ** 2)))
    assert 0.25 < rounding(lens.astype("float32")) / rms < 4
    with pytest.warns(AccuracyWarning, match="rounding: in float32"):
        lenstrace.psf(lens.astype("float32"), samples=16)
    with pytest.warns(AccuracyWarning, match="rounding: in float32"):
        lenstrace.mtf(lens.astype("float32"), [1.0], samples=16)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lenstrace.wavefront(designs["double_gauss"].astype("float32"), samples=9)
