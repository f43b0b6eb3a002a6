"""Users' solvers: by name, by entry point, through the gates; what is wrong with one is named."""

import os
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from conftest import SCENE, cli
from faults import seams
from oracles.processes import answer_here

from validation.engine.case import Case
from validation.engine.measure import execute
from validation.errors import InputError
from validation.metrics.values import NOT_REPORTED
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.solvers import registry
from validation.solvers.processes.user_worker import answering
from validation.solvers.registry import get_solver, is_solver
from validation.solvers.user import UserSolver
from validation.suite.folders import scene_study

HERE = Path(__file__).parent / "user_solvers"


@pytest.fixture
def scene(scene_file, monkeypatch):
    monkeypatch.syspath_prepend(str(HERE))
    answer_here(monkeypatch)
    return load_scene(scene_file)


def test_no_answer_is_refused_for_what_the_built_in_solver_does_not_take(scene, tmp_path):
    """DDA takes no base that is elsewhere than at zero where contact opens; another program's answer stands."""
    (tmp_path / "base.csv").write_text("time,x,y\n0,0.001,0\n1,0.001,0\n")
    moved = load_scene("field-opening").with_values({"load.base_motion": str(tmp_path / "base.csv"), "time.steps": 3})
    with pytest.raises(InputError, match="motion"):
        get_solver("dda").solve(moved)
    run = get_solver("named:Named").solve(moved.with_values({"title": "hostile:sound"}))
    assert run.outcome is Outcome.COMPLETED, run.notes


def test_what_is_not_reported_is_not_made_up(scene):
    scenes = [scene.with_values({"title": f"my_solver:{name}"}) for name in ("displacement_only", "Reporting")]
    row, _ = execute(Case(scenes[0], "named:Named"), "key", "study")
    assert row.metrics["displacement.static"] == row.metrics["mode1.damping"] == NOT_REPORTED
    assert row.metrics["pressure.final"] == NOT_REPORTED
    assert row.metrics["displacement.settling_step"] == 44.0  # measured from the block's own static value
    row, _ = execute(Case(scenes[1], "named:Named"), "key", "study")
    assert (row.metrics["displacement.static"], row.metrics["mode1.frequency"]) == (-0.01, 317.0)


def test_every_request_is_answered_where_the_first_one_was(scene, tmp_path, monkeypatch):
    answer = answering("my_solver:Reporting")
    here = os.getcwd()
    monkeypatch.chdir(tmp_path)
    assert answer({"parts": ["static", "x"], "about": ()}) == {"parts": ["static"], "about": {}} and os.getcwd() == here


def test_names(scene, monkeypatch):
    points = [EntryPoint(name, "made:solve", registry.GROUP) for name in ("mine", "dda")]
    monkeypatch.setattr(registry.importlib.metadata, "entry_points", lambda group: points)
    assert registry.entry_points.__wrapped__() == {"mine": "made:solve"}
    assert registry.rank("fem") < registry.rank("fem:full") < registry.rank("fenicsx") < registry.rank("bar")
    assert registry.by_role("judged") == ["dda"] and registry.role("fem:full") == "repeat"
    assert isinstance(get_solver("my_solver:solve"), UserSolver)
    UserSolver("mine", "json.decoder:JSONDecoder").check_module()
    with pytest.raises(InputError):
        UserSolver("mine", "my_solver.part:solve").check_module()
    assert is_solver("fenicsx:2") and is_solver("a.b:c.d") and not is_solver("femm") and not is_solver("femm:2")
    with pytest.raises(InputError) as told:
        get_solver("femm:2")
    assert told.value.field == "solver" and "femm:2" in str(told.value.value)


def test_a_user_solver_always_runs_afresh(scene, tmp_path, monkeypatch):
    from validation.engine.run import run_study

    answer_here(monkeypatch)
    seams.ORIGIN.put(monkeypatch, lambda: {"python": "3", "commit": "here", "packages": {}})
    path = tmp_path / "own.toml"
    named = SCENE.replace("A small scene", "my_solver:solve")
    path.write_text(named + '[run]\nsolvers = ["named:Named", "dda"]\n')
    seen = []
    for _ in range(2):
        study = replace(scene_study(str(path)), annotate=lambda *given: {"alarms": [], "budgets": []})
        run_study(study, Results(tmp_path / "r"), progress=lambda d, t, label: seen.append(label))
    assert sorted(label.split()[-1] for label in seen) == ["dda", "named:Named", "named:Named"]


@pytest.mark.long
def test_an_entry_point_is_a_name_everywhere(scene_file, tmp_path, monkeypatch):
    package = tmp_path / "site/my_package-1.0.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: my-package\nVersion: 1.0\n")
    (package / "entry_points.txt").write_text("[dda_validation.solvers]\nmine = my_solver:solve\n")
    path = os.pathsep.join([str(package.parent), str(HERE), os.environ.get("PYTHONPATH", "")])
    monkeypatch.setenv("PYTHONPATH", path)
    done = cli("solve", scene_file, "--solver", "mine", "--csv", tmp_path / "mine.csv")
    assert done.returncode == 0 and (tmp_path / "mine.csv").exists()
