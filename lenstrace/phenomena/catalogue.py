"""Which demonstrations there are, by group: phenomena/GROUP/NAME.py holds the function NAME."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

# Folder: what the group is called, and the names in it.
GROUPS = {
    "lenses": (
        "What a lens is",
        (
            "principal-planes",
            "lensmaker",
            "ball-lens",
            "aplanatic-points",
            "cartesian-oval",
            "parabola-mirror",
            "achromat",
        ),
    ),
    "negative_index": ("Negative index", ("slab", "negative-prism", "negative-lens", "negative-waves")),
    "bending": (
        "Bending at a surface, and on the way",
        ("snell", "critical-angle", "brewster", "prism", "rainbow", "fermat", "mirage", "luneburg", "fish-eye"),
    ),
    "screens": (
        "Thin phase screens",
        ("ideal-lens", "grating", "zernike-screen", "sampled-screen", "deformable-mirror", "point-mass"),
    ),
    "lines": ("Straight lines", ("point-in-polygon", "mirror-room", "view-factor")),
}
PLACES = {name: group for group, (_, names) in GROUPS.items() for name in names}


def find(name: str) -> Callable[..., Any]:
    """The demonstration of a name, such as critical-angle."""
    word = name.replace("-", "_")
    return getattr(importlib.import_module(f"lenstrace.phenomena.{PLACES[name]}.{word}"), word)


def summary(name: str) -> str:
    """What it shows, in one line."""
    return (find(name).__doc__ or "").split("\n")[0].rstrip(".")
