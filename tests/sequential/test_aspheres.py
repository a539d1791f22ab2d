"""Asphere terms in r / r_norm: no overflow, right derivatives; and a given number of Newton steps."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, RayStatus
from lenstrace.sequential import paraxial
from lenstrace.sequential.trace import trace

TERMS = {2: 2e-4, 4: -3e-5, 6: 2e-7, 16: -2e-18}
QUICKLY = {"xla_backend_optimization_level": 0}


def made(terms: dict[int, Any], scale: float = 1.0) -> Lens:
    """An asphere and a sphere, in mm times `scale`."""
    terms = {power: a * scale ** (1 - power) for power, a in terms.items()}
    front = {"radius": 20 * scale, "thickness": 5 * scale, "index": 1.5, "asphere": terms, "stop": True}
    rows = [front, {"radius": -60 * scale, "thickness": 40 * scale}]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 10 * scale}, [0.0], [0.55])


def test_the_system_holds_the_terms_of_the_rows() -> None:
    system = made(TERMS).system
    for power, a in TERMS.items():
        assert_allclose(np.asarray(system.term(power)), [a, 0, 0], rtol=1e-15)
    assert not np.asarray(system.term(8)).any()
    # r at which a term has a sag of r: the smallest is 3e-5^(-1/3) = 32 or 2e-18^(-1/15) = 15.1
    assert_allclose(system.norm_radius, [16, 1, 1])
    assert_allclose(paraxial.effective_curvature(system.at(0))[0], 1 / 20 + 4e-4, rtol=1e-15)


def test_no_power_overflows_in_float32() -> None:
    for scale in (2.0**20, 2.0**-30):
        system = made(TERMS, scale).astype("float32").system
        assert np.isfinite(system.coefficients).all()
        assert (np.asarray(system.coefficients)[0] != 0).all()
        assert_allclose(system.norm_radius[0], 16 * scale)


@pytest.mark.parametrize("terms", [TERMS, dict.fromkeys(TERMS, 0.0), {1: 1e-3, 3: 1e-5}])
def test_what_is_differentiated_is_the_term_and_not_its_radius(terms: dict[int, float]) -> None:
    """Also from zero: of a sum of weighted terms, the derivatives are the weights."""
    lens, weights = made(terms), range(2, 2 + len(terms))

    def weighted(values: list[jax.Array]) -> jax.Array:
        system = lens.replace(surface=1, asphere=dict(zip(terms, values, strict=True))).system
        return sum((w * system.term(p)[0] for w, p in zip(weights, terms, strict=True)), jnp.zeros(()))

    found = jax.jit(jax.grad(weighted), compiler_options=QUICKLY)([jnp.asarray(a) for a in terms.values()])
    assert_allclose(found, list(weights), rtol=1e-14)


def test_newton_steps_that_are_given() -> None:
    """None taken: the conic's own crossing, or the plane's; each more squares the error; status stays OK throughout."""
    lens = made(TERMS)
    system = lens.system.at(0)
    ray = lenstrace.trace(lens, field=10.0, pupil=(0.0, np.array([0.5, 1.0])))
    start = jax.tree.map(lambda a: a[0], ray)
    traced = jax.jit(trace, compiler_options=QUICKLY)
    exact = traced(system, start)
    errors = []
    for steps in (0, 1, 2, 5):
        found = traced(system.with_newton_steps(steps), start)
        assert (np.asarray(found.status) == RayStatus.OK).all()
        errors.append(float(np.abs(found.y - exact.y).max()))
    assert errors[0] > 1e-4
    assert errors[1] < 0.1 * errors[0]
    assert errors[2] < 1e-2 * errors[1]
    assert errors[3] < 1e-14
    assert system.with_newton_steps(5).with_newton_steps(None).kinds == system.kinds
