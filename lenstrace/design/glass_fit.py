"""Real glasses for model glasses: the nearest ones of a catalogue are tried, surface by surface, and the best kept."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

from lenstrace.design.optimize import optimize
from lenstrace.design.outcome import Optimized, aligned
from lenstrace.design.places import Place, prepared, read
from lenstrace.design.problem import Problem
from lenstrace.design.variables import places_of
from lenstrace.errors import DesignError, MediumError
from lenstrace.optics.glasses import glass_map
from lenstrace.sequential.lens import Lens

GLASS = ("index", "abbe")
# Differences in nd and in vd that count alike: on the map of glasses neighbours are about so far apart.
NEAR_INDEX, NEAR_ABBE = 0.01, 1.5


@dataclasses.dataclass(frozen=True)
class Swap:
    """A model glass that gave way to a real one.

    surface:  in front of the glass.       nd, vd: of the model glass.        glass: with its catalogue.
    merit_before, merit_after:  with the model glass, and with the real one, everything else refined.
    tried:    every glass, and the merit it came to, the best first.
    """

    surface: int
    nd: float
    vd: float
    glass: str
    merit_before: float
    merit_after: float
    tried: tuple[tuple[str, float], ...]


@dataclasses.dataclass(frozen=True)
class GlassFit:
    """A lens of real glasses: the last search, the one before any swap, and what each swap cost."""

    optimized: Optimized
    model: Optimized
    swaps: tuple[Swap, ...]

    @property
    def lens(self) -> Lens:
        """The lens of real glasses."""
        return self.optimized.lens

    def table(self) -> str:
        """A line for each swap, as text."""
        head = ("surface", "nd", "vd", "glass", "merit before", "merit after", "others tried")
        rows = [
            (
                str(swap.surface),
                f"{swap.nd:.5f}",
                f"{swap.vd:.2f}",
                swap.glass,
                f"{swap.merit_before:.6e}",
                f"{swap.merit_after:.6e}",
                ", ".join(f"{name} {merit:.3e}" for name, merit in swap.tried[1:]),
            )
            for swap in self.swaps
        ]
        return aligned([head, *rows], left=(3, 6))


def fit_glasses(
    problem: Problem,
    catalog: str = "SCHOTT",
    *,
    candidates: int = 4,
    progress: Callable[[int, int], None] | None = None,
) -> GlassFit:
    """Optimize with model glasses, then put a real glass in the place of each, one after the other.

    problem:     whose variables Index, or Index and Abbe, say which glasses.
    catalog:     the maker.
    candidates:  so many of the nearest glasses are tried for each; what else may vary is refined for each of them.
    progress:    called with how many glasses have been tried, and how many there are.

    DesignError where no glass varies. UnknownGlassError for no maker.
    """
    if isinstance(candidates, bool) or not isinstance(candidates, int) or candidates < 1:
        raise DesignError(f"candidates must be a whole number, 1 or more, got {candidates!r}")
    catalog = catalog.upper()
    known = glass_map(catalog)
    surfaces = sorted(
        {place.surface for each in problem.vary if each.kind in GLASS for place in places_of(problem.lens, each)}
    )
    if not surfaces:
        raise DesignError("fit_glasses: no glass varies; name some, such as Index('glass'), Abbe('glass')")
    if all(each.kind in GLASS for each in problem.vary):
        raise DesignError(
            "fit_glasses: nothing but glasses varies, and each swap is to be refined; name a curvature too"
        )
    model = found = _optimized(problem)
    swaps = list[Swap]()
    for surface in surfaces:
        lens = prepared(found.lens, [Place("abbe", surface)])
        nd, vd = (float(read(lens, Place(kind, surface))) for kind in GLASS)
        near = sorted(known, key=lambda row: math.hypot((row[1] - nd) / NEAR_INDEX, (row[2] - vd) / NEAR_ABBE))
        tried = list[tuple[str, Optimized]]()
        for name, _, _ in near:
            try:
                real = lens.replace(surface=surface, glass=f"{catalog}:{name}")
                _ = real.system
            except MediumError:
                continue  # not known at a wavelength of the lens
            tried.append((f"{catalog}:{name}", _optimized(_without(problem, real, surface))))
            if progress is not None:
                progress(len(swaps) * candidates + len(tried), len(surfaces) * candidates)
            if len(tried) == candidates:
                break
        if not tried:
            raise DesignError(f"surface {surface}: no glass of {catalog} is known at the wavelengths of the lens")
        tried.sort(key=lambda each: each[1].merit_after)
        merits = tuple((name, each.merit_after) for name, each in tried)
        swaps.append(Swap(surface, nd, vd, merits[0][0], found.merit_after, merits[0][1], merits))
        problem, found = _without(problem, tried[0][1].lens, surface), tried[0][1]
    return GlassFit(found, model, tuple(swaps))


def _optimized(problem: Problem) -> Optimized:
    """As `optimize`; Ctrl-C ends all of it: a search that was broken off says nothing of a glass."""
    found = optimize(problem)
    if found.interrupted:
        raise KeyboardInterrupt
    return found


def _without(problem: Problem, lens: Lens, surface: int) -> Problem:
    """The problem of a lens in which the glass behind one surface does not vary."""
    vary = list[Any]()
    for each in problem.vary:
        if each.kind not in GLASS:
            vary.append(each)
            continue
        left = [place.surface for place in places_of(problem.lens, each) if place.surface != surface]
        if left:
            vary.append(dataclasses.replace(each, surfaces=left))  # pyright: ignore[reportArgumentType]
    return dataclasses.replace(problem, lens=lens, vary=vary)
