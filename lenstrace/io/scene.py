"""A scene as a file: what stands in it, what lights it, from where it is seen, and how it is to be rendered.

    name = "A ball on a floor"
    [camera]
    kind = "pinhole"
    position = [0, 1, 5]
    target = [0, 0.5, 0]
    field_of_view = 40
    [render]
    method = "path"
    samples = 64
    [materials]
    grey = { kind = "diffuse", albedo = [0.5, 0.5, 0.5] }
    [[objects]]
    shape = { kind = "sphere", radius = 0.5 }
    material = "grey"
    position = [0, 0.5, 0]
    [[lights]]
    kind = "point_light"
    position = [2, 4, 3]
    intensity = [30, 30, 30]

A kind is the name of its class in `lenstrace.scene`, in small letters, and the other keys are its fields; what is said
otherwise stands in `scene_kinds.py`.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from lenstrace.errors import SceneError
from lenstrace.io.kinds import Kinds, fields_of, made, near, tupled, unknown
from lenstrace.io.native import keys_in, read_with
from lenstrace.io.scene_kinds import LIGHT_KINDS, MATERIAL_KINDS, TEXTURE_KINDS, camera_kinds, shape_kinds
from lenstrace.scene.number_rules import Rule, not_negative, number, obeyed, size, whole
from lenstrace.scene.objects import Object, Scene

SECTIONS = ("name", "source", "camera", "render", "materials", "objects", "lights", "environment")


def text(value: Any) -> str:
    """Words."""
    if not isinstance(value, str):
        raise SceneError(f"must be text in quotes, got {value!r}")
    return value


SETTING_RULES: Mapping[str, Rule] = {
    **{"size": size, "samples": whole, "depth": whole},
    **{"threshold": not_negative, "exposure": number, "method": text, "sampler": text},
}


@dataclasses.dataclass(frozen=True)
class Settings:
    """How a scene is to be rendered, see `render`; exposure: of the picture on a screen."""

    size: tuple[int, int] = (256, 256)
    method: str = "path"
    samples: int | None = None
    depth: int | None = None
    threshold: float | None = None
    sampler: str = "independent"
    exposure: float = 0.0

    def arguments(self) -> dict[str, Any]:
        """For `render`."""
        return {key: value for key, value in dataclasses.asdict(self).items() if key != "exposure"}


@dataclasses.dataclass(frozen=True)
class Setup:
    """A scene, from where it is seen, and how it is to be rendered."""

    scene: Scene
    camera: Any
    settings: Settings


def load_scene(path: str | os.PathLike[str]) -> Setup:
    """Read a scene. SceneError (or another LensTraceError) says file, where, what, got, what to do."""
    folder = os.path.dirname(os.path.abspath(path))
    return read_with(path, lambda text: scene_from_keys(keys_in(text), folder))


def scene_from_keys(keys: Mapping[str, Any], folder: str) -> Setup:
    """A scene out of the keys of a file; other files that it names are looked for in `folder`."""
    unknown("the file", keys, SECTIONS, SceneError)
    named = {
        name: made(f"materials: {name}", entry, MATERIAL_KINDS, SceneError, TEXTURE_KINDS)
        for name, entry in _table(keys, "materials").items()
    }
    shapes = shape_kinds(folder)
    scene = Scene(
        [_object(f"objects {i}", entry, named, shapes) for i, entry in enumerate(_tables(keys, "objects"), 1)],
        [made(f"lights {i}", entry, LIGHT_KINDS, SceneError) for i, entry in enumerate(_tables(keys, "lights"), 1)],
        _environment(_table(keys, "environment"), folder) if "environment" in keys else None,
        obeyed("name", text, keys.get("name", "")),
    )
    if "camera" not in keys:
        raise SceneError("camera is missing; write [camera] with a kind, a position and a target")
    camera = made("camera", _table(keys, "camera"), camera_kinds(folder), SceneError)
    return Setup(scene, camera, _settings(_table(keys, "render")))


def _settings(entry: Mapping[str, Any]) -> Settings:
    """Of [render], each of the type that is meant."""
    given = fields_of("render", entry, Settings, SceneError)
    return Settings(**{key: obeyed(f"render: {key}", SETTING_RULES[key], value) for key, value in given.items()})


def _object(where: str, entry: Mapping[str, Any], named: Mapping[str, Any], shapes: Kinds) -> Object:
    """One of [[objects]]; its material a name or a table."""
    given = fields_of(where, entry, Object, SceneError)
    material = entry["material"]
    if isinstance(material, str):
        if material not in named:
            raise SceneError(f"{where}: material {material!r} is not in [materials]; {near(material, list(named))}")
        given["material"] = named[material]
    else:
        given["material"] = made(f"{where}: material", material, MATERIAL_KINDS, SceneError, TEXTURE_KINDS)
    given["shape"] = made(f"{where}: shape", entry["shape"], shapes, SceneError)
    return Object(**given)


def _environment(entry: Mapping[str, Any], folder: str) -> Any:
    """Of [environment]: one radiance, or the file of a map."""
    unknown("environment", entry, ("radiance", "map"), SceneError)
    if len(entry) != 1:
        raise SceneError('environment: give radiance = [r, g, b] or map = "file.npy"')
    if "radiance" in entry:
        return tupled(entry["radiance"])
    path = os.path.join(folder, obeyed("environment: map", text, entry["map"]))
    try:
        return np.load(path, allow_pickle=False)
    except (OSError, ValueError) as error:
        raise SceneError(f"environment: map {path} cannot be read: {error}") from None


def _table(keys: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """A section, empty where the file has none."""
    if not isinstance(keys.get(name, {}), Mapping):
        raise SceneError(f"{name} must be a section, [{name}], got {keys[name]!r}")
    return keys.get(name, {})


def _tables(keys: Mapping[str, Any], name: str) -> list[Mapping[str, Any]]:
    """A list of tables, empty where the file has none."""
    entries = keys.get(name, [])
    if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
        raise SceneError(f"{name} must be a list of tables, [[{name}]], got {entries!r}")
    return entries
