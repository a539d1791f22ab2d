"""stub"""
from __future__ import annotations
import jax.numpy as jnp
from lenstrace.compute.pytree import pytree
@pytree
class Rectangle:
    half_x: object
    half_y: object
    def roots(self,p,d,on):
        t=-p[2]/jnp.where(d[2]==0,1,d[2])
        x=p[0]+t*d[0]; y=p[1]+t*d[1]
        return ((t,(d[2]!=0)&(jnp.abs(x)<=self.half_x)&(jnp.abs(y)<=self.half_y)&~on),)
    def normal(self,p): return 0*p[0],0*p[0],1+0*p[0]
    def touch(self,p,d,t): return t
    def area(self): return 4*self.half_x*self.half_y
    def place(self,u,v): return (2*u-1)*self.half_x,(2*v-1)*self.half_y,0*u
