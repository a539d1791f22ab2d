"""Sections small and batch: questions whose cost is the call, and a thousand of them at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import lenstrace
from tests.benchmarks import launched, peers
from tests.benchmarks.paired import interleaved, repeated
from tests.benchmarks.table import Table

ROUNDS = 9
TIMES = 20  # calls of lenstrace, or of a peer's short ones, in one timing
VARIANTS = 1_000
LOOPED = 20  # variants that the loop is timed with
CARDINAL = ("f1", "f2", "F1", "F2", "P1", "P2", "N1", "N2")


def small() -> Table:
    """Warm calls from Python: a spot diagram, first-order figures, one ray; against Optiland."""
    lens = launched.double_gauss()
    asked = {
        "spots": lambda: lenstrace.spots(lens),
        "first_order": lambda: lenstrace.first_order(lens),
        "one ray": lambda: lenstrace.trace(lens, field=10.0, pupil=(0.0, 0.5)),
    }
    calls = {f"lenstrace {name}": repeated(_ready(call), TIMES) for name, call in asked.items()}
    times = dict.fromkeys(calls, TIMES)
    missing = peers.absent("optiland")
    if not missing:
        optic = peers.optiland_double_gauss()
        top = max(lens.fields.y)
        calls["Optiland spots"] = lambda: peers.optiland_spots(optic)
        calls["Optiland first_order"] = repeated(lambda: [getattr(optic.paraxial, name)() for name in CARDINAL], TIMES)
        calls["Optiland one ray"] = repeated(lambda: optic.trace_generic(0.0, 10.0 / top, 0.0, 0.5, 0.5876), 5)
        times |= {"Optiland spots": 1, "Optiland first_order": TIMES, "Optiland one ray": 5}
        _check_ray(float(asked["one ray"]().y[-1]), float(optic.trace_generic(0.0, 10.0 / top, 0.0, 0.5, 0.5876).y[0]))
    seconds = interleaved(calls, ROUNDS)
    table = Table(
        "small: warm calls from Python, double Gauss; spots: 3 fields x 3 wavelengths x 127 rays", notes=missing
    )
    each = {name: values * 1e3 / times[name] for name, values in seconds.items()}
    for name, values in each.items():
        table.time(name, values, "ms")
    if not missing:
        for name, least in (("spots", 80.0), ("first_order", 2.0), ("one ray", 30.0)):
            table.compare(
                f"{name}: Optiland / lenstrace", each[f"Optiland {name}"], each[f"lenstrace {name}"], at_least=least
            )
        table.notes.append(f"first_order: lenstrace at three wavelengths, Optiland {', '.join(CARDINAL)} at one")
    return table


def batch() -> Table:
    """A thousand variants of a lens in one program, against a loop in Python."""
    lens = lenstrace.load(launched.DESIGNS / "cooke_triplet.toml")
    chance = np.random.default_rng(0).uniform(0.99, 1.01, (VARIANTS, lens.curvature.size))
    variants = jnp.asarray(lens.curvature * chance)
    some = np.asarray(variants[:LOOPED])
    table = Table(f"batch: {VARIANTS:,} variants of a Cooke triplet, 3 wavelengths; one variant")
    for name, question in {
        "first order": lambda lens: lenstrace.first_order(lens).focal_length,
        "RMS spots, 3 fields x 37 rays": lambda lens: lenstrace.spots(lens, rings=3).polychromatic.rms_centroid,
        "RMS spots, 3 fields x 127 rays": lambda lens: lenstrace.spots(lens).polychromatic.rms_centroid,
    }.items():

        def figure(curvature: Any, question: Callable[[Any], jax.Array] = question) -> jax.Array:
            return question(lens.replace(curvature=curvature))

        together = jax.jit(jax.vmap(figure))

        def loop(figure: Callable[[Any], jax.Array] = figure) -> list[jax.Array]:
            return [jax.block_until_ready(figure(curvature)) for curvature in some]

        seconds = interleaved({"batch": _ready(lambda f=together: f(variants)), "loop": loop}, ROUNDS)
        each = {"batch": seconds["batch"] * 1e3 / VARIANTS, "loop": seconds["loop"] * 1e3 / LOOPED}
        for way, values in each.items():
            table.time(f"{name}: {way}", values, "ms")
        table.compare(f"{name}: loop / batch", each["loop"], each["batch"], at_least=100.0)
        worst = float(jnp.max(jnp.abs(together(variants)[:LOOPED] / jnp.stack(loop()) - 1)))
        table.notes.append(f"{name}: largest relative difference {worst:.1e}")
    table.notes.append(f"the loop is timed with {LOOPED} variants")
    return table


def _ready(call: Callable[[], Any]) -> Callable[[], Any]:
    return lambda: jax.block_until_ready(call())


def _check_ray(height: float, optiland: float) -> None:
    if not abs(height - optiland) <= 1e-9:
        raise SystemExit(f"one ray: lenstrace {height!r} mm, Optiland {optiland!r} mm: not the same lens or ray")
