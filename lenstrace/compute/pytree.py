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

    JAX rebuilds these objects with tracers inside, so there is no validation here: it stands in factories. They are
    rebuilt without a call of the class.
    """
    cls = dataclasses.dataclass(frozen=True, eq=False)(cls)
    fields = dataclasses.fields(cls)  # pyright: ignore[reportArgumentType]
    meta = tuple(field.name for field in fields if field.metadata.get("static"))
    data = tuple(field.name for field in fields if not field.metadata.get("static"))
    keys = tuple(jax.tree_util.GetAttrKey(name) for name in data)

    def flatten(tree: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        return tuple([getattr(tree, name) for name in data]), tuple([getattr(tree, name) for name in meta])

    def flatten_with_keys(tree: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        children, statics = flatten(tree)
        return tuple(zip(keys, children, strict=True)), statics

    def unflatten(statics: tuple[Any, ...], children: Any) -> Any:
        tree = object.__new__(cls)
        tree.__dict__.update(zip(data, children, strict=True))
        tree.__dict__.update(zip(meta, statics, strict=True))
        return tree

    # not `register_dataclass`: to JAX 0.10 the structures of two such classes are equal where their fields are, and the
    # program of one is taken for the other whenever their hashes meet
    jax.tree_util.register_pytree_with_keys(cls, flatten_with_keys, unflatten, flatten)
    return cls


def is_traced(tree: Any) -> bool:
    """True where JAX is tracing a number in `tree`: it has no value that could be looked at or checked."""
    return any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves(tree))
