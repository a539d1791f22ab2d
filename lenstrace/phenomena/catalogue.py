"""Which demonstrations there are, by group: phenomena/GROUP/NAME.py holds the function NAME."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

# Folder: what the group is called, and the names in it.
GROUPS = {
    "bending": ("Bending at a surface", ("snell", "critical-angle", "brewster", "prism", "rainbow")),
    "negative_index": ("Negative index", ("slab",)),
}
PLACES = {name: group for group, (_, names) in GROUPS.items() for name in names}


def find(name: str) -> Callable[..., Any]:
    """The demonstration of a name, such as critical-angle."""
    word = name.replace("-", "_")
    return getattr(importlib.import_module(f"lenstrace.phenomena.{PLACES[name]}.{word}"), word)


def summary(name: str) -> str:
    """What it shows, in one line."""
    return (find(name).__doc__ or "").split("\n")[0].rstrip(".")
