"""Every prescription in designs/: its source, and the figures published of it."""

import pytest

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.published import published_figures

NAMES = sorted(
    [
        "cemented_doublet",
        "cooke_triplet",
        "double_gauss",
        "hubble",
        "negative_index_slab",
        "singlet_rear_stop",
        "tessar",
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


def test_slab_focuses_inside_and_takes_no_optical_path(designs: dict[str, Lens]) -> None:
    slab = designs["negative_index_slab"]
    # launched 0.7 mm behind the source: the path from there is minus the path from the source
    path = lenstrace.trace(slab, field=0.0, pupil=(0.0, 1.0))
    from_source = 0.7 / float(path.n[0])
    assert abs(float(path.opl[-1]) + from_source) < 1e-14
    # inside, 0.7 mm behind the front face, every ray crosses the axis
    inside = float(path.y[1] + 0.7 * path.m[1] / path.n[1])
    assert abs(inside) < 1e-14
