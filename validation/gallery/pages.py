"""The pages: a template of `templates`, filled."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Sequence
from typing import Any

import jinja2
from markupsafe import Markup, escape

from validation.gallery import scene_data, verdicts
from validation.gallery.calculators import CALCULATORS, Calculator
from validation.gallery.cases import GalleryScene, GalleryStudy, readable
from validation.gallery.chapters import page_blocks
from validation.gallery.histories import samples_for
from validation.report.chapters.text import parameters
from validation.report.references import PAPER, identity, references
from validation.runs.case_name import CaseName
from validation.runs.results import Results
from validation.runs.text import visible

MENU = (("index.html", "Results"), *((f"{c.id}.html", c.title) for c in CALCULATORS))
BIBLIOGRAPHY = references()
CITATION = re.compile(r"@([a-z]+\d{4})\b")
LINE_BYTES = 900_000  # of all histories; the figures of a full gallery take four times as much
SCRIPTS = ("uPlot.iife.min.js", "numerals.js", "gallery.js")


def environment() -> jinja2.Environment:
    """Return what fills the templates."""
    templates = jinja2.Environment(
        loader=jinja2.PackageLoader("validation.gallery", "templates"),
        autoescape=True,
        finalize=_finalized,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    templates.filters["data"] = _data
    templates.filters["cited"] = _cited
    return templates


def _visible(value: Any) -> Any:
    """Return data whose texts are visible; a list of numbers is one already."""
    if isinstance(value, str):
        return visible(value)
    if isinstance(value, dict):
        return {_visible(key): _visible(item) for key, item in value.items()}
    if isinstance(value, list | tuple) and not (value and isinstance(value[0], float)):
        return [_visible(item) for item in value]
    return value


def _finalized(value: Any) -> Any:
    """Return a value as a page writes it: texts are visible, what is markup already is left."""
    return visible(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _data(value: object) -> Markup:
    """Return data for a script element, in which nothing can end the element."""
    text = json.dumps(_visible(value), ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for sign in "<>&":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return Markup(text)


class Pages:
    """The pages of one gallery."""

    def __init__(
        self, results: Results, studies: Sequence[GalleryStudy], scenes: Sequence[GalleryScene], docs: str = ""
    ) -> None:
        self._environment = environment()
        self._results = results
        self._studies = studies
        self._scenes = scenes
        self._most = scene_data.most_lines(scenes)
        self._samples = samples_for(scene_data.all_lines(scenes, self._most), LINE_BYTES)
        self._imprint = readable(identity(study.manifest.get("provenance") or {} for study in studies))
        self._docs = docs
        self._menu = (*MENU, (f"{docs}/index.html", "Documentation")) if docs else MENU

    def _page(self, template: str, file: str, **values: object) -> str:
        page = self._environment.get_template(template)
        return page.render(menu=self._menu, docs=self._docs, file=file, imprint=self._imprint, **values)

    def index(self) -> str:
        """Return the first page: studies with their verdicts, what fails, scenes, calculators."""
        all_verdicts = list(itertools.chain.from_iterable(study.verdicts for study in self._studies))
        rows = [(study, verdicts.counts(study.verdicts)) for study in self._studies]
        failures = [verdict for verdict in all_verdicts if verdict["verdict"] == "FAIL"]
        failure_table = verdicts.table(failures) if failures else None
        return self._page(
            "index.html.j2",
            "index.html",
            studies=rows,
            scenes=self._scenes,
            counts=verdicts.counts(all_verdicts),
            failed=failure_table,
            paper=PAPER,
            calculators=CALCULATORS,
            scripts=SCRIPTS,
        )

    def study(self, study: GalleryStudy) -> str:
        """Return the page of a study: its chapter, its scenes, its verdicts."""
        return self._page(
            "study.html.j2",
            study.page,
            study=study,
            blocks=page_blocks(self._results, study),
            counts=verdicts.counts(study.verdicts),
            table=verdicts.table(study.verdicts),
            scripts=SCRIPTS,
        )

    def scene(self, scene: GalleryScene) -> str:
        """Return the page of a scene: its parameters, histories, numbers and verdicts."""
        varied: set[str] = set().union(*(CaseName.parse(case.name).values for case in scene.cases))
        return self._page(
            "scene.html.j2",
            scene.page,
            scene=scene,
            parameters=readable(parameters(scene.cases[0].scene, varied)),
            studies=[study for study in self._studies if study.name in scene.studies],
            data=scene_data.data(self._results, scene, self._most, self._samples),
            drawn=len(scene_data.drawn(scene, self._most)),
            counts=verdicts.counts(scene.verdicts),
            table=verdicts.table(scene.verdicts),
            scripts=SCRIPTS,
        )

    def references(self) -> str:
        """Return the page of the paper and the sources of the methods."""
        return self._page("references.html.j2", "references.html", sources=BIBLIOGRAPHY, scripts=())

    def calculator(self, calculator: Calculator) -> str:
        """Return the page of a calculator."""
        scripts = ("uPlot.iife.min.js", "numerals.js", "formulas.js", "calculators.js", "gallery.js")
        return self._page("calculator.html.j2", f"{calculator.id}.html", calculator=calculator, scripts=scripts)


def _citation(match: re.Match[str]) -> str:
    """Return a link to a source as author and year; a text that is no key stays."""
    source = BIBLIOGRAPHY.get(match[1])
    if source is None:
        return match[0]
    return f'<a href="references.html#{match[1]}">{escape(source["author"].partition(",")[0])} {source["year"]}</a>'


def _cited(text: str) -> Markup:
    """Return a text whose citations are links to the page of references."""
    return Markup(CITATION.sub(_citation, str(escape(visible(text)))))
