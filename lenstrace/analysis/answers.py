"""Several questions of one lens, where some may have no answer: an afocal lens has no spot, but it has a layout."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax

from lenstrace.errors import LensTraceError


def answers(
    asked: dict[str, Callable[[], Any]], forgiven: type[LensTraceError] = LensTraceError
) -> tuple[dict[str, Any], dict[str, str]]:
    """What can be said, in numpy, and why the rest cannot; the first error where nothing can.

    asked:     questions by name.       forgiven:  the errors that are an answer; others are raised.
    """
    found: dict[str, Any] = {}
    errors: dict[str, LensTraceError] = {}
    for name, question in asked.items():
        try:
            found[name] = jax.device_get(question())
        except forgiven as error:
            errors[name] = error
    if not found:
        raise next(iter(errors.values()))
    return found, {name: str(error) for name, error in errors.items()}
