"""The figures of third-order theory: Seidel sums, and the transverse, longitudinal and wave aberrations that follow."""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree


@pytree
class Sums:
    """S_I, S_II, S_III, S_IV, S_V, C_I and C_II, mm: (S,) of every surface, or () of a lens."""

    spherical: jax.Array
    coma: jax.Array
    astigmatism: jax.Array
    petzval: jax.Array
    distortion: jax.Array
    axial_colour: jax.Array
    lateral_colour: jax.Array


class Transverse(NamedTuple):
    """Where rays of the rim meet the paraxial image plane, mm from the paraxial image, positive toward +y for a field
    and a pupil point at +y. With K = 1 / (N' u'), nan where the image is at infinity (u' = 0):

    spherical TSPH = K S_I / 2                    tangential_coma TTCO = 3 K S_II / 2, sagittal_coma TSCO = K S_II / 2
    astigmatism TAST = K S_III (tangential - sagittal)               petzval TPFC = K S_IV / 2
    tangential_field TTFC = K (3 S_III + S_IV) / 2                   sagittal_field TSFC = K (S_III + S_IV) / 2
    distortion TDIST = K S_V / 2, of the chief ray
    axial_colour TAXC = K C_I, lateral_colour TLC = K C_II: shortest minus longest wavelength, rim ray and chief ray
    """

    spherical: jax.Array
    tangential_coma: jax.Array
    sagittal_coma: jax.Array
    astigmatism: jax.Array
    petzval: jax.Array
    tangential_field: jax.Array
    sagittal_field: jax.Array
    distortion: jax.Array
    axial_colour: jax.Array
    lateral_colour: jax.Array


class Longitudinal(NamedTuple):
    """Foci from the paraxial image plane, mm along +z: -1/u' times the transverse figure; nan where u' = 0.

    spherical LSA: of the rim rays.     tangential_field, sagittal_field, petzval: of the three image surfaces at the
    field.     astigmatism: tangential - sagittal.     axial_colour LCA: shortest minus longest wavelength.
    """

    spherical: jax.Array
    astigmatism: jax.Array
    petzval: jax.Array
    tangential_field: jax.Array
    sagittal_field: jax.Array
    axial_colour: jax.Array


class Waves(NamedTuple):
    """Coefficients of the wave aberration at the rim of the pupil, in primary wavelengths.

    W040 = S_I/8, W131 = S_II/2, W222 = S_III/2, W220P = S_IV/4 (Petzval), W220 = (S_III + S_IV)/4 (sagittal),
    W311 = S_V/2, W020 = C_I/2 and W111 = C_II (colour: defocus and tilt, shortest minus longest wavelength).
    """

    W040: jax.Array
    W131: jax.Array
    W222: jax.Array
    W220P: jax.Array
    W220: jax.Array
    W311: jax.Array
    W020: jax.Array
    W111: jax.Array


@pytree
class Seidel:
    """Third-order aberrations of a lens of S surfaces, at full aperture and one field, primary wavelength.

    total, surfaces:    the sums of the lens, each (), and of its surfaces, each (S,), the two parts together:
    spherical_part:     each (S,), of spheres that have the curvature of the surfaces at their vertices.
    aspheric_part:      each (S,), of conics and asphere terms, as departures from those spheres; no colour.
    marginal_height, chief_height:  (S,), y and ybar at the surfaces, mm.
    lagrange_invariant: H = N (u ybar - ubar y), mm.
    petzval_curvature:  of the Petzval surface, N' sum c D(1/N), 1/mm, positive when its centre is at larger z.
    image_index, image_slope:  N' and u' behind the last surface; u' is nan where the image is at infinity.
    field:              radians, or mm of object or image height.
    wavelength:         the primary one, mm.

    Tilts and decentres do not count, nor does the curvature of the image surface.
    """

    total: Sums
    surfaces: Sums
    spherical_part: Sums
    aspheric_part: Sums
    marginal_height: jax.Array
    chief_height: jax.Array
    lagrange_invariant: jax.Array
    petzval_curvature: jax.Array
    image_index: jax.Array
    image_slope: jax.Array
    field: jax.Array
    wavelength: jax.Array

    @property
    def petzval_radius(self) -> jax.Array:
        """Radius of the Petzval surface, mm; inf where it is flat."""
        flat = self.petzval_curvature == 0
        return jnp.where(flat, jnp.inf, 1 / jnp.where(flat, 1.0, self.petzval_curvature))

    def transverse(self, sums: Sums | None = None) -> Transverse:
        """Transverse aberrations of the lens, or of what is given: `transverse(surfaces)` is (S,) each."""
        s, k = self.total if sums is None else sums, 1 / (self.image_index * self.image_slope)
        return Transverse(
            spherical=k * s.spherical / 2,
            tangential_coma=3 * k * s.coma / 2,
            sagittal_coma=k * s.coma / 2,
            astigmatism=k * s.astigmatism,
            petzval=k * s.petzval / 2,
            tangential_field=k * (3 * s.astigmatism + s.petzval) / 2,
            sagittal_field=k * (s.astigmatism + s.petzval) / 2,
            distortion=k * s.distortion / 2,
            axial_colour=k * s.axial_colour,
            lateral_colour=k * s.lateral_colour,
        )

    def longitudinal(self, sums: Sums | None = None) -> Longitudinal:
        """Longitudinal aberrations of the lens, or of what is given."""
        across = self.transverse(sums)
        return Longitudinal(*(-getattr(across, name) / self.image_slope for name in Longitudinal._fields))

    def waves(self, sums: Sums | None = None) -> Waves:
        """Wave aberration coefficients of the lens, or of what is given."""
        s, one = self.total if sums is None else sums, 1 / self.wavelength
        return Waves(
            W040=one * s.spherical / 8,
            W131=one * s.coma / 2,
            W222=one * s.astigmatism / 2,
            W220P=one * s.petzval / 4,
            W220=one * (s.astigmatism + s.petzval) / 4,
            W311=one * s.distortion / 2,
            W020=one * s.axial_colour / 2,
            W111=one * s.lateral_colour,
        )
