"""The lenses that are timed, the rays they are given, and the call that is timed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

import lenstrace
from lenstrace import Fields, Lens, Ray, Wavelengths

DESIGNS = Path(__file__).parents[2] / "designs"
FIELD = 10.0  # degrees


def double_gauss() -> Lens:
    """Eleven surfaces, three fields, three wavelengths."""
    return lenstrace.load(DESIGNS / "double_gauss.toml")


def with_aspheres(lens: Lens) -> Lens:
    """The double Gauss with two mild aspheres, conic + r^4, r^6, r^8."""
    lens = lens.replace(surface=2, conic=0.3, asphere={4: 1e-7, 6: -2e-10, 8: 1e-13})
    return lens.replace(surface=9, conic=-0.2, asphere={4: -2e-7, 6: 1e-10, 8: 1e-13})


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


def image(lens: Lens, rays: Ray, *, opl: bool = False) -> Callable[[], Ray]:
    """A call from launch arrays to the rays at the image."""
    return lambda: jax.block_until_ready(lenstrace.trace(lens, rays, path=False, opl=opl))


def rounded(rays: Ray) -> Ray:
    """In float32 from the start, so that no call has to convert them."""
    return jax.tree.map(lambda a: a.astype(np.float32) if a.dtype == np.float64 else a, rays)


def per_ray_surface(lens: Lens, rays: Ray) -> float:
    """Nanoseconds per ray and surface for a second per call."""
    return 1e9 / rays.x.size / len(lens)


def arrays(rays: Ray) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    """Points and directions."""
    x, y, z, l, m, n = (np.array(a) for a in (rays.x, rays.y, rays.z, rays.l, rays.m, rays.n))
    return (x, y, z), (l, m, n)


def check(who: str, found: float, expected: float, tolerance: float) -> None:
    """Stop where another tracer's figure, a mean image height in mm for one, differs: another thing would be timed."""
    if not abs(found - expected) <= tolerance:
        raise SystemExit(f"{who}: {found!r}, lenstrace {expected!r}: not the same lens or rays")


def losses(rays: Ray) -> list[str]:
    """A line that says how many of the rays fail; none if all arrive."""
    lost = int(jnp.sum(rays.failure != 0))
    return [f"{lost:,} rays of {rays.x.size:,} fail"] if lost else []
