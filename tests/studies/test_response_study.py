"""The study `response`: each of its gates is bitten by a fault, and its records are what its scenes say."""

import numpy as np
import pytest
from faults import seams
from faults.fault import Fault, late, thousandth, with_scheme
from faults.kill_matrix import check_kill_matrix, failed

from validation.engine.run import finish
from validation.runs.results import Results
from validation.scenes.record import base_record
from validation.scenes.scene import load_scene
from validation.studies.response import formulas as response
from validation.studies.response.formulas import BASE, DAMPING, FREQUENCIES, LOW
from validation.suite.folders import get_study

STUDY = get_study("response")


def another_frequency(sound):
    """Answer at a squared frequency that is a millionth off, and has turned by as much."""
    return lambda *a, **k: (lambda w2, factor: (w2 * (1 + 1e-6 + 1e-6j), factor))(*sound(*a, **k))


ANSWERS = [
    Fault("dda", ("dda",), seams.DDA_ANSWERING, another_frequency),
    Fault("fem", ("fem",), seams.FEM_ANSWERING, another_frequency),
    Fault("bar", ("bar",), seams.BAR_ANSWERING, another_frequency),
]
STEPS = [
    Fault("dda: delta 0.1 % high", ("dda",), seams.DDA_CARRIED, with_scheme(0, delta=thousandth)),
    Fault("dda: delta of the velocity 0.1 % high", ("dda",), seams.DDA_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("fem: one step late", ("fem",), seams.FEM_RUN, late),
]


@pytest.mark.parametrize("fault", ANSWERS, ids=lambda fault: fault.name)
@pytest.mark.long
def test_a_response_at_another_frequency_is_seen_by_every_gate_on_it(fault, finished_cases):
    judged = [g for g in STUDY.gates() if g.metric not in ("damping.steps", "mode1.damping")]
    gates = [g for g in judged if reached(g, fault.name)]
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
    check_kill_matrix(STUDY, STUDY.cases(), gates, STEPS, tmp_path, finished_cases)


@pytest.mark.parametrize(("name", "frequencies", "step"), [(BASE, FREQUENCIES, 0.002), (DAMPING, LOW, 0.01)])
def test_records_are_sines_of_a_millimetre_of_whole_periods(name, frequencies, step):
    record = base_record(load_scene(name).expand()[0])
    assert record is not None
    sines = 1e-3 * np.sin(2 * np.pi * np.outer(frequencies, record.time)).sum(axis=0)
    assert np.allclose(record.time, step * np.arange(701), rtol=1e-14)
    assert np.allclose(record.y, sines, rtol=0, atol=1e-15)
    periods = np.array(frequencies) * step * response.WINDOWS[name]
    assert np.allclose(periods, np.round(periods), rtol=1e-12)
