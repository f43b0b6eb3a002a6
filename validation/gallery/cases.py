"""What the pages show: the scenes of a results directory with their cases, whichever studies have run them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from validation.report.chapters.data import CaseResults, spoken_of
from validation.report.chapters.text import case_labels
from validation.runs.case_name import scene_of
from validation.runs.records import CaseRecord, Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.text import shown
from validation.scenes.scene import parse_scene
from validation.solvers.registry import FULL

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
    scenes = {name: _scene(name, scene, page("scene", name), rows, verdicts) for name, scene in records.items()}
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


def _scene(
    name: str, of_scene: _SceneRecords, page: str, rows: Mapping[str, Row], verdicts: Iterable[VerdictRecord]
) -> GalleryScene:
    """Return a scene; solvers that repeat another one in full are left out."""
    names = list(of_scene.records)
    scenes = []
    for case, records in of_scene.records.items():
        first_record = next(iter(records.values()))
        scenes.append(parse_scene(first_record["definition"], case))
    labels = case_labels(names, scenes)
    cases = []
    for case, label, scene in zip(names, labels, scenes, strict=True):
        keys = {solver: record["key"] for solver, record in of_scene.records[case].items() if not solver.endswith(FULL)}
        rows_by_solver = {solver: rows[key] for solver, key in keys.items() if key in rows}
        cases.append(CaseResults(case, label, scene, rows_by_solver))
    verdicts_of_scene = tuple(v for v in verdicts if scene_of(v["scene"]) == name)
    return GalleryScene(name, of_scene.title or name, page, tuple(cases), tuple(of_scene.studies), verdicts_of_scene)


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
