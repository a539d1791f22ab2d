"""Frozen dataclasses as JAX pytrees: the one way data is declared in this package."""

from __future__ import annotations

import dataclasses
from typing import Any, TypeVar, dataclass_transform

import jax
import jax.core

Data = TypeVar("Data")


def static(*, default: Any = dataclasses.MISSING) -> Any:
    """A field that changes the compiled program: hashable, compared by value, never differentiated."""
    return dataclasses.field(default=default, metadata={"static": True})


@dataclass_transform(frozen_default=True, field_specifiers=(static, dataclasses.field))
def pytree(cls: type[Data]) -> type[Data]:
    """Make `cls` a frozen dataclass and a pytree: fields are leaves, except those declared `static()`.

    JAX rebuilds these objects with tracers inside, so there is no validation here: it stands in factories.
    """
    cls = dataclasses.dataclass(frozen=True, eq=False)(cls)
    fields = dataclasses.fields(cls)  # pyright: ignore[reportArgumentType]
    meta = [field.name for field in fields if field.metadata.get("static")]
    data = [field.name for field in fields if not field.metadata.get("static")]
    jax.tree_util.register_dataclass(cls, data_fields=data, meta_fields=meta)
    return cls


def is_traced(tree: Any) -> bool:
    """True where JAX is tracing a number in `tree`: it has no value that could be looked at or checked."""
    return any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves(tree))
