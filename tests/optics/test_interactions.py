"""The law of interaction: Snell's law, reflection, negative index, total reflection, reversibility."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace.optics.interactions import Interaction
from lenstrace.optics.interactions import bend as law

MET = jnp.asarray(True)


def random_geometry(count: int = 500) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Directions, normals of any length, |N.d|, and the sign of N.d."""
    generator = np.random.default_rng(7)
    direction, normal = generator.normal(size=(2, 3, count))
    direction /= np.linalg.norm(direction, axis=0)
    cosine = (direction * normal).sum(0)
    return direction, normal, np.abs(cosine), np.sign(cosine)


def bend(direction, normal, cosine, side, n1, n2):
    vectors = (tuple(map(jnp.asarray, v)) for v in (direction, normal))
    squared = jnp.asarray((np.asarray(normal) ** 2).sum(0))
    scalars = (jnp.asarray(v) for v in (cosine, side, float(n1), float(n2)))
    kind = Interaction.REFRACT_EITHER_SIGN if n1 * n2 < 0 else Interaction.REFRACT
    return law(kind, *vectors, squared, *scalars, MET)


@pytest.mark.parametrize(
    ("n1", "n2"), [(1, 1.5), (1.5, 1), (1, 4), (1, 1 + 1e-12), (1, -1), (1.5, -1.1), (-1, 1), (-2, -1.5)]
)
def test_law_of_refraction(n1: float, n2: float) -> None:
    direction, normal, cosine, side = random_geometry()
    bent, transmitted = bend(direction, normal, cosine, side, n1, n2)
    bent, alive = np.asarray(bent), np.asarray(transmitted)
    unit = normal / np.linalg.norm(normal, axis=0)
    sine = np.linalg.norm(np.cross(direction.T, unit.T), axis=1)
    assert (alive == (np.abs(n1 / n2) * sine < 1)).all()
    assert_allclose(np.linalg.norm(bent, axis=0)[alive], 1, rtol=2e-14)
    # what is totally reflected goes straight on
    assert (bent[:, ~alive] == direction[:, ~alive]).all()
    # tangential optical momentum is conserved: n1 (d1 x N) = n2 (d2 x N)
    before, after = n1 * np.cross(direction.T, unit.T), n2 * np.cross(bent.T, unit.T)
    assert_allclose(after[alive], before[alive], atol=2e-14)
    # the light goes on through the surface
    assert (np.sign((bent * normal).sum(0)) == side)[alive].all()


def test_the_direction_at_30_degrees_into_glass() -> None:
    # from n = 1 to 1.5 at 30 degrees, going down: (1/3, 0, -0.942809041582063), and of length 1. The vector
    # form often printed with the wrong sign gives a length of 2.124 or 0.395.
    direction = np.array([0.5, 0.0, -np.sqrt(3) / 2])
    bent, _ = bend(direction, np.array([0.0, 0.0, 1.0]), np.sqrt(3) / 2, -1.0, 1, 1.5)
    assert_allclose(bent, [1 / 3, 0, -0.942809041582063], atol=1e-15)


def test_critical_angle() -> None:
    # sin = 1 / 1.5: 41.8103148958 degrees
    for angle, through in ((41.8103148957, True), (41.8103148959, False)):
        sine, cosine = np.sin(np.deg2rad(angle)), np.cos(np.deg2rad(angle))
        bent, transmitted = bend(np.array([0, sine, cosine]), np.array([0.0, 0.0, 1.0]), cosine, 1.0, 1.5, 1)
        assert bool(transmitted) is through
        assert through or (np.asarray(bent) == [0, sine, cosine]).all()


def test_negative_index_sends_the_ray_to_the_other_side_of_the_normal() -> None:
    direction = np.array([0.0, 0.6, 0.8])
    bent, _ = bend(direction, np.array([0.0, 0.0, 1.0]), 0.8, 1.0, 1, -1)
    assert_allclose(bent, [0, -0.6, 0.8], atol=1e-16)


def test_law_of_reflection() -> None:
    direction, normal, cosine, side = random_geometry()
    squared = (normal**2).sum(0)
    arguments = (tuple(map(jnp.asarray, v)) for v in (direction, normal))
    one = jnp.ones(())
    scalars = (jnp.asarray(v) for v in (squared, cosine, side))
    bent, kept = law(Interaction.REFLECT, *arguments, *scalars, one, one, MET)
    mirrored = np.asarray(bent)
    assert np.asarray(kept).all()
    expected = direction - 2 * (direction * normal).sum(0) / squared * normal
    assert_allclose(mirrored, expected, atol=2e-14)
    assert_allclose(np.linalg.norm(mirrored, axis=0), 1, rtol=1e-14)


def test_refraction_is_reversible() -> None:
    direction, normal, cosine, side = random_geometry()
    bent, transmitted = bend(direction, normal, cosine, side, 1.3, 1.7)
    bent, alive = np.asarray(bent), np.asarray(transmitted)
    back, _ = bend(-bent, normal, np.abs((bent * normal).sum(0)), -side, 1.7, 1.3)
    assert_allclose(np.asarray(back)[:, alive], -direction[:, alive], atol=5e-14)


def test_nearly_equal_indices_keep_their_digits() -> None:
    # 45 degrees, n2 = 1 + 1e-12: the deflection is tan(45) 1e-12 to first order
    direction = np.array([0.0, np.sqrt(0.5), np.sqrt(0.5)])
    n2 = 1 + 1e-12
    bent, _ = bend(direction, np.array([0.0, 0.0, 1.0]), np.sqrt(0.5), 1.0, 1, n2)
    turn = float(bent[1]) * np.sqrt(0.5) - float(bent[2]) * np.sqrt(0.5)
    assert_allclose(turn, -(n2 - 1), rtol=2e-4)


def test_either_sign_serves_positive_indices_too() -> None:
    direction, normal, cosine, side = random_geometry()
    vectors = (tuple(map(jnp.asarray, v)) for v in (direction, normal))
    scalars = [jnp.asarray((normal**2).sum(0)), *(jnp.asarray(v) for v in (cosine, side, 1.0, 1.7))]
    general, _ = law(Interaction.REFRACT_EITHER_SIGN, *vectors, *scalars, MET)
    assert_allclose(general, bend(direction, normal, cosine, side, 1.0, 1.7)[0], atol=1e-15)


def test_derivative_by_index_is_finite_at_total_reflection() -> None:
    @jax.jit
    @jax.grad
    def slope(n2: jax.Array) -> jax.Array:
        zero, sine = jnp.zeros(()), jnp.asarray(0.9)
        cosine = jnp.sqrt(1 - sine**2)
        bent, _ = law(
            Interaction.REFRACT,
            (zero, sine, cosine),
            (zero, zero, jnp.ones(())),
            1.0,
            cosine,
            jnp.ones(()),
            jnp.asarray(1.5),
            n2,
            MET,
        )
        return bent[1] + bent[2]

    assert np.isfinite(slope(1.0))


@functools.partial(jax.jit, static_argnums=0)
def to_second_order(kind: Interaction, given: Any, toward: Any, weights: jax.Array) -> Any:
    """A weighted sum of the direction behind with its gradient, and how fast both change on the way `toward`."""

    def behind(given: Any) -> jax.Array:
        direction, normal, n1, n2 = given
        along = direction @ normal
        geometry = tuple(direction), tuple(normal), normal @ normal, abs(along), jnp.sign(along)
        return weights @ jnp.stack(law(kind, *geometry, n1, n2, MET)[0])

    return jax.jvp(jax.value_and_grad(behind), (given,), (toward,))


@pytest.mark.parametrize("kind", list(Interaction))
def test_derivatives_of_both_orders(kind: Interaction) -> None:
    """Forward and in reverse, in a random direction of all numbers, against central differences."""
    directions, normals, *_ = random_geometry(8)
    indices = [(1.0, 1.5), (1.5, 1.0), (1.4, 1.4), (1.3, -1.2)]
    some, step = np.random.default_rng(8), 1e-6
    for n1, n2 in indices[: 3 if kind is Interaction.REFRACT else 4]:
        for direction, normal in zip(directions.T, normals.T, strict=True):
            given = direction, normal, np.float64(n1), np.float64(n2)
            toward, weights = jax.tree.map(lambda a: some.standard_normal(np.shape(a)), given), some.standard_normal(3)
            toward = jax.tree.map(np.asarray, toward)
            sides = [jax.tree.map(lambda a, b, s=s: np.asarray(a + s * step * b), given, toward) for s in (1, -1)]
            (_, slopes), changes = to_second_order(kind, given, toward, weights)
            ends = [to_second_order(kind, side, toward, weights)[0] for side in sides]
            differences = jax.tree.map(lambda a, b: (a - b) / (2 * step), *ends)
            for change, difference in zip(*map(jax.tree.leaves, (changes, differences)), strict=True):
                assert_allclose(change, difference, rtol=1e-6, atol=1e-6)
            assert_allclose(sum(np.vdot(a, b) for a, b in zip(slopes, toward, strict=True)), changes[0], rtol=1e-12)


def test_a_ray_that_meets_nothing_goes_straight_on_and_its_derivatives_too() -> None:
    def behind(direction: jax.Array, index: jax.Array) -> jax.Array:
        zero, one = jnp.zeros(()), jnp.ones(())
        geometry = tuple(direction), (zero, zero, one), one, direction[2], one
        return jnp.stack(law(Interaction.REFRACT, *geometry, one, index, ~MET)[0])

    direction = jnp.array([0.0, 0.6, 0.8])
    by_direction, by_index = jax.jit(jax.jacobian(behind, (0, 1)))(direction, jnp.asarray(1.5))
    assert (jax.jit(behind)(direction, jnp.asarray(1.5)) == direction).all()
    assert (by_direction == np.eye(3)).all()
    assert (by_index == 0).all()
