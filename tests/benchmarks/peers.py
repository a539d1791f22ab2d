"""The same double Gauss in batoid, Optiland and rayoptics, which are imported when they are asked for.

Read from the file without lenstrace, so that a fresh process that asks a peer loads the peer alone.
"""

from __future__ import annotations

import importlib.util
import os
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

FILE = Path(__file__).parents[2] / "designs" / "double_gauss.toml"
INSTALL = 'pip install -e ".[bench]"'
ENTRANCE_PUPIL = 57.912  # mm from the first vertex
OBJECT = 1.0  # mm, of rayoptics' object plane before the first vertex
TURN = 2.4  # radians from one point of a pupil to the next: nearly the golden angle
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


def optiland_double_gauss(backend: str = "numpy", precision: str = "float64") -> Any:
    """Three fields, three wavelengths; its indices are those of the file, found without a search of a catalogue.

    backend: numpy or torch. It is a setting of the whole process, numpy except while the lens is made or traced.
    precision: of torch alone.
    """
    _set(backend, precision)
    optic = _optiland_lens(_written())
    _set("numpy", precision)
    return optic


def _optiland_lens(written: dict[str, Any]) -> Any:
    """The lens of a file of centred surfaces, with the keys of which it is written."""
    import optiland.backend as be
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
            return be.interp(wavelength, be.array(self.um), be.array(self.table))

        def _calculate_k(self, wavelength: Any, **_: Any) -> Any:
            return 0.0 * wavelength

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


def optiland_traced(
    optic: Any, points: Numbers, directions: Numbers, backend: str = "numpy", precision: str = "float64"
) -> Callable[[], Any]:
    """A call from launch arrays to the rays at the image, which alone are kept. precision: of torch alone."""
    from optiland.rays import RealRays

    count = len(points[0])
    given = (*points, *directions, np.ones(count), np.full(count, _written()["wavelengths"]["primary"]))
    if backend == "torch":
        import torch

        given = tuple(torch.tensor(a, dtype=getattr(torch, precision)) for a in given)

    def call() -> Any:
        _set(backend, precision)
        image = optic.surfaces.trace(RealRays(*given), skip=1, record=False)
        _set("numpy", precision)
        return image

    return call


def _set(backend: str, precision: str) -> None:
    """What Optiland computes with."""
    import optiland.backend as be

    be.set_backend(backend)
    if backend == "torch":
        be.set_precision(precision)


def optiland_spots(optic: Any) -> Any:
    """RMS spot sizes of all fields and wavelengths, 127 rays each."""
    from optiland.analysis import SpotDiagram

    return SpotDiagram(optic, num_rings=6, distribution="hexapolar").rms_spot_radius()


def rayoptics_double_gauss() -> Any:
    """Its sequential model, with an object plane OBJECT mm before the first vertex."""
    from rayoptics.optical.opticalmodel import OpticalModel

    model = OpticalModel()
    for row in _written()["lens"]["surfaces"]:
        index = row["index"]["n"][1] if "index" in row else 1.0
        model.seq_model.add_surface([1 / row["radius"] if "radius" in row else 0.0, row["thickness"], index])
    model.seq_model.gaps[0].thi = OBJECT
    model.update_model()
    return model.seq_model


def rayoptics_traced(model: Any, points: Numbers, directions: Numbers) -> Callable[[], np.ndarray]:
    """A call that traces the rays one by one, as it does, from the first vertex plane: x, y, z at the image, (N, 3)."""
    from rayoptics.raytr.raytrace import trace_raw

    nm = model.central_wavelength()  # its indices are constants
    path = list(model.path(wl=nm))
    turned = np.stack(directions, -1)
    start = np.stack(points, -1) - OBJECT * turned / turned[:, 2:]
    start[:, 2] = 0  # in the frame of the object plane

    def call() -> np.ndarray:
        return np.array([trace_raw(iter(path), point, d, nm)[0][-1][0] for point, d in zip(start, turned, strict=True)])

    return call


def rayoptics_spots() -> np.ndarray:
    """As `batoid_spots`."""
    points, directions = _bundles()
    image = rayoptics_traced(rayoptics_double_gauss(), points, directions)()
    return np.hypot(image[:, 0].reshape(9, 127).std(1), image[:, 1].reshape(9, 127).std(1))


def batoid_spots() -> np.ndarray:
    """RMS spots of nine bundles of 127 rays, all of one wavelength, in one call: as much work as `optiland_spots`."""
    optic = batoid_double_gauss()
    rays = batoid_rays(*_bundles())
    optic.trace(rays)
    return np.hypot(rays.x.reshape(9, 127).std(1), rays.y.reshape(9, 127).std(1))


def filling(count: int, degrees: float = 10.0) -> tuple[Numbers, Numbers]:
    """Points and directions of rays of one field all over the pupil, found without lenstrace."""
    turn, height = np.arange(count) * TURN, np.sqrt((np.arange(count) + 0.5) / count) * _radius()
    angle = np.deg2rad(degrees)
    y = height * np.sin(turn) - ENTRANCE_PUPIL * np.tan(angle)
    x = height * np.cos(turn)
    return (x, y, 0 * x), (0 * x, 0 * x + np.sin(angle), 0 * x + np.cos(angle))


def _bundles() -> tuple[Numbers, Numbers]:
    """Nine bundles of 127 rays, three of each field."""
    each = [filling(127, degrees) for degrees in (0.0, 10.0, 14.0) for _ in range(3)]
    points, directions = (tuple(np.concatenate(a) for a in zip(*part, strict=True)) for part in zip(*each, strict=True))
    return points, directions


def _radius() -> float:
    return _written()["aperture"]["entrance_pupil_diameter"] / 2


def _written() -> dict[str, Any]:
    return tomllib.loads(FILE.read_text())


def optiland_optimized(file: Path) -> tuple[float, float]:
    """Merit and seconds of Optiland's least squares on the triplet of a file: nine spots of 6 rings and the focal
    length, six radii and three gaps."""
    from optiland.optimization import LeastSquares, OptimizationProblem

    _set("numpy", "float64")
    written = tomllib.loads(file.read_text())
    optic = _optiland_lens(written)
    problem = OptimizationProblem()
    top = max(written["fields"]["y"])
    for y in written["fields"]["y"]:
        for um in written["wavelengths"]["um"]:
            asked = {"optic": optic, "surface_number": -1, "Hx": 0, "Hy": y / top, "num_rays": 6, "wavelength": um}
            problem.add_operand("rms_spot_size", target=0, weight=1, input_data={**asked, "distribution": "hexapolar"})
    (wanted,) = (each["target"] for each in written["optimize"]["want"] if each["kind"] == "focal_length")
    problem.add_operand("f2", target=wanted, weight=1, input_data={"optic": optic})
    for number in range(1, 7):
        problem.add_variable(optic, "radius", surface_number=number)
    for number in (2, 4, 6):
        bounds = {} if number == 6 else {"min_val": 0.1}
        problem.add_variable(optic, "thickness", surface_number=number, **bounds)
    start = time.perf_counter()
    LeastSquares(problem).optimize()
    return float(problem.sum_squared()), time.perf_counter() - start
