"""Studies: scenes x variations x solvers, with the gates that judge them."""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from validation.cases import FULL, MEASURES, Case
from validation.gates import Gate
from validation.metrics import METRICS, PAIRS
from validation.results import Value
from validation.scene import Scene, SceneError, load_scene, scene_names
from validation.solvers import get_solver, is_solver, solver_names

if TYPE_CHECKING:
    from validation.engine import Finished


REPEATS = 3  # of each case of a study of timings


def _no_gates() -> tuple[Gate, ...]:
    return ()


def _nothing_derived() -> tuple[Derived, ...]:
    return ()


def _no_data() -> Mapping[str, Any]:
    return {}


@dataclass(frozen=True)
class Derived:
    """A row that is computed from finished cases instead of by a solver; gates address it as any other.

    Attributes
    ----------
    scene, name
        Where gates find it: ``Gate(scene, (name,), metric, ...)``.
    needs
        The (case, solver) pairs that it is computed from; where one did not complete, neither does this.
    compute
        Function of the finished cases that returns metrics.
    """

    scene: str
    name: str
    needs: tuple[tuple[str, str], ...]
    compute: Callable[[Finished], Mapping[str, Value]]


@dataclass(frozen=True)
class Study:
    """A declaration that the engine runs.

    Attributes
    ----------
    name, title, purpose
        Name on the command line, heading and first sentence of its chapter.
    scenes
        Names of built-in scenes, or scenes.
    solvers
        Solvers for every scene; by default those of the scene's `[run]` table.
    variations
        Dotted key to values, in product with the scenes' own sweeps.
    extra
        Further (case name, solver) pairs, such as a run without savings.
    gates
        Function that returns the gates, so that listing studies computes nothing.
    timed
        Whether the study is one of timings, which always run afresh, alone and repeatedly.
    derived
        Function that returns the rows that are computed from finished cases.
    data
        Function that returns plain data which the chapter draws beside the rows, such as closed forms.
    measures
        What is measured on each run, see `validation.cases`.
    pairs
        The comparisons that are kept; every solver with every later one where None.
    long
        Whether the gates are left to `dda-validate run`; the tests judge the others.
    """

    name: str
    title: str
    purpose: str
    scenes: Sequence[str | Scene]
    solvers: tuple[str, ...] | None = None
    variations: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    extra: tuple[tuple[str, str], ...] = ()
    gates: Callable[[], tuple[Gate, ...]] = _no_gates
    timed: bool = False
    derived: Callable[[], tuple[Derived, ...]] = _nothing_derived
    data: Callable[[], Mapping[str, Any]] = _no_data
    measures: tuple[str, ...] = MEASURES
    pairs: tuple[tuple[str, str], ...] | None = None
    long: bool = False

    def cases(self, full: bool = False, ranks: int = 1) -> list[Case]:
        """Return all cases; with `full` those of every solver's full model, on `ranks` ranks where one can use them."""
        scenes = [case for scene in self.scenes for case in self._varied(scene).expand()]
        named = {scene.name: scene for scene in scenes}
        pairs = [(scene, solver) for scene in scenes for solver in self.solvers or scene.run.solvers]
        pairs += [(named[name], solver) for name, solver in self.extra if name in named]
        repeats = REPEATS if self.timed else 0
        return [Case(scene, solver, full, ranks, self.measures, repeats) for scene, solver in pairs]

    def recipes(self) -> dict[tuple[str, str], Derived]:
        """Return the derived rows by the names that gates address them with."""
        return {(row.scene, row.name): row for row in self.derived()}

    def needs(self, gate: Gate) -> list[tuple[str, str]]:
        """Return the (case, solver) pairs that a gate needs, those behind derived rows included."""
        recipes = self.recipes()
        return [need for name in gate.cases for need in (recipes[name].needs if name in recipes else (name,))]

    def _varied(self, scene: str | Scene) -> Scene:
        loaded = load_scene(scene) if isinstance(scene, str) else scene
        if not self.variations:
            return loaded
        sweep = dict(loaded.sweep) | {key: list(values) for key, values in self.variations.items()}
        return loaded.model_copy(update={"sweep": sweep})


STUDIES = {
    "core": "validation.core:CORE",
    "two-codes": "validation.two_codes:TWO_CODES",
    "paper": "validation.paper:PAPER",
    "limits": "validation.locking:STUDY",
    "stiff-contact": "validation.stiff_contact:STUDY",
    "stability-small": "validation.stability_study:small",
    "stability": "validation.stability_study:full",
    "subblocks": "validation.subblocks:SUBBLOCKS",
    "work-precision": "validation.work_precision:WORK_PRECISION",
}


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
    SceneError
        The scene, a solver, a column or a gate in it is not allowed.
    """
    scene = load_scene(source)
    scene = scene.with_values(dict(assignments)) if assignments else scene
    check_words(scene, source)
    own = tuple(gate for case in scene.expand() for gate in own_gates(case))
    return Study(
        scene.name,
        scene.title or scene.name,
        f"The scene {scene.name}.",
        [scene],
        extra=built_in_extra(scene),
        gates=lambda: own + built_in_gates(scene),
        derived=lambda: built_in_derived(scene),
    )


def check_words(scene: Scene, source: str) -> None:
    """Check the words of a scene that name solvers, columns, metrics and pairs, before anything runs.

    Raises
    ------
    SceneError
        A solver or a metric is unknown, a column is one that none of the solvers has, or a gate's pair does not fit.
    """
    for name in scene.run.solvers:
        if not is_solver(name.removesuffix(FULL)):
            raise SceneError(f"{source}: run.solvers: must be among {', '.join(solver_names())}, got {name!r}")
    known = [get_solver(name.removesuffix(FULL)).columns() for name in scene.run.solvers]
    served = dict.fromkeys(column for columns in known for column in columns or scene.run.columns)
    for column in scene.run.columns:
        if column not in served:
            raise SceneError(f"{source}: run.columns: must be among {', '.join(served)}, got {column!r}")
    _check_gates(scene, source)


def _check_gates(scene: Scene, source: str) -> None:
    for number, section in enumerate(scene.gate):
        if section.metric not in METRICS:
            raise SceneError(
                f"{source}: gate.{number}.metric: must be among {', '.join(METRICS)}, got {section.metric!r}"
            )
        missing = [name for name in section.pair if name not in scene.run.solvers]
        if missing:
            raise SceneError(
                f"{source}: gate.{number}.pair: must be solvers that run.solvers lists, got {missing[0]!r}"
            )
        if section.metric in PAIRS and len(section.pair) < 2:
            raise SceneError(
                f"{source}: gate.{number}.pair: must name a solver and a reference for {section.metric}, "
                f"got {list(section.pair)}"
            )


def own_gates(case: Scene) -> tuple[Gate, ...]:
    """Return the gates that a scene file states for one of its cases."""
    return tuple(Gate(case.name, s.pair, s.metric, *s.band, s.reason) for s in case.gate)


def is_built_in(scene: Scene) -> bool:
    """Whether a scene is a built-in one, unchanged."""
    return scene.name in scene_names() and scene == load_scene(scene.name)


def built_in_gates(scene: Scene) -> tuple[Gate, ...]:
    """Return the suite's own gates for the cases of a scene, where it is the built-in one unchanged."""
    names = {case.name for case in scene.expand()} if is_built_in(scene) else set()
    return tuple(gate for study in judged_studies() for gate in get_study(study).gates() if gate.scene in names)


def built_in_derived(scene: Scene) -> tuple[Derived, ...]:
    """Return the derived rows of the cases of a scene, where it is the built-in one unchanged."""
    names = {case.name for case in scene.expand()} if is_built_in(scene) else set()
    return tuple(row for study in judged_studies() for row in get_study(study).derived() if row.scene in names)


def built_in_extra(scene: Scene) -> tuple[tuple[str, str], ...]:
    """Return the further runs that the suite's gates on a built-in scene compare with."""
    names = {case.name for case in scene.expand()} if is_built_in(scene) else set()
    return tuple(pair for study in judged_studies() for pair in get_study(study).extra if pair[0] in names)


def resolve(targets: Sequence[str], assignments: Mapping[str, Any] | None = None) -> list[Study]:
    """Return the studies that the command line names: studies (`all` of them), scenes or scene files.

    Raises
    ------
    SceneError
        A name is neither, or values are set on a study.
    """
    studies = []
    for target in STUDIES if list(targets) == ["all"] else targets:
        if target in STUDIES and not assignments:
            studies.append(get_study(target))
        elif target in STUDIES:
            raise SceneError(f"--set: goes with a scene, got the study {target!r}; name a scene or a scene file")
        elif target in scene_names() or target.endswith(".toml"):
            studies.append(scene_study(target, assignments))
        else:
            raise SceneError(
                f"{target}: must be a study ({', '.join(STUDIES)}), a built-in scene "
                f"({', '.join(scene_names())}) or a scene file ending in .toml"
            )
    return studies
