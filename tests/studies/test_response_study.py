"""The study `response`: each of its gates is bitten by a fault, and its records are what its scenes say."""

import pytest
from faults.fault_table import faults_of
from faults.kill_matrix import check_kill_matrix, failed

from validation.engine.run import finish
from validation.runs.results import Results
from validation.studies.response.formulas import BASE
from validation.suite.folders import get_study

STUDY = get_study("response")


def another_frequency(sound):
    """Answer at a squared frequency that is a millionth off, and has turned by as much."""
    return lambda *a, **k: (lambda w2, factor: (w2 * (1 + 1e-6 + 1e-6j), factor))(*sound(*a, **k))


@pytest.mark.parametrize("number", range(3))
@pytest.mark.long
def test_a_response_at_another_frequency_is_seen_by_every_gate_on_it(number, finished_cases):
    fault = faults_of("response-answers", globals())[number]
    judged = [g for g in STUDY.gates() if g.metric not in ("damping.steps", "mode1.damping")]
    gates = [g for g in judged if reached(g, *fault.solvers)]
    finished = finish(STUDY.cases(), STUDY, Results(finished_cases))
    with pytest.MonkeyPatch.context() as patch:
        fault.seam.wrap(patch, fault.replacement)
        assert failed(finished, gates) == {gate.id for gate in gates}


def reached(gate, solver):
    """Return whether a gate judges a solver's response; the bar is also what the mesh is held against."""
    return gate.pair[0].startswith(solver) or (solver == "bar" and gate.metric.endswith(".mesh"))


@pytest.mark.long
def test_gates_on_steps_are_bitten(tmp_path, finished_cases):
    stepped = (BASE, "viscous")
    gates = [gate for gate in STUDY.gates() if gate.scene.startswith(stepped) or gate.metric == "damping.steps"]
    check_kill_matrix(STUDY, STUDY.cases(), gates, faults_of("response-steps", globals()), tmp_path, finished_cases)
