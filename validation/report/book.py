"""The report: front matter, a chapter for each study of a results directory, provenance."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from validation.errors import InputError
from validation.report.blocks import Blocks, Callout, Heading, figures_of
from validation.report.chapters.data import case_groups, groups_of_studies
from validation.report.chapters.registry import chapter_of
from validation.report.chapters.scene import slide_figure
from validation.report.figures.response import save_as
from validation.report.names import Readable, page_name, unescaped
from validation.report.render.pdf import png_of, write_document
from validation.runs.results import Results
from validation.runs.text import error_text
from validation.scenes.scene import parse_scene
from validation.suite.folders import study_names


def ordered_studies(results: Results, chosen: Sequence[str] | None = None) -> list[str]:
    """Return the studies of a directory, or those named, in the order of their chapters, users' scenes last.

    Raises
    ------
    InputError
        There is none, or none of a name.
    """
    order = {name: place for place, name in enumerate(study_names())}
    studies = sorted(results.studies(), key=lambda name: (order.get(name, len(order)), name))
    if not studies:
        raise InputError("no study's results here", source=results.directory, advice="run a study first")
    names = [*map(page_name, chosen or ())]
    for name in names:
        if name not in studies:
            rule = f"must be one of those in {results.directory} ({', '.join(studies)})"
            raise InputError(rule, field="study", value=repr(name))
    return [study for study in studies if study in names] if names else studies


def unread_studies(results: Results, studies: Sequence[str]) -> dict[str, str]:
    """Return the studies whose results this version cannot read, and why.

    Raises
    ------
    InputError
        None of them can be read.
    """
    reasons = {}
    verdicts = results.unread_verdicts()
    for study in studies:
        try:
            for case in results.whole(study, histories=True).get("cases", []):
                parse_scene(case["definition"], case["scene"])
        except InputError as error:
            reasons[study] = str(error)
        else:
            if unescaped(study) in verdicts:
                reasons[study] = (
                    f"{results.directory / 'verdicts.json'}: {verdicts[unescaped(study)]}; run {study} again"
                )
    if len(reasons) == len(studies):
        raise InputError(next(iter(reasons.values())))
    return reasons


def build(results: Results, out: Path, chosen: Sequence[str] | None = None, gates: bool = False) -> Path:
    """Write the PDF of studies in a results directory, by default all, and return its path.

    Where `gates` is true, those that passed are listed.

    Raises
    ------
    InputError
        There are no results, or the file cannot be written.
    """
    results = Readable(results)
    studies = ordered_studies(results, chosen)
    return write_document(out, lambda root: _all_blocks(results, studies, root, gates))


def _all_blocks(results: Results, studies: Sequence[str], figures: Path, gates: bool = False) -> Blocks:
    from validation.report.appendix.pages import appendix
    from validation.report.front import front_chapter, front_pages

    unread = unread_studies(results, studies)
    chapters: Blocks = []
    for study in studies:
        if study in unread:
            chapters += [Heading(study), Callout(f"{unread[study]}.", "fail")]
        else:
            chapters += chapter_blocks(results, study, figures)
    readable = [study for study in studies if study not in unread]
    with _damage_named(results, "the first and the last pages"):
        groups = groups_of_studies(results, map(results.manifest, readable), drawn=False)
        verdicts = [verdict for verdict in results.verdicts() if verdict["study"] in readable]
        provenances = [results.manifest(study).get("provenance", {}) for study in readable]
        front = front_pages(front_chapter(results, readable, figures), groups, verdicts, provenances)
        return [*front, *chapters, *appendix(results, groups, verdicts, readable, gates)]


def chapter_blocks(results: Results, study: str, figures: Path) -> Blocks:
    """Return the chapter of a study, or why its results give no numbers for it: the others go on."""
    try:
        return _chapter(results, study, figures)
    except _NotDrawable as error:
        return [Heading(study), Callout(f"{error}.", "fail")]


def _chapter(results: Results, study: str, figures: Path) -> Blocks:
    manifest = results.whole(study, histories=True)
    with _damage_named(results, f"the chapter of {unescaped(study)}"):
        return chapter_of(study)(results, manifest, figures)


class _NotDrawable(InputError):
    """A part of the report without numbers."""


@contextmanager
def _damage_named(results: Results, what: str) -> Iterator[None]:
    """Name the part that results, damaged in a way that no check detects, give no numbers for."""
    try:
        yield
    except InputError:
        raise
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        why = error_text(error)
        raise _NotDrawable(f"{results.directory}: {what} cannot be drawn from these results ({why})") from error


def write_figures(results: Results, out: Path, chosen: Sequence[str] | None = None) -> list[Path]:
    """Write the figures of the chapters, and one for a slide of each scene, as SVG and PNG; return the files.

    Raises
    ------
    InputError
        The directory has no such study, or cannot be made.
    """
    results = Readable(results)
    studies = ordered_studies(results, chosen)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", source=out, advice="choose another place") from None
    paths = []
    for study in studies:
        for block in figures_of(_chapter(results, study, out)):
            svg = out / block.file
            paths += [svg, png_of(svg)]
        for group in case_groups(results, results.manifest(study)):
            figure = slide_figure(group)
            if figure is not None:
                paths += [save_as(figure, out / f"{group.slug}-slide{ending}") for ending in (".svg", ".png")]
    return paths
