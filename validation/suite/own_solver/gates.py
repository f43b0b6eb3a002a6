"""The gates that a user's solver goes through, what each of them tells, and what a history shows in place of a report.

A solver that is one function reports no modes and no static solution. Its history shows them all the same (`history`).
"""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace

from validation.engine.case import Case
from validation.engine.judge import reads
from validation.engine.study import Study
from validation.gates.gate import Gate
from validation.metrics.catalogue import CATALOGUE, HISTORY, MODES, REFERENCE, STATIC
from validation.scenes import features
from validation.scenes.keys import is_fulfilled
from validation.scenes.scene import Scene, load_scene
from validation.suite.bands import about, near
from validation.suite.folders import get_study, judged_studies
from validation.suite.matrix import JUDGED
from validation.suite.own_solver import block_data
from validation.suite.own_solver.history import FREQUENCY, PENCIL
from validation.theory import spectra
from validation.theory.spectra import rounding

GROUPS = {  # in the order in which a person looks: a fault in one shows in those after it
    "statics": "displacement at rest: load, springs, Young's modulus, size",
    "frequency": "natural frequency, whatever damps it: mass, springs, alpha",
    "damping": "damping ratio: delta, gg",
    "start": "first step: initial acceleration, first row",
    "digits": "displacement, step by step",
    "pressure": "contact pressure: its formula, its time",
}
# Gates on scenes with another datum each, which no slip of the scheme reaches: they are judged by themselves.
BLOCK_DATA = "block data"
BLOCK_DATA_WORDS = "width and height, Poisson's ratio, plane strain, shear springs, place of the load"
REPORTABLE = frozenset({HISTORY, STATIC, MODES, REFERENCE})  # what a user's solver, or a reference, can report
FIRST = 1e-3  # relative: what a file of few digits may lose in the first row
SHOWN = ("displacement.static", "mode1.frequency", "mode1.damping", "mode1.measured_damping")  # by a history


def _start() -> Iterator[Gate]:
    """Yield the gates on the first step and what follows, from zero and from consistent acceleration."""
    first = "the first step from rest, to three digits: a wrong initial acceleration changes it by half or by all of it"
    history = "matrix pencil on the displacement, which holds the ratio and, with alpha and gg, the natural frequency"
    same = "same equations, rounding apart (see the core study)"
    for scene in starts():
        high, pair, frequency = rounding(scene), (JUDGED, "dda-textbook"), spectra.dda_frequency(scene)
        ratio = spectra.damping_ratio(scene, frequency)
        yield Gate(scene.name, pair, "displacement.max", 0, FIRST, first, until=scene.time.step)
        if scene.time.discount == 1:  # a slip in gg changes the root, and is one of damping
            yield Gate(scene.name, (JUDGED,), "mode1.frequency", *near(frequency, FREQUENCY), history)
        yield Gate(scene.name, (JUDGED,), "mode1.measured_damping", *about(ratio, PENCIL), history)
        for metric in ("displacement.max", "pressure.max"):
            yield Gate(scene.name, pair, metric, 0, high, same)


# what gates may see of a solver: a kind of scene in words, and what its tables say, as of `features.Feature`
KINDS: Mapping[str, tuple[str, ...]] = {
    "a rectangle that is no square": ("block.height",),
    "Poisson's ratio": ("block.poisson",),
    "plane strain": ('block.hypothesis = "plane strain"', "block.poisson"),
    "shear springs of their own stiffness": ("contact.shear_stiffness",),
    "an off-centre load": ("load.eccentricity",),
    "an outline that is no rectangle": ("block.vertices",),
    "a shear load": ("load.traction",),
    "gravity": ("load.gravity",),
    "contact that opens": ('contact.law = "unilateral"',),
    "friction": ("contact.friction",),
    "a base that moves": ("load.base_motion",),
    "a gap at the start": ("contact.gap",),
    "a velocity at the start": ("block.velocity",),
    "viscous damping": ("damping.present",),
}


def unseen(scenes: Iterable[Scene]) -> list[str]:
    """Return the kinds of scenes that none of some scenes is."""
    every = [scene.tables() for scene in scenes]
    return [
        kind
        for kind, says in KINDS.items()
        if not any(all(is_fulfilled(one, "", tables) for one in says) for tables in every)
    ]


@functools.cache
def starts() -> tuple[Scene, ...]:
    """Return the scenes in which the initial acceleration counts: average acceleration, with and without discount."""
    plain = load_scene("figure-8").with_values({"time.alpha": 0.25, "time.delta": 0.5})
    undiscounted = [plain.with_values({"time.start": start}, label=True) for start in ("zero", "consistent")]
    return (*undiscounted, plain.with_values({"time.start": "consistent", "time.gg": 0.95}, label=True))


START = Study(
    "own-solver",
    "Your own solver",
    "Initial accelerations, of which the paper's scenes have one only, and data of the block that they never change.",
    (*starts(), *block_data.scenes()),
    (JUDGED, "dda-textbook"),
    gates=lambda: (*_start(), *block_data.gates(JUDGED)),
)


# ---- which gates ----


@functools.cache
def study_of(name: str) -> Study:
    """Return a study by name, without the repeats of timings, of which no gate speaks."""
    return START if name == START.name else replace(get_study(name), timed=False)


@functools.cache
def applying() -> Mapping[str, tuple[str, Gate]]:
    """Return the gates on the two-block model of `dda`, and those on the start, which are for users' solvers alone.

    Bands are formulas, of seconds where a limit is searched: those of studies without such a case are not computed.
    """
    by_id: dict[str, tuple[str, Gate]] = {}
    for study in judged_studies():
        if any(map(_is_two_blocks, cases(study).values())):
            by_id |= {gate.id: (study, gate) for gate in get_study(study).gates() if applies(study, gate)}
    return by_id | {gate.id: (START.name, gate) for gate in START.gates()}


@functools.cache
def cases(study: str) -> Mapping[tuple[str, str], Case]:
    """Return the cases of a study by scene and solver."""
    return {(case.scene.name, case.solver): case for case in study_of(study).cases()}


@functools.cache
def asked(studies: tuple[str, ...]) -> Mapping[tuple[str, str], frozenset[str]]:
    """Return the metrics that the gates of some studies read, by scene and solver."""
    metrics_by_case: dict[tuple[str, str], set[str]] = {}
    for study in studies:
        for gate in get_study(study).gates():
            for case, metric in reads(gate, study_of(study).recipes):
                metrics_by_case.setdefault(case, set()).add(metric)
    return {case: frozenset(metrics) for case, metrics in metrics_by_case.items()}


def applies(study: str, gate: Gate) -> bool:
    """Whether a gate is one on the two-block model of `dda`.

    What a user's solver has no way to report, such as the solves of a step, is not asked of it.
    """
    case = cases(study).get(gate.cases[0])
    return case is not None and _is_two_blocks(case) and CATALOGUE[gate.metric].needs <= REPORTABLE


def _is_two_blocks(case: Case) -> bool:
    """Whether it is one of the two-block model of `dda`: one block, a centred pressure, a sound history."""
    beyond = features.FIRST | {case.scene.kind.feature}  # a block, whose kind has none, under a centred pressure
    is_sound = "stability" not in case.measures
    return case.solver == JUDGED and is_sound and beyond.isdisjoint(features.of(case.scene))


def group(gate: Gate, scene: Scene) -> str:
    """Return which of `GROUPS` a gate belongs to, or `BLOCK_DATA`."""
    if scene.name in block_data.datum_of():
        return BLOCK_DATA
    if gate.metric.startswith("pressure."):
        return "pressure"
    if gate.metric in ("displacement.static", "displacement.final"):
        return "statics"
    if gate.metric.startswith("mode1.") and "frequency" in gate.metric:
        return "frequency"
    if gate.metric.startswith(("mode1.", "contact.", "energy.")):
        return "damping"
    return "start" if gate.until == scene.time.step else "digits"


# ---- what a solver does not report ----


def lacking(gate: Gate, scene: Scene, parts: Collection[str]) -> str | None:
    """Return the part of the contract without which a gate measures nothing, None where a solver has what it takes.

    `scene` is that of the judged side, `parts` what the solver reports beside its history, among "modes" and "static".
    """
    if shown_by_history(gate, scene):
        return None
    if gate.metric.endswith(".static"):
        return None if "static" in parts else "static"
    return "modes" if MODES in CATALOGUE[gate.metric].needs and "modes" not in parts else None


def shown_by_history(gate: Gate, scene: Scene) -> bool:
    """Whether the history shows what a gate of one solver asks for."""
    if len(gate.pair) != 1 or gate.metric not in SHOWN:
        return False
    rests = gate.metric == "displacement.static" and scene.name in block_data.datum_of()
    return rests or (scene.block.poisson == 0 and scene.block.vertices is None)
