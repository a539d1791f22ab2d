"""`lenstrace render`: pictures, figures, ends and mistakes."""

import json
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from lenstrace.__main__ import main

SCENES = Path(__file__).parents[2] / "designs" / "scenes"
BOX = str(SCENES / "cornell_box.toml")


def run(capsys, *words):
    status = main(["render", *words])
    said = capsys.readouterr()
    return status, said.out, said.err


def test_json_and_both_kinds_of_file(capsys, tmp_path):
    png, npy = tmp_path / "box.png", tmp_path / "box.npy"
    few = "--size", "24x16", "--spp", "4", "--depth", "3"
    status, out, _ = run(capsys, BOX, *few, "-o", str(png), "--json")
    keys = json.loads(out)
    assert status == 0
    assert {"width", "height", "samples", "rays", "seconds", "rays_per_second", "mean_rgb", "nan_pixels"} <= set(keys)
    assert (keys["width"], keys["height"], keys["samples"], keys["nan_pixels"]) == (24, 16, 4, 0)
    assert keys["compile_seconds"] >= 0
    assert keys["rays_per_second"] == pytest.approx(keys["rays"] / keys["seconds"])
    assert run(capsys, BOX, *few, "-o", str(npy))[0] == 0
    linear, shown = np.load(npy), matplotlib.image.imread(png)
    assert linear.dtype == np.float32
    assert linear.shape == (16, 24, 3) == shown[..., :3].shape
    np.testing.assert_allclose(linear.mean((0, 1)), keys["mean_rgb"], rtol=1e-6)
    # the curve of IEC 61966-2-1 between: of a pixel within the screen's reach
    inside = np.all((linear > 0.01) & (linear < 1), -1)
    curve = 1.055 * linear[inside] ** (1 / 2.4) - 0.055
    np.testing.assert_allclose(shown[..., :3][inside], curve, atol=0.6 / 255)


def test_what_is_printed(capsys):
    status, out, _ = run(capsys, BOX, "--size", "16x16", "--seconds", "0.2")
    assert status == 0
    for words in ("Cornell box: 16 x 16 pixels", "mean radiance (linear RGB)", "noise", "million rays in"):
        assert words in out


def test_a_part_is_that_of_the_whole(capsys, tmp_path):
    few = "--size", "24x16", "--spp", "2", "--depth", "3"
    for name, words in (("whole", ()), ("part", ("--crop", "6x4+10+8"))):
        assert run(capsys, BOX, *few, *words, "-o", str(tmp_path / f"{name}.npy"))[0] == 0
    whole, part = (np.load(tmp_path / f"{name}.npy") for name in ("whole", "part"))
    np.testing.assert_allclose(part, whole[8:12, 10:16], rtol=1e-5)


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_scene_that_ships_has_light_and_no_nan(path, capsys):
    status, out, _ = run(capsys, str(path), "--size", "8x6", "--spp", "2", "--json")
    keys = json.loads(out)
    assert status == 0
    assert keys["nan_pixels"] == 0
    assert min(keys["mean_rgb"]) > 0


def test_ctrl_c_writes_the_picture_so_far(capsys, tmp_path, monkeypatch):
    import lenstrace.cli.render as command

    def interrupting(*arguments, **more):
        def stop(now):
            if now.samples >= 2:
                raise KeyboardInterrupt

        return render(*arguments, **(more | {"progress": stop}))

    render = command.render
    monkeypatch.setattr(command, "render", interrupting)
    path = tmp_path / "box.npy"
    status, _, err = run(capsys, BOX, "--size", "16x16", "--spp", "64", "-o", str(path))
    assert status == 130
    assert "interrupted" in err
    assert np.isfinite(np.load(path)).all()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["nowhere.toml"], "nowhere.toml: cannot be read"),
        ([BOX, "--size", "big"], "--size: width and height in pixels, such as 640x480; got 'big'"),
        ([BOX, "--crop", "64x48"], "--crop: size and place in pixels, such as 64x48+100+20; got '64x48'"),
        ([BOX, "--size", "16x16", "--crop", "9x9+8+0"], "must lie in the 16x16 pixels"),
        ([BOX, "--spp", "0"], "samples must be a whole number, at least 1, got 0"),
        ([BOX, "-o", "box.bmp"], "suffix must be one of"),
        ([BOX, "-o", "/nowhere/box.png"], "not a folder"),
        ([BOX, "--noise", "-1"], "noise must be positive, got -1"),
    ],
)
def test_mistakes_are_one_line_and_status_2(capsys, words, says):
    status, out, err = run(capsys, *words)
    assert status == 2
    assert not out
    assert says in err
    assert err.count("\n") == 1
