"""Error against run time: rivals, window and norm, what reaches an error, a user's block, and the kill matrix."""

import re
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from faults.fault import changed_fields
from faults.fault_table import faults_of
from faults.kill_matrix import check_kill_matrix
from oracles.made_cases import made_history, made_row
from typer.testing import CliRunner

from validation.cli.app import app
from validation.errors import InputError
from validation.scenes.scene import load_scene
from validation.solvers.registry import solve
from validation.studies.cost import formulas, measures
from validation.studies.cost.answer import answer
from validation.studies.cost.ladder import Ladder, Method, first_period, landing, methods
from validation.studies.cost.rivals import ModalFilter, PlainLoop
from validation.suite.folders import folder_of, get_study, study_of_scene

COST = get_study("cost")
COARSE = replace(COST, timed=False)  # the repeats of a study of timings are tested apart
PAPER = load_scene("cost-paper")
GRANITE = load_scene("cost-granite")
OPENING = load_scene("cost-opening")
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
CONSTANT = {"time.alpha": 0.5, "time.delta": 1.0, "time.gg": 0.99}


# ---- rivals -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", [AVERAGE, CONSTANT], ids=["average", "constant"])
@pytest.mark.parametrize("block", [PAPER, GRANITE, OPENING], ids=["paper", "granite", "opening"])
def test_the_plain_loop_steps_the_block_of_one_strain(block, scheme):
    scene = block.with_values(scheme)
    ours = solve(scene, "dda").history
    theirs = PlainLoop().solve(scene).history
    for name, column in theirs.columns.items():
        assert np.abs(column - ours.columns[name]).max() < 1e-9 * np.abs(column).max()


def filtered(b, a, x):
    """Return what `lfilter` does of second order, whose import takes long."""
    y = np.zeros(len(x) + 2)
    before = np.concatenate([[0.0], x])
    for n in range(len(x)):
        y[n + 2] = (b[0] * before[n + 1] + b[1] * before[n] - a[1] * y[n + 1] - a[2] * y[n]) / a[0]
    return y[2:]


def test_filtered_modes_are_the_bar(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.signal", SimpleNamespace(lfilter=filtered))
    fine = {"time.step": 2e-4, "time.steps": 40, "fem.elements": 128, "block.width": 0.7, "block.height": 2.0}
    modal = ModalFilter().solve(PAPER.with_values(fine))
    exact = solve(PAPER.with_values(fine), "continuum").history
    for name, column in modal.history.columns.items():
        assert np.abs(column - exact.columns[name]).max() < 4e-4 * np.abs(column).max()
    assert modal.work == {"unknowns": 128, "factorisations": 0, "solves": 128, "steps": 40}
    hanging = ModalFilter().solve(PAPER.with_values(fine | {"load.gravity": 2e3})).history
    meshed = solve(PAPER.with_values(fine | {"load.gravity": 2e3, "fem.elements": 16} | AVERAGE), "fem").history
    for name, column in hanging.columns.items():
        assert np.mean(column) == pytest.approx(np.mean(meshed.columns[name]), rel=2e-3)
    assert ModalFilter().applicable(PAPER.with_values({"time.gg": 0.9}))
    assert ModalFilter().applicable(PAPER.with_values({"block.poisson": 0.1}))


# ---- window and norm ----------------------------------------------------------------------------------------------


def test_the_window_is_in_periods_of_the_first_mode_from_the_landing_on():
    (first, _) = solve_modes(PAPER)
    assert first_period(PAPER) == pytest.approx(2 * np.pi / first, rel=1e-9)
    assert landing(PAPER) == 0.0
    assert landing(OPENING) == pytest.approx(np.sqrt(2 * 1e-4 / 9.81))
    assert landing(OPENING.with_values({"block.velocity": -0.5, "load.gravity": 0.0})) == pytest.approx(2e-4)
    thrown = landing(OPENING.with_values({"block.velocity": 0.1, "contact.gap": 0.0}))
    assert thrown == pytest.approx(2 * 0.1 / 9.81)


def solve_modes(scene):
    from validation.solvers.registry import get_solver

    return sorted(mode.frequency for mode in get_solver("dda").modes(scene))


def test_errors_are_of_means_of_means():
    """A constant doubled from t = 0 on is 100 % off in every mean; a zigzag of one step is nearly nothing in them."""
    ladder = SimpleNamespace(mean=1.0)
    flat, steps = np.ones(100), np.arange(100)
    reference, double = made_history(0.1, flat, flat), made_history(0.1, 2 * flat, 2 * flat)
    zigzag = made_history(0.1, flat + 0.1 * (-1.0) ** steps, flat)
    assert measures.errors(ladder, double, reference) == {
        "displacement": pytest.approx(1.0),
        "force": pytest.approx(1.0),
    }
    found = measures.errors(ladder, zigzag, reference)
    assert found["displacement"] < 2e-3 and found["force"] == 0.0


# ---- what reaches an error ----------------------------------------------------------------------------------------


def made_run(name, level, error, work=1.0):
    method = Method(name, name, "dda", {}, ())
    return measures.Run(method, level, {"error.force": error, "work": work})


def test_a_run_reaches_an_error_if_all_finer_ones_of_its_method_do():
    runs = [made_run("a", 8, 0.005), made_run("a", 16, 0.02), made_run("a", 32, 0.009), made_run("b", 8, 0.1)]
    assert measures.reaching(runs, "force", 0.01) == [runs[2]]
    assert measures.reaching(runs, "force", 0.1) == runs
    assert measures.reached(runs, "force") == 2
    assert measures.reached([made_run("a", 8, float("nan"))], "force") == 0


def test_work_counts_lines_of_python_and_numbers_of_compiled_loops():
    row = made_row("dda", {}, "w", work={"lines": 400, "unknowns": 20, "steps": 50})
    assert measures.effort(row) == 400 + 20 * 50 / measures.NUMBERS_A_LINE


# ---- orders -------------------------------------------------------------------------------------------------------


def test_the_grid_convergence_index_is_that_of_the_last_change():
    """Values 1 + n^-2 change by (3/4) n^-2: order 2, index 1.25 |last change| / (2^2 - 1)."""
    values = [1 + n**-2 for n in formulas.MESHES]
    metrics = formulas.grid_convergence([(None, made_history(0.1, [one] * 3, [2 * one] * 3)) for one in values])
    change = 0.75 * 32**-2 / values[-1]
    assert metrics["order.displacement"] == pytest.approx(2.0, abs=0.02)
    assert metrics["gci.displacement"] == pytest.approx(1.25 * change / (2 ** metrics["order.displacement"] - 1))
    assert metrics["gci.pressure"] == pytest.approx(metrics["gci.displacement"])


# ---- a user's block: what is run, and what is printed ----------------------------------------------------------------

MINE = {
    "block": {"width": 0.8, "height": 0.5, "density": 2400.0, "young": 2e9},
    "contact": {"stiffness": 5e8},
    "load": {"pressure": 1e5},
    "time": {"step": 1e-3, "steps": 10},
}


@pytest.mark.long
def test_a_user_s_block_is_run_and_told(tmp_path, monkeypatch):
    """Few methods, two levels each: the command runs the study of the scene and prints the cheapest ways."""
    short = tuple(replace(one, levels=one.levels[:2]) for one in methods() if one.id in ("fem-linear", "modal"))
    monkeypatch.setattr("validation.studies.cost.ladder.methods", lambda: short)
    monkeypatch.setattr(measures, "methods", lambda: short)
    path = tmp_path / "mine.toml"
    path.write_text("\n".join(f"{name} = {inline(table)}" for name, table in MINE.items()))
    run = CliRunner().invoke(app, ["run", "cost", "--scene", str(path), "--results", str(tmp_path / "results")])
    assert run.exit_code == 0, run.output
    assert "2 modes" in run.output and "no run gets there" in run.output


def inline(values):
    return "{ " + ", ".join(f"{key} = {value!r}" for key, value in values.items()) + " }"


def test_a_user_s_block_is_solved_by_all_methods_that_take_it():
    mine = study_of_scene("cost", "cost-paper", {"block.poisson": 0.2, "time.gg": 0.9})
    ladder = Ladder.of(PAPER.with_values({"block.poisson": 0.2, "time.gg": 0.9}))
    left_out = {scene.name for scene in ladder.scenes()} - {scene.name for scene in mine.scenes}
    assert left_out == {f"cost-paper-{name}" for name in ("bar", "continuum", "bar-events", "loop", "modal")}
    assert (mine.name, mine.gates(), len(mine.derived())) == ("cost-of-cost-paper", (), 59)
    assert folder_of(mine.name).path.name == "cost"


def test_the_cheapest_ways_are_told_with_the_reference():
    """Numbers of the text: window and mean in ms, and per cent that the reference may be off."""
    told = {"window": 0.01254, "mean": 0.0047548, "label": "a mesh", "uncertainty.force": 0.00234}
    way = {"who": measures.OWN, "quantity": "force", "accuracy": "1 %", "way": "few", "step": 0.00213, "work": 417.0}
    way |= {"seconds": 0.49849, "setup": 0.79951}
    derived = [{"name": measures.REFERENCE, "metrics": told}, {"name": "cheapest", "metrics": way}]
    derived.append({"name": "none", "metrics": {}})
    table_of_ways, text = answer({"derived": derived})
    (row,) = table_of_ways.rows
    assert [str(cell) for cell in row] == ["force", "1 %", "dda", "few", "2.13", "498", "800", "417"]
    assert re.findall(r"[\d.]*\d", text.text) == ["2", "12.5", "4.75", "0.23"]


@pytest.mark.parametrize(
    ("study", "scene", "values", "field"),
    [
        ("core", "cost-paper", {}, "--scene"),
        ("cost", "columns-weight", {}, "--scene"),
        ("cost", "figures-3-4", {}, "sweep"),
        ("cost", "cost-opening", {"contact.gap": 1.0}, "contact.gap"),
        ("cost", "cost-opening", {"load.gravity": 0.0, "load.pressure": -1e5}, "block"),
        ("cost", "cost-paper", {"damping.kinetic": "adaptive"}, "damping.kinetic"),
    ],
)
def test_what_a_study_cannot_be_run_for_is_refused(study, scene, values, field):
    with pytest.raises(InputError) as caught:
        study_of_scene(study, scene, values)
    assert caught.value.field == field


# ---- faults -------------------------------------------------------------------------------------------------------


def heavier_on_coarse_meshes(sound):
    """An error of first order in h."""
    return lambda basis, *a, **k: (1 + basis.N**-0.5) * sound(basis, *a, **k)


def of_newmark(**changes):
    """Another scheme in place of Newmark's; a discount that it sets does not vanish with the step."""

    def wrap(sound):
        def faulty(scene):
            scheme = sound(scene)
            if scene.time.scheme != "newmark":
                return scheme
            return replace(scheme, **changed_fields(scheme, changes))

        return faulty

    return wrap


def softer(share):
    """Elements of another modulus, by a share that may depend on how many there are."""
    return lambda sound: lambda p: sound(replace(p, young=p.young * (1 - share(p.elements))))


def by_one_element(elements):
    return 1 / elements


def where_fine(elements):
    return 0.1 * (elements > 40)


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    faults = faults_of("cost", globals())
    check_kill_matrix(COARSE, COARSE.cases(), list(COARSE.gates()), faults, tmp_path, finished_cases)
