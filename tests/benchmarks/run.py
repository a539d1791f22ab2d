"""The benchmark: python tests/benchmarks/run.py [SECTION ...] [--json FILE]; all sections without a name.

Every claim is a ratio of medians of calls taken in turn in this one run, warm, compile time apart: times belong to the
machine, ratios less so. A peer that is not installed is left out: pip install -e ".[bench]". The limit is a loop in C,
left out where there is no compiler.
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import json
import os
import platform
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))
# read when OpenMP is first loaded: its threads are not to spin on while the next call is timed
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

from tests.benchmarks import design, diffraction, forward, honesty, limit, processes, rates, required, scenes, small

SECTIONS = {
    "forward": forward.forward,
    "asphere": rates.asphere,
    "gradient": rates.gradient,
    "required": required.required,
    "honesty": honesty.honesty,
    "small": small.small,
    "diffraction": diffraction.diffraction,
    "memory": processes.memory,
    "compile": processes.compile,
    "start": processes.start,
    "batch": small.batch,
    "design": design.design,
    "scenes": scenes.scenes,
}
PACKAGES = ("lenstrace", "jax", "jaxlib", "numpy", "batoid", "optiland", "torch", "rayoptics", "mitsuba")
CPU = Path("/proc/cpuinfo")


def main(arguments: list[str] | None = None) -> None:
    """Print the sections asked for, and write them to a file."""
    parser = argparse.ArgumentParser(description="What lenstrace costs, against the machine and against its peers.")
    parser.add_argument("sections", nargs="*", metavar="SECTION", help=f"some of {', '.join(SECTIONS)}; all by default")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write what was found there too")
    asked = parser.parse_args(arguments)
    unknown = [name for name in asked.sections if name not in SECTIONS]
    if unknown:
        parser.error(f"no section {', '.join(unknown)}; there are {', '.join(SECTIONS)}")
    about = {
        "machine": machine(),
        "load": f"{os.getloadavg()[0]:.2f} before the run; what else is busy takes from the threads of all",
        "versions": versions(),
        "date": f"{datetime.date.today()}",
    }
    print("\n".join(f"{name}: {value}" for name, value in about.items()))
    tables = []
    for name in asked.sections or SECTIONS:
        tables.append(SECTIONS[name]())
        print(f"\n{tables[-1].text()}", flush=True)
    if asked.json:
        asked.json.write_text(json.dumps({**about, "sections": [table.as_json() for table in tables]}, indent=1) + "\n")


def machine() -> str:
    """Processor, number of them, system."""
    named = [line.split(":")[1].strip() for line in CPU.read_text().splitlines() if line.startswith("model name")]
    wide = ", AVX-512" if "avx512f" in CPU.read_text() else ""
    return f"{named[0]}{wide}, {os.cpu_count()} processors, {platform.system()} {platform.release()}"


def versions() -> str:
    """Of what is timed, as far as it is installed."""
    known = {each.metadata["Name"].lower(): each.version for each in importlib.metadata.distributions()}
    found = [f"{name} {known[name]}" for name in PACKAGES if name in known]
    return ", ".join([f"Python {platform.python_version()}", *found, limit.version()])


if __name__ == "__main__":
    main()
