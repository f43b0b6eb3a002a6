"""What the pages show: the scenes of a results directory with their cases, whichever studies have run them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from validation.report.chapters.data import CaseResults, cases_with, spoken_of
from validation.runs.case_name import scene_of
from validation.runs.records import CaseRecord, Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.text import shown
from validation.solvers.registry import FULL

PlainData = dict[str, Any]  # for a template or a script of a page
_DIRECTORIES = re.compile(r"(?<![\w.:/-])(?:[A-Za-z]:[\\/]|/)(?:[^\s/\\'\"]+[\\/])+")


def readable(text: str) -> str:
    """Return a text for a page: no control characters, and of an absolute path only its last part."""
    return _DIRECTORIES.sub("", shown(text))


@dataclass(frozen=True)
class GalleryScene:
    """A scene with all its cases and verdicts, and the studies that run it."""

    name: str
    title: str
    page: str  # file name
    cases: tuple[CaseResults, ...]  # without histories, which a page samples one by one
    studies: tuple[str, ...]
    verdicts: tuple[VerdictRecord, ...]


@dataclass(frozen=True)
class GalleryStudy:
    """A study with its scenes and verdicts."""

    name: str
    page: str  # file name
    manifest: Manifest
    scenes: tuple[GalleryScene, ...]
    verdicts: tuple[VerdictRecord, ...]

    @property
    def title(self) -> str:
        """What the study calls itself."""
        return self.manifest.get("title") or self.name


@dataclass
class _SceneRecords:
    """Records of one scene, in the order of the manifests."""

    title: str = ""
    records: dict[str, dict[str, CaseRecord]] = field(default_factory=dict)  # case and solver
    studies: dict[str, None] = field(default_factory=dict)


def studies_and_scenes(results: Results, names: Iterable[str]) -> tuple[list[GalleryStudy], list[GalleryScene]]:
    """Return the studies of these names in this order, and all their scenes in the order in which they are met.

    Raises
    ------
    InputError
        A manifest, a row or a history is lost or damaged.
    """
    manifests = {name: results.whole(name, histories=True) for name in names}
    records: dict[str, _SceneRecords] = {}
    for study, manifest in manifests.items():
        for record in spoken_of(manifest):
            scene = records.setdefault(scene_of(record["scene"]), _SceneRecords())
            scene.title = scene.title or record.get("title") or ""
            scene.studies[study] = None
            scene.records.setdefault(record["scene"], {})[record["solver"]] = record
    page = _pages()
    rows = results.rows()
    verdicts = results.readable_verdicts()
    scenes = {}
    for name, scene in records.items():
        by_case = {case: [*by_solver.values()] for case, by_solver in scene.records.items()}
        verdicts_of_scene = tuple(v for v in verdicts if scene_of(v["scene"]) == name)
        cases = tuple(_without_repeats(case) for case in cases_with(by_case, rows))
        title = scene.title or name
        scenes[name] = GalleryScene(name, title, page("scene", name), cases, tuple(scene.studies), verdicts_of_scene)
    studies = [
        GalleryStudy(
            name,
            page("study", name),
            manifest,
            tuple(scene for scene in scenes.values() if name in scene.studies),
            tuple(v for v in verdicts if v["study"] == name),
        )
        for name, manifest in manifests.items()
    ]
    return studies, list(scenes.values())


def _without_repeats(case: CaseResults) -> CaseResults:
    """Return a case without the rows of solvers that repeat another one in full."""
    return replace(case, rows={solver: row for solver, row in case.rows.items() if not solver.endswith(FULL)})


def _pages() -> Callable[[str, str], str]:
    """Return a function that names files: safe characters, and no name twice, whatever the letters' case."""
    used: set[str] = set()

    def page(kind: str, name: str) -> str:
        stem = f"{kind}-{re.sub(r'[^A-Za-z0-9_.-]+', '-', name).strip('-.') or 'unnamed'}"[:100]
        number = 1
        unique_stem = stem
        while unique_stem.casefold() in used:
            number += 1
            unique_stem = f"{stem}-{number}"
        used.add(unique_stem.casefold())
        return f"{unique_stem}.html"

    return page
