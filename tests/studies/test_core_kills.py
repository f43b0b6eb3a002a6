"""Every gate is bitten: gates x seeded faults of solver code, printed as the kill matrix, a gate until it is bitten.

A fault patches a named line of a solver; production code has no switch for it. Only the cases of the solvers that
a fault reaches run again, the others are taken from the sound run.
"""

from __future__ import annotations

from pathlib import Path

from faults.fault import (
    Fault,
    first_times,
    late,
    no_damping,
    no_discount,
    soft_springs,
    stiff_problem,
    swapped,
    thousandth,
    times,
    with_scheme,
)
from faults.kill_matrix import check_kill_matrix

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
from validation.studies.core import CORE

SLOW = ("figure-7",)  # 20,000 steps: a few of the faults, enough to bite its gates
FEW = (
    "dda: springs p/2",
    "dda: histories with another delta",
    "fem: delta 0.1 % high",
    "bar: base spring k/2",
)


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


CASES = [case for case in CORE.cases() if not case.scene.name.startswith(SLOW)]
GATES = [gate for gate in CORE.gates() if not gate.scene.startswith(SLOW)]


def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    check_kill_matrix(CORE, CASES, GATES, FAULTS, tmp_path, finished_cases)


def test_every_gate_of_the_longest_scene_is_bitten(tmp_path: Path, finished_cases: Path) -> None:
    cases = [case for case in CORE.cases() if case.scene.name.startswith(SLOW)]
    gates = [gate for gate in CORE.gates() if gate.scene.startswith(SLOW)]
    check_kill_matrix(CORE, cases, gates, [fault for fault in FAULTS if fault.name in FEW], tmp_path, finished_cases)
