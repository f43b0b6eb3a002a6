"""The contract: a solver refuses what it does not handle, and what has no meaning is not measured or judged."""

import numpy as np
import pytest
from faults import seams
from oracles.processes import answer_here

from validation.engine.measure import completed
from validation.engine.run import run_study
from validation.errors import InputError
from validation.gates.gate import Gate
from validation.metrics.catalogue import CATALOGUE
from validation.metrics.values import NOT_REPORTED
from validation.results import Results
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import load_scene, parse_scene
from validation.solvers import registry
from validation.solvers.contract import Solver
from validation.solvers.names import check_names
from validation.solvers.registry import get_solver
from validation.suite import Study

JOINTS = "rusty joints"


class Jointed(Solver):
    """A solver of a feature that no other solver knows."""

    name = "jointed"
    handles = features.FIRST | {JOINTS}
    sources = ("validation.solvers",)

    def solve(self, scene, full=False, fields=None):
        time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
        return Run(Outcome.COMPLETED, History(time, {name: np.sin(time) for name in scene.run.columns}))


@pytest.fixture
def jointed(scene_file, monkeypatch):
    """Return a scene with a feature that is one line of the table, and register its solver by another line."""
    feature = features.Feature(JOINTS, 'block.hypothesis = "plane strain"', linear=False)
    monkeypatch.setattr(features, "FEATURES", (*features.FEATURES, feature))
    monkeypatch.setitem(registry.BUILT_IN, "jointed", f"{__name__}:Jointed")
    seams.IMPORTED_SOLVER.wrap(
        monkeypatch, lambda sound: lambda target: Jointed if target.endswith(":Jointed") else sound(target)
    )
    return load_scene(scene_file).with_values({"block.hypothesis": "plane strain"})


def test_a_users_function_that_does_not_name_the_feature_is_not_run(jointed, tmp_path, monkeypatch):
    (tmp_path / "plain.py").write_text("def solve(scene):\n    raise RuntimeError('was run')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    answer_here(monkeypatch)
    run = completed(get_solver("plain:solve"), jointed)
    assert run.outcome is Outcome.NOT_APPLICABLE and JOINTS in run.notes[-1]


def test_no_metric_and_no_gate_on_modes_or_statics_of_a_scene_that_is_not_linear(jointed, tmp_path):
    metrics = [name for name, metric in CATALOGUE.items() if "reference" not in metric.needs]
    gates = tuple(Gate(jointed.name, ("jointed",), metric, -1e9, 1e9, "a test") for metric in metrics)
    study = Study("jointed", "t", "p", [jointed], ("jointed", "dda"), gates=lambda: gates)
    verdicts = run_study(study, Results(tmp_path))
    judged = {verdict.gate.metric for verdict in verdicts}
    assert {"displacement.final", "pressure.minimum"} <= judged
    assert not {name for name in judged if CATALOGUE[name].linear}
    row = next(row for row in Results(tmp_path).rows().values() if row.solver == "jointed")
    assert row.metrics["mode1.frequency"] == row.metrics["displacement.static"] == NOT_REPORTED


def test_a_gate_of_a_scene_file_that_could_judge_nothing_is_refused(jointed):
    gate = {"pair": ["jointed"], "metric": "mode1.frequency", "band": [0.0, 1e9], "reason": "a test"}
    asked = parse_scene(jointed.definition() | {"run": {"solvers": ["jointed"]}, "gate": [gate]}, "mine.toml")
    with pytest.raises(InputError, match=rf"gate\.0\.metric: mode1\.frequency .*{JOINTS}"):
        check_names(asked, "mine.toml")
    swept = parse_scene(
        asked.definition() | {"sweep": {"block.hypothesis": ["plane strain", "plane stress"]}}, "mine.toml"
    )
    check_names(swept, "mine.toml")  # one of its cases is linear
