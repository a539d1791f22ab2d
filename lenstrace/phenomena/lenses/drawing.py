"""What is drawn of a lens beside its rays."""

from __future__ import annotations

import dataclasses

import numpy as np

from lenstrace.analysis.layout import Layout, layout
from lenstrace.optics.rays import Ray
from lenstrace.sequential.lens import Lens


def bare(lens: Lens) -> Layout:
    """The layout without rays, stop and image; what fills the image space only where nothing else is filled."""
    drawing = layout(lens)
    inside = tuple(medium for medium in drawing.media if medium.last <= len(lens)) or drawing.media
    surfaces = tuple(dataclasses.replace(surface, bars=surface.bars[:0]) for surface in drawing.surfaces[:-1])
    return dataclasses.replace(drawing, bundles=(), media=inside, surfaces=surfaces)


def course(lens: Lens, path: Ray, beyond: float) -> np.ndarray:
    """(2, S + 2, N), z and y of N rays as launched, at surfaces 1 ... S, and a distance beyond these; mm from the first
    vertex. path: as `trace` gives it, in numpy."""
    vertices = np.append(0.0, np.cumsum(np.asarray(lens.thickness)))[:-1, None]
    z, y = np.concatenate([path.z[:1], path.z[1:-1] + vertices]), path.y[:-1]
    last = [z[-1] + beyond * path.n[-1], y[-1] + beyond * path.m[-1]]
    return np.stack([np.vstack([z, last[0]]), np.vstack([y, last[1]])])
