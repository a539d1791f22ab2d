"""Every prescription in designs/: its source, and the figures published of it."""

import numpy as np
import pytest

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.published import published_figures

NAMES = sorted(
    [
        "afocal_expander",
        "ball_lens",
        "cartesian_oval",
        "cemented_doublet",
        "cooke_triplet",
        "double_gauss",
        "fisheye",
        "fold_mirror",
        "hubble",
        "hyperbolic_singlet",
        "immersion_objective",
        "infrared_germanium_silicon",
        "negative_index_slab",
        "phone_lens",
        "plano_convex_curved_first",
        "plano_convex_plane_first",
        "relay_one_to_one",
        "singlet_rear_stop",
        "tessar",
        "thick_meniscus",
        "three_mirror_telescope",
        "triplet_to_optimize",
    ]
)


def test_these_are_all(designs: dict[str, Lens]) -> None:
    assert sorted(designs) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_published_figures_come_out(name: str, designs: dict[str, Lens]) -> None:
    lens = designs[name]
    assert lens.source
    figures = published_figures(lens)
    assert figures
    assert all(figure.agrees for figure in figures), figures


def test_a_wrong_lens_does_not_agree(designs: dict[str, Lens]) -> None:
    bent = designs["cooke_triplet"].replace(surface=1, radius=22.1)
    assert not any(figure.agrees for figure in published_figures(bent))
    thick = designs["negative_index_slab"].replace(surface=1, thickness=2.001)
    assert not all(figure.agrees for figure in published_figures(thick))
    # with power left there is no angular magnification
    (expander,) = published_figures(designs["afocal_expander"].replace(surface=2, thickness=250.1))
    assert np.isnan(expander.computed)
    assert not expander.agrees


def test_slab_focuses_inside_and_takes_no_optical_path(designs: dict[str, Lens]) -> None:
    slab = designs["negative_index_slab"]
    # launched 0.7 mm behind the source: the path from there is minus the path from the source
    path = lenstrace.trace(slab, field=0.0, pupil=(0.0, 1.0))
    from_source = 0.7 / float(path.n[0])
    assert abs(float(path.opl[-1]) + from_source) < 1e-14
    # inside, 0.7 mm behind the front face, every ray crosses the axis
    inside = float(path.y[1] + 0.7 * path.m[1] / path.n[1])
    assert abs(inside) < 1e-14
