"""Error against run time: points, fronts, the command, and the kill matrix of the study's gates."""

from dataclasses import replace
from pathlib import Path

import pytest
from conftest import beside
from faults import seams
from faults.fault import Fault, swapped, with_scheme
from faults.kill_matrix import check_kill_matrix
from oracles.pages import table
from typer.testing import CliRunner

from validation.cli.app import app
from validation.engine.run import run_study
from validation.errors import InputError
from validation.runs.results import Results
from validation.suite.folders import get_study

WORK_PRECISION = get_study("work-precision")

ROOT = Path(__file__).parents[2]
COARSE = replace(WORK_PRECISION, timed=False)  # the repeats of a study of timings are tested apart
LEVELS = 2  # of the first scene, the coarsest ones
FIRST = WORK_PRECISION.scenes[0].model_copy(
    update={"sweep": {key: x if key == "mode" else x[:LEVELS] for key, x in WORK_PRECISION.scenes[0].sweep.items()}}
)
FEW = replace(COARSE, scenes=[FIRST], gates=tuple, derived=tuple)
PAIRS = tuple((case.scene.name, case.solver) for case in FEW.cases())


@pytest.fixture(scope="module")
def few(tmp_path_factory, finished_cases):
    """Return the results of the coarsest levels of one scene, by all four solvers."""
    kept = beside(finished_cases, tmp_path_factory.mktemp("few"))
    run_study(FEW, kept)
    return kept


def heavier_on_coarse_meshes(sound):
    """An error of first order in h."""
    return lambda basis, *a, **k: (1 + basis.N**-0.5) * sound(basis, *a, **k)


def kept_velocity(gg):
    """A discount that does not vanish with the step."""
    return 0.999 * gg


FAULTS = [
    Fault("dda: a discount", ("dda",), seams.DDA_VELOCITY, with_scheme(0, gg=kept_velocity)),
    Fault("dda: other start", ("dda",), seams.DDA_START, with_scheme(0, start=swapped)),
    Fault("dda: delta 1/2", ("dda",), seams.DDA_VELOCITY, with_scheme(0, delta=lambda d: 0.5)),
    Fault("fem: column 0.1 % soft", ("fem",), seams.FEM_COLUMN, lambda sound: lambda p: sound(softer(p))),
    Fault("fem: mass of first order", ("fem",), seams.FEM_MASS, heavier_on_coarse_meshes),
]


def softer(problem):
    return replace(problem, young=0.999 * problem.young)


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    check_kill_matrix(COARSE, COARSE.cases(), list(COARSE.gates()), FAULTS, tmp_path, finished_cases)


def test_rows_are_a_table_of_every_run(few, tmp_path):
    where = ["--results", str(few.directory)]
    assert CliRunner().invoke(app, ["rows", "work-precision", "--csv", str(tmp_path / "a.csv"), *where]).exit_code == 0
    lines = table(tmp_path / "a.csv")
    assert len({(line["case"], line["solver"]) for line in lines if line["case"]}) >= len(PAIRS) == 4 * LEVELS
    assert {"time.step", "solver", "reference", "window", "metric", "value", "unit"} <= set(lines[0])
    assert {("continuum", "displacement.l2"), ("", "work.solves")} <= {
        (one["reference"], one["metric"]) for one in lines
    }
    assert isinstance(CliRunner().invoke(app, ["rows", "core", *where]).exception, InputError)


def test_a_study_of_timings_repeats_and_keeps_the_spread(tmp_path):
    one = FIRST.model_copy(update={"sweep": {}})
    kept = Results(tmp_path)
    run_study(replace(FEW, scenes=[one], timed=True), kept, jobs=2)
    assert len(kept.rows()) == 4
    assert all("least seconds of 3 repeats, spread" in row.notes[-1] for row in kept.rows().values())
