"""Gates x seeded faults: every gate is bitten by a fault, every fault is seen by a gate.

Only the cases of the solvers that a fault reaches run again, the others are taken from the sound run.
"""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.engine.run import finish
from validation.gates.gate import Status
from validation.runs.case_name import scene_of
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.suite.folders import get_study, judged_studies
from validation.suite.own_solver.gates import asked


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


def cases_of(study, gates, judged=None):
    """Return the cases that gates need."""
    needed = {need for gate in gates for need in study.needs(gate)}
    cases = [case for case in study.cases() if (case.scene.name, case.solver) in needed]
    return as_gates_run(study, cases, judged)


def as_gates_run(study, cases, judged=None):
    """Return cases of a study with the metrics alone that gates of judged studies ask for, of all by default.

    Their rows are then those that `validation/test_gates.py` has finished, but for a study whose gates it leaves out.
    """
    judged = tuple(judged or judged_studies())
    metrics = asked(judged if study.name in judged else (study.name,))
    return [replace(case, only=metrics.get((case.scene.name, case.solver), frozenset())) for case in cases]


def check_study(name, faults, directory, finished_cases, is_checked=lambda gate: True, first=None, judged=None):
    """Check the kill matrix of a study, or of some of its gates."""
    study = get_study(name)
    gates = [gate for gate in study.gates() if is_checked(gate)]
    check_kill_matrix(study, cases_of(study, gates, judged), gates, faults, directory, finished_cases, first)


def check_kill_matrix(study, cases, gates, faults, directory, finished_cases, first=None):
    """Run the cases sound, and with faults until every gate is bitten and every fault seen.

    Scenes whose runs take least come first. In each the fault is tried that has bitten most of what is unbitten there
    on scenes of its family, or on others; of several what costs least. A fault that no gate has seen then goes on
    through all scenes. What runs once with a fault is kept. Where a run is dear, ``first`` names for a scene the faults
    that are tried before the others.
    """
    first = first or {}
    sound = finish(cases, study, Results(finished_cases))
    assert not failed(sound, gates)
    seconds = {case: sum(row.seconds.values()) for case, row in sound.rows.items()}

    def cost(runs):
        return sum(seconds[case] for case in runs)

    scenes = {}
    for gate in gates:
        scenes.setdefault(gate.scene, []).append(gate)
    by_cost = sorted(scenes.values(), key=lambda some: cost({need for gate in some for need in study.needs(gate)}))
    kills = {fault.name: set() for fault in faults}
    results = {fault.name: Overlay(directory / str(i), sound.results) for i, fault in enumerate(faults)}
    bites = {fault.name: {} for fault in faults}  # by kind of gate, on the last such scene
    runs = {fault.name: set() for fault in faults}

    def bite(fault, some):
        bitten = killed(study, cases, some, fault, sound, results[fault.name])
        kills[fault.name] |= bitten
        for gate in some:
            bites[fault.name] |= dict.fromkeys((kind(gate), kind(gate)[1:]), gate.id in bitten)
        runs[fault.name] |= reached(study, some, fault)

    def promise(fault, some):
        seen = bites[fault.name]
        known = [seen.get(kind(gate), seen.get(kind(gate)[1:])) for gate in some]
        is_first = fault.name in first.get(scene_of(some[0].scene), ())
        seconds_more = cost(reached(study, some, fault) - runs[fault.name])
        return is_first, known.count(True), -known.count(False), -seconds_more

    def unbitten(some):
        bitten = set().union(*kills.values())
        return [gate for gate in some if gate.id not in bitten]

    for some in by_cost:
        untried = list(faults)
        while untried and (missing := unbitten(some)):
            best = max(untried, key=lambda fault: promise(fault, missing))
            untried.remove(best)
            bite(best, missing)
    for fault, some in product(faults, by_cost):
        if not kills[fault.name]:
            bite(fault, some)
    print_matrix(kills, gates)
    unseen = [name for name, killed in kills.items() if not killed]
    assert not unseen, f"faults that no gate sees: {unseen}"
    assert not unbitten(gates), f"gates that no fault bites: {sorted(gate.id for gate in unbitten(gates))}"


def kind(gate):
    """Return what a gate has in common with those on the same scene with other values."""
    return scene_of(gate.scene), gate.pair, gate.metric


def reached(study, gates, fault):
    """Return the cases that gates need and a fault reaches."""
    return {need for gate in gates for need in study.needs(gate) if need[1] in fault.solvers}


def killed(study, cases, gates, fault, sound, results):
    """Return the gates that fail with a fault; only the cases that it reaches run again."""
    needed = reached(study, gates, fault)
    if not needed:
        return set()
    again = [case for case in cases if (case.scene.name, case.solver) in needed]
    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        fault.seam.wrap(patch, fault.replacement)
        faulty = finish(again, study, results)
    whole(fault.name, faulty)
    return failed(Finished(sound.rows | faulty.rows, results, sound.derived), gates)


def print_matrix(kills, gates):
    """Print one row a gate, one column a fault."""
    names = list(kills)
    for number, name in enumerate(names):
        print(f"{number + 1:>3}  {name}: {len(kills[name])} gates")
    for gate in gates:
        print("".join("x" if gate.id in kills[name] else "." for name in names), gate.id)
