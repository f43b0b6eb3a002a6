"""A history beside other solvers of the suite, and beside linear DDA where no candidate change of a block steps it.

Candidates, fits and decision are those of `beside`. What a mesh leaves beside an exact solution counts as noise.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from validation.diagnosis import evidence
from validation.diagnosis.answer import Answer
from validation.diagnosis.beside import Candidate, RunExplanation, RunVerdict, SceneSearch, answer_of, verdict_of
from validation.diagnosis.causes import BENIGN_COMPLIANCE, words_of
from validation.diagnosis.constants import CLEARLY, DISCOUNTS, SLIGHT
from validation.diagnosis.evidence import Departure
from validation.diagnosis.fits.bar import Bar
from validation.diagnosis.moves import FACTORS
from validation.diagnosis.numbers import Values
from validation.diagnosis.one_change import Fitted, of_discount, of_numbers, of_schemes
from validation.diagnosis.reading import Foreign, steppings
from validation.diagnosis.readings import Reading, slips, without_slips
from validation.diagnosis.variant import rectangle_of
from validation.errors import InputError
from validation.metrics.contact import SHIFT
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

CANDIDATES = {"springs-factor", "density-factor", "young-factor", "load-factor", "gg"}  # numbers that are tried
STARTS = tuple(FACTORS[len(FACTORS) // 4 : -len(FACTORS) // 4])  # to begin from: the middle half of those of a block
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
        self.solver = get_solver(name)
        self.is_slow = self.solver.meshed
        if self.is_slow:
            self.patience = 1  # a run of a mesh is too dear for what comes no nearer in the first rows
        if name != DDA:
            self.model = name
            self.model_words = name + EXACT.get(name, "")
        roundings = [None] * len(reading.recorded) if reading.rounding is None else list(reading.rounding)
        self.bars = [Bar.of(values, unit) for values, unit in zip(reading.recorded, roundings, strict=True)]
        super().__init__(reading.scene_of(scene), reading)

    def candidates(self) -> Iterator[Candidate]:
        """Yield schemes, where the solver has one, and single numbers."""
        if self.solver.name != WITHOUT_SCHEME:
            yield from of_schemes(self.scene)
            yield of_discount(self.scene, DISCOUNTS)
        starts = STARTS[:: FEW if self.is_slow else 1]
        yield from (each for each in of_numbers(self.scene, starts, units=False) if each.id in CANDIDATES)

    def explanations(self, begun: Sequence[Fitted[Values]] = ()) -> list[RunExplanation]:
        """Return the candidates as `SceneSearch` does; of a fine mesh those that a coarse one takes for possible."""
        mesh = self.scene.fem
        if begun or not self.solver.meshed or mesh.mesh is not None or mesh.per_side <= COARSE:
            return super().explanations(begun)
        coarse = SolverSearch(self.scene.with_values({"fem.elements": COARSE}), self.reading, self.solver.name)
        coarse.changes = self.changes  # of numbers that have nothing to do with a mesh
        sizes = np.maximum(np.linalg.norm(self.scene_run, axis=1), np.finfo(float).tiny)
        error = float(np.max(np.linalg.norm(coarse.scene_run - self.scene_run, axis=1) / sizes))
        near = [each for each in coarse.explanations() if each.explains or each.left <= CLEARLY * error]
        return super().explanations([each.candidate for each in near]) if near else []

    def solved(self, values: Values, steps: int, is_shifted: bool) -> Array | None:
        """Return displacement and pressure of a change, springs stiffer by `SHIFT` where it is shifted."""
        try:
            scene = self.scene.with_values(values | {"time.steps": steps})
            if is_shifted:
                scene = scene.with_values({"contact.stiffness": scene.contact.stiffness * (1 + SHIFT)})
            run = self.solver.solve(scene)
        except InputError:  # the step lies beyond the limit of the scheme
            return None
        columns = np.array([run.displacement, run.contact_pressure])
        return columns if np.all(np.isfinite(columns)) else None

    def is_noise(self, columns: Array) -> bool:
        """Whether columns leave noise of a linear motion, or beside an exact solution what a mesh does."""
        is_exact = self.model and not self.solver.meshed
        least = min(MESH, SLIGHT * self.left(self.scene_run)) if is_exact else 0.0
        if self.left(columns) <= least:
            return True
        if self.rows < self.recorded.shape[1]:  # a run without bounds
            return False
        return all(bar.holds(row) for bar, row in zip(self.bars, self.recorded - columns, strict=True))

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
    readings = []
    for stepping in steppings(foreign, scene.time.step):
        if np.ptp(stepping.steps) == 0:
            run = get_solver(DDA).solve(without_slips(foreign, stepping).scene_of(scene))
            readings += slips(foreign, stepping, run.displacement[stepping.rows], run.contact_pressure[stepping.rows])
    verdict = verdict_of_solvers(scene, readings, (DDA, "fem"))
    if verdict is None:
        raise InputError("the times of the history are not uniform, which this scene needs", source=scene.name)
    note = "the block is not an upright rectangle: opening and updated geometry are not tried"
    return answer_of(foreign, verdict, notes=[note])
