"""The site of results: the three decisions, chapters, a page for each scene, calculators; written as a whole.

The first page shows each by a picture of its page, each study with its scenes below it.
"""

from __future__ import annotations

import itertools
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from validation.report.blocks import Blocks, Callout, Heading, Link, Links, Paragraph, References, figures_of
from validation.report.book import chapter_blocks, ordered_studies, unread_studies
from validation.report.chapters.data import CaseGroup, case_groups
from validation.report.chapters.gates import gate_list, not_passed, verdict_line
from validation.report.chapters.registry import chapter_of
from validation.report.chapters.scene import scene_chapter, scene_page
from validation.report.front import DECISIONS as THREE
from validation.report.front import front_chapter
from validation.report.names import Readable
from validation.report.references import PAPER, identity
from validation.report.render import html
from validation.report.verification import matrix
from validation.runs.case_name import scene_of
from validation.runs.files import atomic_directory, check_place, write_new
from validation.runs.progress import Progress
from validation.runs.results import Results

NAME = "DDA validation"
MARK = html.REFERENCES  # the page that marks a directory as such a site
CALCULATORS = "calculators.html"
VERIFIED = "verification.html"
DECISIONS = "decisions.html"
SCRIPTS = ("damping.js", "adviser.js", "calculators.js")


def build(
    results: Results,
    out: Path,
    chosen: Sequence[str] | None = None,
    progress: Progress = lambda finished, total, label: None,
    docs: str = "",
) -> Path:
    """Write the site of a results directory and return its first page.

    Parameters
    ----------
    results
        The results directory; studies that this version cannot read are left out.
    out
        A new or empty directory, or an earlier site, which is replaced as a whole.
    chosen
        The studies that are shown, all by default.
    progress
        Called before each study: how many are finished, of how many, and which is next.
    docs
        Address of the documentation's folder, to which pages link, such as ".." where the site lies inside it.

    Raises
    ------
    InputError
        There are no results, or they are damaged, or the directory is not one to write to.
    """
    check_place(out, MARK, "site")
    readable = Readable(results)
    names = ordered_studies(readable, chosen)
    unread = unread_studies(readable, names)
    with atomic_directory(out) as place:
        site = Site(readable, [name for name in names if name not in unread], place, docs)
        for number, study in enumerate(site.studies):
            progress(number, len(site.studies), study)
            site.write_study(study)
        site.write_other_pages()
    return out / "index.html"


def size(place: Path) -> int:
    """Return the size of a site [bytes]."""
    return sum(path.stat().st_size for path in place.rglob("*") if path.is_file())


class Site:
    """The pages of one results directory."""

    def __init__(self, results: Readable, studies: Sequence[str], place: Path, docs: str = "") -> None:
        self.studies = studies
        self._results = results
        self._place = place
        self._docs = docs
        self._manifests = {study: results.manifest(study) for study in studies}
        self._verdicts = [v for v in results.verdicts() if v["study"] in self._manifests]
        self._matrix = matrix(self._verdicts)
        self._imprint = identity(manifest.get("provenance") or {} for manifest in self._manifests.values())
        self._study_pages = page_names("study", studies)
        names: dict[str, None] = {}
        for manifest in self._manifests.values():
            names |= dict.fromkeys(scene_of(case["scene"]) for case in manifest.get("cases", []))
        self._scene_pages = page_names("scene", list(names))
        self._studies: list[Link] = []
        self._scenes: dict[str, Link] = {}

    def _write(self, file: str, title: str, blocks: Blocks, **values: object) -> None:
        menu = [("index.html", "Results"), (CALCULATORS, "Calculators"), (html.REFERENCES, "References")]
        if self._matrix:
            menu.append((VERIFIED, "Verification"))
        if self._docs:
            menu.append((f"{self._docs}/index.html", "Documentation"))
        stem = file.removesuffix(".html")
        text = html.page(
            title, blocks, file=file, name=NAME, menu=menu, imprint=f"{self._imprint}.",
            figure=lambda figure: f"{stem}/{figure}", **values,  # type: ignore[arg-type]
        )  # fmt: skip
        write_new(self._place / file, text)

    def write_study(self, study: str) -> None:
        """Write the chapter of a study, and pages of scenes that no study before it has."""
        page = self._study_pages[study]
        groups = case_groups(self._results, self._results.whole(study, histories=True))
        drawn = {group.name: self._write_scene(group) for group in groups if group.name not in self._scenes}
        scenes = tuple(self._scenes[group.name] for group in groups)
        if len(groups) == len(drawn) == 1 and chapter_of(study) is scene_chapter:
            # Such a chapter is the page of its scene, whose figures are not drawn twice.
            (chapter,) = drawn.values()
            shutil.copytree(self._figures(scenes[0].target), self._figures(page))
        else:
            chapter = chapter_blocks(self._results, study, self._directory(page))
        gates = gate_list([verdict for verdict in self._verdicts if verdict["study"] == study])
        self._write(
            page,
            self._title(study),
            [*chapter, Heading("Scenes", 2), Links(scenes), *gates],
            scenes=self._scene_pages,
        )
        picture = picture_of(page, chapter) or next((scene.image for scene in scenes), "")
        purpose = self._manifests[study].get("purpose", "")
        self._studies.append(Link(page, self._title(study), purpose, picture, scenes))

    def _write_scene(self, group: CaseGroup) -> Blocks:
        """Write the page of a scene; return what it says, without its gates."""
        page = self._scene_pages[group.name]
        verdicts = [verdict for verdict in self._verdicts if scene_of(verdict["scene"]) == group.name]
        blocks = scene_page(group, self._directory(page))
        self._write(page, f"{group.name}: {group.title}", [*blocks, *gate_list(verdicts)])
        self._scenes[group.name] = Link(page, group.title, group.name, picture_of(page, blocks))
        return blocks

    def _figures(self, page: str) -> Path:
        """Return the directory of a page's figures."""
        return self._place / page.removesuffix(".html")

    def _directory(self, page: str) -> Path:
        directory = self._figures(page)
        directory.mkdir()
        return directory

    def _write_decisions(self) -> Blocks:
        """Write the page of the three decisions; return what leads there, or nothing without such a study."""
        front = front_chapter(self._results, self.studies, self._figures(DECISIONS))
        if front is None:
            return []
        front.directory.mkdir()
        decisions = [front.blocks(name) for name in THREE]
        title = "Three decisions"
        self._write(DECISIONS, title, [Heading(title), *itertools.chain.from_iterable(decisions)])
        links = []
        for blocks in decisions:
            question = next(block.text for block in blocks if isinstance(block, Heading))
            rule = next(block.text for block in blocks if isinstance(block, Callout))
            place = f"{DECISIONS}#{html.anchor(question)}"
            links.append(Link(place, question, rule.removeprefix("Rule. "), picture_of(DECISIONS, blocks)))
        return [Heading(title, 2), Links(tuple(links))]

    def _title(self, study: str) -> str:
        return self._manifests[study].get("title") or study

    def write_other_pages(self) -> None:
        """Write the first page, what is verified, calculators, sources and what pages share."""
        lead = (
            "Blocks on springs, computed by DDA, by finite elements and exactly, judged by gates with a band and a "
            "reason each."
        )
        index = [
            Heading("Discontinuous Deformation Analysis against finite elements"),
            Paragraph(lead, "lead"),
            Paragraph(f"The model is that of {PAPER}.", "small"),
            verdict_line(self._verdicts),
            *not_passed(self._verdicts),
            *self._write_decisions(),
            Heading("Studies", 2),
            Links(tuple(self._studies)),
            Heading("Calculators", 2),
            Links((Link(CALCULATORS, "Damping of a step, and the step for a damping"),)),
        ]
        self._write("index.html", NAME, index)
        if self._matrix:
            self._write(VERIFIED, "Verification", self._matrix)
        sources = "The paper whose model is tested, and the sources of the methods."
        self._write(html.REFERENCES, "References", [Heading("References"), Paragraph(sources, "lead"), References()])
        self._write(
            CALCULATORS, "Calculators", [], template="calculators.html.j2", package=__package__, scripts=SCRIPTS
        )
        for name in (html.STYLE, html.SCRIPT):
            write_new(self._place / name, html.static(name))
        for name in SCRIPTS:
            write_new(self._place / name, Path(__file__).with_name(name).read_text("utf-8"))


def picture_of(page: str, blocks: Blocks) -> str:
    """Return the address of the first figure of a page, or nothing."""
    figures = figures_of(blocks)
    return f"{page.removesuffix('.html')}/{figures[0].file}" if figures else ""


def page_names(kind: str, names: Sequence[str]) -> dict[str, str]:
    """Return a file for each name: safe characters, no file twice, whatever the case of letters."""
    pages = {}
    used = set()
    for name in names:
        stem = f"{kind}-{re.sub(r'[^A-Za-z0-9_.-]+', '-', name).strip('-.') or 'unnamed'}"[:100]
        unique = stem
        number = 1
        while unique.casefold() in used:
            number += 1
            unique = f"{stem}-{number}"
        used.add(unique.casefold())
        pages[name] = f"{unique}.html"
    return pages
