"""The classroom: each demonstration sets something up, measures it with the tracer, and compares it with theory.

Every one is a function here, imported when it is first used: `phenomena.slab(index=-1.1)` gives a result that shows
itself as a table, and that `lenstrace.plot_demonstration` draws.
"""

from __future__ import annotations

from typing import Any

from lenstrace.phenomena.catalogue import PLACES, find

_NAMES = {name.replace("-", "_"): name for name in PLACES}


def __getattr__(name: str) -> Any:
    if name not in _NAMES:
        raise AttributeError(f"module 'lenstrace.phenomena' has no attribute {name!r}")
    return find(_NAMES[name])


def __dir__() -> list[str]:
    return sorted(_NAMES)
