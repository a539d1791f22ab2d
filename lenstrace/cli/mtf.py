"""`lenstrace mtf DESIGN`: contrast against spatial frequency, with diffraction, by rays alone, through focus."""

from __future__ import annotations

import argparse
import math
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.mtf import GeometricMtf, Mtf, ThroughFocusMtf, geometric_mtf, mtf, mtf_through_focus
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import number_text, print_json, print_notes, print_table
from lenstrace.cli.spots import field_text
from lenstrace.errors import AccuracyError, RayError
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.mtf import mtf_figure
from lenstrace.sequential.lens import Lens

# Frequencies where none are asked for: about so many, up to this part of where contrast ends.
COUNT, REACH = 8, 0.7
ROUND = (1.0, 2.0, 2.5, 5.0, 10.0)
# Places through focus.
STEPS = 21


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("mtf", help="contrast against spatial frequency, through focus")
    add_design(parser)
    parser.add_argument(
        "--frequencies", type=float, nargs="+", metavar="F", help="cycles/mm (about 8 up to 70 %% of the largest)"
    )
    parser.add_argument("--samples", type=int, metavar="N", help="across the pupil, even (as the aberrations need)")
    parser.add_argument("--geometric", action="store_true", help="the contrast by rays alone too")
    parser.add_argument(
        "--through-focus",
        type=float,
        metavar="MM",
        help="shift the image by up to so much to either side, at the middle one of the frequencies",
    )
    parser.add_argument("--plot", metavar="FILE", help="write the curves (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the contrast of a design."""
    span = arguments.through_focus
    if span is not None and not (math.isfinite(span) and span > 0):
        raise RayError(f"--through-focus must be a positive number of mm, got {span:g}")
    lens = load_design(arguments)
    curve = jax.device_get(mtf(lens, samples=arguments.samples))
    asked = arguments.frequencies or round_frequencies(float(curve.frequency[-1]))
    table = jax.device_get(mtf(lens, asked, samples=arguments.samples))
    rays = jax.device_get(geometric_mtf(lens, asked)) if arguments.geometric else None
    if rays is None and not np.isfinite(table.tangential).any():
        raise AccuracyError("; ".join(table.notes) or "no field has a contrast")
    through = None
    if span is not None:
        shift = np.linspace(-span, span, STEPS)
        middle = sorted(asked)[len(asked) // 2]
        through = jax.device_get(mtf_through_focus(lens, middle, shift, samples=arguments.samples))
    if arguments.plot:
        fine = jax.device_get(geometric_mtf(lens, curve.frequency)) if arguments.geometric else None
        shown = [] if through is None else [through]
        save_figure(mtf_figure(curve, lens, geometric=fine, through=shown), arguments.plot)
    if arguments.json:
        print_json(mtf_keys(lens, table, rays, through))
        return
    print_table(f"{lens.name or arguments.design}: contrast, all wavelengths by weight", *_rows(lens, table, rays))
    if through is not None:
        title = f"Through focus at {float(through.frequency):g} cycles/mm"
        print_table(title, *_through_rows(lens, through))
    print_notes(table.notes)
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def round_frequencies(largest: float) -> list[float]:
    """About 8 round numbers from a step up to 70 % of the largest.

    >>> round_frequencies(340.0)
    [25.0, 50.0, 75.0, 100.0, 125.0, 150.0, 175.0, 200.0, 225.0]
    """
    raw = REACH * largest / COUNT
    power = 10.0 ** math.floor(math.log10(raw))
    step = power * min(ROUND, key=lambda each: abs(math.log(each * power / raw)))
    return [step * (k + 1) for k in range(math.floor(REACH * largest / step))]


def mtf_keys(lens: Lens, table: Mtf, rays: GeometricMtf | None, through: ThroughFocusMtf | None) -> dict[str, Any]:
    """The object that --json prints."""
    fields = [
        {
            "field": [lens.fields.x[f], lens.fields.y[f]],
            "tangential": table.tangential[f],
            "sagittal": table.sagittal[f],
            "limit_tangential": table.limit_tangential[f],
            "limit_sagittal": table.limit_sagittal[f],
            "wavelengths": [
                {"wavelength_um": um, "tangential": table.each_tangential[f, w], "sagittal": table.each_sagittal[f, w]}
                for w, um in enumerate(lens.wavelengths.um)
            ],
            **({"geometric_tangential": rays.tangential[f], "geometric_sagittal": rays.sagittal[f]} if rays else {}),
        }
        for f in range(len(lens.fields.y))
    ]
    found: dict[str, Any] = {"frequency": table.frequency, "mtf": fields, "notes": table.notes}
    if through is not None:
        found["through_focus"] = {
            "frequency": through.frequency,
            "shift": through.shift,
            "tangential": through.tangential,
            "sagittal": through.sagittal,
        }
    return found


def _rows(lens: Lens, table: Mtf, rays: GeometricMtf | None) -> tuple[list[str], list[list[str]]]:
    curves = [("tangential", table.tangential), ("sagittal", table.sagittal)]
    curves += [("limit tangential", table.limit_tangential), ("limit sagittal", table.limit_sagittal)]
    if rays is not None:
        curves += [("rays tangential", rays.tangential), ("rays sagittal", rays.sagittal)]
    rows = [
        [
            field_text(lens, f) if not k else "",
            f"{frequency:g}",
            *(_contrast(values[f, k]) for _, values in curves),
        ]
        for f in range(len(lens.fields.y))
        for k, frequency in enumerate(table.frequency)
    ]
    return [f"field, {lens.fields.unit}", "cycles/mm", *(name for name, _ in curves)], rows


def _contrast(value: Any) -> str:
    return f"{value:.5f}" if np.isfinite(value) else "-"


def _through_rows(lens: Lens, through: ThroughFocusMtf) -> tuple[list[str], list[list[str]]]:
    fields = range(len(lens.fields.y))
    columns = [f"{field_text(lens, f)} {lens.fields.unit}, {way}" for f in fields for way in ("tang.", "sag.")]
    rows = [
        [
            number_text(shift),
            *(_contrast(a[f, p]) for f in fields for a in (through.tangential, through.sagittal)),
        ]
        for p, shift in enumerate(through.shift)
    ]
    return ["shift, mm", *columns], rows
