"""Pictures of scenes: as files, and on axes."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lenstrace.errors import SceneError
from lenstrace.plotting.files import check_folder, written
from lenstrace.scene.picture import Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINEAR, SCREEN = ".npy", (".png", ".jpg", ".tif")


def plot_picture(picture: Picture, axes: Axes, exposure: float = 0.0) -> Axes:
    """What a screen shows of a picture; radiance times 2^exposure. Axes in pixels."""
    axes.imshow(picture.screen(exposure), interpolation="nearest")
    axes.set_xlabel("pixels")
    axes.set_ylabel("pixels")
    return axes


def save_picture(picture: Picture, path: str | os.PathLike[str], exposure: float = 0.0) -> None:
    """Write a picture: `.npy` holds linear radiance, (H, W, 3) of 32 bits, the others what a screen shows.

    SceneError for another suffix, or where the file cannot be written; nothing is left behind then.
    """
    check_picture_target(path)
    suffix = Path(path).suffix.lower()

    def write(partial: Path) -> None:
        if suffix == LINEAR:
            with partial.open("wb") as file:
                np.save(file, picture.radiance.astype(np.float32))
        else:
            from PIL import Image

            Image.fromarray(picture.screen(exposure)).save(
                partial, format=suffix[1:].replace("jpg", "jpeg").replace("tif", "tiff")
            )

    written(path, write)


def check_picture_target(path: str | os.PathLike[str]) -> None:
    """SceneError where a picture cannot be written there. To ask before a long computation."""
    suffix = Path(path).suffix
    if suffix.lower() not in (LINEAR, *SCREEN):
        raise SceneError(f"{path}: the suffix must be one of {', '.join((LINEAR, *SCREEN))}, got {suffix or 'none'}")
    check_folder(path)
