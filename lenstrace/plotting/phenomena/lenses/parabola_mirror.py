"""A beam on a spherical and on a parabolic mirror, and how far their rays miss the focus."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.parabola_mirror import ParabolaMirror
from lenstrace.plotting.colours import AXIS, MIRROR, PALETTE

NAMES = ("sphere", "parabola")
ROUNDING = 1e-17  # mm: what is drawn where a ray misses by nothing


def plot_rays(found: ParabolaMirror, axes: Axes) -> Axes:
    """The sphere in the upper half, the parabola in the lower; mm, z toward the light."""
    half = len(found.heights) // 2
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    for place, part in enumerate((slice(half, None), slice(half))):
        z, y, ends = found.mirror_z[place, part], found.heights[part], found.crossings[place, part]
        axes.plot(z, y, color=MIRROR, linewidth=2)
        far = 0.75 * found.radius
        for a, b, end in zip(z, y, ends, strict=True):
            axes.plot([far, a, end], [b, b, 0], color=PALETTE[place], linewidth=0.7)
        axes.plot([], [], color=PALETTE[place], label=f"{NAMES[place]} ({'above' if place == 0 else 'below'})")
    axes.plot(found.radius / 2, 0, "o", color=PALETTE[5], markersize=5, label="focus")
    axes.set(xlabel="z from the vertex, mm", ylabel="y, mm", title="A beam along the axis")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(fontsize="small", loc="upper right")
    return axes


def plot_misses(found: ParabolaMirror, axes: Axes) -> Axes:
    """The outermost ray in the plane of the focus, against the F-number."""
    for place, marker in enumerate("o^"):
        misses = found.misses[place].clip(ROUNDING)
        axes.loglog(
            found.f_numbers, misses, marker, color=PALETTE[place], markersize=4, label=f"{NAMES[place]}, traced"
        )
    axes.loglog(found.f_numbers, found.theory, color=PALETTE[0], linewidth=1, label="sphere, theory")
    axes.set(
        xlabel="F-number of the beam", ylabel="outermost ray misses the focus by, mm", title="Spherical aberration"
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_rays, plot_misses)
