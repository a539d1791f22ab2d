"""Section scenes: Cornell's box against Mitsuba, and what each thing costs that a scene may or may not require."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.blocks import each
from lenstrace.compute.compiled import LONG_OPTIONS
from lenstrace.compute.tiles import each_tile
from lenstrace.io.native import load
from lenstrace.io.scene import load_scene
from lenstrace.scene import (
    Dielectric,
    Diffuse,
    DistantLight,
    Mirror,
    Object,
    PointLight,
    RoughConductor,
    Scene,
    ThinLens,
    Torus,
    formula_mesh,
    lens_camera,
    render,
)
from lenstrace.scene.build import world_of
from lenstrace.scene.hits import nearest
from lenstrace.scene.lanes import samples_of
from lenstrace.scene.rays import NOWHERE, SceneRay
from lenstrace.scene.render import SHARES, task_of
from lenstrace.scene.search.kind import Way
from tests.benchmarks import fresh
from tests.benchmarks.paired import interleaved
from tests.benchmarks.table import Table

SCENES = Path(__file__).parents[2] / "designs" / "scenes"
SIZE, SAMPLES, DEPTH = 256, 64, 8
FEW = 8  # samples, where many variants are compared
ROUNDS = 5
RAYS = 1_000_000
MEAN = np.array([0.24015, 0.14112, 0.05998])
WITHIN = 6e-4


def scenes() -> Table:
    """Cornell's box, 256 x 256 pixels, 64 samples, 7 scatterings, float32; and its variants with 8 samples."""
    table = Table("scenes: Cornell's box by path tracing, 256 x 256 pixels, 64 samples, depth 8, float32")
    _cornell(table)
    _features(table)
    _mesh(table)
    _through_lens(table)
    large = fresh.answer("children", "large_picture")
    table.value("a picture of 4,000 x 3,000 pixels: memory of the process at most", large["peak"], "MB", at_most=2000)
    return table


def _cornell(table: Table) -> None:
    setup = load_scene(SCENES / "cornell_box.toml")
    pictures = []

    def ours() -> None:
        pictures.append(render(setup.scene, setup.camera, size=(SIZE, SIZE), samples=SAMPLES, depth=DEPTH))

    calls: dict[str, Callable[[], Any]] = {"lenstrace": ours} | _mitsuba()
    seconds = interleaved(calls, ROUNDS)
    table.time("lenstrace", np.array([picture.seconds for picture in pictures[1:]]), "s", at_most=3.0)
    table.value("compilation, once", pictures[0].compile_seconds, "s", at_most=5.0)
    table.value("rays", pictures[-1].rays_per_second / 1e6, "million/s")
    off = np.max(np.abs(pictures[-1].mean_rgb - MEAN))
    table.value("mean RGB, largest difference from Mitsuba's", off, "", at_most=WITHIN)
    for name, values in seconds.items():
        if name != "lenstrace":
            table.time(name, values, "s")
            table.compare(f"{name} / lenstrace", values, seconds["lenstrace"])


def _mitsuba() -> dict[str, Callable[[], Any]]:
    """The same picture, where Mitsuba is installed; its first call, which compiles, is not timed."""
    try:
        import mitsuba
    except ImportError:
        return {}
    calls = {}
    # its LLVM variant ends the whole process where the LLVM it finds lacks an instruction
    for variant in ("scalar_rgb",):
        if variant not in mitsuba.variants():
            continue
        mitsuba.set_variant(variant)
        keys = mitsuba.cornell_box()
        keys["sensor"]["film"]["rfilter"] = {"type": "box"}
        keys["integrator"]["rr_depth"] = 1000
        scene = mitsuba.load_dict(keys)

        def draw(variant: str = variant, scene: Any = scene) -> Any:
            mitsuba.set_variant(variant)
            return np.array(mitsuba.render(scene, spp=SAMPLES))

        calls[f"Mitsuba, {variant}"] = draw
    return calls


def _features(table: Table) -> None:
    """Seconds and size of the program of variants of the box, against the box itself."""
    setup = load_scene(SCENES / "cornell_box.toml")
    plain, camera = setup.scene, setup.camera
    small = plain.objects[6]
    white = small.material
    lens = ThinLens(camera.view, 0.05, 2.0, 3.9, 0.0362)
    variants: dict[str, tuple[Scene, Any, str]] = {
        "plain": (plain, camera, "path"),
        "cast, no light from walls": (plain, camera, "cast"),
        "a point light": (dataclasses.replace(plain, lights=[PointLight((0.0, 0.5, 0.0), 0.1)]), camera, "path"),
        "a distant light": (dataclasses.replace(plain, lights=[DistantLight((0, -1, -1), 0.1)]), camera, "path"),
        "light all around": (dataclasses.replace(plain, environment=0.1), camera, "path"),
        "a map all around": (dataclasses.replace(plain, environment=np.full((32, 64, 3), 0.1)), camera, "path"),
        "a mirror": (_with(plain, Mirror(0.9)), camera, "path"),
        "glass": (_with(plain, Dielectric(1.5)), camera, "path"),
        "glass with dispersion": (_with(plain, Dielectric("N-SF11")), camera, "path"),
        "polished gold": (_with(plain, RoughConductor()), camera, "path"),
        "a moving box": (_with(plain, white, motion=(0.2, 0.0, 0.0)), camera, "path"),
        "a ring": (dataclasses.replace(plain, objects=[*plain.objects, _ring()]), camera, "path"),
        "a thin lens": (plain, lens, "path"),
    }
    pictures: dict[str, Any] = {}

    def draw(name: str) -> Callable[[], None]:
        scene, eye, method = variants[name]

        def call() -> None:
            picture = render(scene, eye, size=(SIZE, SIZE), samples=FEW, depth=DEPTH, method=method)
            pictures.setdefault(name, picture)

        return call

    seconds = interleaved({name: draw(name) for name in variants}, ROUNDS)
    for name, (scene, eye, method) in variants.items():
        table.compare(f"{name}: time", seconds[name], seconds["plain"])
        table.value(f"{name}: compilation", pictures[name].compile_seconds, "s")
        table.value(f"{name}: program", _instructions(scene, eye, method), "instructions")


def _mesh(table: Table) -> None:
    """The nearest of 72,000 triangles along rays that have nothing to do with each other."""
    mesh = formula_mesh("torus knot", 600, 60)
    random = np.random.default_rng(0)
    point, aim = (random.normal(size=(RAYS, 3)).astype(np.float32) for _ in range(2))
    point *= 2 / np.linalg.norm(point, axis=1, keepdims=True)
    aim /= np.linalg.norm(aim, axis=1, keepdims=True)
    columns = (tuple(jnp.asarray(a) for a in vector.T) for vector in (point, aim))
    ray = SceneRay(*columns, jnp.full(RAYS, NOWHERE, jnp.int32))  # type: ignore[arg-type]
    world = {way: world_of(Scene([Object(mesh, Diffuse(0.5))]), np.float32, way) for way in (Way.AUTO, Way.HIERARCHY)}
    calls: dict[str, Callable[[], Any]] = {
        "Embree": lambda: jax.block_until_ready(each_tile(nearest, world[Way.AUTO], ray)),
        "the hierarchy in JAX": lambda: jax.block_until_ready(each(nearest, world[Way.HIERARCHY], ray)),
    }
    seconds = interleaved(calls, ROUNDS)
    # all but those that go through an edge
    numbers = [np.asarray(call()[1]) for call in calls.values()]
    table.value(
        "of them, rays for which both name another triangle", np.mean(numbers[0] != numbers[1]), "", at_most=1e-5
    )
    for name, at_least in (("Embree", 4.0), ("the hierarchy in JAX", None)):
        rate = RAYS / float(np.median(seconds[name])) / 1e6
        table.value(f"incoherent rays among {len(mesh):,} triangles, {name}", rate, "million/s", at_least=at_least)


def _through_lens(table: Table) -> None:
    """Cornell's box through the double Gauss, of one wavelength and of all, against the pinhole."""
    setup = load_scene(SCENES / "cornell_box.toml")
    gauss = load(SCENES.parent / "double_gauss.toml")
    given: dict[str, Any] = {"focus": 3.9, "f_number": 5.0, "film": 36.2, "unit_mm": 1000.0, "aspect": 1.0}
    view = setup.camera.view
    eyes = {"pinhole": setup.camera}
    for name, colour in (("through the double Gauss, one wavelength", False), ("through the double Gauss", True)):
        eyes[name] = lens_camera(gauss, view.position, view.target, view.up, colour=colour, **given)

    def draw(eye: Any) -> Callable[[], Any]:
        return lambda: render(setup.scene, eye, size=(SIZE, SIZE), samples=SAMPLES, depth=DEPTH)

    seconds = interleaved({name: draw(eye) for name, eye in eyes.items()}, ROUNDS)
    for name in list(eyes)[1:]:
        table.compare(f"{name} / pinhole", seconds[name], seconds["pinhole"], at_most=1.6)


def _with(scene: Scene, material: Any, **more: Any) -> Scene:
    """The scene with its small box of another material."""
    objects = list(scene.objects)
    objects[6] = dataclasses.replace(objects[6], material=material, **more)
    return dataclasses.replace(scene, objects=objects)


def _ring() -> Object:
    return Object(Torus(0.2, 0.05), Diffuse(0.5), (0.3, 0.0, 0.4))


def _instructions(scene: Scene, camera: Any, method: str) -> int:
    """Of the program of the samples, as XLA leaves it."""
    task = task_of(scene, camera, (SIZE, SIZE), method=method, depth=DEPTH)
    pixels = jnp.zeros(SHARES[-1], jnp.uint32)
    compiled = jax.jit(samples_of, compiler_options=LONG_OPTIONS).lower(task, pixels).compile()
    return compiled.as_text().count(" = ")
