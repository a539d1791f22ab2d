"""Section design: known problems of optimization, how low and how fast; one of them against Optiland."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import jax
import numpy as np

import lenstrace
from lenstrace import Problem
from lenstrace.design import Curvature, FocalLength, SpotRMS, Thickness, optimize, optimize_from
from lenstrace.design.ready import begun
from lenstrace.io.native import dumps
from tests.benchmarks import fresh, peers
from tests.benchmarks.paired import interleaved
from tests.benchmarks.table import Line, Table
from tests.design.problems import GAPS, perturbed, plates

ROUNDS = 5
STARTS = 256
DESIGNS = Path(__file__).parents[2] / "designs"
# Of each problem: the merit and the seconds, fresh and warm, to be reached.
TARGETS = {"cooke_triplet": (1.38684e-3, 2.5, 0.25), "double_gauss": (7.370e-5, 4.0, 0.5)}
STEP = 0.8


def design() -> Table:
    """Two lenses out of shape, warm and in fresh processes; a triplet from flat plates; one step with 20 variables."""
    table = Table("design: optimization; merit: squares of nine RMS spots and of the error of the focal length")
    warm: dict[str, np.ndarray] = {}
    for name, (merit, first, again) in TARGETS.items():
        problem = perturbed(lenstrace.load(DESIGNS / f"{name}.toml"), GAPS[name])
        found = optimize(problem)
        table.value(f"{name}: merit", found.merit_after, "mm^2", at_most=merit)
        warm[name] = interleaved({name: lambda problem=problem: optimize(problem)}, ROUNDS)[name]
        table.time(f"{name}, warm, {found.steps} evaluations", warm[name], "s", at_most=again)
        _fresh(table, name, problem, first)
    _peer(table, warm["cooke_triplet"])
    _step(table)
    _plates(table)
    return table


def _fresh(table: Table, name: str, problem: Problem, most: float) -> None:
    """`lenstrace optimize` from start to end, without compiled programs and with them."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "problem.toml"
        file.write_text(dumps(problem.lens) + _section(problem))
        command = ["-m", "lenstrace", "optimize", str(file)]
        seconds = {"empty": list[float](), "warm": list[float]()}
        for _ in range(ROUNDS):
            with tempfile.TemporaryDirectory() as kept:
                for times in seconds.values():
                    times.append(fresh.seconds(command, XDG_CACHE_HOME=kept))
    table.time(f"{name}, lenstrace optimize, cache empty", np.array(seconds["empty"]), "s", at_most=most)
    table.time(f"{name}, lenstrace optimize, cache warm", np.array(seconds["warm"]), "s", at_most=most)


def _section(problem: Problem) -> str:
    """[optimize] of a problem of `perturbed`."""
    curvature, gaps, _ = problem.vary
    _, focal_length = problem.want
    return f"""
[optimize]
vary = [
  {{ kind = "curvature", surfaces = {list(curvature.surfaces)} }},
  {{ kind = "thickness", surfaces = {list(gaps.surfaces)}, bounds = [0.1, inf] }},
  {{ kind = "thickness", surfaces = "last" }},
]
want = [{{ kind = "spot_rms" }}, {{ kind = "focal_length", target = {focal_length.target} }}]
"""


def _peer(table: Table, ours: np.ndarray) -> None:
    table.notes += peers.absent("optiland")
    if not peers.absent("optiland"):
        merit, seconds = peers.optiland_optimized(DESIGNS / "triplet_to_optimize.toml")
        table.value("cooke_triplet, Optiland least squares: merit", merit, "mm^2")
        table.lines.append(Line("cooke_triplet, Optiland least squares", seconds, "s"))
        table.compare("Optiland / lenstrace, warm", np.array([seconds]), np.array([np.median(ours)]), at_least=10.0)


def _step(table: Table) -> None:
    """Values, Jacobian and their triangle of about 1,000 residuals by 20 variables."""
    lens = lenstrace.load(DESIGNS / "double_gauss.toml")
    lens = lens.replace(fields=lenstrace.Fields((0.0,) * 5, (0.0, 5.0, 9.0, 12.0, 14.0), "angle"))
    # all ten that bend, and ten gaps; of each of fifteen spots half of 61 points
    vary = [Curvature("all"), Thickness([1, 2, 3, 4, 5, 7, 8, 9, 10, 11])]
    ready = begun(Problem(lens, vary=vary, want=[SpotRMS(rings=4), FocalLength(99.0)]))
    numbers = ready.start.numbers
    residuals = 2 * 15 * ready.start.posed.wants[0].points.x.size + 1  # type: ignore[attr-defined]
    call = {"step": lambda: jax.block_until_ready(ready.merit.evaluated(numbers))}
    table.time(
        f"one step: {residuals} residuals, {len(numbers)} variables",
        interleaved(call, 200)["step"] * 1e3,
        "ms",
        at_most=STEP,
    )


def _plates(table: Table) -> None:
    lens = lenstrace.load(DESIGNS / "cooke_triplet.toml")
    began = time.perf_counter()
    found = optimize_from(plates(lens, rings=4), STARTS)
    seconds = time.perf_counter() - began
    table.lines.append(Line(f"a triplet from flat plates, {STARTS} starts, all of it", seconds, "s", at_most=60.0))
    published, ours = (
        float(np.sum(np.asarray(lenstrace.spots(each).rms_centroid) ** 2)) for each in (lens, found[0].lens)
    )
    table.value("  nine spots, best / published", ours / published, "times", at_most=1.0)
    better = sum(float(np.sum(np.asarray(lenstrace.spots(each.lens).rms_centroid) ** 2)) <= published for each in found)
    table.value("  distinct lenses as good as the published one", better, "", at_least=1)
    table.value("  distinct minima among the ends that were refined", found.distinct, "")
