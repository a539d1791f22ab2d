"""stub"""
from __future__ import annotations
import jax.numpy as jnp
from lenstrace.compute.pytree import pytree
@pytree
class Diffuse:
    sends = (False, False)
    disperses = False
    albedo: object
    def sample(self, place, outgoing, u, v, w):
        r=jnp.sqrt(u); t=2*jnp.pi*v; z=jnp.sqrt(1-u)
        return (r*jnp.cos(t),r*jnp.sin(t),z),tuple(a+0*u for a in self.albedo),z/jnp.pi
    def evaluate(self, place, outgoing, incoming):
        c=jnp.maximum(incoming[2],0)/jnp.pi
        return tuple(a*c for a in self.albedo),c
