"""The numbers of a lens, stacked per surface: what is compiled, traced and differentiated."""

from __future__ import annotations

import dataclasses
import enum
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.interactions import Interaction
from lenstrace.optics.screens.screen import Screen


class Placement(enum.Enum):
    """How the frame of a surface stands in the chain of vertices."""

    CENTRED = "centred"
    POSED = "posed"  # decentre and tilt move this surface alone
    BREAK = "break"  # decentre and tilt move all that follows


@dataclasses.dataclass(frozen=True)
class Kind:
    """The structure of one surface: what its compiled program contains. Surfaces of one kind share it.

    powers: powers of r of its asphere terms, empty for a conic.
    turned: its tilt turns the axis by more than 90 degrees, so that light crosses it the other way.
    newton_steps: of an asphere, see `Asphere`.
    screen: place of its phase screen in `System.screens`.
    """

    powers: tuple[int, ...] = ()
    interaction: Interaction = Interaction.REFRACT
    aperture: ApertureKind = ApertureKind.NONE
    placement: Placement = Placement.CENTRED
    turned: bool = False
    newton_steps: int | None = None
    screen: int | None = None


class Light(NamedTuple):
    """What depends on the colour.

    index:       (S + 1,), relative to air, of the object space and after each surface.
    wavelength:  (), mm.
    With a leading axis, of several wavelengths.
    """

    index: Any
    wavelength: Any


@pytree
class System:
    """S surfaces and the image as number S + 1, K = S + 1 in all; W wavelengths; F fields.

    curvature:        (K,), 1/mm.              conic: (K,).
    coefficients:     (K, T), asphere terms a_p r_norm^(p - 1), pure numbers, for the T powers p that the aspheres of
                      the lens have; see `term`.
    norm_radius:      (K,), r_norm, mm, a power of two about as large as r is where the series matters.
    thickness:        (S,), mm, signed along z, from this vertex to the next.
    index:            (W, S + 1) relative to air, of the object space and after each surface; (S + 1,) once a
                      wavelength is chosen with `at`.
    wavelength:       (W,), mm; () then.
    decenter, tilt:   (K, 2) mm, (K, 3) radians.
    aperture:         (K, 2), mm, the numbers of each surface's aperture.
    object_distance:  mm, from the object to the first vertex; None at infinity.
    stop_size:        what the aperture of the lens says: see `aperture_kind`; mm or a pure number.
    fields:           (F, 2), radians or mm: see `field_kind`.
    weights:          (W,) of the wavelengths.
    screens:          the phase screens that surfaces carry.

    Static: the kind of every surface, the number of the stop (1 ... S), the place of the primary wavelength, what
    stop_size and fields mean, and whether rays are aimed at the stop.
    """

    curvature: jax.Array
    conic: jax.Array
    coefficients: jax.Array
    norm_radius: jax.Array
    thickness: jax.Array
    index: jax.Array
    wavelength: jax.Array
    decenter: jax.Array
    tilt: jax.Array
    aperture: jax.Array
    object_distance: jax.Array | None
    stop_size: jax.Array
    fields: jax.Array
    weights: jax.Array
    screens: tuple[Screen, ...]
    kinds: tuple[Kind, ...] = static()
    stop: int = static()
    primary: int = static()
    aperture_kind: str = static()
    field_kind: str = static()
    ray_aiming: bool = static()

    @property
    def surfaces(self) -> int:
        """S, the number of rows without object and image."""
        return len(self.kinds) - 1

    @property
    def bends(self) -> Any:
        """(S,) of bool: True where a surface bends light: a mirror, a screen, another index behind it than before."""
        always = np.array(
            [kind.interaction is Interaction.REFLECT or kind.screen is not None for kind in self.kinds[:-1]]
        )
        changes = self.index[..., 1:] != self.index[..., :-1]
        return always | (changes.any(0) if changes.ndim == 2 else changes)

    @property
    def orientation(self) -> tuple[int, ...]:
        """(S + 1,) of +1 and -1: the direction of light along z in the object space and after each surface."""
        return self._signs()[0]

    @property
    def sides(self) -> tuple[int, ...]:
        """(K,) of +1 and -1: the direction of light along z where it meets each surface, in that surface's frame."""
        return self._signs()[1]

    def _signs(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        gaps, sides = [1], []
        for kind in self.kinds:
            sides.append(-gaps[-1] if kind.turned else gaps[-1])
            follows = sides[-1] if kind.placement is Placement.BREAK else gaps[-1]
            gaps.append(-follows if kind.interaction is Interaction.REFLECT else follows)
        return tuple(gaps[:-1]), tuple(sides)

    def at(self, wavelength: int) -> System:
        """The system at one of its wavelengths, by its place: see `with_light`."""
        return self.with_light(self.light_at(wavelength))

    @property
    def light(self) -> Light:
        """Of all its wavelengths."""
        return Light(self.index, self.wavelength)

    def light_at(self, wavelength: int) -> Light:
        """Of one of its wavelengths, by its place."""
        return Light(self.index[wavelength], self.wavelength[wavelength])

    def with_light(self, light: Light) -> System:
        """The system at one wavelength; without the lists of wavelengths and fields, so that lenses that differ in them
        alone are traced by one program."""
        nothing = {"weights": self.weights[:0], "fields": self.fields[:0]}
        return self.replace(index=light.index, wavelength=light.wavelength, primary=0, **nothing)

    def without_apertures(self) -> System:
        """The same surfaces, nothing stopped: what rays are aimed through."""
        return self.replace(kinds=tuple(dataclasses.replace(kind, aperture=ApertureKind.NONE) for kind in self.kinds))

    def with_newton_steps(self, steps: int | None) -> System:
        """The same surfaces, their aspheres met by at most so many of Newton's steps, and taken as they then are; None:
        by as many as it takes."""
        return self.replace(kinds=tuple(dataclasses.replace(kind, newton_steps=steps) for kind in self.kinds))

    def term(self, power: int) -> jax.Array:
        """(K,), the coefficient a_p of r^p, mm^(1 - p), in the sag of each surface; 0 where it has none."""
        powers = max((kind.powers for kind in self.kinds), key=len)
        if power not in powers:
            return jnp.zeros_like(self.curvature)
        return self.coefficients[:, powers.index(power)] * jnp.asarray(self.norm_radius) ** (1 - power)

    def replace(self, **changes: Any) -> System:
        """A copy with some fields changed."""
        return dataclasses.replace(self, **changes)

    def astype(self, dtype: Any) -> System:
        """The same system in another precision; a trace runs in the precision of these arrays."""
        return jax.tree.map(lambda a: a.astype(dtype), self)
