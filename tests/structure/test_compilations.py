"""New numbers never compile a program again; only a new structure may."""

import dataclasses
from collections.abc import Callable, Iterator

import jax
import pytest

import lenstrace
from lenstrace import Fields, Lens, Wavelengths

EVENT = "/jax/core/compile/backend_compile_duration"
QUESTIONS = (lenstrace.trace, lenstrace.spots, lenstrace.first_order, lenstrace.mean_square_spot)

ROWS = [
    {"radius": 23.0, "thickness": 3.0, "glass": "N-BK7"},
    {"radius": -41.0, "thickness": 1.5, "glass": "N-SF2", "stop": True},
    {"radius": -130.0, "thickness": 30.0},
]


@pytest.fixture
def compiled() -> Iterator[list[str]]:
    """The names of the programs that are compiled while a test runs."""
    names: list[str] = []

    def heard(event: str, _: float, **more: str) -> None:
        if event == EVENT:
            names.append(more.get("fun_name", "?"))

    jax.monitoring.register_event_duration_secs_listener(heard)
    yield names
    jax.monitoring.unregister_event_duration_listener(heard)


def doublet(rows: list[dict] | None = None, um: tuple[float, ...] = (0.48, 0.55, 0.65)) -> Lens:
    return lenstrace.lens(rows or ROWS, {"entrance_pupil_diameter": 8.0}, [0.0, 2.0], um)


def other_numbers(lens: Lens) -> Lens:
    """Every number changed that JAX may see, and the glasses."""
    lens = lens.replace(
        curvature=lens.curvature * 1.01,
        thickness=lens.thickness + 0.2,
        conic=lens.conic - 0.5,
        fields=Fields((0.1, 0.0), (1.0, 1.7), "angle"),
        aperture=lenstrace.Aperture(7.0, "entrance_pupil_diameter"),
        wavelengths=Wavelengths((1.0, 2.0, 0.5), (0.45, 0.6, 0.7), 1),
        image=lens.image.replace(curvature=-0.01, conic=0.3),
        name="another",
    )
    return lens.replace(surface=1, glass="N-LAK8").replace(surface=2, glass="SF6")


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_lens_of_other_numbers_compiles_nothing(question: Callable, compiled: list[str]) -> None:
    question(doublet())
    compiled.clear()
    question(other_numbers(doublet()))
    assert compiled == []


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_lens_of_another_structure_compiles(question: Callable, compiled: list[str]) -> None:
    question(doublet())
    compiled.clear()
    # powers that no other test has
    question(doublet([ROWS[0] | {"asphere": {4: 1e-9, 14: 1e-21}}, *ROWS[1:]]))
    assert compiled


def test_a_mirror_compiles_a_trace(compiled: list[str]) -> None:
    lenstrace.trace(doublet())
    compiled.clear()
    lenstrace.trace(doublet([*ROWS[:2], {"radius": -130.0, "thickness": -30.0, "mirror": True}]))
    assert len(compiled) >= 1


def test_other_rays_compile_no_trace(compiled: list[str]) -> None:
    lens = doublet()
    lenstrace.trace(lens)
    compiled.clear()
    for wavelength in (0.48, 0.5, 0.61, None):
        for field in (0.0, 1.3, -2, (0.5, 1.0)):
            for pupil in ((0.0, 0.0), (0.1, -0.7), (0, 1)):
                lenstrace.trace(lens, field=field, pupil=pupil, wavelength=wavelength)
    assert compiled == []


def test_the_lists_of_fields_and_wavelengths_compile_no_trace(compiled: list[str]) -> None:
    lenstrace.trace(doublet())
    compiled.clear()
    for um in ((0.55,), (0.5, 0.6), (0.45, 0.5, 0.55, 0.6, 0.65)):
        lens = doublet(um=um)
        lenstrace.trace(lens)
        lenstrace.trace(lens.replace(fields=Fields((0.0,), (3.0,), "angle")), field=3.0)
        lenstrace.trace(lens.replace(wavelengths=dataclasses.replace(lens.wavelengths, primary=0)))
    assert compiled == []


def test_a_given_ray_compiles_a_trace_once(compiled: list[str]) -> None:
    lens = doublet()
    lenstrace.trace(lens, lenstrace.ray((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    compiled.clear()
    ray = lenstrace.ray((0.3, -1.0, 0.0), (0.0, 0.6, 0.8))
    lenstrace.trace(other_numbers(lens), ray)
    assert compiled == []


def test_gradients_of_other_numbers_compile_nothing(compiled: list[str]) -> None:
    def merit(lens: Lens) -> jax.Array:
        return lenstrace.mean_square_spot(lens, rings=2).sum()

    jax.grad(merit)(doublet())
    compiled.clear()
    jax.grad(merit)(other_numbers(doublet()))
    assert compiled == []
