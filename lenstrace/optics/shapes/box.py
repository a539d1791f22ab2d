"""stub"""
from __future__ import annotations
import jax.numpy as jnp
from lenstrace.compute.pytree import pytree
@pytree
class Box:
    half_x: object
    half_y: object
    half_z: object
    def roots(self,p,d,on):
        h=(self.half_x,self.half_y,self.half_z); near=-jnp.inf; far=jnp.inf
        for i in range(3):
            inv=1/jnp.where(d[i]==0,1e-30,d[i]).astype(d[i].dtype)
            a=jnp.abs(inv)*h[i]; b=-p[i]*inv
            near=jnp.maximum(near,b-a); far=jnp.minimum(far,b+a)
        return ((near,(near<far)&~on),)
    def normal(self,p):
        h=(self.half_x,self.half_y,self.half_z)
        r=[jnp.abs(jnp.abs(a)-b) for a,b in zip(p,h)]
        m=jnp.minimum(jnp.minimum(*r[:2]),r[2])
        return tuple(jnp.where(b==m,jnp.sign(a),0) for a,b in zip(p,r))
    def touch(self,p,d,t): return t
