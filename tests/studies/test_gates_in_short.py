"""Gates of some studies on the first cases of their cheapest scenes; `validation/test_gates.py` has all, and is long.

What formulas of all studies give is judged by `test_numbers.py` without a run.
"""

from fnmatch import fnmatchcase

import pytest

from validation.gates.gate import Status
from validation.runs.case_name import scene_of
from validation.runs.results import Results
from validation.suite.folders import get_study
from validation.suite.own_solver.session import GateRuns

SHORT = {
    "beams": ("beams-squares",),
    "limits": ("*",),
    "opening": ("unlocked",),
    "rocking": ("rocking-swing",),
    "stability-small": ("*",),
    "stiff-contact": ("*",),
}


@pytest.mark.parametrize("name", SHORT)
def test_gates_of_the_first_cases(name, finished_cases):
    runs = GateRuns(Results(finished_cases), studies=[name])
    first = {}
    failed = {}
    passed = 0
    for gate in get_study(name).gates():
        scene = scene_of(gate.scene)
        if not any(fnmatchcase(scene, pattern) for pattern in SHORT[name]):
            continue
        if first.setdefault(scene, gate.scene) != gate.scene:
            continue
        verdict = runs.verdict(name, gate)
        passed += verdict.status is Status.PASS
        if verdict.status is Status.FAIL:
            failed[gate.id] = (verdict.value, gate.low, gate.high, verdict.why)
    assert not failed and passed
