"""The scene tracer: whatever is hit first, and pictures of it.

`from lenstrace.scene import Scene, Object, Sphere, Diffuse` gives the words that a scene is said in.
"""

from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.asphere_cap import AsphereCap
from lenstrace.optics.shapes.box import Box
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.conic_cap import ConicCap
from lenstrace.optics.shapes.cylinder import Cylinder
from lenstrace.optics.shapes.disk import Disk
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.optics.shapes.plane import Plane
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.optics.shapes.torus import Torus
from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.scene.cameras.lens_camera import lens_camera
from lenstrace.scene.cameras.simple import Orthographic, Pinhole, ThinLens
from lenstrace.scene.cameras.through_lens import LensCamera
from lenstrace.scene.cameras.view import View
from lenstrace.scene.lights.delta import DistantLight, PointLight
from lenstrace.scene.materials.blinn_phong import BlinnPhong
from lenstrace.scene.materials.dielectric import Dielectric
from lenstrace.scene.materials.diffuse import Diffuse
from lenstrace.scene.materials.mirror import Mirror
from lenstrace.scene.materials.rough_conductor import RoughConductor
from lenstrace.scene.materials.rough_dielectric import RoughDielectric
from lenstrace.scene.materials.texture import Checker
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.mesh_file import load_mesh
from lenstrace.scene.mesh_formula import Parametric, formula_mesh
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.picture import Picture
from lenstrace.scene.pixels import radiance
from lenstrace.scene.render import Progress, render
from lenstrace.scene.surfaces import asphere, conic, implicit

__all__ = [
    "Asphere",
    "AsphereCap",
    "BlinnPhong",
    "Box",
    "Checker",
    "Conic",
    "ConicCap",
    "Cylinder",
    "Dielectric",
    "Diffuse",
    "Disk",
    "DistantLight",
    "Implicit",
    "LensCamera",
    "Mesh",
    "Mirror",
    "Object",
    "Orthographic",
    "Parametric",
    "Picture",
    "Pinhole",
    "Plane",
    "PointLight",
    "Progress",
    "Rectangle",
    "RoughConductor",
    "RoughDielectric",
    "Scene",
    "Sphere",
    "ThinLens",
    "Torus",
    "Triangle",
    "View",
    "asphere",
    "conic",
    "formula_mesh",
    "implicit",
    "lens_camera",
    "load_mesh",
    "radiance",
    "render",
]
