"""The studies of the suite, and the study of a single scene."""

from __future__ import annotations

import difflib
import functools
import importlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from validation.errors import InputError
from validation.gates.gate import Gate
from validation.metrics.catalogue import CATALOGUE, PAIRS
from validation.runs.case_name import scene_of
from validation.scenes import features
from validation.scenes.scene import Scene, load_scene, scene_names
from validation.scenes.tables import GateSection
from validation.solvers.registry import FULL, get_solver, is_solver, solver_names
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
    "slopes": "validation.studies.slopes.sliding:STUDY",
    "creep": "validation.studies.slopes.creep:STUDY",
    "rocking": "validation.studies.rocking.rocking:STUDY",
    "toppling": "validation.studies.rocking.toppling:STUDY",
    "waves": "validation.studies.waves.study:study",
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
    check_words(scene, source)
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


def check_words(scene: Scene, source: str) -> None:
    """Check the words of a scene that name solvers, columns, metrics and pairs, before anything runs.

    Raises
    ------
    InputError
        A solver or a metric is unknown, a column is one that none of the solvers has, or a gate's pair does not fit.
    """
    for name in scene.run.solvers:
        if not is_solver(name.removesuffix(FULL)):
            raise InputError(f"{source}: run.solvers: must be among {', '.join(solver_names())}, got {name!r}")
    served: dict[str, None] = {}
    for name in scene.run.solvers:
        served |= dict.fromkeys(get_solver(name.removesuffix(FULL)).columns() or scene.run.columns)
    for column in scene.run.columns:
        if column not in served:
            raise InputError(f"{source}: run.columns: must be among {', '.join(served)}, got {column!r}")
    _check_repeats(scene, source)
    for number, section in enumerate(scene.gate):
        _check_gate(section, scene.run.solvers, f"{source}: gate.{number}")
    _check_linear(scene, source)


def _check_repeats(scene: Scene, source: str) -> None:
    pairs_and_metrics = set()
    for number, section in enumerate(scene.gate):
        if (section.pair, section.metric) in pairs_and_metrics:
            raise InputError(
                f"{source}: gate.{number}: must not repeat pair and metric of another gate, got "
                f"{', '.join(section.pair)} and {section.metric}"
            )
        pairs_and_metrics.add((section.pair, section.metric))


def _check_gate(section: GateSection, solvers: Sequence[str], location: str) -> None:
    if section.metric not in CATALOGUE:
        raise InputError(f"{location}.metric: must be among {', '.join(CATALOGUE)}, got {section.metric!r}")
    missing = [name for name in section.pair if name not in solvers]
    if missing:
        raise InputError(f"{location}.pair: must be solvers that run.solvers lists, got {missing[0]!r}")
    if section.metric in PAIRS and len(section.pair) < 2:
        raise InputError(
            f"{location}.pair: must name a solver and a reference for {section.metric}, got {list(section.pair)}"
        )


def _check_linear(scene: Scene, source: str) -> None:
    """Refuse a gate on a metric of linear scenes where no case is linear: it would be dropped without a word."""
    if not any(CATALOGUE[section.metric].linear for section in scene.gate):
        return
    cases = scene.expand()
    if any(map(features.linear, cases)):
        return
    for number, section in enumerate(scene.gate):
        if CATALOGUE[section.metric].linear:
            nonlinear = (
                f"{section.metric} exists for linear scenes only, got one with {', '.join(features.of(cases[0]))}"
            )
            raise InputError(f"{source}: gate.{number}.metric: {nonlinear}")


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
                f"{target}: must not have the name of {studies[study.name][0]}, whose verdicts it would replace; "
                "rename the file, or run it into another directory with --results"
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
        raise InputError(f"--set: goes with a scene, got the study {target!r}; name a scene or a scene file")
    if target not in scene_names() and not target.endswith(".toml"):
        raise InputError(
            f"{target}: must be a study, a built-in scene or a scene file ending in .toml;{_meant(target)} "
            "dda-validate list names studies and scenes"
        )
    study = scene_study(target, assignments)
    if study.name.casefold() in STUDIES and target not in scene_names():
        raise InputError(f"{target}: must not have the name of the study {study.name}, whose results it would replace")
    return study
