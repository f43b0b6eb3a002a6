"""The report: front matter, a chapter for each study of a results directory, provenance."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.errors import InputError
from validation.report.blocks import Block, FigureBlock, PageBreak
from validation.report.chapters.registry import chapter_of
from validation.report.typesetting import png_of, write_document
from validation.runs.results import Results


def ordered_studies(results: Results) -> list[str]:
    """Return the studies of a directory, the core study first.

    Raises
    ------
    InputError
        There is none.
    """
    studies = sorted(results.studies(), key=lambda name: (name != "core", name))
    if not studies:
        raise InputError(f"{results.directory}: no study's results here; run a study first")
    return studies


def build(results: Results, out: Path) -> Path:
    """Write the PDF of all studies in a results directory and return its path.

    Raises
    ------
    InputError
        There are no results, or the file cannot be written.
    """
    studies = ordered_studies(results)
    return write_document(out, lambda root: _all_blocks(results, studies, root))


def _all_blocks(results: Results, studies: Sequence[str], figures: Path) -> list[Block]:
    from validation.report.chapters.front import front_matter, provenance

    blocks = front_matter(results, studies, figures)
    for study in studies:
        blocks += [PageBreak(), *chapter_of(study)(results, results.manifest(study), figures)]
    return [*blocks, PageBreak(), *provenance(results, studies)]


def figures(study: str, results: Results, out: Path) -> list[Path]:
    """Write the figures of a study's chapter to a directory as SVG and PNG and return their paths.

    Raises
    ------
    InputError
        The directory has no such study, or cannot be made.
    """
    if study not in results.studies():
        known = ", ".join(results.studies()) or "none"
        raise InputError(f"study: must be one of those in {results.directory} ({known}), got {study!r}")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{out}: cannot be made: {error.strerror}; choose another place") from None
    blocks = chapter_of(study)(results, results.manifest(study), out)
    paths: list[Path] = []
    for block in blocks:
        if isinstance(block, FigureBlock):
            svg = out / block.file
            paths += [svg, png_of(svg)]
    return paths
