"""Sections memory, compile and start: what is measured in fresh processes."""

from __future__ import annotations

import tempfile

import numpy as np

from tests.benchmarks import fresh, peers
from tests.benchmarks.table import Line, Table

ROUNDS = 5
COMPILE_ROUNDS = 3
COMPILED_RAYS = 100_000
SPOTS = ["-m", "lenstrace", "spots", "designs/double_gauss.toml"]
PEER_MEMORY = {
    "batoid": "batoid_memory",
    "optiland": "optiland_memory",
    "optiland torch": "optiland_torch_memory",
    "rayoptics": "rayoptics_memory",
}
FROM_PEERS = "from tests.benchmarks.peers import"


def memory() -> Table:
    """Peak memory above the imported package."""
    table = Table("memory: the most a process holds, above what it held when lenstrace was imported")
    if not fresh.STATUS.exists():
        table.notes.append(f"{fresh.STATUS} is not there: skipped")
        return table
    for function, what, most in (
        ("forward_memory", "trace, float64, image alone", 300.0),
        ("gradient_memory", "mean square spot and gradient", 500.0),
    ):
        found = fresh.answer("children", function)
        table.lines.append(Line(f"{what}, {found['rays']:,} rays", found["peak"], "MB", at_most=most))
        table.lines.append(Line("  of which the rays sent and received", found["arrays"], "MB"))
    for package, function in PEER_MEMORY.items():
        if missing := peers.absent(*package.split()):
            table.notes += missing
            continue
        found = fresh.answer("peer_memory", function)
        table.lines.append(Line(f"{package}, trace, float64, {found['rays']:,} rays", found["peak"], "MB"))
    table.notes.append(
        "the lens, the compiler and what it compiled are counted in it; a peer: above what its import held"
    )
    table.notes.append("rayoptics: as many rays as it traces in a second or two; it keeps what a list of rays takes")
    return table


def compile() -> Table:
    """First calls in fresh processes."""
    asked = {
        "bare kernel, 11 surfaces": ("kernel_compiles", 1, None),
        "trace, 11 surfaces": ("forward_compiles", 1, 0.35),
        "trace, 33 surfaces": ("forward_compiles", 3, 0.35),
        "value and gradient, 11 surfaces": ("gradient_compiles", 1, 1.5),
        "value and gradient, 33 surfaces": ("gradient_compiles", 3, 1.5),
    }
    found: dict[str, list[dict[str, float]]] = {what: [] for what in asked}
    for _ in range(COMPILE_ROUNDS):
        for what, (function, copies, _most) in asked.items():
            found[what].append(fresh.answer("children", function, COMPILED_RAYS, copies))
    seconds = {what: np.array([each["all"] for each in answers]) for what, answers in found.items()}
    table = Table(f"compile: first call less a warm one, {COMPILED_RAYS:,} rays, fresh processes without a cache")
    for what, (_function, _copies, most) in asked.items():
        table.time(what, seconds[what], "s", at_most=most)
        compiler = np.array([each["xla"] for each in found[what]])
        table.time(f"  of which in XLA, programs: {found[what][0]['programs']}", compiler, "s")
    kernel = seconds.pop(next(iter(asked)))
    for what, values in seconds.items():
        table.compare(f"{what} / bare kernel", values, kernel)
    return table


def start() -> Table:
    """From nothing to the first result, process and all."""
    asked = {
        "import jax": (["-c", "import jax"], None),
        "import lenstrace": (["-c", "import lenstrace"], None),
        "lenstrace spots, cache empty": (SPOTS, 2.5),
        "lenstrace spots, cache warm": (SPOTS, 1.5),
    }
    missing = peers.absent("optiland", "batoid", "rayoptics")
    if not any(line.startswith("optiland") for line in missing):
        code = f"{FROM_PEERS} optiland_double_gauss, optiland_spots; optiland_spots(optiland_double_gauss())"
        asked["Optiland, the same spots"] = (["-c", code], None)
    if not any(line.startswith("batoid") for line in missing):
        asked["batoid, as many rays"] = (["-c", f"{FROM_PEERS} batoid_spots; batoid_spots()"], None)
    if not any(line.startswith("rayoptics") for line in missing):
        asked["rayoptics, as many rays"] = (["-c", f"{FROM_PEERS} rayoptics_spots; rayoptics_spots()"], None)
    found: dict[str, list[float]] = {what: [] for what in asked}
    with tempfile.TemporaryDirectory() as kept:
        fresh.seconds(SPOTS, XDG_CACHE_HOME=kept)
        for _ in range(ROUNDS):
            for what, (arguments, _most) in asked.items():
                with tempfile.TemporaryDirectory() as empty:
                    cache = empty if "empty" in what else kept
                    found[what].append(fresh.seconds(arguments, XDG_CACHE_HOME=cache))
    table = Table(f"start: fresh processes from start to end, medians of {ROUNDS}", notes=missing)
    for what, (_arguments, most) in asked.items():
        table.time(what, np.array(found[what]), "s", at_most=most)
    beyond = np.median(found["import lenstrace"]) - np.median(found["import jax"])
    table.lines.append(Line("import lenstrace beyond jax", float(beyond), "s", at_most=0.15))
    for what in list(asked)[4:]:
        table.compare(
            f"{what.split(',')[0]} / lenstrace, cache warm",
            np.array(found[what]),
            np.array(found["lenstrace spots, cache warm"]),
        )
    return table
