"""The table of a lens, as text and as HTML."""

from __future__ import annotations

import html
import math
from typing import Any

from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.media import Constant, Table
from lenstrace.sequential.document import Document

APERTURE_LABELS = {
    "entrance_pupil_diameter": "entrance pupil diameter {} mm",
    "image_f_number": "image F-number {}",
    "object_na": "object NA {}",
    "stop_semi_diameter": "stop semi-diameter {} mm",
}
FIELD_LABELS = {
    "angle": "field angles",
    "object_height": "object heights",
    "image_height": "paraxial image heights",
}


def text_table(lens: Document) -> str:
    """The lens as lines of text: a heading, one row a surface, lengths in mm."""
    head, rows = _cells(lens)
    widths = [max(len(row[i]) for row in (head, *rows)) for i in range(len(head))]
    lines = [
        "  ".join(
            cell.ljust(w) if i >= len(head) - 2 else cell.rjust(w)
            for i, (cell, w) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in (head, *rows)
    ]
    return "\n".join([*_heading(lens), *lines])


def html_table(lens: Document) -> str:
    """The lens as an HTML table, for a notebook."""
    head, rows = _cells(lens)
    title, *rest = (html.escape(line) for line in _heading(lens))
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    top = "".join(f"<th>{html.escape(cell)}</th>" for cell in head)
    return (
        f"<div><strong>{title}</strong><br>{'<br>'.join(rest)}"
        f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _heading(lens: Document) -> list[str]:
    waves = ", ".join(
        f"{um:g}" + (" (primary)" if i == lens.wavelengths.primary and len(lens.wavelengths.um) > 1 else "")
        for i, um in enumerate(lens.wavelengths.um)
    )
    if any(not _is_zero(x) for x in lens.fields.x):
        fields = ", ".join(f"({_plain(x)}, {_plain(y)})" for x, y in zip(lens.fields.x, lens.fields.y, strict=True))
    else:
        fields = ", ".join(_plain(y) for y in lens.fields.y)
    aiming = ", rays aimed at the stop" if lens.ray_aiming else ""
    return [
        lens.name or "Lens",
        f"{APERTURE_LABELS[lens.aperture.kind].format(_plain(lens.aperture.value))}{aiming}; "
        f"{FIELD_LABELS[lens.fields.kind]} {fields} {lens.fields.unit}; wavelengths {waves} um",
    ]


def _cells(lens: Document) -> tuple[list[str], list[list[str]]]:
    """Heading and rows; columns that no surface needs are left out."""
    distance = lens.object_distance
    numbers = ["0", *map(str, range(1, len(lens.rows) + 1)), str(len(lens.rows) + 1)]
    surfaces = [None, *lens.rows, lens.image]
    columns: list[tuple[str, list[str]]] = [
        ("surface", numbers),
        ("radius, mm", ["" if row is None else _plain(row.radius) for row in surfaces]),
        (
            "thickness, mm",
            [
                "inf" if distance is None else _plain(distance),
                *(_plain(row.thickness) for row in lens.rows),
                "",
            ],
        ),
        (
            "semi-diameter, mm",
            ["" if row is None or row.semi_diameter is None else _plain(row.semi_diameter) for row in surfaces],
        ),
        ("conic", ["" if row is None or _is_zero(row.conic) else _plain(row.conic) for row in surfaces]),
        ("medium", [lens.object_glass or lens.object_medium.name, *_media(lens), ""]),
        ("remarks", ["object", *(_remarks(row) for row in lens.rows), _remarks(lens.image, "image")]),
    ]
    optional = {"semi-diameter, mm", "conic"}
    kept = [(name, cells) for name, cells in columns if name not in optional or any(cells)]
    return [name for name, _ in kept], [list(row) for row in zip(*(cells for _, cells in kept), strict=True)]


def _media(lens: Document) -> list[str]:
    """The glass as written, or the index at the primary wavelength."""
    primary = lens.wavelengths.um[lens.wavelengths.primary]
    return [
        f"n={_plain(row.medium.index(primary))}" if isinstance(row.medium, (Constant, Table)) else row.material
        for row in lens.rows
    ]


def _remarks(row: Any, first: str = "") -> str:
    parts = [first, "stop" if row.stop else "", row.name]
    parts += [f"a{power} = {_plain(value)}" for power, value in row.asphere.items()]
    if row.aperture_kind is not ApertureKind.NONE:
        parts.append(f"{row.aperture_kind.value} {', '.join(map(_plain, row.aperture))} mm")
    if row.screen is not None:
        parts.append(row.screen.label)
    if row.is_break:
        parts.append("break")
    if row.decenter is not None:
        parts.append(f"decenter {', '.join(map(_plain, row.decenter))} mm")
    if row.tilt is not None:
        parts.append(f"tilt {', '.join(map(_plain, row.tilt))} deg")
    return "; ".join(part for part in parts if part)


def _plain(value: Any) -> str:
    """A number as a person writes it; a traced one has none."""
    try:
        number = float(value)
    except TypeError:
        return "traced"
    return "inf" if math.isinf(number) else f"{number:.8g}"


def _is_zero(value: Any) -> bool:
    return _plain(value) == "0"
