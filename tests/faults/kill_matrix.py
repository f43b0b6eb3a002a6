"""Gates x seeded faults: every gate is bitten by a fault, every fault is seen by a gate.

Only the cases of the solvers that a fault reaches run again, the others are taken from the sound run.
"""

from itertools import product

import numpy as np
import pytest

from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.engine.run import finish
from validation.gates.gate import Status
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.suite.folders import get_study


class Overlay(Results):
    """Histories of a faulty run over those of the sound one."""

    def __init__(self, directory, sound):
        super().__init__(directory)
        self.unharmed = sound

    def history(self, key):
        return super().history(key) or self.unharmed.history(key)


def failed(finished, gates):
    return {gate.id for gate in gates if evaluate(gate, finished).status is Status.FAIL}


def whole(fault, faulty):
    """Refuse a fault that breaks a solver instead of changing its numbers: without a row every gate fails."""
    broken = {row.notes[-1] for row in faulty.rows.values() if row.outcome is Outcome.RAISED}
    assert not broken, f"{fault}: breaks the solver, which bites every gate: {sorted(broken)}"


def cases_of(study, gates):
    """Return the cases that gates need."""
    needed = {need for gate in gates for need in study.needs(gate)}
    return [case for case in study.cases() if (case.scene.name, case.solver) in needed]


def check_study(name, faults, directory, finished_cases, is_checked=lambda gate: True):
    """Check the kill matrix of a study, or of some of its gates."""
    study = get_study(name)
    gates = [gate for gate in study.gates() if is_checked(gate)]
    check_kill_matrix(study, cases_of(study, gates), gates, faults, directory, finished_cases)


def check_kill_matrix(
    study,
    cases,
    gates,
    faults,
    directory,
    finished_cases,
):
    """Run the cases sound, and with faults until every gate is bitten and every fault seen.

    Scene by scene the faults are tried that have bitten most, as long as a gate of it is unbitten; a fault that no gate
    has seen then goes on through all other scenes. What runs once with a fault is kept.
    """
    sound = finish(cases, study, Results(finished_cases))
    assert not failed(sound, gates)
    scenes = {}
    for gate in gates:
        scenes.setdefault(gate.scene, []).append(gate)
    kills = {fault.name: set() for fault in faults}
    results = {fault.name: Overlay(directory / str(i), sound.results) for i, fault in enumerate(faults)}
    tried = set()

    def bite(fault, scene):
        tried.add((fault.name, scene))
        kills[fault.name] |= killed(study, cases, scenes[scene], fault, sound, results[fault.name])

    for scene, some in scenes.items():
        for fault in sorted(faults, key=lambda fault: -len(kills[fault.name])):
            if not {gate.id for gate in some} <= set().union(*kills.values()):
                bite(fault, scene)
    for fault, scene in product(faults, scenes):
        if not kills[fault.name] and (fault.name, scene) not in tried:
            bite(fault, scene)
    print_matrix(kills, gates)
    unseen = [name for name, killed in kills.items() if not killed]
    unbitten = sorted({gate.id for gate in gates} - set().union(*kills.values()))
    assert not unseen, f"faults that no gate sees: {unseen}"
    assert not unbitten, f"gates that no fault bites: {unbitten}"


def killed(study, cases, gates, fault, sound, results):
    """Return the gates that fail with a fault; only the cases that it reaches run again."""
    needed = {need for gate in gates for need in study.needs(gate)}
    reached = [case for case in cases if case.solver in fault.solvers and (case.scene.name, case.solver) in needed]
    if not reached:
        return set()
    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        fault.seam.wrap(patch, fault.replacement)
        faulty = finish(reached, study, results)
    whole(fault.name, faulty)
    return failed(Finished(sound.rows | faulty.rows, results, sound.derived), gates)


def print_matrix(kills, gates):
    """Print one row a gate, one column a fault."""
    names = list(kills)
    for number, name in enumerate(names):
        print(f"{number + 1:>3}  {name}: {len(kills[name])} gates")
    for gate in gates:
        print("".join("x" if gate.id in kills[name] else "." for name in names), gate.id)
