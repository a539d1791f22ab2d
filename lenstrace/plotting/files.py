"""Pictures as files: the format follows from the suffix, and a file appears whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from lenstrace.errors import LensTraceError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "pdf", "svg")
# Dots per inch of a png.
RESOLUTION = 150


def save_figure(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure as png, pdf or svg.

    LensTraceError for another suffix, or where the file cannot be written; nothing is left behind then.
    """
    kind = check_format(path)
    written(path, lambda partial: figure.savefig(partial, format=kind, dpi=RESOLUTION))


def save_pages(figures: Iterable[Figure], path: str | os.PathLike[str]) -> None:
    """Write figures as the pages of one pdf; errors as of `save_figure`."""
    from matplotlib.backends.backend_pdf import PdfPages

    def write(partial: Path) -> None:
        with PdfPages(partial) as pages:
            for figure in figures:
                pages.savefig(figure)

    written(path, write)


def written(path: str | os.PathLike[str], write: Callable[[Path], None]) -> None:
    """A file that `write` writes: it appears whole or not at all."""
    target = Path(path).resolve()  # a link is written through, not replaced
    partial = target.with_name(f".{target.name}.partial")
    try:
        write(partial)
        partial.replace(target)
    except OSError as error:
        raise LensTraceError(f"{path}: cannot be written: {error.strerror}") from None
    finally:
        partial.unlink(missing_ok=True)


def check_format(path: str | os.PathLike[str]) -> str:
    """The format that a suffix stands for; LensTraceError for another one. To ask before a long computation."""
    suffix = Path(path).resolve().suffix
    kind = suffix.lower().removeprefix(".")
    if kind not in FORMATS:
        got = f"got {suffix!r}" if kind else "got none"
        raise LensTraceError(f"{path}: the suffix must be one of {', '.join(FORMATS)}, {got}")
    return kind


def check_target(path: str | os.PathLike[str]) -> None:
    """`check_format`, and LensTraceError where there is no folder to write to. To ask before a long computation."""
    check_format(path)
    check_folder(path)


def check_folder(path: str | os.PathLike[str]) -> None:
    """LensTraceError where there is no folder to write a file to."""
    folder = Path(path).resolve().parent
    if not (folder.is_dir() and os.access(folder, os.W_OK)):
        raise LensTraceError(f"{path}: cannot be written: {folder} is not a folder that can be written to")
