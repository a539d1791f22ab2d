"""Cardinal points and traced rays on an Axes."""

import numpy as np
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens


def test_cardinal_points_stand_where_they_are(designs: dict[str, Lens]) -> None:
    lens = designs["double_gauss"]
    points = lenstrace.first_order(lens)
    axes = Figure().add_subplot()
    assert lenstrace.plot_first_order(points, axes, wavelength=1) is axes
    drawn = sorted(float(np.asarray(line.get_xdata())[0]) for line in axes.lines)
    front = [points.front_focal_point[1], points.front_principal_plane[1], points.front_nodal_point[1]]
    length = sum(float(row.thickness) for row in lens.rows[:-1])
    rear = [points.rear_focal_point[1], points.rear_principal_plane[1], points.rear_nodal_point[1]]
    assert_allclose(drawn, sorted(float(z) for z in (*front, *(length + part for part in rear))), rtol=1e-12)
    # in air H and N coincide and share a label
    assert {text.get_text() for text in axes.texts} == {"F", "H, N", "F'", "H', N'"}


def test_an_afocal_lens_has_no_points_to_draw(designs: dict[str, Lens]) -> None:
    axes = lenstrace.plot_first_order(lenstrace.first_order(designs["negative_index_slab"]), Figure().add_subplot())
    assert not axes.lines


def test_rays_run_through_the_traced_points(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    path = lenstrace.trace(lens, field=np.array([0.0, 14.0, 75.0]), pupil=(0.0, 0.8))
    axes = Figure().add_subplot()
    assert lenstrace.plot_rays(path, lens, axes) is axes
    z = np.concatenate([[0, 0], np.cumsum([float(row.thickness) for row in lens.rows])])
    first, second, lost = axes.lines
    for line, ray in ((first, 0), (second, 1)):
        assert_allclose(line.get_ydata(), path.y[:, ray], atol=1e-12)
        assert_allclose(line.get_xdata(), z + np.asarray(path.z[:, ray]), atol=1e-12)
    assert len(np.asarray(lost.get_xdata())) == int(path.surface[-1, 2]) < len(z)
