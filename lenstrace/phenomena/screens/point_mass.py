"""A star as a lens: what stands behind it is seen twice.

Light that passes a mass at the distance b is turned toward it by 2 r_s / b, r_s its Schwarzschild radius. With the
distances D_l to the lens, D_s to the source and D_ls between them, an image at the angle t belongs to a source at

    u = t - t_E^2 / t,      t_E^2 = 2 r_s D_ls / (D_l D_s),

so that t = (u +- sqrt(u^2 + 4 t_E^2)) / 2, and the light of both together is magnified

    (x^2 + 2) / (x sqrt(x^2 + 4)),      x = u / t_E.

Source: Einstein, Science 84, 506 (1936); Schneider, Ehlers & Falco, Gravitational Lenses (1992), section 2.1.
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import ray, trace
from lenstrace.optics.rays import living
from lenstrace.phenomena.demonstration import RELATIVE_TOLERANCE, Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

SUN_SCHWARZSCHILD = 2.9532500765e6  # mm; 2 G M / c^2 of the nominal solar mass, IAU 2015 resolution B3
SUN_RADIUS = 6.957e11  # mm, nominal, IAU 2015 resolution B3
KILOPARSEC = 3.0856775814913673e22  # mm, IAU 2015 resolution B2
ARC_SECOND = math.pi / 180 / 3600
STEPS = 8  # of Newton's method, which converges from one side
SOURCE = 0.2  # radius of the drawn star, in units of t_E
SMALL_ANGLES = 10.0  # of the square of the angle, which the closed forms leave out, at offsets of some t_E
POINTS = 181  # of the drawn images


@result
class PointMass(Demonstration):
    """The images of a round source near a point mass, angles in milliarcseconds.

    einstein:     t_E.                          source: where its centre is, along y.
    edge:         (2, N), x and y of its rim.   images: (2, 2, N), x and y of the rims of its two images.
    covers:       whether the star is seen behind the mass itself: then its images are one ring, between the two rims.
    positions:    (Q,), of a source, in units of t_E.     magnification, magnification_theory: (Q,), there.
    """

    einstein: float
    source: float
    edge: np.ndarray
    images: np.ndarray
    covers: bool
    positions: np.ndarray
    magnification: np.ndarray
    magnification_theory: np.ndarray


@demonstration
def point_mass(
    mass: Annotated[float, Option("mass of the lens", "solar masses", least=1e-6, most=1e12, slider=(0.1, 10))] = 1.0,
    lens_distance: Annotated[float, Option("distance of the lens", "kpc", least=1e-3, most=1e5, slider=(1, 8))] = 4.0,
    beyond: Annotated[float, Option("from the lens to the source", "kpc", least=1e-3, most=1e5, slider=(1, 8))] = 4.0,
    offset: Annotated[float, Option("source from the line through the lens", "t_E", least=0.01, most=5)] = 0.4,
) -> PointMass:
    """A mass as a lens: light bent by gravity, two images of one star."""
    near, far = lens_distance * KILOPARSEC, beyond * KILOPARSEC
    radius = mass * SUN_SCHWARZSCHILD
    einstein = math.sqrt(2 * radius * far / near / (near + far))
    thin = lens(
        [{"stop": True, "screen": {"point_mass": radius}, "thickness": far}],
        {"entrance_pupil_diameter": 1.0},
        [0.0],
        [0.5876],
        object_distance=near,
    )
    limb = thin.replace(surface=1, screen={"point_mass": SUN_SCHWARZSCHILD})
    grazing = trace(limb, rays=ray((0.0, SUN_RADIUS, 0.0), (0.0, 0.0, 1.0)))
    turned = 2 * SUN_SCHWARZSCHILD / SUN_RADIUS / ARC_SECOND

    turn = np.linspace(0, 2 * np.pi, POINTS)
    edge = np.array([SOURCE * np.sin(turn), offset + SOURCE * np.cos(turn)])
    positions = np.linspace(0.1, 3, 30)
    centres = np.append(positions, offset)
    sources = np.concatenate([edge, np.array([0 * centres, centres])], 1)
    images, magnified, ring = jax.device_get(_images(thin, einstein, sources))
    magnification = magnified.sum(0)[POINTS:]
    theory = (centres**2 + 2) / (centres * np.sqrt(centres**2 + 4))
    both = (offset + np.array([1, -1]) * math.sqrt(offset**2 + 4)) / 2
    unit = einstein / ARC_SECOND * 1e3
    small = RELATIVE_TOLERANCE + SMALL_ANGLES * einstein**2
    return PointMass(
        setting=f"a lens of {mass:g} solar masses at {lens_distance:g} kpc, a star {beyond:g} kpc behind it and "
        f"{offset * unit:.4g} mas off its line; Einstein's angle t_E is {unit:.6g} mas",
        rows=(
            Comparison("light at the rim of the Sun is turned by", "arcsec", -float(grazing.m[1]) / ARC_SECOND, turned),
            Comparison("image on the side of the star", "mas", images[0, 1, -1] * unit, both[0] * unit, small * unit),
            Comparison("image on the other side", "mas", images[1, 1, -1] * unit, both[1] * unit, small * unit),
            Comparison(
                "light of both images over that of the star", "", magnification[-1], theory[-1], small * theory[-1]
            ),
            Comparison("where a ray at Einstein's angle comes from", "mas", ring * unit, 0.0, small * unit),
        ),
        einstein=unit,
        source=offset * unit,
        edge=edge * unit,
        images=images[..., :POINTS] * unit,
        covers=offset < SOURCE,
        positions=positions,
        magnification=magnification[:-1],
        magnification_theory=theory[:-1],
    )


@jax.jit
def _images(thin: Lens, einstein: jax.Array, sources: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Images (2, 2, N) of sources (2, N) and how much each is magnified, (2, N); where a ray along y at t_E comes from.
    All angles in units of t_E, by rays traced back from the observer."""
    near, far = jnp.asarray(thin.object_distance), jnp.asarray(thin[1].thickness)

    def source_of(image: jax.Array) -> jax.Array:
        x, y = image * einstein
        length = jnp.sqrt(1 + x * x + y * y)
        zero = jnp.zeros_like(x)
        end = trace(thin, rays=living(zero, zero, zero - near, x / length, y / length, 1 / length), path=False)
        return jnp.stack([end.x, end.y]) / ((near + far) * einstein)

    def slopes(image: jax.Array) -> jax.Array:
        return jax.jacfwd(source_of)(image)

    def image_of(source: jax.Array, side: jax.Array) -> tuple[jax.Array, jax.Array]:
        distance = jnp.hypot(*source)
        start = side * source / distance * (1 + distance) ** side

        def step(_: int, image: jax.Array) -> jax.Array:
            return image - jnp.linalg.solve(slopes(image), source_of(image) - source)

        image = jax.lax.fori_loop(0, STEPS, step, start)
        return image, 1 / jnp.abs(jnp.linalg.det(slopes(image)))

    sides = jnp.array([1.0, -1.0])
    images, magnified = jax.vmap(jax.vmap(image_of, (1, None)), (None, 0))(sources, sides)
    return jnp.swapaxes(images, 1, 2), magnified, source_of(jnp.array([0.0, 1.0]))[1]
