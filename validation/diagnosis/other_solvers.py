"""A history beside other solvers of the suite, and beside linear DDA where no candidate change of a block steps it.

Candidates, fits and decision are those of `beside`. What a mesh leaves beside an exact solution counts as noise.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from validation.diagnosis import evidence
from validation.diagnosis.answer import Answer
from validation.diagnosis.beside import RunVerdict, SceneSearch, answer_of, searches_of, verdict_of
from validation.diagnosis.causes import BENIGN_COMPLIANCE, words_of
from validation.diagnosis.constants import CLEARLY, SLIGHT
from validation.diagnosis.evidence import Departure
from validation.diagnosis.fits.bar import Bar, bars_of
from validation.diagnosis.numbers import CandidateChange
from validation.diagnosis.one_change import STARTS, Fitted, of_scene
from validation.diagnosis.reading import Foreign
from validation.diagnosis.readings import Reading
from validation.diagnosis.variant import rectangle_of
from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

CANDIDATES = {"springs-factor", "density-factor", "young-factor", "load-factor"}  # numbers that are tried
SCHEMES = {"scheme", "start", "gg"}
FEW = 4  # of a slow solver every so many of the starts: a factor of three apart
COARSE = 8  # elements a side of the mesh that finds candidates for a finer one
MESH = 5e-3  # relative L2 that a coarse mesh leaves beside the exact bar: eight linear elements a side at 0.5 ms
DDA = "dda"
RIVALS = ("bar", "continuum", "fem")
EXACT = {"bar": " (the exact bar, which fine finite elements converge to)"}
WITHOUT_SCHEME = "continuum"


class SolverSearch(SceneSearch):
    """The search beside runs of any solver."""

    NAMES = (DISPLACEMENT, PRESSURE)
    WOULD_TELL = "another time step, or another contact stiffness"

    def __init__(self, scene: Scene, reading: Reading, name: str) -> None:
        if name != DDA:
            self.model = name
            self.model_words = name + EXACT.get(name, "")
        super().__init__(scene, reading, get_solver(name))

    def candidates(self) -> Iterator[CandidateChange]:
        """Yield schemes, where the solver has one, and single numbers."""
        tried = CANDIDATES | (set() if self.solver.name == WITHOUT_SCHEME else SCHEMES)
        changes = of_scene(self.scene, STARTS[:: FEW if self.solver.meshed else 1])
        return (each for each in changes if each.id in tried)

    def explanations(self, begun: Sequence[Fitted] = ()) -> list[Fitted]:
        """Return the candidates as `SceneSearch` does; of a fine mesh those that a coarse one takes for possible."""
        mesh = self.scene.fem
        if begun or not self.solver.meshed or mesh.mesh is not None or mesh.per_side <= COARSE:
            return super().explanations(begun)
        coarse = SolverSearch(self.scene.with_values({"fem.elements": COARSE}), self.reading, self.solver.name)
        sizes = np.maximum(np.linalg.norm(self.scene_run, axis=1), np.finfo(float).tiny)
        error = float(np.max(np.linalg.norm(coarse.scene_run - self.scene_run, axis=1) / sizes))
        near = [each for each in coarse.explanations() if each.explains or each.left <= CLEARLY * error]
        return super().explanations(near) if near else []

    def is_noise(self, columns: Array) -> bool:
        """Whether columns leave noise, or beside an exact solution what a mesh does."""
        is_exact = self.model and not self.solver.meshed
        least = min(MESH, SLIGHT * self.left(self.scene_run)) if is_exact else 0.0
        if self.left(columns) <= least or super().is_noise(columns):
            return True
        is_whole = self.rows == self.recorded.shape[1]  # else a run without bounds
        return is_whole and all(bar.holds(row) for bar, row in zip(self.bars, self.recorded - columns, strict=True))

    @cached_property
    def bars(self) -> list[Bar]:
        """What digits and noise of a linear motion may leave of each column."""
        return bars_of(self.recorded, self.reading.rounding)

    def departure(self, verdict: RunVerdict) -> Departure | None:
        """Return where a history departs: what is exact in time, from the run of `dda` under the scene's scheme."""
        if self.solver.name != WITHOUT_SCHEME:
            return super().departure(verdict)
        rows = self.reading.stepping.rows
        own_run = get_solver(DDA).solve(self.scene).displacement[rows]
        return evidence.measured(own_run, self.recorded[0], rows, 0.0)


def rivals_of(scene: Scene) -> tuple[str, ...]:
    """Return the names of the solvers that a history of a scene is held against beside DDA."""
    return RIVALS if scene.block.poisson == 0 and rectangle_of(scene) is not None else ("fem",)


def not_installed(scene: Scene, solvers: Iterable[str]) -> tuple[str, ...]:
    """Return a sentence for each solver that applies to a scene and lacks an extra here."""
    adapters = (get_solver(name) for name in solvers)
    absent = {solver.name: solver.missing(scene) for solver in adapters if solver.refusal(scene) is None}
    return tuple(f"{name} is no candidate: it {reason}" for name, reason in absent.items() if reason is not None)


def verdict_of_solvers(scene: Scene, readings: Sequence[Reading], names: Iterable[str]) -> RunVerdict | None:
    """Return the nearest of the solvers that apply to a scene, each as it is or with one thing changed."""
    searches = searches_beside(scene, readings, names)
    return as_they_are(searches) or with_one_change(searches)


def searches_beside(scene: Scene, readings: Sequence[Reading], names: Iterable[str]) -> list[SolverSearch]:
    """Return the searches beside those solvers that apply to a scene, for each reading of a history."""
    searches = []
    for name in names:
        solver = get_solver(name)
        # the damped continuum takes minutes over long histories
        is_slow = name == WITHOUT_SCHEME and scene.time.discount != 1
        if solver.refusal(scene) is not None or solver.missing(scene) is not None or is_slow:
            continue
        try:
            searches += [SolverSearch(scene, reading, name) for reading in readings]
        except InputError:  # an exact solution has an end
            if name == DDA:
                raise
    return searches


def as_they_are(searches: Sequence[SolverSearch]) -> RunVerdict | None:
    """Return the nearest of the solvers whose run of the scene as it is explains a history, if one does."""
    own = [search for search in searches if search.is_scene(MESH if search.model else 0.0)]
    if not own:
        return None
    nearest = min(own, key=lambda search: (len(search.reading.corrected), search.left(search.scene_run)))
    return _named(RunVerdict(nearest, True))


def with_one_change(searches: Sequence[SolverSearch]) -> RunVerdict | None:
    """Return the nearest of the solvers, each with one thing changed in the scene."""
    nearest: dict[str, SolverSearch] = {}
    for search in sorted(searches, key=lambda search: search.left(search.scene_run)):
        nearest.setdefault(search.model, search)  # of each solver the reading that comes nearest to it
    verdicts = []
    for search in nearest.values():
        verdict = _named(verdict_of(search, search.explanations()))
        if verdict.explained:
            return verdict
        verdicts.append(verdict)
    return min(verdicts, key=lambda verdict: verdict.left, default=None)


def _named(verdict: RunVerdict) -> RunVerdict:
    """Return a verdict with the names of what yields a little, a base, and of a solver that has no scheme."""
    causes = dict(verdict.causes)
    softness = -math.log(causes.get("springs-factor") or 1.0)
    if 0 < softness < 2 * BENIGN_COMPLIANCE:
        causes = {"base-compliance": softness}
    if verdict.explained and verdict.search.model == WITHOUT_SCHEME:
        causes["exact-in-time"] = None
    new_words = {name: words_of(name, value or 0.0) for name, value in causes.items() if name not in verdict.causes}
    return replace(verdict, causes=causes, words={**verdict.words, **new_words})


def judged_without_rectangle(scene: Scene, foreign: Foreign) -> Answer:
    """Return the answer for a block that is no upright rectangle, or that turns: linear models alone are tried."""
    searches = searches_of(scene, foreign, partial(SolverSearch, name=DDA))
    verdict = verdict_of_solvers(scene, [search.reading for search in searches], (DDA, "fem"))
    note = "the block is not an upright rectangle: opening and updated geometry are not tried"
    return answer_of(replace(foreign, notes=(*foreign.notes, note)), verdict or RunVerdict(searches[0], False))
