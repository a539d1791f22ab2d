"""What a want is: figures of a lens, and residuals whose squares say how far each is from what is wanted."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, ClassVar, NamedTuple, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.design.view import View
from lenstrace.errors import DesignError
from lenstrace.sequential.lens import Lens

AIMS = ("target", "min", "max")


class Measured(NamedTuple):
    """The T terms of a want.

    value:     (T,), in the unit of the want: what a table says.
    residual:  (T, M), in the same unit, not weighted; the sum of the squares of a row is how far its term is missed.
    failure:   of rays that an aperture may stop, see `counting`; None of a want without such.
    lost:      how many rays are lost that count.
    """

    value: jax.Array
    residual: jax.Array
    failure: jax.Array | None = None
    lost: jax.Array | float = 0.0


@pytree
class Want:
    """A want: its numbers are leaves, so that no program is compiled anew for another weight or target.

    unit: of values and residuals; empty for pure numbers.
    """

    unit: ClassVar[str] = ""

    @property
    def weight(self) -> Any:
        """Of its residuals, a number or one for each term; three times the weight makes nine times the term."""
        raise NotImplementedError

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """The same want with what it needs to know of the lens; DesignError for what can be seen without tracing a ray.

        mirrored: the lens stays its own mirror image in x = 0, whatever changes."""
        _check_weight(self)
        _ = lens, mirrored
        return self

    @property
    def um(self) -> tuple[float, ...]:
        """Wavelengths that it asks for beside those of the lens."""
        return ()

    def check(self, lens: Lens) -> None:
        """DesignError where the lens, as it is at the start, has no such figure."""
        _ = lens

    def counting(self, failure: np.ndarray) -> Want:
        """The want after `Measured.failure` of the start is known: which rays count."""
        _ = failure
        return self

    def names(self, lens: Lens) -> list[str]:
        """One for each term."""
        raise NotImplementedError

    def measured(self, view: View) -> Measured:
        """The terms, of numbers that JAX may trace."""
        raise NotImplementedError

    @property
    def aim(self) -> str:
        """What is wanted, in words: "50", "at least 1"."""
        return "0"


@pytree
class Scalar(Want):
    """A want of figures that should be a target, or lie within limits, in the unit of the want.

    A limit that is kept adds nothing to the merit, one that is missed by d adds (weight d)^2: a smooth sum.
    """

    target: Any = None
    weight: Any = 1.0
    min: Any = None
    max: Any = None

    def values(self, view: View) -> jax.Array:
        """(T,) or ()."""
        raise NotImplementedError

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError without target and limits, and for limits that contradict each other."""
        super().posed(lens, mirrored)
        name = type(self).__name__
        given = {key: checked_number(name, key, getattr(self, key)) for key in AIMS if getattr(self, key) is not None}
        if not given:
            raise DesignError(f"{name}: nothing is wanted of it; give target, min or max")
        low, high = (np.asarray(given.get(key, end), float) for key, end in (("min", -math.inf), ("max", math.inf)))
        if np.any(low > high):
            raise DesignError(f"{name}: min must not be above max, got min = {self.min} and max = {self.max}")
        target = np.asarray(given.get("target", low), float)
        if "target" in given and (np.any(target < low) or np.any(target > high)):
            raise DesignError(f"{name}: the target {self.target} lies outside min = {self.min}, max = {self.max}")
        return self

    def measured(self, view: View) -> Measured:
        """The figures, and how far they miss what is wanted."""
        return self.missed(jnp.atleast_1d(self.values(view)))

    def missed(self, value: jax.Array) -> Measured:
        """One residual for the target, one for each limit; value: (T,)."""
        parts = []
        if self.target is not None:
            parts.append(value - self.target)
        if self.min is not None:
            parts.append(jnp.maximum(self.min - value, 0))
        if self.max is not None:
            parts.append(jnp.maximum(value - self.max, 0))
        return Measured(value, jnp.stack(parts, -1))

    @property
    def aim(self) -> str:
        """Target and limits."""
        words = [] if self.target is None else [_text(self.target)]
        words += [] if self.min is None else [f"at least {_text(self.min)}"]
        words += [] if self.max is None else [f"at most {_text(self.max)}"]
        return ", ".join(words)


Wanted = TypeVar("Wanted", bound=Scalar)


def or_nothing(want: Wanted) -> Wanted:
    """The want with the target 0, where neither target nor limits are given."""
    given = (want.target, want.min, want.max)
    return want if any(each is not None for each in given) else dataclasses.replace(want, target=0.0)


def lost_residual(x: jax.Array, y: jax.Array, length: jax.Array) -> jax.Array:
    """What a lost ray counts: one `length` L and more, the more the farther its straight course passes the place where
    it should arrive, at (x, y): finite, smooth, and its slope leads back from afar.

        L (1 + log(1 + e^2 / L^2)),   e^2 = x^2 + y^2
    """
    return length * (1 + jnp.log1p((x * x + y * y) / (length * length)))


def sized(want: Want, lens: Lens) -> Want:
    """The want with lists of targets, limits and weights as arrays; DesignError for such as are neither one number nor
    one for each term."""
    count = len(want.names(lens))
    arrays = {}
    for key in (*AIMS, "weight"):
        value = getattr(want, key, None)
        if value is not None and np.size(value) not in (1, count):
            terms = f"one number, or {count}, one for each of its terms" if count > 1 else "one number"
            raise DesignError(f"{type(want).__name__}: {key} must be {terms}; got {value}")
        if isinstance(value, list | tuple):
            arrays[key] = np.array(value, float)
    return dataclasses.replace(want, **arrays)


def checked_number(what: str, key: str, value: Any) -> np.ndarray:
    """Finite numbers, of any shape; else DesignError."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu" or not np.all(np.isfinite(array)):
        raise DesignError(f"{what}: {key} must be a finite number, got {value!r}")
    return array.astype(float)


def _check_weight(want: Want) -> None:
    weight = checked_number(type(want).__name__, "weight", want.weight)
    if np.any(weight < 0) or not np.any(weight > 0):
        raise DesignError(
            f"{type(want).__name__}: weight must be positive, got {want.weight}; leave out what is not wanted"
        )


def _text(value: Any) -> str:
    values = np.unique(np.asarray(value, float))
    return f"{values[0]:g}" if len(values) == 1 else ", ".join(f"{each:g}" for each in np.asarray(value, float).ravel())
