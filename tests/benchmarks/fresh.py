"""Work in fresh processes: how long they take, what they print, how much memory they held at most."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
STATUS = Path("/proc/self/status")


def seconds(arguments: list[str], **environment: str) -> float:
    """Seconds from the start of `python ARGUMENTS` to its end."""
    start = time.perf_counter()
    _run(arguments, environment)
    return time.perf_counter() - start


def answer(module: str, function: str, *arguments: int) -> Any:
    """What a function of tests/benchmarks returns in a fresh process without a compilation cache, by way of JSON."""
    call = f"{function}({', '.join(map(str, arguments))})"
    code = f"import json; from tests.benchmarks.{module} import {function}; print(json.dumps({call}))"
    return json.loads(_run(["-c", code], {"JAX_ENABLE_COMPILATION_CACHE": "false"}).splitlines()[-1])


def peak_mb() -> float:
    """The most memory that this process has held so far, MB.

    `ru_maxrss` will not do: in a process made by `vfork` it begins with what the parent held.
    """
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) * 1024 / 1e6


def _run(arguments: list[str], environment: dict[str, str]) -> str:
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"python {' '.join(arguments)}\n{done.stderr}")
    return done.stdout
