"""`lenstrace psf DESIGN`: point spreads by diffraction, Strehl ratios, encircled energy."""

from __future__ import annotations

import argparse
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.encircled import EncircledEnergy, encircled_energy, radius_of
from lenstrace.analysis.psf import METHODS, Psf, psf
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import number_text, print_json, print_notes, print_table
from lenstrace.cli.spots import field_text
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.psf import psf_figure
from lenstrace.sequential.lens import Lens

# Parts of the light whose radii are printed.
PARTS = (0.5, 0.8)


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("psf", help="point spreads by diffraction, Strehl ratios, encircled energy")
    add_design(parser)
    parser.add_argument("--samples", type=int, metavar="N", help="across the pupil, even (as the aberrations need)")
    parser.add_argument("--method", choices=METHODS, default="auto", help="how waves are summed (auto)")
    parser.add_argument("--full", action="store_true", help="with --json: the densities at all points too")
    parser.add_argument("--plot", metavar="FILE", help="write point spreads and encircled energy (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the point spreads of a design."""
    lens = load_design(arguments)
    found = psf(lens, samples=arguments.samples, method=arguments.method)
    energy = jax.device_get(encircled_energy(found))
    found = jax.device_get(found)
    if arguments.plot:
        save_figure(psf_figure(found, energy, lens), arguments.plot)
    if arguments.json:
        print_json(psf_keys(lens, found, energy, arguments.full))
        return
    count, pixel = len(found.position), float(found.position[1] - found.position[0])
    title = f"{lens.name or arguments.design}: {count} x {count} points {pixel * 1000:.4g} um apart"
    print_table(title, *_rows(lens, found))
    print_table("All wavelengths by weight, circles about the centroid", *_energy_rows(lens, found, energy))
    print(f"method {found.method}: {found.reason}")
    print_notes(found.notes)
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def psf_keys(lens: Lens, found: Psf, energy: EncircledEnergy, full: bool) -> dict[str, Any]:
    """The object that --json prints; densities in 1/mm^2 where the whole is asked for."""
    radii = {part: radius_of(energy, part) for part in PARTS}
    fields = [
        {
            "field": [lens.fields.x[f], lens.fields.y[f]],
            "densest_over_perfect": np.max(found.polychromatic[f]) / found.polychromatic_peak[f],
            "within": energy.within[f],
            "centroid": [energy.centre_x[f], energy.centre_y[f]],
            **{f"radius_{round(100 * part)}": radii[part][f] for part in PARTS},
            "encircled": energy.circle[f],
            "ensquared": energy.square[f],
            **({"density": found.polychromatic[f]} if full else {}),
        }
        for f in range(len(lens.fields.y))
    ]
    single = [
        {
            "field": [lens.fields.x[f], lens.fields.y[f]],
            "wavelength_um": um,
            "strehl": found.strehl[f, w],
            "densest_over_perfect": np.max(found.density[f, w]) / found.peak[f, w],
            "within": found.within[f, w],
            **({"density": found.density[f, w]} if full else {}),
        }
        for f in range(len(lens.fields.y))
        for w, um in enumerate(lens.wavelengths.um)
    ]
    return {
        "method": found.method,
        "reason": found.reason,
        "notes": found.notes,
        "points": len(found.position),
        "pixel": found.position[1] - found.position[0],
        "radius": energy.radius,
        **({"position": found.position} if full else {}),
        "psf": single,
        "polychromatic": fields,
    }


def _rows(lens: Lens, found: Psf) -> tuple[list[str], list[list[str]]]:
    rows = [
        [
            field_text(lens, f),
            f"{um:g}",
            number_text(found.strehl[f, w]),
            number_text(np.max(found.density[f, w]) / found.peak[f, w]),
            number_text(found.within[f, w], 4),
        ]
        for f in range(len(lens.fields.y))
        for w, um in enumerate(lens.wavelengths.um)
    ]
    return [f"field, {lens.fields.unit}", "um", "Strehl", "densest over perfect", "light in the window"], rows


def _energy_rows(lens: Lens, found: Psf, energy: EncircledEnergy) -> tuple[list[str], list[list[str]]]:
    radii = [radius_of(energy, part) * 1000 for part in PARTS]
    rows = [
        [
            field_text(lens, f),
            number_text(np.max(found.polychromatic[f]) / found.polychromatic_peak[f]),
            number_text(energy.within[f], 4),
            *(number_text(radius[f], 4) for radius in radii),
        ]
        for f in range(len(lens.fields.y))
    ]
    columns = [f"field, {lens.fields.unit}", "densest over perfect", "light in the window"]
    return [*columns, *(f"radius of {part:.0%}, um" for part in PARTS)], rows
