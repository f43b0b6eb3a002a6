"""The studies of the suite, found by their folders, and the study of a single scene.

A folder of `validation.studies` with a ``study.toml`` (its keys: `validation.suite.tables`) is a study; beside it are

    scenes/*.toml    the scenes of this study alone
    formulas.py      bands, derived rows and generated scenes, which the table names
    chapter.toml     the texts, tables and figures of its chapter
    chapter.py       the function ``chapter``, where these need one
    answer.py        the function ``answer``, what is printed where the study is run for a user's scene
"""

from __future__ import annotations

import difflib
import functools
import importlib
import importlib.util
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from validation.errors import InputError
from validation.gates.gate import Gate
from validation.runs.case_name import scene_of
from validation.scenes import features
from validation.scenes.places import STUDIES, study_directories
from validation.scenes.scene import Scene, load_scene, scene_names
from validation.solvers.names import check_names
from validation.suite.claims import Register
from validation.suite.declaration import Study
from validation.suite.tables import declare

T = TypeVar("T")
OF_SCENE = "-of-"  # between the names of a study and of the scene that it is run for
REQUIRED = ("name", "title", "purpose", "phenomenon", "order")  # of every study


@dataclass(frozen=True)
class StudyFolder:
    """A folder with a ``study.toml``."""

    path: Path
    form: str = "study"  # the table of ``study.toml`` that declares it; "short": of fewer cases

    @property
    def fields(self) -> dict[str, Any]:
        """The fields of the study."""
        table = _table(self.path / "study.toml")
        fields: dict[str, Any] = table.get("study", {}) | table.get(self.form, {})
        return fields

    def module(self, name: str) -> Any:
        """Return a module of the folder, None where there is none."""
        full_name = f"{STUDIES}.{self.path.name}.{name}"
        return importlib.import_module(full_name) if (self.path / f"{name}.py").exists() else None


@functools.cache
def _table(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"must be TOML: {error}", source=path) from None


def study_folders() -> Mapping[str, StudyFolder]:
    """Return the folders of the studies by name, in the order of the report.

    Raises
    ------
    InputError
        Two studies have one name.
    """
    return _study_folders(study_directories())


@functools.cache
def _study_folders(directories: tuple[Path, ...]) -> Mapping[str, StudyFolder]:
    folders = []
    for directory in directories:
        for path in directory.glob("*/study.toml"):
            folders.append(StudyFolder(path.parent))
            if "short" in _table(path):
                folders.append(StudyFolder(path.parent, "short"))
    for folder in folders:
        missing = [key for key in REQUIRED if key not in folder.fields]
        if missing:
            raise InputError("is required", source=folder.path / "study.toml", field=f"study.{missing[0]}")
    by_name: dict[str, StudyFolder] = {}
    for folder in sorted(folders, key=lambda folder: (folder.fields["order"], folder.fields["name"])):
        name = folder.fields["name"]
        if name in by_name:
            raise InputError(f"must not have the name of the study in {by_name[name].path}", source=folder.path)
        by_name[name] = folder
    return by_name


def study_names() -> list[str]:
    """Return the names of the studies, in the order of the report."""
    return list(study_folders())


def get_study(name: str) -> Study:
    """Return a study by name."""
    return _declared(study_folders()[name])


@functools.cache
def _declared(folder: StudyFolder) -> Study:
    return declare(folder.path, folder.fields, folder.module("formulas"))


def folder_of(name: str) -> StudyFolder | None:
    """Return the folder of a study, or of one that is run for a user's scene; None of a scene alone."""
    folders = study_folders()
    return folders.get(name) or folders.get(name.partition(OF_SCENE)[0])


def study_of_scene(name: str, source: str, assignments: Mapping[str, Any] | None = None) -> Study:
    """Return a study with a user's scene, built-in or a file, in place of its own ones.

    Raises
    ------
    InputError
        The study is made for its own scenes only, or it does not take this one.
    """
    able = [study for study, folder in study_folders().items() if "of_scene" in folder.fields]
    if name not in able:
        raise InputError(f"goes with {', '.join(able)}", field="--scene", value=f"the study {name!r}")
    folder = study_folders()[name]
    scene = load_scene(source)
    scene = scene.with_values(dict(assignments)) if assignments else scene
    features.refuse_sweep(scene, source)
    fields = getattr(folder.module("formulas"), folder.fields["of_scene"])(scene)
    title = f"{folder.fields['title']}: {scene.title or scene.name}"
    return replace(get_study(name), name=f"{name}{OF_SCENE}{scene.name}", title=title, gates=tuple, **fields)


def sources_of(name: str) -> str:
    """Return what the methods of a study rest on, with keys of the bibliography; nothing of a user's scene."""
    folder = study_folders().get(name)
    return "" if folder is None else str(folder.fields.get("sources", ""))


def register_of(name: str) -> Register:
    """Return the register of statements of a study that has one."""
    folder = study_folders()[name]
    register: Register = getattr(folder.module("formulas"), folder.fields["register"])
    return register


def judged_studies() -> list[str]:
    """Return the names of the studies whose gates the tests judge: all but the long ones."""
    return [name for name, folder in study_folders().items() if not folder.fields.get("long")]


def scene_study(source: str, assignments: Mapping[str, Any] | None = None) -> Study:
    """Return the study of one scene, built-in or a file, with its gates.

    Raises
    ------
    InputError
        The scene, a solver, a column or a gate in it is not allowed.
    """
    scene = load_scene(source)
    scene = scene.with_values(dict(assignments)) if assignments else scene
    check_names(scene, source)
    scene_gates = []
    for case in scene.expand():
        for section in case.gate:
            scene_gates.append(Gate(case.name, section.pair, section.metric, *section.band, section.reason))
    return Study(
        scene.name,
        scene.title or scene.name,
        f"The scene {scene.name}.",
        [scene],
        extra=_of_suite(scene, lambda study: study.extra, lambda pair: pair[0]),
        gates=lambda: (*scene_gates, *_of_suite(scene, lambda study: study.gates(), lambda gate: gate.scene)),
        derived=lambda: _of_suite(scene, lambda study: study.derived(), lambda row: row.scene),
    )


def _of_suite(scene: Scene, part_of: Callable[[Study], Iterable[T]], case_of: Callable[[T], str]) -> tuple[T, ...]:
    """Return what the suite's studies hold of the cases of a scene, where it is the built-in one unchanged."""
    if scene.name not in scene_names() or scene != load_scene(scene.name):
        return ()
    names = {case.name for case in scene.expand()}
    items = []
    for study in map(get_study, judged_studies()):
        study_scenes = [declared if isinstance(declared, str) else declared.name for declared in study.scenes]
        if scene.name in map(scene_of, study_scenes):
            items += [item for item in part_of(study) if case_of(item) in names]
    return tuple(items)


def resolve(targets: Sequence[str], assignments: Mapping[str, Any] | None = None) -> list[Study]:
    """Return the studies that the command line names: studies (`all` of them), scenes or scene files.

    Raises
    ------
    InputError
        A name is neither, values are set on a study, or two of them go by one name.
    """
    studies: dict[str, tuple[str, Study]] = {}
    for target in study_folders() if list(targets) == ["all"] else dict.fromkeys(targets):
        study = _resolved(target, assignments)
        if study.name in studies:
            raise InputError(
                f"must not have the name of {studies[study.name][0]}, whose verdicts it would replace",
                source=target,
                advice="rename the file, or run it into another directory with --results",
            )
        studies[study.name] = target, study
    return [study for _, study in studies.values()]


def _meant(target: str) -> str:
    near = difflib.get_close_matches(target, [*study_names(), *scene_names()], cutoff=0.5)
    return f" did you mean {', '.join(near)}?" if near else ""


def _resolved(target: str, assignments: Mapping[str, Any] | None) -> Study:
    if target in study_folders() and not assignments:
        return get_study(target)
    if target in study_folders():
        raise InputError(
            "goes with a scene", field="--set", value=f"the study {target!r}", advice="name a scene or a scene file"
        )
    if target not in scene_names() and not target.endswith(".toml"):
        raise InputError(
            "must be a study, a built-in scene or a scene file ending in .toml",
            source=target,
            advice=f"{_meant(target)} dda-validate list names studies and scenes".lstrip(),
        )
    study = scene_study(target, assignments)
    if study.name.casefold() in study_folders() and target not in scene_names():
        raise InputError(
            f"must not have the name of the study {study.name}, whose results it would replace", source=target
        )
    return study
