"""The six numbers of an index: against the media they are fitted to."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lenstrace
from lenstrace import WavelengthError
from lenstrace.optics.made_media import Melt, Sampled
from lenstrace.optics.media import AIR, AbbeModel, Constant, Table
from lenstrace.scene.dispersion import RANGE_UM, dispersion_of, dispersions_of

UM = np.linspace(*RANGE_UM, 257)


@pytest.mark.parametrize("name", ["N-BK7", "N-SSK2", "N-SK2", "N-SK16", "F5", "SF5", "N-LAK8", "SILICA", "SAPPHIRE"])
def test_catalogue_glass_is_met_to_a_millionth(name: str) -> None:
    medium = lenstrace.glass(name)
    fit = dispersion_of(medium)
    assert np.abs(fit.index(UM) - medium.index(UM)).max() < 1e-6
    single = jax.tree.map(lambda a: jnp.asarray(a, jnp.float32), fit)
    assert np.abs(np.asarray(single.index(jnp.asarray(UM, jnp.float32)), float) - medium.index(UM)).max() < 1.2e-6


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("n", [1.0, 1.6, -1.0, 2.2071])
def test_a_constant_stays_exact(n: float, dtype: type) -> None:
    fit = jax.tree.map(lambda a: jnp.asarray(a, dtype), dispersion_of(Constant(n)))
    assert np.all(np.asarray(jax.jit(fit.index.__func__)(fit, jnp.asarray(UM, dtype))) == dtype(n))
    assert np.all(dispersion_of(AIR).index(UM) == 1)


def test_an_abbe_model_is_met_to_a_millionth() -> None:
    medium = AbbeModel(1.62, 60.3)
    assert np.abs(dispersion_of(medium).index(UM) - medium.index(UM)).max() < 1e-6
    melt = Melt(medium, 1e-3, 0.1, 0.55)
    assert np.abs(dispersion_of(melt).index(UM) - melt.index(UM)).max() < 1e-6


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_nodes_are_met_exactly(count: int) -> None:
    um = (0.4861, 0.5876, 0.6563)[:count]
    glass = lenstrace.glass("N-SSK2")
    table = Table(um, tuple(float(glass.index(each)) for each in um))
    for medium in (table, Sampled(table.n, um)):
        fit = dispersion_of(medium)
        assert np.abs(fit.index(np.asarray(um)) - np.asarray(table.n)).max() < 1e-14
    if count == 3:
        beyond = np.abs(dispersion_of(table).index(UM) - glass.index(UM))
        assert beyond[(UM > 0.4) & (UM < 0.7)].max() < 1.5e-4
        assert beyond.max() < 3e-4


def test_more_nodes_are_fitted() -> None:
    glass = lenstrace.glass("N-BK7")
    for um in (np.linspace(0.4, 0.7, 4), np.linspace(0.4, 0.75, 6), np.linspace(0.35, 0.85, 30)):
        table = Table(tuple(um), tuple(float(glass.index(each)) for each in um))
        inside = UM[(um[0] < UM) & (um[-1] > UM)]
        assert np.abs(dispersion_of(table).index(inside) - glass.index(inside)).max() < 2e-5


def test_media_are_stacked() -> None:
    media = [AIR, lenstrace.glass("N-BK7"), Constant(1.7)]
    stacked = dispersions_of(media)
    together = jax.tree.map(lambda a: a[:, None], stacked).index(UM[None])
    for medium, row in zip(media, together, strict=True):
        assert np.abs(row - medium.index(UM)).max() < 1e-6


def test_what_is_dark_is_no_medium_here() -> None:
    with pytest.raises(WavelengthError, match="not in visible light"):
        dispersion_of(lenstrace.glass("GERMANIUM"))
    with pytest.raises(WavelengthError, match="not in visible light"):
        dispersion_of(Table((3.0, 4.0), (4.0, 3.9)))


def test_the_index_carries_derivatives_of_the_medium() -> None:
    def index(nd: jax.Array) -> jax.Array:
        return dispersion_of(AbbeModel(nd, 50.0)).index(jnp.asarray(0.45))

    exact = jax.grad(lambda nd: AbbeModel(nd, 50.0).index(0.45))(1.6)
    assert float(jax.grad(index)(1.6)) == pytest.approx(float(exact), rel=1e-5)
