"""The same double Gauss in batoid and in Optiland, which are imported when they are asked for.

Read from the file without lenstrace, so that a fresh process that asks a peer loads the peer alone.
"""

from __future__ import annotations

import importlib.util
import os
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

FILE = Path(__file__).parents[2] / "designs" / "double_gauss.toml"
INSTALL = 'pip install -e ".[compare]"'
ENTRANCE_PUPIL = 57.912  # mm from the first vertex
Numbers = tuple[np.ndarray, ...]


def absent(*names: str) -> list[str]:
    """A line for each of these peers that is not installed."""
    return [f"{name} is not installed: {INSTALL}" for name in names if importlib.util.find_spec(name) is None]


def batoid_double_gauss() -> Any:
    """At the primary wavelength, all surfaces spheres or planes, lengths in mm; as many threads as processors."""
    import batoid
    import batoid.global_vars

    batoid.global_vars._batoid_max_threads = os.cpu_count()  # 1 by default, even if OMP_NUM_THREADS is not given
    written = _written()
    items, z, before = [], 0.0, 1.0
    for row in written["lens"]["surfaces"]:
        after = row["index"]["n"][1] if "index" in row else 1.0
        shape = batoid.Sphere(row["radius"]) if "radius" in row else batoid.Plane()
        media = {"inMedium": batoid.ConstMedium(before), "outMedium": batoid.ConstMedium(after)}
        items.append(batoid.RefractiveInterface(shape, coordSys=batoid.CoordSys(origin=[0, 0, z]), **media))
        z, before = z + row["thickness"], after
    items.append(batoid.Detector(batoid.Plane(), coordSys=batoid.CoordSys(origin=[0, 0, z])))
    return batoid.CompoundOptic(items)


def batoid_rays(points: Numbers, directions: Numbers) -> Any:
    """Rays for batoid: points (mm) and unit vectors, x, y, z each (N,)."""
    import batoid

    return batoid.RayVector(*points, *directions)


def optiland_double_gauss() -> Any:
    """Three fields, three wavelengths; its indices are those of the file, found without a search of a catalogue."""
    from optiland.materials import BaseMaterial
    from optiland.optic import Optic

    class Tabulated(BaseMaterial):
        """Indices n at the wavelengths um; they do not change, so that Optiland may keep what it has looked up."""

        def __init__(self, um: list[float], n: list[float]) -> None:
            super().__init__()
            self.um, self.table = um, n

        def _cache_state(self) -> tuple[Any, ...]:
            return ()

        def _calculate_n(self, wavelength: Any, **_: Any) -> Any:
            return np.interp(wavelength, self.um, self.table)

        def _calculate_k(self, wavelength: Any, **_: Any) -> Any:
            return 0.0 * wavelength

    written = _written()
    optic = Optic()
    optic.surfaces.add(index=0, radius=np.inf, thickness=np.inf)
    rows = written["lens"]["surfaces"]
    for number, row in enumerate(rows, 1):
        material = Tabulated(**row["index"]) if "index" in row else "air"
        shape = {"radius": row.get("radius", np.inf), "thickness": row["thickness"]}
        optic.surfaces.add(index=number, material=material, is_stop="stop" in row, **shape)
    optic.surfaces.add(index=len(rows) + 1)
    optic.set_aperture(aperture_type="EPD", value=written["aperture"]["entrance_pupil_diameter"])
    optic.fields.set_type(field_type="angle")
    for y in written["fields"]["y"]:
        optic.fields.add(y=y)
    for um in written["wavelengths"]["um"]:
        optic.wavelengths.add(value=um, is_primary=um == written["wavelengths"]["primary"])
    return optic


def optiland_traced(optic: Any, points: Numbers, directions: Numbers) -> Callable[[], Any]:
    """A call from launch arrays to the rays at the image, which alone are kept."""
    from optiland.rays import RealRays

    count = len(points[0])
    ones, um = np.ones(count), np.full(count, _written()["wavelengths"]["primary"])

    def call() -> Any:
        return optic.surfaces.trace(RealRays(*points, *directions, ones, um), skip=1, record=False)

    return call


def optiland_spots(optic: Any) -> Any:
    """RMS spot sizes of all fields and wavelengths, 127 rays each."""
    from optiland.analysis import SpotDiagram

    return SpotDiagram(optic, num_rings=6, distribution="hexapolar").rms_spot_radius()


def batoid_spots() -> np.ndarray:
    """RMS spots of nine bundles of 127 rays, all of one wavelength, in one call: as much work as `optiland_spots`."""
    optic = batoid_double_gauss()
    written = _written()
    radius = written["aperture"]["entrance_pupil_diameter"] / 2
    turn, height = np.arange(127) * 2.4, np.sqrt(np.arange(127) / 126) * radius
    x, y = np.tile([height * np.cos(turn), height * np.sin(turn)], 9)
    angle = np.deg2rad(np.repeat([0.0, 10.0, 14.0], 3 * 127))
    y = y - ENTRANCE_PUPIL * np.tan(angle)
    rays = batoid_rays((x, y, 0 * x), (0 * x, np.sin(angle), np.cos(angle)))
    optic.trace(rays)
    return np.hypot(rays.x.reshape(9, 127).std(1), rays.y.reshape(9, 127).std(1))


def _written() -> dict[str, Any]:
    return tomllib.loads(FILE.read_text())
