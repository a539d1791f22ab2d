"""`lenstrace wavefront DESIGN`: how far wavefronts are from spheres, and their Zernike coefficients."""

from __future__ import annotations

import argparse
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.path_difference import REFERENCES
from lenstrace.analysis.wavefront import SAMPLES, Wavefront, wavefront, zernike_coefficients
from lenstrace.analysis.zernike import ZernikeFit
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import number_text, print_json, print_notes, print_table
from lenstrace.cli.spots import field_text
from lenstrace.optics.zernike import ORDERS, zernike_index, zernike_name
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.wavefront import pupil_maps, wavefront_figure
from lenstrace.sequential.lens import Lens

FIGURES = {
    "rms": "RMS",
    "rms_without_tilt": "no tilt",
    "rms_without_focus": "no tilt, focus",
    "peak_to_valley": "P-V",
    "strehl_from_rms": "Strehl (Marechal)",
    "strehl": "Strehl",
}
STREHL = ("strehl_from_rms", "strehl")
TERMS = 16
# Smaller numbers of waves are rounding.
ROUNDING = 1e-12
# Of a step from one sample to the next, in waves: beyond it the sum over amplitudes is too coarse.
COARSE = 0.25
# Marechal's estimate is good to about a tenth above this.
ROUGH = 0.3


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("wavefront", help="wavefront errors, Strehl ratios and Zernike coefficients")
    add_design(parser)
    parser.add_argument("--samples", type=int, default=SAMPLES, help=f"of the grid across the pupil ({SAMPLES})")
    parser.add_argument("--reference", choices=REFERENCES, default="chief", help="centre of the sphere (chief)")
    parser.add_argument("--zernike", choices=tuple(ORDERS), default="fringe", help="order of the terms (fringe)")
    parser.add_argument("--terms", type=int, default=TERMS, help=f"count of Zernike terms ({TERMS})")
    parser.add_argument("--plot", metavar="FILE", help="write the maps (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the wavefront errors of a design."""
    lens = load_design(arguments)
    front = jax.device_get(wavefront(lens, samples=arguments.samples, reference=arguments.reference))
    fit = jax.device_get(zernike_coefficients(front, order=arguments.zernike, count=arguments.terms))
    if arguments.plot:
        save_figure(wavefront_figure(front, lens), arguments.plot)
    if arguments.json:
        print_json(wavefront_keys(lens, front, fit, arguments.reference))
        return
    title = (
        f"{lens.name or arguments.design}: waves, reference {arguments.reference}, {arguments.samples} samples across"
    )
    print_table(title, *_rows(lens, front))
    primary = lens.wavelengths.primary
    print_table(f"Zernike terms ({fit.order}) at {lens.wavelengths.um[primary]:g} um, waves", *_zernike_rows(lens, fit))
    for note in _notes(front, fit):
        print(note)
    print_notes(front.notes)
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def wavefront_keys(lens: Lens, front: Wavefront, fit: ZernikeFit, reference: str) -> dict[str, Any]:
    """The object that --json prints; all in waves of each wavelength."""
    return {
        "reference": reference,
        "notes": front.notes,
        "zernike_order": fit.order,
        "terms": [{"number": number, "n": n, "m": m, "name": zernike_name(n, m)} for number, n, m in _terms(fit)],
        "wavefronts": [
            {
                "field": [lens.fields.x[f], lens.fields.y[f]],
                "wavelength_um": um,
                **{name: getattr(front, name)[f, w] for name in FIGURES},
                "zernike": fit.coefficients[f, w],
                "zernike_residual": fit.residual_rms[f, w],
            }
            for f in range(len(lens.fields.y))
            for w, um in enumerate(lens.wavelengths.um)
        ],
    }


def _rows(lens: Lens, front: Wavefront) -> tuple[list[str], list[list[str]]]:
    """Columns and rows of the figures of every field and wavelength."""
    rows = [
        [
            field_text(lens, f),
            f"{um:g}",
            *(_waves(getattr(front, name)[f, w]) for name in FIGURES if name not in STREHL),
            *(_fixed(getattr(front, name)[f, w]) for name in STREHL),
        ]
        for f in range(len(lens.fields.y))
        for w, um in enumerate(lens.wavelengths.um)
    ]
    return [f"field, {lens.fields.unit}", "um", *FIGURES.values()], rows


def _zernike_rows(lens: Lens, fit: ZernikeFit) -> tuple[list[str], list[list[str]]]:
    """Columns and rows of the coefficients at the primary wavelength, a column for each field."""
    primary = lens.wavelengths.primary
    fields = range(len(lens.fields.y))
    rows = [
        [f"{number}", f"{n}, {m}", zernike_name(n, m), *(_waves(fit.coefficients[f, primary, place]) for f in fields)]
        for place, (number, n, m) in enumerate(_terms(fit))
    ]
    rows.append(["", "", "RMS left over", *(_waves(fit.residual_rms[f, primary]) for f in fields)])
    return ["term", "n, m", "name", *(f"{field_text(lens, f)} {lens.fields.unit}" for f in fields)], rows


def _terms(fit: ZernikeFit) -> list[tuple[int, int, int]]:
    """Number, n and m of every term."""
    first = ORDERS[fit.order]
    numbers = range(first, first + fit.coefficients.shape[-1])
    return [(number, *zernike_index(fit.order, number)) for number in numbers]


def _fixed(value: Any) -> str:
    return f"{value:.6f}" if np.isfinite(value) else "-"


def _waves(value: Any) -> str:
    return number_text(0.0 if abs(value) < ROUNDING else value)


def _notes(front: Wavefront, fit: ZernikeFit) -> list[str]:
    """What a reader must know of these figures."""
    notes = []
    lost = np.isnan(front.opd) & (front.pupil_x**2 + front.pupil_y**2 <= 1)
    if lost.any():
        notes.append(
            f"lost: {lost.mean((0, 1)).sum() / (front.pupil_x**2 + front.pupil_y**2 <= 1).sum():.1%} of the rays"
        )
    if np.isnan(fit.coefficients).any():
        notes.append("Zernike terms: the rays that arrive do not tell so many terms apart; give fewer, or more samples")
    maps = pupil_maps(front)
    steps = np.maximum(_step(maps, -1), _step(maps, -2))
    if (steps > COARSE).any():
        notes.append(
            f"Strehl: path differences step by up to {steps.max():.2g} waves from one sample to the next; "
            "give more samples"
        )
    if (front.strehl_from_rms < ROUGH).any():
        notes.append(f"Strehl (Marechal): an estimate for small errors, rough below {ROUGH:g}")
    return notes


def _step(maps: np.ndarray, axis: int) -> np.ndarray:
    """The largest step (F, W) along an axis of maps."""
    steps = np.abs(np.diff(maps, axis=axis))
    return np.max(steps, axis=(-2, -1), initial=0.0, where=np.isfinite(steps))
