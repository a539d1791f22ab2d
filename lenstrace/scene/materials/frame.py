"""stub"""
from __future__ import annotations
import jax.numpy as jnp
def axes(n):
    s=jnp.where(n[2]>=0,1,-1).astype(n[2].dtype); a=-1/(s+n[2]); b=n[0]*n[1]*a
    return (1+s*n[0]*n[0]*a,s*b,-s*n[0]),(b,s+n[1]*n[1]*a,-n[1])
def to_local(n,d):
    a,b=axes(n)
    from lenstrace.optics.vectors import dot
    return dot(a,d),dot(b,d),dot(n,d)
def to_global(n,d):
    a,b=axes(n)
    return tuple(d[0]*a[i]+d[1]*b[i]+d[2]*n[i] for i in range(3))
