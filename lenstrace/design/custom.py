"""A want of one's own: any function of the lens."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree, static
from lenstrace.design.view import View
from lenstrace.design.wants import Scalar, Want, or_nothing
from lenstrace.errors import DesignError
from lenstrace.sequential.lens import Lens


@pytree
class Custom(Scalar):
    """Figures of a function from a lens to a number or an array of them; each is a term, with the target 0 unless it is
    given, or limits are.

    function: of jax.numpy and of lenstrace; JAX traces the numbers of the lens it is given, so it must not look at
              their values with `if` or `float`. The same function object is compiled once.
    label, written_unit: for tables.
    """

    function: Callable[[Lens], Any] | None = static(default=None)
    label: str = static(default="custom")
    written_unit: str = static(default="")

    @property
    def unit(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """As written."""
        return self.written_unit

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError where it is no function."""
        if not callable(self.function):
            raise DesignError(f"Custom: function must take a lens and give numbers, got {self.function!r}")
        return super(Custom, or_nothing(self)).posed(lens, mirrored)

    def check(self, lens: Lens) -> None:
        """DesignError where what it gives are no finite numbers."""
        assert self.function is not None
        try:
            found = np.asarray(self.function(lens))
        except Exception as error:
            why = f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else 'no word'}"
            raise DesignError(f"Custom {self.label!r}: the function fails at the start: {why}") from None
        if found.dtype.kind not in "fiu" or not np.all(np.isfinite(found)) or not found.size:
            raise DesignError(
                f"Custom {self.label!r}: the function gives {found} at the start; it must be finite numbers"
            )

    def names(self, lens: Lens) -> list[str]:
        """The label, numbered where there are several."""
        assert self.function is not None
        count = np.size(self.function(lens))
        return [self.label] if count == 1 else [f"{self.label} {i + 1}" for i in range(count)]

    def values(self, view: View) -> jax.Array:
        """Flat."""
        assert self.function is not None
        try:
            return jnp.ravel(jnp.asarray(self.function(view.lens), float))
        except jax.errors.ConcretizationTypeError:
            raise DesignError(
                f"Custom {self.label!r}: the function looks at numbers of the lens (with if, float, numpy), and JAX "
                "traces them; write it with jax.numpy"
            ) from None
