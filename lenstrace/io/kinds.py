"""A table of a file as an object: `kind` is the name of its class in small letters, the other keys are its fields."""

from __future__ import annotations

import dataclasses
import difflib
import re
from collections.abc import Mapping, Sequence
from typing import Any

from lenstrace.errors import LensTraceError


def made(
    where: str, entry: Any, kinds: Sequence[type], error: type[LensTraceError], within: Sequence[type] = ()
) -> Any:
    """An object of one of `kinds` out of the keys of a table; lists become tuples. `error` says where, what, got.

    within: what tables in that table may be.
    """
    kind = kind_of(where, entry, kinds, error)
    given = fields_of(f"{where}, {entry['kind']}", entry, kind, error)
    for key, value in given.items():
        if isinstance(value, Mapping) and within:
            given[key] = made(f"{where}: {key}", value, within, error)
    try:
        return kind(**given)
    except LensTraceError as mistake:
        raise error(f"{where}, {entry['kind']}: {mistake}") from None


def kind_of(where: str, entry: Any, kinds: Sequence[type], error: type[LensTraceError]) -> type:
    """The class that a table names."""
    if not isinstance(entry, Mapping):
        raise error(f"{where} must be a table, {{ kind = ... }}, got {entry!r}")
    names = {small(kind): kind for kind in kinds}
    name = entry.get("kind")
    if name not in names:
        hint = near(str(name), list(names)) if name is not None else f"one of {', '.join(names)}"
        raise error(f"{where}: {'kind is missing' if name is None else f'unknown kind {name!r}'}; {hint}")
    return names[name]


def fields_of(where: str, entry: Mapping[str, Any], kind: type, error: type[LensTraceError]) -> dict[str, Any]:
    """The other keys of a table, as arguments of the class."""
    known = {field.name: field for field in dataclasses.fields(kind) if field.init}
    given = {key: tupled(value) for key, value in entry.items() if key != "kind"}
    unknown(where, given, list(known), error)
    for key, field in known.items():
        needed = field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
        if needed and key not in given:
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
