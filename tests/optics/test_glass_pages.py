"""Pages of the database: every one can be read, air or vacuum, and the Abbe-number model over SCHOTT's."""

import numpy as np
import pytest

from lenstrace.optics.glass_names import MAKERS
from lenstrace.optics.glass_pages import data_folder, page_name, page_paths, read_page
from lenstrace.optics.glasses import glass
from lenstrace.optics.media import LINE_C, LINE_D, LINE_F, AbbeModel, Air, Formula, Table


class TestAirOrVacuum:
    """The evidence for what the docstring of `glasses` says."""

    def test_formulas_give_the_printed_nd(self) -> None:
        """An index relative to vacuum would miss the makers' nd, which is in air, by 2.7e-4 n."""
        printed = {maker: 0 for maker in ("SCHOTT", "HIKARI", "OHARA", "HOYA", "CDGM", "SUMITA")}
        for _, maker, path in _pages():
            if maker in printed and "/optical/" in path:
                text = (data_folder() / path).read_text(encoding="utf-8")
                nd = float(text.partition("\n    nd: ")[2].partition("\n")[0])
                assert read_page(path, page_name(path), maker).index(LINE_D) == pytest.approx(nd, abs=4e-5)
                printed[maker] += 1
        assert printed == {
            "SCHOTT": 156,
            "HIKARI": 363,
            "OHARA": 410,
            "HOYA": 190,
            "CDGM": 314,
            "SUMITA": 176,
        }

    @pytest.mark.parametrize(("paper", "maker"), [("SILICA", "LITHOSIL-Q"), ("CAF2", "LITHOTEC-CAF2")])
    def test_malitson_is_in_air(self, paper: str, maker: str) -> None:
        assert glass(paper).index(LINE_D) == pytest.approx(glass(maker, "SCHOTT").index(LINE_D), abs=3e-5)

    def test_water_is_in_vacuum(self) -> None:
        """Before the division, the page is the IAPWS formulation (R9-97), which is relative to vacuum."""
        wavelength = np.linspace(0.4, 0.8, 9)
        absolute = Formula(*_without_division(glass("WATER"))).index(wavelength)
        assert absolute == pytest.approx(_iapws_water(293.15, 998.2071, wavelength), abs=1.5e-5)
        divided = glass("WATER").index(wavelength)
        assert absolute - divided == pytest.approx(np.full(9, 2.73e-4 * 1.335), rel=0.03)


def test_every_page_can_be_read() -> None:
    """Every formula and table gives the index of something transparent over its whole range."""
    count = 0
    for name, maker, path in _pages():
        medium = read_page(path, page_name(path), maker)
        low, high = medium.range_um
        n = medium.index(np.linspace(low, high, 7))
        # Germanium reaches 4.2; nothing transparent is below 1.3.
        assert np.all((n > 1.3) & (n < 4.3)), (name, maker)
        assert hash(medium) == hash(read_page(path, page_name(path), maker))
        count += 1
    assert count > 1700
    assert {maker for _, maker, _ in _pages()} == set(MAKERS)


def test_error_of_the_abbe_model_over_schott() -> None:
    """The figures in the docstring of `AbbeModel`."""
    errors = []
    for _, maker, path in _pages():
        if maker == "SCHOTT" and "/optical/" in path:
            medium = read_page(path, page_name(path), maker)
            f, d, c = medium.index([LINE_F, LINE_D, LINE_C])
            wavelength = np.arange(0.42, 0.7001, 0.005)
            wavelength = wavelength[wavelength >= medium.range_um[0]]
            errors.append(AbbeModel(d, (d - 1) / (f - c)).index(wavelength) - medium.index(wavelength))
    assert len(errors) == 156
    assert np.sqrt(np.mean(np.concatenate(errors) ** 2)) == pytest.approx(1.3e-4, abs=5e-6)
    assert np.max(np.abs(np.concatenate(errors))) == pytest.approx(2.8e-3, abs=5e-5)


def _pages() -> list[tuple[str, str, str]]:
    """Name, maker, path of every page."""
    return [(key, maker, path) for key, makers in page_paths().items() for maker, path in makers.items()]


def _without_division(medium: Formula | Table | Air) -> tuple[int, tuple[float, ...], tuple[float, float]]:
    assert isinstance(medium, Formula)
    assert medium.absolute
    return medium.number, medium.coefficients, medium.range_um


def _iapws_water(temperature: float, density: float, wavelength: np.ndarray) -> np.ndarray:
    """IAPWS R9-97: kelvin, kg/m^3, um."""
    t, r, w2 = temperature / 273.15, density / 1000.0, (wavelength / 0.589) ** 2
    refraction = r * (
        0.244257733
        + 9.74634476e-3 * r
        - 3.73234996e-3 * t
        + 2.68678472e-4 * w2 * t
        + 1.58920570e-3 / w2
        + 2.45934259e-3 / (w2 - 0.2292020**2)
        + 0.900704920 / (w2 - 5.432937**2)
        - 1.66626219e-2 * r**2
    )
    return np.sqrt((1 + 2 * refraction) / (1 - refraction))
