"""The studies of the suite, and the study of a single scene."""

from __future__ import annotations

import difflib
import functools
import importlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from validation.errors import InputError
from validation.gates.gate import Gate
from validation.runs.case_name import scene_of
from validation.scenes.scene import Scene, load_scene, scene_names
from validation.solvers.names import check_names
from validation.studies.declaration import Study

STUDIES = {
    "core": "validation.studies.core:CORE",
    "two-codes": "validation.studies.second_fem_code:TWO_CODES",
    "paper": "validation.studies.paper.study:PAPER",
    "limits": "validation.studies.limits:STUDY",
    "stiff-contact": "validation.studies.stiff_contact:STUDY",
    "stability-small": "validation.studies.stability:small",
    "stability": "validation.studies.stability:full",
    "subblocks": "validation.studies.subblocks:SUBBLOCKS",
    "opening": "validation.studies.opening:OPENING",
    "rebound": "validation.studies.contact.rebound:STUDY",
    "impacts": "validation.studies.contact.impacts:STUDY",
    "methods": "validation.studies.methods.study:study",
    "slopes": "validation.studies.slopes.sliding:STUDY",
    "creep": "validation.studies.slopes.creep:STUDY",
    "rocking": "validation.studies.rocking.rocking:STUDY",
    "toppling": "validation.studies.rocking.toppling:STUDY",
    "waves": "validation.studies.waves.study:study",
    "columns": "validation.studies.columns.study:study",
    "response": "validation.studies.waves.response:STUDY",
    "work-precision": "validation.studies.work.study:WORK_PRECISION",
    "field": "validation.studies.field.study:study",
}
T = TypeVar("T")


@functools.cache
def get_study(name: str) -> Study:
    """Return a study of the suite by name; one of many scenes is declared by a function."""
    module, _, attribute = STUDIES[name].partition(":")
    declared: Study | Callable[[], Study] = getattr(importlib.import_module(module), attribute)
    return declared if isinstance(declared, Study) else declared()


def judged_studies() -> list[str]:
    """Return the names of the studies whose gates the tests judge, which are not the long ones."""
    return [name for name in STUDIES if not get_study(name).long]


def scene_study(source: str, assignments: Mapping[str, Any] | None = None) -> Study:
    """Return the study of one scene, built-in or a file, with the gates that belong to it.

    Raises
    ------
    InputError
        The scene, a solver, a column or a gate in it is not allowed.
    """
    scene = load_scene(source)
    scene = scene.with_values(dict(assignments)) if assignments else scene
    check_names(scene, source)
    scene_gates: list[Gate] = []
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
    items: list[T] = []
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
    for target in STUDIES if list(targets) == ["all"] else dict.fromkeys(targets):
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
    near = difflib.get_close_matches(target, [*STUDIES, *scene_names()], cutoff=0.5)
    return f" did you mean {', '.join(near)}?" if near else ""


def _resolved(target: str, assignments: Mapping[str, Any] | None) -> Study:
    if target in STUDIES and not assignments:
        return get_study(target)
    if target in STUDIES:
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
    if study.name.casefold() in STUDIES and target not in scene_names():
        raise InputError(
            f"must not have the name of the study {study.name}, whose results it would replace", source=target
        )
    return study
