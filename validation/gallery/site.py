"""The site: every page under a temporary name, then renamed as a whole."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources
from pathlib import Path

from validation.gallery.calculators import CALCULATORS
from validation.gallery.cases import studies_and_scenes
from validation.gallery.pages import Pages
from validation.gallery.places import check_place, write
from validation.report.book import ordered_studies, unread_studies
from validation.runs.files import atomic_directory
from validation.runs.results import Results

STATIC = (
    "gallery.css",
    "gallery.js",
    "numerals.js",
    "formulas.js",
    "calculators.js",
    "uPlot.iife.min.js",
    "uPlot.min.css",
)
NOTICE = "NOTICE.txt"  # licence of what others have written; its first line marks a directory as a gallery
Progress = Callable[[int, int, str], None]


def build(
    results: Results, out: Path, progress: Progress = lambda finished, total, label: None, docs: str = ""
) -> Path:
    """Write the gallery of a results directory and return its first page.

    Parameters
    ----------
    results
        The results directory; no solver is called, and studies that this version cannot read are left out.
    out
        Directory to write: a new or empty one, or an earlier gallery, which is replaced as a whole.
    progress
        Called before each page: how many are finished, of how many, and which is next.
    docs
        Address of the documentation's folder, such as ".." where the gallery lies inside it; its pages are linked to.

    Raises
    ------
    InputError
        There are no results, or they are damaged, or the directory is not one to write to.
    """
    check_place(out, NOTICE, "gallery")
    names = ordered_studies(results)
    unread = unread_studies(results, names)
    studies, scenes = studies_and_scenes(results, [name for name in names if name not in unread])
    total = len(studies) + len(scenes)
    with atomic_directory(out) as place:
        pages = Pages(results, studies, scenes, docs)
        for name in (*STATIC, NOTICE):
            write(place / name, resources.files("validation.gallery").joinpath("static", name).read_text("utf-8"))
        for calculator in CALCULATORS:
            write(place / f"{calculator.id}.html", pages.calculator(calculator))
        write(place / "index.html", pages.index())
        write(place / "references.html", pages.references())
        for number, study in enumerate(studies):
            progress(number, total, study.name)
            write(place / study.page, pages.study(study))
        for number, scene in enumerate(scenes, start=len(studies)):
            progress(number, total, scene.name)
            write(place / scene.page, pages.scene(scene))
    return out / "index.html"


def size(place: Path) -> int:
    """Return the size of a gallery [bytes]."""
    return sum(path.stat().st_size for path in place.iterdir())
