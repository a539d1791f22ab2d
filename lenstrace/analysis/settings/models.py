"""Paraxial optics and third-order theory as settings of a trade."""

from __future__ import annotations

import functools
from collections.abc import Callable

import jax
import numpy as np

from lenstrace.accuracy.trade import Setting
from lenstrace.compute.compiled import COMPILER_OPTIONS
from lenstrace.errors import PrescriptionError
from lenstrace.sequential.lens import Lens

PRECISIONS = ("float64", "float32")


def model_settings(lens: Lens, predicted: Callable[..., jax.Array]) -> list[Setting]:
    """Both models in both precisions, where they say something of the lens; predicted: see `predictions`."""
    settings = []
    for precision in PRECISIONS:
        one = lens.astype(precision)
        for name, third in (("paraxial", False), ("third order", True)):
            asked = functools.partial(predicted, third_order=third)
            try:
                if not np.isfinite(asked(one)):
                    continue
            except PrescriptionError:  # a field of 90 degrees and more, a term below third order
                continue
            how = functools.partial(jax.jit(asked, compiler_options=COMPILER_OPTIONS), one)
            settings.append(Setting(f"{name}, {precision}", name, 0, how))
    return settings
