"""Rows of the metrics that gates read, and no others: gates judge them as they judge whole rows."""

from dataclasses import replace

import pytest

from validation.engine.finished import Derived
from validation.engine.judge import evaluate, reads
from validation.engine.run import finish
from validation.engine.study import Study
from validation.gates.gate import Gate
from validation.runs.results import Results

MEASURED = "mode1.measured_damping"


def pencil(finished):
    return {"ratio": finished.rows["small", "dda"].metrics.get(MEASURED)}


def opening(scene, name="opening", stiffness=1e11):
    """Return the scene on springs that open, on which switches amplify rounding before the last step."""
    values = {"contact.law": "unilateral", "contact.stiffness": stiffness, "time.steps": 100}
    return scene.with_values(values | {"time.alpha": 0.25, "time.delta": 0.5}).model_copy(update={"name": name})


def study_of(scene):
    """Return a study with a gate of every kind: of one run, of two, of histories, on a derived row."""
    kinds = (
        ("small", ("dda",), "mode1.damping"),
        ("small", ("dda", "bar"), "displacement.static"),
        ("small", ("dda", "bar"), "pressure.scaled"),
        ("small", ("pencil",), "ratio"),
        ("opening", ("dda",), "energy.imbalance"),
    )
    gates = [Gate(*kind, 0.0, 1.0, "as measured") for kind in kinds]
    gates += [Gate("opening", ("dda", "dda"), "displacement.max", 0.0, 1.0, "as measured", against="other")]
    row = Derived("small", "pencil", (("small", "dda"),), pencil, (MEASURED,))
    return Study(
        "s",
        "S",
        "?",
        [scene, opening(scene), opening(scene, "other", 1.001e11)],
        ("dda", "bar"),
        gates=lambda: tuple(gates),
        derived=lambda: (row,),
    )


@pytest.fixture(scope="module")
def whole_rows(tmp_path_factory):
    return tmp_path_factory.mktemp("whole")


def judged(study, gate, cases, directory):
    return evaluate(gate, finish(cases, study, Results(directory)))


@pytest.mark.parametrize("number", range(6))
def test_what_a_gate_reads_is_enough_to_judge_it(scene, tmp_path, whole_rows, number):
    study = study_of(scene)
    gate = study.gates()[number]
    asked = list(reads(gate, study.recipes))
    whole = [case for case in study.cases() if (case.scene.name, case.solver) in study.needs(gate)]
    some = [
        replace(case, only=frozenset(metric for of, metric in asked if of == (case.scene.name, case.solver)))
        for case in whole
    ]
    found = judged(study, gate, some, tmp_path / "some")
    assert found == judged(study, gate, whole, whole_rows) and isinstance(found.value, float)
    assert ("compared" in found.why) == (number == 5)  # the horizon is among what is read
