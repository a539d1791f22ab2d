"""The lenses that are timed, and the rays they are given."""

from __future__ import annotations

from pathlib import Path

import jax
import numpy as np

import lenstrace
from lenstrace import Fields, Lens, Ray, Wavelengths

DESIGNS = Path(__file__).parents[2] / "designs"
FIELD = 10.0  # degrees


def double_gauss() -> Lens:
    """Eleven surfaces, three fields, three wavelengths."""
    return lenstrace.load(DESIGNS / "double_gauss.toml")


def thrice(lens: Lens) -> Lens:
    """The rows of a lens three times, one behind the other: the same kinds of surface. Most rays fail in it."""
    return lens.replace(rows=lens.rows + tuple(row.replace(stop=False) for row in lens.rows) * 2)


def one_colour(lens: Lens) -> Lens:
    """A lens with one field, 10 degrees, and its primary wavelength."""
    waves = lens.wavelengths
    return lens.replace(
        fields=Fields(x=(0.0,), y=(FIELD,), kind="angle"),
        wavelengths=Wavelengths(weights=(1.0,), um=(waves.um[waves.primary],), primary=0),
    )


def filling(lens: Lens, count: int) -> Ray:
    """Rays of the 10 degree field spread evenly at random over the entrance pupil, on the first vertex plane."""
    pupil = lenstrace.overview(lens).entrance_pupil
    chance = np.random.default_rng(0)
    radius, turn = np.sqrt(chance.random(count)) * float(pupil.diameter) / 2, chance.random(count) * 2 * np.pi
    angle = np.deg2rad(FIELD)
    middle = -float(pupil.position) * np.tan(angle)
    point = radius * np.cos(turn), radius * np.sin(turn) + middle, 0.0
    return jax.block_until_ready(lenstrace.ray(point, (0.0, np.sin(angle), np.cos(angle))))
