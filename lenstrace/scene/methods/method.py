"""The methods by name."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp

from lenstrace.errors import SceneError
from lenstrace.scene.methods.cast import Cast
from lenstrace.scene.methods.path import Path
from lenstrace.scene.methods.tree import THRESHOLD, Tree, levels_for

METHODS = ("cast", "whitted", "distributed", "path")
# Segments of a path that only chance ends, which it does long before; of a tree of rays, where the threshold does.
PATH_DEPTH, TREE_DEPTH = 1 << 14, 128


def method_of(name: str, depth: int | None, threshold: float | None, dtype: Any) -> Any:
    """A method by its name. depth, threshold: None for what is usual. SceneError for one that does not exist."""
    if threshold is not None and not 0 <= threshold < 1:
        raise SceneError(f"threshold: a share of the light, 0 to below 1, got {threshold}")
    match name:
        case "cast":
            return Cast()
        case "whitted" | "distributed":
            deep, least = depth or TREE_DEPTH, THRESHOLD if threshold is None else threshold
            return Tree(
                jnp.asarray(deep, jnp.int32), jnp.asarray(least, dtype), levels_for(least, deep), name == "distributed"
            )
        case "path":
            # where nobody says how long walks may be, chance ends them
            return Path(jnp.asarray(depth or PATH_DEPTH, jnp.int32), jnp.asarray(depth is None))
    raise SceneError(f"method: unknown {name!r}; one of {', '.join(METHODS)}")
