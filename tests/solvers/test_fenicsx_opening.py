"""Contact that opens by two finite-element codes: equal to rounding with all their counts, slips of either seen."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned
from faults import seams

from validation import solve
from validation.runs.history import History
from validation.runs.run import Outcome
from validation.scenes.scene import Scene, load_scene
from validation.solvers import fenicsx as adapters_fenicsx
from validation.solvers.processes import worker
from validation.solvers.registry import get_solver
from validation.studies.two_codes.formulas import SAME

pytestmark = pytest.mark.xdist_group("fenicsx")  # one worker process serves them all
GLUED = {"load.eccentricity": 0.25, "block.poisson": 0.25, "contact.shear_stiffness": 4e8}
RUBBING = {"contact.friction": 25.0, "contact.cohesion": 1e5}
INCLINE = {"load.pressure": 0.0, "load.gravity": 98.1, "load.slope": 25.0, "contact.shear_stiffness": 4e8}
TRIED = {"load.eccentricity": 0.5, "load.traction": 2e6, "contact.solve_limit": 1, "time.step": 1e-3}
SHAKEN = {"load.base_motion": str(Path(__file__).with_name("shake.csv")), "load.gravity": 9.81}
SCENES = {  # constant acceleration: average acceleration multiplies rounding at impacts
    "centred": {"load.gravity": 9.81, "block.velocity": -0.2, "contact.gap": 1e-4, "time.gg": 0.99},
    "frictionless": {"load.eccentricity": -0.25, "block.poisson": 0.25, "contact.shear_stiffness": 0.0},
    "glued": GLUED | {"time.start": "consistent", "time.alpha": 0.5625},
    "corner": GLUED | {"fem.foundation": "corner", "load.eccentricity": 0.5},
    "triangles": GLUED | {"fem.cells": "triangles", "fem.degree": 1, "block.hypothesis": "plane strain"},
    "slow": {"block.velocity": -0.2, "contact.gap": 1e-5, "time.step": 2e-6},
    "cut": GLUED | {"load.eccentricity": 0.5, "contact.stiffness": 1e11, "time.step": 1e-3, "contact.solve_limit": 2},
    "rubbing": GLUED | RUBBING | {"load.traction": 1e6, "time.gg": 0.999, "contact.gap": 1e-5},
    "rubbing corners": GLUED | RUBBING | {"fem.foundation": "corner", "contact.gap": 1e-4, "load.traction": -1e6},
    "incline": INCLINE | {"contact.friction": 20.0, "contact.cohesion": 2e4, "fem.degree": 1, "block.velocity": -0.1},
    "shaken": RUBBING | SHAKEN | {"load.pressure": 2e5, "contact.shear_stiffness": 4e8, "block.poisson": 0.25},
    "shaken in pieces": GLUED
    | SHAKEN
    | {"load.eccentricity": 0.5, "contact.stiffness": 1e11, "time.step": 1e-3, "contact.solve_limit": 2},
    "few that rub": GLUED | RUBBING | TRIED | {"fem.elements": 2, "fem.degree": 1},
    "many that rub": GLUED | RUBBING | TRIED,
    "all states": GLUED | {"fem.elements": 2, "load.eccentricity": 0.5, "contact.solve_limit": 1, "time.step": 1e-3},
}

SHORT = ("centred", "cut", "shaken")  # of these in the short set


@pytest.fixture
def scene() -> Scene:
    """The paper's block on 8 elements a side, for 32 ms."""
    values = {"time.step": 2e-4, "time.steps": 160, "fem.elements": 8, "run.columns": adapters_fenicsx.OPENING_COLUMNS}
    return load_scene("unlocked").expand()[1].with_values(values)


def distance(scene: Scene, solver: str = "fenicsx") -> float:
    """Return the distance of a solver's history from that of `fem`."""
    return compared(scene, solver)[0]


def compared(scene: Scene, solver: str = "fenicsx") -> tuple[float, History]:
    """Return the largest difference from `fem`, over each column's size, of any column, and the history of `fem`.

    Displacements share a scale.
    """
    own, other = get_solver("fem").prepare(scene, full=True), get_solver(solver).prepare(scene)
    runs = own.run(), other.run()
    histories = [run.history for run in runs]
    if runs[0].outcome != runs[1].outcome or len(histories[0].time) != len(histories[1].time):
        return np.inf, histories[0]
    size = {name: float(np.abs(values).max()) for name, values in histories[0].columns.items()}
    size["horizontal_displacement"] = size["displacement"]
    size["base_shear"] = size["contact_pressure"]
    size |= dict.fromkeys(("open_share", "solves", "cuts"), 1.0)
    size |= dict.fromkeys(("largest_gap", "largest_penetration", "largest_slide"), size["displacement"])
    found = [
        float(np.abs(values - histories[1].columns[name]).max()) / size[name]
        for name, values in histories[0].columns.items()
    ]
    return max(found) if own.switches() == other.switches() else np.inf, histories[0]


@pytest.mark.fenicsx
@pytest.mark.parametrize(
    "name", thinned([name if name in SHORT else pytest.param(name, marks=pytest.mark.long) for name in SCENES], 3)
)
def test_the_two_codes_agree_on_contact_that_opens(scene: Scene, name: str) -> None:
    values = SCENES[name]
    case = scene.with_values(values)
    found, history = compared(case)
    assert 0 < found <= SAME
    assert 0 < history.columns["open_share"].mean() < 1
    assert (history.columns["largest_slide"].max() > 1e-4) == ("contact.friction" in values)
    if "contact.solve_limit" in values and "contact.friction" not in values:
        assert (history.columns["cuts"].max() > 0) == (case.fem.per_side == 8)


@pytest.mark.fenicsx
@pytest.mark.parametrize("name", ["pentagon", pytest.param("quadrilateral", marks=pytest.mark.long)])
def test_the_two_codes_agree_on_files_of_gmsh(name: str) -> None:
    contact: dict[str, object] = {"law": "unilateral", "stiffness": 1e9, "shear_stiffness": 4e8, "gap": 1e-4}
    contact |= {"friction": 20.0} if name == "pentagon" else {}
    values = {"contact": contact, "block.velocity": -0.5, "time.step": 5e-4, "time.steps": 60}
    case = load_scene(name).expand()[0].with_values(values | {"run.columns": adapters_fenicsx.OPENING_COLUMNS})
    found, history = compared(case)
    assert 0 < found <= SAME
    assert 0 < history.columns["open_share"].mean() < 1


@pytest.mark.long
@pytest.mark.fenicsx
@pytest.mark.parametrize("name", ["glued", "corner", "cut", "rubbing", "shaken"])
def test_ranks_share_one_contact(scene: Scene, name: str) -> None:
    assert 0 < distance(scene.with_values(SCENES[name]), "fenicsx:2") <= SAME


@pytest.mark.fenicsx
def test_a_step_without_a_contact_ends_the_history_by_name(scene: Scene) -> None:
    hopeless = scene.with_values(SCENES["glued"] | {"contact.solve_limit": 1})
    assert [solve(hopeless, name, full=True).outcome for name in ("fem", "fenicsx")] == [Outcome.NO_CONTACT_STATE] * 2


WORKER_MODULES = ("opening.py", "small.py", "model.py")
SLIPS = {  # a line of the worker, what a slip makes of it, and a scene that sees it
    "reference of a node that closes at its end": ("unstrained = slip +", "unstrained = slip + 0 *", "glued"),
    "gap remembers tension": ("np.where(forces.states != 0, -forces.N / law.k, forces.w)", "forces.w + 1e-6", "cut"),
    "a pulling node stays closed": ("forces.N >= 0", "forces.N >= -1e3", "frictionless"),
    "dead band of a micrometre": ("forces.w < 0)", "forces.w < -1e-6)", "slow"),
    "shares of the base uneven": ("parts / self.length, 0.0)", "1 / np.count_nonzero(parts), 0.0)", "glued"),
    "gg applied twice": ("self.V = gg * self.V", "self.V = gg * gg * self.V", "centred"),
    "gg of the whole step in a piece": ('self.request["gg"] ** share', 'self.request["gg"]', "cut"),
    "gap at the start forgotten": ('w + self.request["gap"]', "w", "centred"),
    "velocity at the start forgotten": ('[0.0, request["velocity"]]', "[0.0, 0.0]", "centred"),
    "friction begins late": ("np.abs(holding) > most", "np.abs(holding) > 1.5 * most", "rubbing"),
    "friction keeps a point that turns": ("-np.sign(states) * holding >=", "0 * holding >= 0 *", "shaken"),
    "no cohesion where a node slides": ("q[n + i] = -d * self.law.c[i]", "q[n + i] = 0.0", "rubbing corners"),
    "crossing of a node that slides": ("self.start.states == 0, self._passed(N)", "False, N", "incline"),
    "base a step late": ("self._way(self.time + dt)", "self._way(self.time)", "shaken"),
    "slope turned back": ("np.sin(angle)", "-np.sin(angle)", "incline"),
    "states of the end not set": ("states=forces.states,", "states=start.states,", "glued"),
}


def module_of(line: str) -> str:
    """Return the one module of the worker in which the line stands, once."""
    counts = {name: (adapters_fenicsx.WORKER / name).read_text().count(line) for name in WORKER_MODULES}
    (name,) = [name for name, count in counts.items() if count]
    assert counts[name] == 1
    return name


@pytest.mark.parametrize("line", [line for line, *_ in SLIPS.values()], ids=SLIPS)
def test_the_line_of_each_slip_stands_in_the_worker(line: str) -> None:
    assert module_of(line) in WORKER_MODULES  # where FEniCSx is not installed nothing else would see that it moved


@pytest.mark.long
@pytest.mark.fenicsx
@pytest.mark.parametrize(("line", "slip", "name"), SLIPS.values(), ids=SLIPS)
def test_a_slip_of_the_worker_is_seen(
    scene: Scene, line: str, slip: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(adapters_fenicsx.WORKER, tmp_path / "worker")
    module = tmp_path / "worker" / module_of(line)
    module.write_text(module.read_text().replace(line, slip))
    seams.FENICSX_WORKER.put(monkeypatch, tmp_path / "worker")
    case = scene.with_values(SCENES[name] | {"time.gg": 0.99})
    try:
        assert distance(case) > 100 * SAME
    finally:
        worker.close_all()
