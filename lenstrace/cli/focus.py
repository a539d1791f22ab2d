"""`lenstrace focus DESIGN`: best focus, spots through focus, spot sizes against field and wavelength."""

from __future__ import annotations

import argparse
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.focus import STEPS, BestFocus, Focus, ThroughFocus, best_focus, check_steps, through_focus
from lenstrace.analysis.spot_curves import SpotField, SpotSpectrum, spot_field, spot_spectrum
from lenstrace.analysis.wave_focus import WaveFocus, wave_focus
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import number_text, print_json, print_table
from lenstrace.cli.spots import field_text
from lenstrace.errors import RayError
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.focus import focus_figure
from lenstrace.sequential.lens import Lens

PLACES = (
    ("given", "as given"),
    ("paraxial", "paraxial focus"),
    ("spot", "least RMS spot, all fields"),
)


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("focus", help="best focus, spots through focus, against field and wavelength")
    add_design(parser)
    parser.add_argument(
        "--range", type=float, metavar="MM", help="shift the image by up to so much to either side (by the lens)"
    )
    parser.add_argument("--steps", type=int, default=STEPS, metavar="N", help=f"places of the image ({STEPS})")
    parser.add_argument("--rings", type=int, default=6, metavar="N", help="rings of the hexapolar pattern (6)")
    parser.add_argument("--plot", metavar="FILE", help="write curves and spots through focus (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the focus of a design."""
    shifts = _shifts(arguments.range, arguments.steps)
    lens = load_design(arguments)
    best = jax.device_get(best_focus(lens, rings=arguments.rings))
    through = jax.device_get(through_focus(lens, shifts, steps=arguments.steps, rings=arguments.rings))
    waves = jax.device_get(wave_focus(lens))
    field = jax.device_get(spot_field(lens, rings=arguments.rings))
    spectrum = jax.device_get(spot_spectrum(lens, rings=arguments.rings))
    if arguments.plot:
        save_figure(focus_figure(through, best, field, spectrum, lens), arguments.plot)
    if arguments.json:
        print_json(focus_keys(lens, best, through, field, spectrum) | {"wave_focus": vars(waves)})
        return
    print_table(f"{lens.name or arguments.design}: where the image may stand", *_best_rows(lens, best))
    print_table("Least RMS wavefront, all wavelengths, tilt removed", *_wave_rows(lens, waves))
    print_table("Spots through focus, RMS about the centroid, mm, all wavelengths", *_through_rows(lens, through))
    print_table("Spots against field, RMS about the centroid, mm", *_field_rows(lens, field))
    print_table("Spots against wavelength, RMS about the centroid, mm", *_spectrum_rows(lens, spectrum))
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def focus_keys(
    lens: Lens, best: BestFocus, through: ThroughFocus, field: SpotField, spectrum: SpotSpectrum
) -> dict[str, Any]:
    """The object that --json prints."""
    fields = [[x, y] for x, y in zip(lens.fields.x, lens.fields.y, strict=True)]
    return {
        "fields": fields,
        "best_focus": {
            **{key: _focus_keys(getattr(best, key)) for key, _ in PLACES},
            "fields": [
                {"field": each, "shift": shift, "rms": rms}
                for each, shift, rms in zip(fields, best.field_shift, best.field_rms, strict=True)
            ],
        },
        "through_focus": {
            "shift": through.shifts,
            "rms": through.rms,
            "field_rms": through.spots.polychromatic.rms_centroid,
            "wavelength_rms": through.spots.rms_centroid,
        },
        "spot_field": {"x": field.x, "y": field.y, "rms": field.rms, "polychromatic": field.polychromatic},
        "spot_spectrum": {"um": spectrum.um, "rms": spectrum.rms},
    }


def _focus_keys(focus: Focus) -> dict[str, Any]:
    return {"shift": focus.shift, "rms": focus.rms, "field_rms": focus.field_rms}


def _shifts(half: float | None, steps: int) -> np.ndarray | None:
    """What --range and --steps ask for."""
    if half is None:
        return None
    if not (np.isfinite(half) and half > 0):
        raise RayError(f"--range must be a positive number of mm, got {half:g}")
    check_steps(steps)
    return half * np.linspace(-1, 1, steps)


def _field_columns(lens: Lens) -> list[str]:
    return [f"{field_text(lens, f)} {lens.fields.unit}" for f in range(len(lens.fields.y))]


def _best_rows(lens: Lens, best: BestFocus) -> tuple[list[str], list[list[str]]]:
    """A row for each place of all fields together, then one for each field, with the RMS spots there."""
    names = _field_columns(lens)
    rows = [
        [label, number_text(focus.shift), number_text(focus.rms, 9), *(number_text(rms, 9) for rms in focus.field_rms)]
        for label, focus in ((label, getattr(best, key)) for key, label in PLACES)
    ]
    for f, name in enumerate(names):
        sizes = [""] * len(names)
        sizes[f] = number_text(best.field_rms[f], 9)
        rows.append([f"least RMS spot, {name}", number_text(best.field_shift[f]), "", *sizes])
    return ["", "shift, mm", "RMS of all fields, mm", *(f"RMS at {name}, mm" for name in names)], rows


def _wave_rows(lens: Lens, waves: WaveFocus) -> tuple[list[str], list[list[str]]]:
    rows = [
        ["as given", number_text(0.0), number_text(waves.given_rms)],
        ["all fields", number_text(waves.shift), number_text(waves.rms)],
    ]
    for name, shift, rms in zip(_field_columns(lens), waves.field_shift, waves.field_rms, strict=True):
        rows.append([name, number_text(shift), number_text(rms)])
    return ["", "shift, mm", "RMS, waves"], rows


def _through_rows(lens: Lens, through: ThroughFocus) -> tuple[list[str], list[list[str]]]:
    rows = [
        [number_text(shift), *(number_text(size, 9) for size in sizes), number_text(whole, 9)]
        for shift, sizes, whole in zip(
            through.shifts, through.spots.polychromatic.rms_centroid, through.rms, strict=True
        )
    ]
    return ["shift, mm", *_field_columns(lens), "all fields"], rows


def _field_rows(lens: Lens, field: SpotField) -> tuple[list[str], list[list[str]]]:
    columns = [f"field, {lens.fields.unit}", *(f"{um:g} um" for um in lens.wavelengths.um)]
    sizes = np.asarray(field.rms)
    if sizes.shape[1] > 1:
        columns.append("all wavelengths")
        sizes = np.column_stack([sizes, field.polychromatic])
    pairs = zip(field.x, field.y, strict=True)
    names = [f"({x:.5g}, {y:.5g})" if np.any(field.x) else f"{y:.5g}" for x, y in pairs]
    rows = [[name, *(number_text(size, 9) for size in row)] for name, row in zip(names, sizes, strict=True)]
    return columns, rows


def _spectrum_rows(lens: Lens, spectrum: SpotSpectrum) -> tuple[list[str], list[list[str]]]:
    rows = [
        [f"{um:.5g}", *(number_text(size, 9) for size in sizes)]
        for um, sizes in zip(spectrum.um, spectrum.rms.T, strict=True)
    ]
    return ["um", *_field_columns(lens)], rows
