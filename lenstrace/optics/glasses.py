"""Glasses by name: "N-BK7", "SCHOTT:N-BK7", "BK7", "PMMA" -> a medium, offline.

The data are those of the refractiveindex.info database (CC0). Its pages do not say whether an index is
relative to air or to vacuum (but for five of VITRON's: air). The package's convention is air, so:

- the makers' pages are taken as they stand. Makers publish indices in air, and the formulas are the makers'
  own: at the d line all 1609 of SCHOTT, HIKARI, OHARA, HOYA, CDGM and SUMITA give the printed nd to 4e-5,
  nearly all to 1e-5; an index relative to vacuum would be larger by 2.7e-4 n.
- fused silica and calcium fluoride (Malitson) are in air: 1.45846 and 1.43385 at d, where the makers' own are
  1.45844 (SCHOTT LITHOSIL-Q) and 1.43385 (SCHOTT LITHOTEC-CAF2); in vacuum they would be 4e-4 larger.
- water (Daimon & Masumura) is relative to vacuum: 1.333349 at 0.58929 um and 20 C is what the formulation of
  the IAPWS, relative to vacuum, gives. It is divided by the index of air at 20 C, 101325 Pa (Ciddor).
- plastics and the other crystals are taken as they stand: prisms measured in air or nitrogen, or a paper that
  does not say; the doubt is 2.7e-4 n, that of the data themselves often more.
"""

from __future__ import annotations

import difflib
import functools

from lenstrace.errors import MediumError, UnknownGlassError
from lenstrace.optics.glass_names import MAKERS, PAGES, Page, plain
from lenstrace.optics.glass_pages import page_name, page_paths, read_page
from lenstrace.optics.media import AIR, LINE_C, LINE_D, LINE_F, Air, Formula, Table

SUGGESTIONS = 4


def glass(name: str, catalog: str | None = None) -> Air | Formula | Table:
    """The medium of a glass; it says in `catalog` whose data it took and in `source` which page.

    name: "N-BK7" or "SCHOTT:N-BK7"; case, spaces, underscores and hyphens do not matter. catalog: the maker,
    where `name` does not say it. With neither: first a name in `glass_names.PAGES` (old names, plastics,
    crystals), then the first maker of `glass_names.MAKERS` that has it. "air" is AIR.

    Raises UnknownGlassError, with near names, or with the catalogues that do have it.

    >>> bk7 = glass("BK7")
    >>> bk7.name, bk7.catalog, round(float(bk7.index(0.5875618)), 5)
    ('N-BK7', 'SCHOTT', 1.5168)
    >>> glass("F2").catalog, glass("CDGM:F2").catalog
    ('SCHOTT', 'CDGM')
    """
    catalog, name = _split(name, catalog)
    key = plain(name)
    page = PAGES.get(key)
    if catalog is None:
        if key == "AIR":
            return AIR
        if page is not None:
            return _read_alias(page)
        makers = page_paths().get(key)
        if makers is None:
            raise UnknownGlassError(f"glass {name!r} is in no catalogue; {_near(key)}")
        catalog = next(iter(makers))
    makers = page_paths().get(key, {})
    if catalog in makers:
        path = makers[catalog]
        return read_page(path, page_name(path), catalog)
    if page is not None and _catalog_of(page) == catalog:
        return _read_alias(page)
    where = ", ".join(catalogs_with(name))
    raise UnknownGlassError(
        f"glass {name!r} is not in the catalogue {catalog}; " + (f"it is in {where}" if where else _near(key))
    )


def catalogs_with(name: str) -> tuple[str, ...]:
    """The catalogues that have a glass of this name, the one `glass` takes first; empty where none has.

    >>> catalogs_with("F2")
    ('SCHOTT', 'HIKARI', 'CDGM')
    """
    key = plain(name)
    alias = [_catalog_of(PAGES[key])] if key in PAGES else []
    return tuple(dict.fromkeys([*alias, *page_paths().get(key, {})]))


@functools.cache
def glass_map(catalog: str) -> tuple[tuple[str, float, float], ...]:
    """Name, nd and vd of every glass of a maker that is known from the F to the C line; else UnknownGlassError.

    >>> next(row for row in glass_map("SCHOTT") if row[0] == "N-BK7")
    ('N-BK7', 1.5168, 64.167)
    """
    if catalog not in MAKERS:
        raise UnknownGlassError(f"glass catalogue {catalog!r} is not known; it is one of {', '.join(MAKERS)}")
    found = []
    for makers in page_paths().values():
        if catalog in makers:
            name = page_name(makers[catalog])
            try:
                d, f, c = (float(n) for n in read_page(makers[catalog], name, catalog).index([LINE_D, LINE_F, LINE_C]))
            except MediumError:
                continue
            found.append((name, round(d, 6), round((d - 1) / (f - c), 3)))
    return tuple(found)


def catalogs() -> tuple[str, ...]:
    """All catalogues: the makers, then the shelves of the database that the names in `PAGES` come from."""
    return tuple(dict.fromkeys([*MAKERS, *(_catalog_of(page) for page in PAGES.values())]))


def _split(name: str, catalog: str | None) -> tuple[str | None, str]:
    """Catalogue (upper case, checked) and name out of "SCHOTT:N-BK7" or the two apart."""
    before, colon, after = name.partition(":")
    if not colon:
        before, after = catalog or "", name
    elif catalog is not None and plain(catalog) != plain(before):
        raise UnknownGlassError(f"glass {name!r} names another catalogue than {catalog!r}; give one of the two")
    if not before:
        return None, after.strip()
    known = {plain(each): each for each in catalogs()}
    if plain(before) not in known:
        near = difflib.get_close_matches(plain(before), known, SUGGESTIONS, 0.5) or list(known)
        raise UnknownGlassError(f"glass catalogue {before!r} is not known; did you mean {', '.join(near)}?")
    return known[plain(before)], after.strip()


def _catalog_of(page: Page) -> str:
    """The maker of "specs/schott/...", else the shelf: "main/..." is MAIN."""
    shelf, maker, *_ = page.path.split("/")
    return (maker if shelf == "specs" else shelf).upper()


def _read_alias(page: Page) -> Formula | Table:
    return read_page(page.path, page.name, _catalog_of(page), page.absolute)


def _near(key: str) -> str:
    """What else it may have been, as the catalogues write it."""
    found = difflib.get_close_matches(key, [*page_paths(), *PAGES], SUGGESTIONS)
    if not found:
        return "give its index instead (index = ..., or abbe = { nd = ..., vd = ... })"
    return "did you mean " + ", ".join(dict.fromkeys(map(_written, found))) + "?"


def _written(key: str) -> str:
    makers = page_paths().get(key)
    if makers is None:
        return key
    return page_name(next(iter(makers.values())))
