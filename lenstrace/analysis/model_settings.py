"""Paraxial optics and third-order theory as settings of a trade."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lenstrace.accuracy.trade import Setting
from lenstrace.errors import PrescriptionError
from lenstrace.sequential.lens import Lens

PRECISIONS = ("float64", "float32")


def model_settings(lens: Lens, predicted: Callable[..., float]) -> list[Setting]:
    """Both models in both precisions, where they say something of the lens; predicted: see `predictions`."""
    settings = []
    for precision in PRECISIONS:
        one = lens.astype(precision)
        for name, third in (("paraxial", False), ("third order", True)):

            def how(one: Lens = one, third: bool = third) -> float:
                return predicted(one, third_order=third)

            try:
                if np.isfinite(how()):
                    settings.append(Setting(f"{name}, {precision}", name, 0, how))
            except PrescriptionError:  # a field of 90 degrees and more, a term below third order
                continue
    return settings
