"""Media: shapes, exact nodes, ranges and their messages, the Abbe-number model, gradients."""

import jax
import numpy as np
import pytest

from lenstrace.errors import MediumError, WavelengthError
from lenstrace.optics.interpolation import interpolate
from lenstrace.optics.media import (
    AIR,
    LINE_C,
    LINE_D,
    LINE_F,
    LINE_G,
    AbbeModel,
    Constant,
    Formula,
    Medium,
    Table,
)

N_BK7 = Formula(
    number=2,
    coefficients=(0.0, 1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653),
    range_um=(0.3, 2.5),
    name="N-BK7",
)
TABLE = Table((0.4861, 0.5876, 0.6563), (1.63, 1.62, 1.61))
MEDIA = [AIR, Constant(1.5), AbbeModel(1.62, 60.3), TABLE, N_BK7]


class TestEveryMedium:
    @pytest.mark.parametrize("medium", MEDIA, ids=lambda medium: medium.name)
    def test_shapes(self, medium: Medium) -> None:
        assert np.shape(medium.index(0.55)) == ()
        assert np.shape(medium.index([0.5, 0.55, 0.6])) == (3,)
        assert np.shape(medium.index(np.full((2, 2), 0.55))) == (2, 2)
        assert medium.index([0.5, 0.55])[1] == medium.index(0.55)

    @pytest.mark.parametrize("medium", MEDIA, ids=lambda medium: medium.name)
    @pytest.mark.parametrize("wrong", [0.0, -0.55, float("nan"), float("inf"), [0.55, float("nan")]])
    def test_no_wavelength(self, medium: Medium, wrong: float | list[float]) -> None:
        with pytest.raises(WavelengthError, match="positive and finite"):
            medium.index(wrong)

    @pytest.mark.parametrize("medium", [AbbeModel(1.62, 60.3), TABLE, N_BK7], ids=lambda medium: medium.name)
    def test_nanometres(self, medium: Medium) -> None:
        with pytest.raises(WavelengthError, match=r"550 looks like nanometres: write 0\.55 \(micrometres\)"):
            medium.index([0.55, 550.0])

    def test_names(self) -> None:
        assert [medium.name for medium in MEDIA] == ["air", "n=1.5", "nd=1.62 vd=60.3", "table", "N-BK7"]

    def test_air_is_one(self) -> None:
        assert np.all(AIR.index([0.2, 0.55, 12.0]) == 1.0)

    def test_range_message(self) -> None:
        with pytest.raises(
            WavelengthError, match=r"^N-BK7: wavelength 0\.2 um is outside its range, 0\.3 to 2\.5 um; "
        ):
            N_BK7.index(0.2)

    def test_rounding_at_the_ends(self) -> None:
        N_BK7.index([0.3 * (1 - 1e-12), 2.5 * (1 + 1e-12)])
        assert TABLE.index(0.6563 * (1 + 1e-12)) == 1.61
        with pytest.raises(WavelengthError):
            N_BK7.index(0.3 * (1 - 1e-8))

    def test_static_media_compare_by_value(self) -> None:
        again = Formula(2, N_BK7.coefficients, (0.3, 2.5), "N-BK7")
        assert again == N_BK7
        assert len({again, N_BK7, TABLE, Table(TABLE.um, TABLE.n)}) == 2


class TestFormula:
    def test_a_constant_term_alone_keeps_the_shape(self) -> None:
        for number in (1, 2, 3, 4, 5, 6):
            assert np.shape(Formula(number, (2.25,), (0.3, 2.0)).index([0.5, 0.6])) == (2,)

    def test_unknown_number(self) -> None:
        with pytest.raises(MediumError, match="numbered 1 to 9, got 10"):
            Formula(10, (1.0,), (0.3, 1.0))

    def test_no_real_index(self) -> None:
        with pytest.raises(MediumError, match="no real index"):
            Formula(1, (-3.0,), (0.3, 1.0)).index(0.5)

    def test_absolute_is_divided_by_air(self) -> None:
        vacuum = Formula(5, (1.0,), (0.3, 1.6), absolute=True)
        assert vacuum.index(0.5875618) == pytest.approx(1 / 1.0002725, abs=1e-7)


class TestTable:
    def test_nodes_are_exact(self) -> None:
        generator = np.random.default_rng(1)
        for count in (1, 2, 3, 4, 5, 6, 20):
            um = np.sort(generator.uniform(0.3, 2.0, count))
            n = 1.5 + 0.1 * generator.uniform(size=count)
            shuffled = generator.permutation(count)
            table = Table(tuple(um[shuffled]), tuple(n[shuffled]))
            assert np.all(table.index(um) == n)

    def test_never_overshoots(self) -> None:
        generator = np.random.default_rng(2)
        um = np.sort(generator.uniform(0.3, 2.0, 30))
        n = 1.5 + 0.1 * generator.uniform(size=30)
        between = np.linspace(um[:-1], um[1:], 40)
        got = Table(tuple(um), tuple(n)).index(between)
        assert np.all(got <= np.maximum(n[:-1], n[1:]) + 1e-15)
        assert np.all(got >= np.minimum(n[:-1], n[1:]) - 1e-15)

    @pytest.mark.parametrize(
        ("nodes", "worst"),
        [
            ((LINE_F, LINE_D, LINE_C), 2e-5),
            ((LINE_G, 0.5460740, 0.7065188), 5e-5),
            (np.arange(0.4, 1.05, 0.05), 5e-6),
        ],
    )
    def test_follows_a_glass(self, nodes: tuple[float, ...], worst: float) -> None:
        between = np.linspace(min(nodes), max(nodes), 301)
        table = Table(tuple(nodes), tuple(N_BK7.index(nodes)))
        assert np.max(np.abs(table.index(between) - N_BK7.index(between))) < worst

    def test_three_nodes_are_the_parabola(self) -> None:
        nodes, values = np.array([1.0, 2.0, 4.0]), np.array([1.0, 2.0, 3.5])
        at = np.linspace(1, 4, 13)
        assert interpolate(nodes, values, at) == pytest.approx(np.polyval(np.polyfit(nodes, values, 2), at), abs=1e-14)

    def test_two_nodes_are_a_line_in_inverse_squares(self) -> None:
        table = Table((0.5, 0.6), (1.6, 1.5))
        assert table.index(((0.5**-2 + 0.6**-2) / 2) ** -0.5) == pytest.approx(1.55, abs=1e-15)

    def test_one_node(self) -> None:
        assert Table((0.6328,), (1.5,)).index(0.6328) == 1.5
        with pytest.raises(WavelengthError):
            Table((0.6328,), (1.5,)).index(0.633)

    @pytest.mark.parametrize(
        ("um", "n", "message"),
        [
            ((), (), "at least one"),
            ((0.5, 0.6), (1.5,), "got 1 n and 2 um"),
            ((0.5, 0.5), (1.5, 1.6), "stand once"),
        ],
    )
    def test_mistakes(self, um: tuple[float, ...], n: tuple[float, ...], message: str) -> None:
        with pytest.raises(MediumError, match=message):
            Table(um, n)


class TestAbbeModel:
    @pytest.mark.parametrize(("nd", "vd"), [(1.5168, 64.17), (1.62, 60.3), (1.8, 25.4), (1.44, 95.0)])
    def test_holds_its_numbers(self, nd: float, vd: float) -> None:
        g, f, d, c = AbbeModel(nd, vd).index([LINE_G, LINE_F, LINE_D, LINE_C])
        assert d == nd
        assert f - c == pytest.approx((nd - 1) / vd, abs=5e-16)
        assert (g - f) / (f - c) == pytest.approx(0.6438 - 0.001682 * vd, abs=1e-13)

    def test_close_to_a_normal_glass(self) -> None:
        wavelength = np.linspace(0.42, 0.70, 57)
        error = AbbeModel(1.5168, 64.1673).index(wavelength) - N_BK7.index(wavelength)
        assert np.max(np.abs(error)) < 1e-4

    def test_gradient(self) -> None:
        def red_index(nd: jax.Array, vd: jax.Array) -> jax.Array:
            return AbbeModel(nd, vd).index(LINE_C)

        with jax.enable_x64(True):
            by_nd, by_vd = jax.jit(jax.grad(red_index, argnums=(0, 1)))(1.62, 60.3)
        step = 1e-4
        assert float(by_nd) == pytest.approx((red_index(1.62 + step, 60.3) - red_index(1.62, 60.3)) / step)
        central = (red_index(1.62, 60.3 + step) - red_index(1.62, 60.3 - step)) / (2 * step)
        assert float(by_vd) == pytest.approx(central, rel=1e-6)


def test_constant_is_a_leaf() -> None:
    with jax.enable_x64(True):
        gradient = jax.grad(lambda medium: medium.index([0.5, 0.6]).sum())(Constant(1.5))
    assert float(gradient.n) == 2.0
