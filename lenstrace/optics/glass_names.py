"""Glass names that are not those of a catalogue page: old names, plastics, crystals, and the page each means.

A page is a path in the refractiveindex.info database. Which of its several pages on one material is meant is
fixed here, because they differ: PMMA is 1.4906 or 1.4925 at the d line, depending on who measured it. Of a
birefringent crystal it is the ordinary ray, and the name says so: SAPPHIRE is SAPPHIRE-O. Sultanova's
plastics are one-term fits: the index holds to about 1e-3, the Abbe number to a tenth (PMMA: 53 there, 58
elsewhere).
"""

from __future__ import annotations

from typing import NamedTuple

MAKERS = (
    "SCHOTT",
    "HIKARI",
    "OHARA",
    "HOYA",
    "SUMITA",
    "CDGM",
    "LZOS",
    "CORNING",
    "CRYSTRAN",
    "AMI",
    "VITRON",
    "LIGHTPATH",
    "BARBERINI",
    "CARGILLE",
)
"""Who is asked first when a name stands in several catalogues and none is given.

HIKARI is second because it makes glasses under SCHOTT's old names with SCHOTT's old constants (SK16, SSK2,
LAK9), where the same name at CDGM or LZOS may be another glass: F2 is 1.6200 at SCHOTT and HIKARI, 1.6129 at
CDGM. ISUZU's colour filters are left out: their tables are noise in places (an index of -20 at 0.208 um).
"""


class Page(NamedTuple):
    """A page under another name."""

    name: str
    path: str
    absolute: bool = False
    """True where the page gives the index relative to vacuum."""


def plain(name: str) -> str:
    """A name without case, spaces, underscores, hyphens: "n-bk7", "N BK7" and "NBK7" are one glass.

    >>> plain("n-bk7"), plain("Fused Silica")
    ('NBK7', 'FUSEDSILICA')
    """
    return name.upper().translate(str.maketrans("", "", " \t_-"))


_SCHOTT_NOW_N = (
    *("BK7", "BK10", "BAK1", "BALF4", "BALF5", "BASF64", "BAF51", "BAF52", "FK5", "FK51", "KF9", "KZFS2"),
    *("LAF21", "LAF32", "LAF33", "LAF34", "LAK8", "LAK10", "LAK14", "LAK21", "LAK22", "LASF9", "LASF31"),
    *("LASF40", "LASF41", "LASF43", "LASF44", "LASF45", "LASF46", "PK51", "PSK3", "PSK53", "SF19", "SF56"),
    *("SF64", "SK5", "SK10", "SK11", "SK14", "SSK5", "ZK7"),
)
"""SCHOTT's old names that today stand in no catalogue, or for another glass (BK10 of LZOS), without the N- of
the successor, which has nearly the same index and dispersion."""

_PMMA = Page("PMMA", "organic/(C5H8O2)n - poly(methyl methacrylate)/nk/Szczurowski.yml")
_POLYCARBONATE = Page("POLYCARB", "organic/(C16H14O3)n - polycarbonate/nk/Sultanova.yml")
_POLYSTYRENE = Page("POLYSTYR", "organic/(C8H8)n - polystyrene/nk/Sultanova.yml")
_SAN = Page("SAN", "other/mixed organic/(C8H8)n-(C3H3N)m/nk/Sultanova.yml")
_E48R = Page("E48R", "other/commercial polymers/ZeonexE48R/nk/Sultanova.yml")
_NAS21 = Page("NAS-21", "other/commercial polymers/NAS-21/nk/Sultanova.yml")
_OPTOREZ = Page("OPTOREZ-1330", "other/commercial polymers/Optorez1330/nk/Sultanova.yml")
_SILICA = Page("SILICA", "main/SiO2/nk/Malitson.yml")
_CALCIUM_FLUORIDE = Page("CAF2", "main/CaF2/nk/Malitson.yml")
_MAGNESIUM_FLUORIDE = Page("MGF2-O", "main/MgF2/nk/Dodge-o.yml")
_BARIUM_FLUORIDE = Page("BAF2", "main/BaF2/nk/Malitson.yml")
_LITHIUM_FLUORIDE = Page("LIF", "main/LiF/nk/Li.yml")
_GERMANIUM = Page("GERMANIUM", "main/Ge/nk/Icenogle.yml")
_SILICON = Page("SILICON", "main/Si/nk/Salzberg.yml")
_ZINC_SELENIDE = Page("ZNSE", "main/ZnSe/nk/Connolly.yml")
_ZINC_SULFIDE = Page("ZNS", "main/ZnS/nk/Debenham.yml")
_SAPPHIRE = Page("SAPPHIRE-O", "main/Al2O3/nk/Malitson-o.yml")
_QUARTZ = Page("QUARTZ-O", "main/SiO2/nk/Ghosh-o.yml")
_DIAMOND = Page("DIAMOND", "main/C/nk/Peter.yml")
_WATER = Page("WATER", "main/H2O/nk/Daimon-20.0C.yml", absolute=True)

PAGES: dict[str, Page] = {
    **{name: Page(f"N-{name}", f"specs/schott/optical/N-{name}.yml") for name in _SCHOTT_NOW_N},
    **dict.fromkeys(("PMMA", "ACRYLIC", "PLEXIGLAS", "PLEXIGLASS", "PERSPEX"), _PMMA),
    **dict.fromkeys(("PC", "POLYCARB", "POLYCARBONATE"), _POLYCARBONATE),
    **dict.fromkeys(("PS", "POLYSTYR", "POLYSTYRENE", "STYRENE"), _POLYSTYRENE),
    "SAN": _SAN,
    **dict.fromkeys(("E48R", "ZEONEX", "ZEONEXE48R"), _E48R),
    "NAS21": _NAS21,
    **dict.fromkeys(("OPTOREZ", "OPTOREZ1330"), _OPTOREZ),
    **dict.fromkeys(("SILICA", "FSILICA", "FUSEDSILICA", "SIO2"), _SILICA),
    **dict.fromkeys(("CAF2", "FLUORITE"), _CALCIUM_FLUORIDE),
    **dict.fromkeys(("MGF2", "MGF2O"), _MAGNESIUM_FLUORIDE),
    "BAF2": _BARIUM_FLUORIDE,
    "LIF": _LITHIUM_FLUORIDE,
    "NACL": Page("NACL", "main/NaCl/nk/Li.yml"),
    "KBR": Page("KBR", "main/KBr/nk/Li.yml"),
    **dict.fromkeys(("GE", "GERMANIUM"), _GERMANIUM),
    **dict.fromkeys(("SI", "SILICON"), _SILICON),
    "ZNSE": _ZINC_SELENIDE,
    **dict.fromkeys(("ZNS", "CLEARTRAN"), _ZINC_SULFIDE),
    **dict.fromkeys(("SAPPHIRE", "SAPPHIREO", "AL2O3"), _SAPPHIRE),
    **dict.fromkeys(("QUARTZ", "QUARTZO"), _QUARTZ),
    "DIAMOND": _DIAMOND,
    **dict.fromkeys(("WATER", "H2O"), _WATER),
}
"""Plain name -> page. A catalogue given with the name (CDGM:BAF2, CRYSTRAN:DIAMOND) is looked in first."""
