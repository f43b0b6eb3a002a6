"""Every gate is bitten: gates x seeded faults of solver code, printed as the kill matrix, a gate until it is bitten.

A fault patches a named line of a solver; production code has no switch for it. Only the cases of the solvers that
a fault reaches run again, the others are taken from the sound run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import dda.one_block.gap_form
import dda.one_block.solution
import dda.one_block.textbook
import dda.scheme.newmark
import fem_reference.exact.bar
import fem_reference.history.solver
import fem_reference.mesh.elasticity
import fem_reference.mesh.model
import fem_reference.scheme.modal
import fem_reference.scheme.newmark
from validation.engine.case import Case
from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.engine.run import finish
from validation.engine.study import Study
from validation.gates.gate import Gate, Status
from validation.runs.history import History
from validation.runs.results import Results
from validation.studies.core import CORE

SLOW = ("figure-7",)  # 20,000 steps: a few of the faults, enough to bite its gates
FEW = (
    "dda: springs p/2",
    "dda: histories with another delta",
    "fem: delta 0.1 % high",
    "bar: base spring k/2",
)


@dataclass(frozen=True)
class Fault:
    """A seeded fault: which solvers it reaches, and the attribute that it replaces."""

    name: str
    solvers: tuple[str, ...]
    module: object
    attribute: str
    replacement: Callable[[Callable[..., object]], Callable[..., object]]


def with_scheme(position: int, **changes: Callable[[float], float]) -> Callable[..., Callable[..., object]]:
    """Hand a function a changed scheme."""

    def wrap(sound: Callable[..., object]) -> Callable[..., object]:
        def faulty(*arguments: object) -> object:
            scheme = arguments[position]
            values = {name: change(getattr(scheme, name)) for name, change in changes.items()}
            changed = replace(scheme, **values)
            return sound(*arguments[:position], changed, *arguments[position + 1 :])

        return faulty

    return wrap


def times(factor: float) -> Callable[..., Callable[..., object]]:
    """Multiply what a function returns."""
    return lambda sound: lambda *a, **k: factor * sound(*a, **k)


def first_times(factor: float) -> Callable[..., Callable[..., object]]:
    """Multiply the first argument of a function."""
    return lambda sound: lambda first, *a, **k: sound(first * factor, *a, **k)


def late(sound: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
    """Report every step one step late, along the axis of steps."""

    def faulty(*a: object, **k: object) -> np.ndarray:
        found = sound(*a, **k)
        axis = int(np.argmax(found.shape))
        shifted = np.roll(found, 1, axis=axis)
        np.moveaxis(shifted, axis, 0)[0] = 0.0
        return shifted

    return faulty


def soft_springs(factor: float) -> Callable[..., Callable[..., object]]:
    """Change the stiffness of the contact springs of the DDA model."""

    def wrap(sound: Callable[..., object]) -> Callable[..., object]:
        def faulty(material: object, contact: object, area: float, a: float) -> object:
            changed = replace(contact, stiffness=contact.stiffness * factor)
            return sound(material, changed, area, a)

        return faulty

    return wrap


def no_discount(position: int) -> Callable[..., Callable[..., object]]:
    return with_scheme(position, gg=lambda gg: 1.0)


def thousandth(delta: float) -> float:
    return 1.001 * delta


def no_damping(delta: float) -> float:
    return 0.501 if delta == 0.5 else 0.5


def stiff_problem(factor: float) -> Callable[..., Callable[..., object]]:
    """Change the springs of a finite-element problem."""
    return lambda sound: lambda problem: sound(replace(problem, stiffness=problem.stiffness * factor))


def swapped(start: str) -> str:
    return "zero" if start == "consistent" else "consistent"


DDA = dda.scheme.newmark
FEM = fem_reference.scheme.newmark
FAULTS = [
    Fault("dda: gg missing in the predictor", ("dda",), DDA, "predictor", no_discount(0)),
    Fault("dda: gg missing in the velocity", ("dda",), DDA, "velocity_corrector", no_discount(0)),
    Fault("dda: delta 0.1 % high", ("dda",), DDA, "velocity_corrector", with_scheme(0, delta=thousandth)),
    Fault("dda: delta forgotten", ("dda",), DDA, "velocity_corrector", with_scheme(0, delta=lambda d: 0.6)),
    Fault("dda: other start", ("dda",), DDA, "initial_acceleration", with_scheme(0, start=swapped)),
    Fault("dda: springs p/2", ("dda",), dda.one_block.gap_form, "_stiffness", soft_springs(0.5)),
    Fault("dda: springs 1e-9 stiff", ("dda",), dda.one_block.gap_form, "_stiffness", soft_springs(1 + 1e-9)),
    Fault("dda: one step late", ("dda",), dda.one_block.solution, "modal_histories", late),
    Fault("dda: load reversed", ("dda",), dda.one_block.gap_form, "_load", times(-1.0)),
    Fault("dda: load 0.2 % high", ("dda",), dda.one_block.gap_form, "_load", times(1.002)),
    Fault(
        "dda: histories with another delta",
        ("dda",),
        dda.one_block.solution,
        "modal_histories",
        with_scheme(0, delta=lambda d: d + 1e-3),
    ),
    Fault(
        "fem: histories with another delta",
        ("fem",),
        fem_reference.history.solver,
        "Stepper",
        with_scheme(3, delta=lambda d: d + 1e-3),
    ),
    Fault("fem: gg missing in the predictor", ("fem",), FEM, "predictor", no_discount(1)),
    Fault("fem: gg missing in the velocity", ("fem",), FEM, "velocity", no_discount(2)),
    Fault("fem: delta 0.1 % high", ("fem",), FEM, "velocity", with_scheme(2, delta=thousandth)),
    Fault("fem: foundation k/2", ("fem",), fem_reference.mesh.elasticity, "_carried", times(0.5)),
    Fault("fem: foundation 0.1 % stiff", ("fem",), fem_reference.mesh.elasticity, "_carried", times(1.001)),
    Fault("fem: column's spring 1e-6 stiff", ("fem",), fem_reference.mesh.model, "column", stiff_problem(1 + 1e-6)),
    Fault("fem: one step late", ("fem",), fem_reference.history.solver, "bounded", late),
    Fault("fem: mass 0.1 % heavy", ("fem", "fem:full"), fem_reference.mesh.elasticity, "mass", times(1.001)),
    Fault("bar: base spring k/2", ("bar",), fem_reference.exact.bar, "wave_numbers", first_times(0.5)),
    Fault("bar: base spring 0.1 % stiff", ("bar",), fem_reference.exact.bar, "wave_numbers", first_times(1.001)),
    Fault("bar: gg missing in the trace", ("bar",), fem_reference.scheme.modal, "trace", no_discount(1)),
    Fault("bar: gg missing in the roots", ("bar",), fem_reference.scheme.modal, "spectrum", no_discount(1)),
    Fault("bar: gg missing in the start", ("bar",), fem_reference.scheme.modal, "first_steps", no_discount(1)),
    Fault(
        "bar: delta missing in the roots",
        ("bar",),
        fem_reference.scheme.modal,
        "_pair",
        with_scheme(1, delta=no_damping),
    ),
    Fault("bar: other start", ("bar",), fem_reference.scheme.modal, "first_steps", with_scheme(1, start=swapped)),
    Fault("bar: delta 0.1 % high", ("bar",), fem_reference.scheme.modal, "spectrum", with_scheme(1, delta=thousandth)),
]


class Overlay(Results):
    """Histories of a faulty run over those of the sound one."""

    def __init__(self, directory: Path, sound: Results) -> None:
        super().__init__(directory)
        self.sound = sound

    def history(self, key: str) -> History | None:
        return super().history(key) or self.sound.history(key)


CASES = [case for case in CORE.cases() if not case.scene.name.startswith(SLOW)]
GATES = [gate for gate in CORE.gates() if not gate.scene.startswith(SLOW)]


def failed(finished: Finished, gates: Sequence[Gate]) -> set[str]:
    return {gate.id for gate in gates if evaluate(gate, finished).status is Status.FAIL}


def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    check_kill_matrix(CORE, CASES, GATES, FAULTS, tmp_path, finished_cases)


def test_every_gate_of_the_longest_scene_is_bitten(tmp_path: Path, finished_cases: Path) -> None:
    cases = [case for case in CORE.cases() if case.scene.name.startswith(SLOW)]
    gates = [gate for gate in CORE.gates() if gate.scene.startswith(SLOW)]
    check_kill_matrix(CORE, cases, gates, [fault for fault in FAULTS if fault.name in FEW], tmp_path, finished_cases)


def check_kill_matrix(
    study: Study,
    cases: Sequence[Case],
    gates: Sequence[Gate],
    faults: Sequence[Fault],
    directory: Path,
    finished_cases: Path,
) -> None:
    """Run the cases sound and with every fault; no fault may pass unseen, no gate may stay unbitten.

    A gate that one fault has bitten is tried again only with faults that no other gate has seen.
    """
    sound = finish(cases, study, Results(finished_cases))
    assert not failed(sound, gates)
    kills: dict[str, set[str]] = {}
    for number, fault in enumerate(faults):
        bitten = set().union(*kills.values())
        results = Overlay(directory / str(number), sound.results)
        kills[fault.name] = next(
            filter(None, killed(study, cases, groups(gates, bitten), fault, sound, results)), set()
        )
    print_matrix(kills, gates)
    unseen = [name for name, killed in kills.items() if not killed]
    unbitten = sorted({gate.id for gate in gates} - set().union(*kills.values()))
    assert not unseen, f"faults that no gate sees: {unseen}"
    assert not unbitten, f"gates that no fault bites: {unbitten}"


def groups(gates: Sequence[Gate], bitten: set[str]) -> list[list[Gate]]:
    """Group gates in the order of trial: all that are not bitten yet, then the others scene by scene."""
    others: dict[str, list[Gate]] = {}
    for gate in gates:
        if gate.id in bitten:
            others.setdefault(gate.scene, []).append(gate)
    return [[gate for gate in gates if gate.id not in bitten], *others.values()]


def killed(
    study: Study,
    cases: Sequence[Case],
    tried: Sequence[Sequence[Gate]],
    fault: Fault,
    sound: Finished,
    results: Overlay,
) -> Iterator[set[str]]:
    """Yield of each group the gates that fail with a fault; only the solvers that it reaches run again."""
    for some in tried:
        needed = {need for gate in some for need in study.needs(gate)}
        reached = [case for case in cases if case.solver in fault.solvers and (case.scene.name, case.solver) in needed]
        with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
            patch.setattr(fault.module, fault.attribute, fault.replacement(getattr(fault.module, fault.attribute)))
            faulty = finish(reached, study, results)
        yield failed(Finished(sound.rows | faulty.rows, results, sound.derived), some) if reached else set()


def print_matrix(kills: dict[str, set[str]], gates: Sequence[Gate]) -> None:
    """Print one row a gate, one column a fault."""
    names = list(kills)
    for number, name in enumerate(names):
        print(f"{number + 1:>3}  {name}: {len(kills[name])} gates")
    for gate in gates:
        print("".join("x" if gate.id in kills[name] else "." for name in names), gate.id)
