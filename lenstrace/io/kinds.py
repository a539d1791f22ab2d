"""A table of a file as an object: `kind` names what is made, the other keys are its arguments."""

from __future__ import annotations

import difflib
import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from lenstrace.errors import LensTraceError

# What makes the objects, classes or functions, by the words of a file.
Kinds = Mapping[str, Callable[..., Any]]


def named(kinds: Iterable[type]) -> dict[str, type]:
    """Classes by their names in small letters."""
    return {small(kind): kind for kind in kinds}


def made(where: str, entry: Any, kinds: Kinds, error: type[LensTraceError], within: Kinds | None = None) -> Any:
    """An object of one of `kinds` out of the keys of a table; lists become tuples. `error` says where, what, got.

    within: what tables with a kind in that table may be.
    """
    kind = kind_of(where, entry, kinds, error)
    where = f"{where}, {entry['kind']}"
    given = fields_of(where, entry, kind, error)
    for key, value in given.items():
        if isinstance(value, Mapping) and within:
            given[key] = made(f"{where}: {key}", value, within, error)
    try:
        return kind(**given)
    except LensTraceError as mistake:
        raise type(mistake)(f"{where}: {mistake}") from None


def kind_of(where: str, entry: Any, kinds: Kinds, error: type[LensTraceError]) -> Callable[..., Any]:
    """What a table names."""
    if not isinstance(entry, Mapping):
        raise error(f"{where} must be a table, {{ kind = ... }}, got {entry!r}")
    name = entry.get("kind")
    if not isinstance(name, str) or name not in kinds:
        hint = near(str(name), list(kinds)) if name is not None else f"one of {', '.join(kinds)}"
        raise error(f"{where}: {'kind is missing' if name is None else f'unknown kind {name!r}'}; {hint}")
    return kinds[name]


def fields_of(
    where: str, entry: Mapping[str, Any], kind: Callable[..., Any], error: type[LensTraceError]
) -> dict[str, Any]:
    """The other keys of a table, as arguments of what is made."""
    known = inspect.signature(kind).parameters
    given = {key: tupled(value) for key, value in entry.items() if key != "kind"}
    unknown(where, given, list(known), error)
    for key, parameter in known.items():
        if parameter.default is inspect.Parameter.empty and key not in given:
            raise error(f"{where}: {key} is missing; it must be given")
    return given


def unknown(where: str, given: Mapping[str, Any], known: Sequence[str], error: type[LensTraceError]) -> None:
    """`error` for the first key that is not known."""
    for key in given:
        if key not in known:
            raise error(f"{where}: unknown key {key!r}; {near(key, list(known))}")


def tupled(value: Any) -> Any:
    """Lists as tuples, all the way down."""
    return tuple(tupled(each) for each in value) if isinstance(value, list) else value


def small(kind: type) -> str:
    """SpotRMS: spot_rms."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", kind.__name__).lower()


def near(word: str, known: list[str]) -> str:
    """What may have been meant."""
    close = difflib.get_close_matches(word, known, 1, 0.5)
    return f"did you mean {close[0]!r}?" if close else f"known here: {', '.join(known)}"
