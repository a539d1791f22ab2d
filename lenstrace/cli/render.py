"""`lenstrace render SCENE.toml -o OUT.png`: the picture of a scene."""

from __future__ import annotations

import argparse
import dataclasses
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, TextColumn
from rich.progress import Progress as Bar

from lenstrace.cli.output import number_text, print_json, print_notes
from lenstrace.errors import SceneError
from lenstrace.io.scene import load_scene
from lenstrace.plotting.picture import check_picture_target, save_picture
from lenstrace.scene.draws import Sampler
from lenstrace.scene.methods.method import METHODS
from lenstrace.scene.picture import Picture
from lenstrace.scene.render import Progress, render


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("render", help="a picture of a scene, also through a lens")
    parser.add_argument("scene", metavar="SCENE", help="a scene in TOML, such as designs/scenes/cornell_box.toml")
    parser.add_argument("-o", "--output", metavar="OUT", help="out.png, or linear radiance in 32 bits: out.npy")
    parser.add_argument("--method", choices=METHODS, help="how light is found (the scene's, or path)")
    parser.add_argument("--size", metavar="WxH", help="pixels (the scene's, or 256x256)")
    parser.add_argument("--crop", metavar="WxH+X+Y", help="only this part of the picture: W x H pixels from X, Y on")
    parser.add_argument("--spp", type=int, metavar="N", help="samples of each pixel (the scene's, or 16)")
    parser.add_argument("--seconds", type=float, metavar="S", help="as many samples as this time allows")
    parser.add_argument("--noise", type=float, metavar="T", help="until the noise, a share of the mean, is below T")
    parser.add_argument("--depth", type=int, metavar="D", help="longest chain of rays from the eye")
    parser.add_argument("--sampler", choices=[each.value for each in Sampler], help="of the random numbers")
    parser.add_argument("--key", type=int, default=0, help="of the random numbers; the same key, the same picture")
    parser.add_argument("--exposure", type=float, metavar="E", help="the picture times 2^E (the scene's, or 0)")
    parser.add_argument("--json", action="store_true", help="print one JSON object, numbers in full precision")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Render a scene, write the picture, and print what it cost and how sure it is."""
    if arguments.output:
        check_picture_target(arguments.output)
    view = load_scene(arguments.scene)
    settings = view.settings
    if arguments.size:
        settings = dataclasses.replace(settings, size=_size(arguments.size))
    if arguments.spp is None and (arguments.seconds is not None or arguments.noise is not None):
        settings = dataclasses.replace(settings, samples=None)
    given = {"method": arguments.method, "samples": arguments.spp, "depth": arguments.depth}
    given |= {"sampler": arguments.sampler, "exposure": arguments.exposure}
    settings = dataclasses.replace(settings, **{key: value for key, value in given.items() if value is not None})
    with bar() as report:
        picture = render(
            *(view.scene, view.camera),
            **settings.arguments(),
            crop=_crop(arguments.crop),
            key=arguments.key,
            seconds=arguments.seconds,
            noise=arguments.noise,
            progress=report,
        )
    if arguments.output:
        save_picture(picture, arguments.output, settings.exposure)
    if arguments.json:
        print_json(picture_keys(picture))
    else:
        _print(picture, view.scene.name or arguments.scene, settings.method)
        print_notes(picture.notes)
        if arguments.output:
            print(f"wrote {arguments.output}")
    if picture.interrupted:
        raise KeyboardInterrupt  # what was there by then has been printed and written


@contextmanager
def bar() -> Iterator[Callable[[Progress], None]]:
    """A function to call with what is done; the bar is shown where there is a terminal."""
    console = Console(stderr=True)
    columns = TextColumn("{task.fields[what]}"), BarColumn(), TextColumn("{task.fields[figures]}")
    with Bar(*columns, console=console, transient=True, disable=not console.is_terminal) as shown:
        task = shown.add_task("", total=None, what="compiling", figures="")

        def report(now: Progress) -> None:
            figures = (
                f"{now.samples:.0f} samples, {now.rays_per_second / 1e6:.1f} million rays/s, noise {now.noise:.2g}"
            )
            left = "" if now.seconds_left is None else f", {now.seconds_left:.0f} s left"
            shown.update(task, total=1, completed=now.done, what="tracing", figures=figures + left)

        yield report


def picture_keys(picture: Picture) -> dict[str, Any]:
    """The object that --json prints: linear radiance, seconds without compilation."""
    height, width, _ = picture.radiance.shape
    return {
        "width": width,
        "height": height,
        "samples": float(picture.samples.mean()),
        "rays": picture.rays,
        "seconds": picture.seconds,
        "compile_seconds": picture.compile_seconds,
        "rays_per_second": picture.rays_per_second,
        "mean_rgb": picture.mean_rgb,
        "noise": picture.noise,
        "nan_pixels": picture.nan_pixels,
    }


def _print(picture: Picture, name: str, method: str) -> None:
    height, width, _ = picture.radiance.shape
    mean = ", ".join(number_text(each, 5) for each in picture.mean_rgb)
    rays, rate = picture.rays / 1e6, picture.rays_per_second / 1e6
    print(f"{name}: {width} x {height} pixels, {picture.samples.mean():.4g} samples each, method {method}")
    print(f"mean radiance (linear RGB): {mean}")
    print(f"noise: {picture.noise:.3g} of the mean; pixels that are not a number: {picture.nan_pixels}")
    print(
        f"{rays:.1f} million rays in {picture.seconds:.2f} s, {rate:.1f} million a second, "
        f"after {picture.compile_seconds:.1f} s of compiling"
    )


def _crop(text: str | None) -> tuple[int, int, int, int] | None:
    """Left, top, width and height out of 64x48+100+20."""
    if text is None:
        return None
    found = re.fullmatch(r"(\d+)x(\d+)\+(\d+)\+(\d+)", text)
    if found is None:
        raise SceneError(f"--crop: size and place in pixels, such as 64x48+100+20; got {text!r}")
    width, height, left, top = map(int, found.groups())
    return left, top, width, height


def _size(text: str) -> tuple[int, int]:
    """Width and height out of 640x480."""
    width, cross, height = text.lower().partition("x")
    if not (cross and width.isdigit() and height.isdigit()):
        raise SceneError(f"--size: width and height in pixels, such as 640x480; got {text!r}")
    return int(width), int(height)
