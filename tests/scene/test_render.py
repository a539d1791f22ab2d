"""The render loop: its results, its errors, its ends; and Cornell's box against Mitsuba's."""

import sys
from pathlib import Path

import jax
import numpy as np
import pytest

from lenstrace.errors import AccuracyWarning, SceneError
from lenstrace.io.scene import load_scene
from lenstrace.optics.shapes.plane import Plane
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.scene.cameras.simple import Orthographic, Pinhole
from lenstrace.scene.cameras.view import View
from lenstrace.scene.lights.delta import PointLight
from lenstrace.scene.materials.diffuse import Diffuse
from lenstrace.scene.materials.mirror import Mirror
from lenstrace.scene.materials.rough_conductor import RoughConductor
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.render import render

CORNELL = load_scene(Path(__file__).parents[2] / "designs" / "scenes" / "cornell_box.toml")
# Made once with mitsuba 3.9.1, scalar_rgb, mitsuba.cornell_box(), box filter, 256 x 256, max_depth 8, no roulette.
MEAN = (0.24015, 0.14112, 0.05998)
VIEW = View((0.0, 1.0, 5.0), (0.0, 0.5, 0.0))
BALL = Scene(
    [Object(Plane(), Diffuse(0.5), rotation=(-90, 0, 0)), Object(Sphere(0.5), Diffuse(0.5), (0, 0.5, 0))],
    [PointLight((2, 4, 3), 30.0)],
)


def cornell(size, samples, **more):
    return render(CORNELL.scene, CORNELL.camera, size=(size, size), samples=samples, depth=8, **more)


@pytest.mark.parametrize("sampler", ["independent", "sobol"])
def test_cornell_box_is_as_bright_as_mitsubas(sampler):
    picture = cornell(256, 64, sampler=sampler)
    np.testing.assert_allclose(picture.mean_rgb, MEAN, atol=6e-4)
    assert picture.nan_pixels == 0
    assert np.all(picture.samples == 64)


def test_cornell_box_pixel_by_pixel():
    """z-values of the difference of both pictures are those of chance."""
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    keys = mitsuba.cornell_box()
    keys["sensor"]["film"] |= {"width": 32, "height": 32, "rfilter": {"type": "box"}}
    keys["integrator"]["rr_depth"] = 1000
    peer = mitsuba.load_dict(keys)
    theirs = np.array([np.array(mitsuba.render(peer, spp=64, seed=seed)) for seed in range(20)])
    error = theirs.std(0, ddof=1) / np.sqrt(len(theirs))
    ours = cornell(32, 2048)
    z = (ours.radiance - theirs.mean(0)) / np.sqrt(error**2 + ours.standard_error**2 + 1e-14)
    assert abs(z.mean()) < 0.1
    # of Student's distribution with 19 degrees of freedom, mixed with a normal one
    assert z.std() == pytest.approx(1, abs=0.08)
    assert np.abs(z).max() < 6


def test_the_same_key_gives_the_same_picture():
    first, again = (cornell(24, 4, key=5).radiance for _ in range(2))
    other = cornell(24, 4, key=6).radiance
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0
    random = jax.random.key(3)
    np.testing.assert_array_equal(cornell(24, 4, key=random).radiance, cornell(24, 4, key=random).radiance)


def test_the_standard_error_is_true():
    """The spread of pictures of other keys is what each of them says; it falls as 1 / sqrt(N)."""
    for samples in (16, 64):
        pictures = [cornell(16, samples, key=key) for key in range(24)]
        spread = np.std([picture.radiance for picture in pictures], axis=0, ddof=1)
        told = np.sqrt(np.mean([picture.standard_error**2 for picture in pictures], axis=0))
        # of each pixel that holds no edge of the lamp: of those one sample in many counts for all
        inner = (told > 1e-4) & (told < 0.5 * np.mean(pictures[0].radiance))
        assert np.mean(inner) > 0.5
        assert np.mean(spread[inner] ** 2 / told[inner] ** 2) == pytest.approx(1, abs=0.1)
    noise = [cornell(32, samples).noise for samples in (64, 256, 1024)]
    slope = np.polyfit(np.log([64, 256, 1024]), np.log(noise), 1)[0]
    assert slope == pytest.approx(-0.5, abs=0.03)


def test_float64_agrees_with_float32():
    """One ray to a pixel, no chance in what it meets: the same picture but for rounding."""
    pictures = [
        render(BALL, Pinhole(VIEW, 30.0), size=(40, 30), method="cast", samples=4, dtype=d) for d in ("f4", "f8")
    ]
    difference = np.abs(pictures[0].radiance - pictures[1].radiance)
    assert pictures[1].radiance.dtype == np.float64
    assert np.quantile(difference, 0.98) < 1e-5


def test_roulette_changes_no_mean():
    fixed = render(CORNELL.scene, CORNELL.camera, size=(16, 16), samples=2048, depth=64)
    by_chance = render(CORNELL.scene, CORNELL.camera, size=(16, 16), samples=2048, key=8)
    assert by_chance.rays < 0.8 * fixed.rays
    error = np.sqrt(np.mean(fixed.standard_error**2 + by_chance.standard_error**2, axis=(0, 1))) / 16
    assert np.all(np.abs(by_chance.mean_rgb - fixed.mean_rgb) < 4 * error)


@pytest.mark.parametrize(("method", "rays"), [("cast", 2), ("whitted", 2), ("distributed", 2), ("path", 3)])
def test_every_method_needs_as_many_rays_as_it_says(method, rays):
    """A lit floor: one ray from the eye, one to the light; a walk of two segments goes on by one."""
    scene = Scene(BALL.objects[:1], BALL.lights)
    eye = Orthographic(View((0, 3, 0), (0, 0, 0), (0, 0, 1)), 2.0)
    picture = render(scene, eye, size=(20, 10), method=method, samples=3, depth=2)
    assert picture.rays == 200 * 3 * rays
    assert picture.radiance.shape == (10, 20, 3)
    assert np.all(np.isfinite(picture.radiance))


def test_work_ends_by_time_by_noise_and_by_ctrl_c():
    timed = cornell(16, None, seconds=0.3)
    assert 0.3 <= timed.seconds < 5
    fine = cornell(16, None, noise=0.05)
    assert fine.noise <= 0.05
    assert cornell(16, 4096, noise=0.5).samples.max() < 4096

    def stop(now):
        if now.samples >= 8:
            raise KeyboardInterrupt

    stopped = cornell(16, 64, progress=stop)
    assert stopped.interrupted
    assert stopped.samples.max() == 8
    assert np.all(np.isfinite(stopped.radiance))


def test_many_pixels_are_cut_into_batches_without_a_seam(monkeypatch):
    whole = cornell(100, 2).radiance
    monkeypatch.setattr(sys.modules["lenstrace.scene.render"], "BATCH", 4096)
    np.testing.assert_array_equal(cornell(100, 2).radiance, whole)


def test_no_light_is_said():
    with pytest.warns(AccuracyWarning, match="no light"):
        picture = render(Scene(BALL.objects), Pinhole(VIEW, 30.0), size=(8, 8), samples=1)
    assert not picture.radiance.any()
    assert "no light" in picture.notes[0]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Scene([]), "at least one"),
        (lambda: Scene([Object(Sphere(0.5), Diffuse(1.2))]), "object 1: material: Diffuse: albedo must be from 0 to 1"),
        (lambda: Scene([Object(Sphere(-1.0), Diffuse(0.5))]), "Sphere: radius must be positive, got -1"),
        (
            lambda: Scene([Object(Sphere(1.0), RoughConductor(roughness=-0.1), name="pot")]),
            "object 1 \\(pot\\).*roughness",
        ),
        (lambda: Scene([Object("ball", Diffuse(0.5))]), "shape: must be one of Sphere"),
        (lambda: Scene([Object(Sphere(1.0), "red")]), "material: must be one of Diffuse"),
        (lambda: Scene([Object(Sphere(1.0), Diffuse(0.5), (0, 0))]), "position: must be three numbers"),
        (lambda: Scene([Object(Sphere(float("nan")), Diffuse(0.5))]), "must be finite"),
        (lambda: Scene(BALL.objects, ["sun"]), "light 1: must be one of PointLight"),
        (lambda: Scene(BALL.objects, environment=np.zeros((3, 4))), "environment"),
        (lambda: Scene(BALL.objects, environment=-1.0), "environment.*negative"),
        (lambda: Scene([Object(Plane(), Diffuse(0.5), emission=1.0)]), "emission of a Plane"),
    ],
)
def test_a_scene_that_cannot_be_is_refused_in_one_line(make, words):
    with pytest.raises(SceneError, match=words):
        render(make(), Pinhole(VIEW, 30.0), size=(8, 8), samples=1)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"size": (0, 4)}, "size"),
        ({"samples": 0}, "samples"),
        ({"method": "photon"}, "unknown 'photon'"),
        ({"depth": 0}, "depth"),
        ({"threshold": 2.0}, "threshold"),
        ({"sampler": "halton"}, "sampler"),
        ({"seconds": -1.0}, "seconds"),
        ({"noise": 0.0}, "noise"),
    ],
)
def test_what_cannot_be_rendered_is_refused(more, words):
    with pytest.raises(SceneError, match=words):
        render(BALL, Pinhole(VIEW, 30.0), **({"size": (8, 8), "samples": 1} | more))


def test_a_camera_in_a_solid_is_refused():
    with pytest.raises(SceneError, match="inside object 2"):
        render(BALL, Pinhole(View((0.0, 0.5, 0.0), (0.0, 0.5, 3.0)), 30.0), size=(8, 8), samples=1)
    with pytest.raises(SceneError, match="Pinhole: field_of_view must be between 0 and 180 degrees"):
        render(BALL, Pinhole(VIEW, -3.0), size=(8, 8), samples=1)


def test_motion_is_smeared_over_its_way():
    """A square that moves by its own width while the shutter is open: a triangle of brightness."""
    square = Object(Rectangle(0.5, 0.5), Diffuse(0.0), emission=1.0, motion=(1.0, 0.0, 0.0))
    camera = Orthographic(View((0.0, 0.0, 5.0), (0.0, 0.0, 0.0)), 4.0)
    picture = render(Scene([square]), camera, size=(32, 32), method="distributed", samples=4000)
    x = (np.arange(32) + 0.5) / 32 * 4 - 2
    expected = np.clip(1 - np.abs(x), 0, None)
    # a pixel's mean of the triangle
    np.testing.assert_allclose(picture.radiance[16, :, 0], expected, atol=0.04)


def test_nothing_is_compiled_for_other_numbers():
    one = Object(Sphere(0.5), Mirror(0.5), (0, 0.5, 0))
    scenes = [Scene([BALL.objects[0], one], BALL.lights)]
    scenes.append(
        Scene([BALL.objects[0], Object(Sphere(0.3), Mirror(0.9), (0.2, 0.5, 0))], [PointLight((1, 4, 3), 9.0)])
    )
    for scene in scenes:
        last = render(scene, Pinhole(VIEW, 30.0), size=(30, 30), samples=2, depth=5)
    assert last.compile_seconds < 0.1
    again = render(scenes[0], Pinhole(VIEW, 50.0), size=(40, 20), samples=3, depth=9, key=4)
    assert again.compile_seconds < 0.1


def test_a_part_of_a_picture_is_that_of_the_whole() -> None:
    whole = render(BALL, Pinhole(VIEW, 30.0), size=(40, 30), samples=2, key=3)
    part = render(BALL, Pinhole(VIEW, 30.0), size=(40, 30), crop=(11, 7, 13, 9), samples=2, key=3)
    np.testing.assert_allclose(part.radiance, whole.radiance[7:16, 11:24], rtol=1e-5, atol=1e-6)
    with pytest.raises(SceneError, match=r"crop: left, top, width, height must lie in the 40x30 pixels, got \(30, 0,"):
        render(BALL, Pinhole(VIEW, 30.0), size=(40, 30), crop=(30, 0, 11, 5), samples=2)
