"""The physical limit: trace.c, compiled here for this machine and called through ctypes.

It is nothing that could be installed: no statuses, no checks, no derivatives but those written out by hand.
"""

from __future__ import annotations

import ctypes
import functools
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lenstrace import Lens

SOURCE = Path(__file__).with_name("trace.c")
# IEEE arithmetic, so that results agree; only errno and traps, which nobody reads, are given up.
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fopenmp", "-shared", "-fPIC")
BLOCK_BYTES = 512  # 64 rays in float64, 128 in float32
NUMBERS = 9  # of a surface: see `Surface` in trace.c
POWERS = (4, 6, 8)
TYPES = {"float64": "double", "float32": "float"}


@dataclass(frozen=True)
class Limit:
    """The lens in C, at its primary wavelength. surfaces: (S, NUMBERS).  last: gap to the image, (1,)."""

    library: ctypes.CDLL
    surfaces: np.ndarray
    last: np.ndarray

    def trace(self, rays: Sequence[np.ndarray], image: Sequence[np.ndarray]) -> None:
        """x, y, z, l, m, n on the first vertex plane, each (N,), N at least a block, into those at the image."""
        self._call(self.library.trace, rays[0].size, _list(rays), _list(image))

    def sums(self, pupil: Sequence[np.ndarray], field: np.ndarray, about: np.ndarray) -> np.ndarray:
        """Sums over the rays of x - x0, y - y0, and of the square of both.

        pupil: x and y, (N,).   field: radius of the pupil, shift in y (mm), m, n.   about: x0, y0.
        """
        found = np.zeros(3)
        self._call(self.library.sums, pupil[0].size, *map(_address, (*pupil, field, about, found)))
        return found

    def slopes(self, pupil: Sequence[np.ndarray], field: np.ndarray, about: np.ndarray) -> np.ndarray:
        """The sum of (x - x0)^2 + (y - y0)^2, its derivatives by the S curvatures, and by the shift of the rays."""
        found = np.zeros(len(self.surfaces) + 2)
        self._call(self.library.slopes, pupil[0].size, *map(_address, (*pupil, field, about, found)))
        return found

    def _call(self, function: Any, count: int, *others: Any) -> None:
        real = ctypes.c_double if self.surfaces.dtype == np.float64 else ctypes.c_float
        function(
            _address(self.surfaces),
            ctypes.c_int(len(self.surfaces)),
            real(self.last[0]),
            ctypes.c_int64(count),
            *others,
        )


def absent() -> list[str]:
    """A line if there is no C compiler."""
    return [] if _compiler() else ["no C compiler (gcc or cc): the limit is left out"]


def version() -> str:
    """Of the compiler."""
    if not _compiler():
        return "no C compiler"
    return subprocess.run(
        [str(_compiler()), "--version"], check=True, capture_output=True, text=True
    ).stdout.splitlines()[0]


def limit(lens: Lens, precision: str) -> Limit:
    """A centred lens of spheres and of aspheres of powers 4, 6, 8, all refracting, with a plane image."""
    system = lens.astype("float64").system
    index, gap = np.asarray(system.index[system.primary]), np.asarray(system.thickness)
    mu = index[:-1] / index[1:]
    surfaces = np.zeros((len(gap), NUMBERS), precision)
    surfaces[:, 0], surfaces[:, 1] = np.asarray(system.curvature)[:-1], np.asarray(system.conic)[:-1]
    surfaces[1:, 2] = gap[:-1]
    surfaces[:, 3], surfaces[:, 4] = mu, 1 - mu**2
    for number, row in enumerate(lens.rows):
        surfaces[number, 5:8] = [row.asphere.get(power, 0.0) for power in POWERS]
        surfaces[number, 8] = bool(row.powers)
    return Limit(_library(precision), surfaces, gap[-1:].astype(precision))


def traced(lens: Lens, rays: Sequence[np.ndarray], *, fresh: bool = False) -> Callable[[], list[np.ndarray]]:
    """A call that traces the rays x, y, z, l, m, n to the image, in their precision.

    fresh: it allocates its results every time, as a caller who wants to keep them must.
    """
    limited = limit(lens, rays[0].dtype.name)
    kept = [np.zeros_like(a) for a in rays]

    def call() -> list[np.ndarray]:
        image = [np.empty_like(a) for a in rays] if fresh else kept
        limited.trace(rays, image)
        return image

    return call


def _compiler() -> str | None:
    return shutil.which("gcc") or shutil.which("cc")


@functools.cache
def _library(precision: str) -> ctypes.CDLL:
    block = BLOCK_BYTES // np.dtype(precision).itemsize
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "trace.so"
        given = (*FLAGS, f"-DREAL={TYPES[precision]}", f"-DBLOCK={block}", "-o", str(made), str(SOURCE), "-lm")
        subprocess.run([_compiler() or "cc", *given], check=True)
        return ctypes.CDLL(str(made))


def _address(array: np.ndarray) -> ctypes.c_void_p:
    return array.ctypes.data_as(ctypes.c_void_p)


def _list(arrays: Sequence[np.ndarray]) -> Any:
    """A C array of their addresses."""
    return (ctypes.c_void_p * len(arrays))(*(array.ctypes.data for array in arrays))
