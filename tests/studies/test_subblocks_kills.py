"""Every gate of the sub-block study is bitten: seeded faults in joints, systems, loads and the mesh's point springs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from faults.fault import Fault, late, no_damping, thousandth, times, with_scheme
from faults.kill_matrix import check_kill_matrix

import dda.one_block.gap_form
import dda.scheme.newmark
import dda.system.joints
import dda.system.solution
import dda.system.subdivision
import dda.system.system
import fem_reference.history.solver
import fem_reference.mesh.elasticity
import fem_reference.scheme.newmark
from validation.studies.subblocks import SUBBLOCKS

# Larger systems take seconds a fault: their gates measure what those of the smaller ones measure.
LEFT_OUT = (
    "subblocks-locking",
    "16x16",
    "1x16",
    "1x32",
    "5x5",
    "=4x4,fem",
    "8x8",
    "=100,",
    "=10]",
    "width=0.6",
    "width=0.2",
)


def soft_glue(sound: Callable[..., object]) -> Callable[..., object]:
    """Glue with half the stiffness."""
    return lambda model, columns, rows, glue, pattern: sound(model, columns, rows, glue / 2, pattern)


SYSTEM = dda.system.solution
FEM = fem_reference.mesh.elasticity
FAULTS = [
    Fault("joints: base springs 1e-6 stiff", ("dda",), dda.system.subdivision, "base_share", times(1 + 1e-6)),
    Fault("joints: glue of half the stiffness", ("dda",), dda, "subdivided", soft_glue),
    Fault("joints: rows of a point 1e-6 long", ("dda",), dda.system.joints, "_value", times(1 + 1e-6)),
    Fault("system: mass 0.1 % heavy", ("dda",), dda.system.system, "_without_rounding", times(1.001)),
    Fault("system: loads 1e-6 high", ("dda",), dda.system.system.BlockSystem, "_load", times(1 + 1e-6)),
    Fault("system: forces of half the flexibility", ("dda",), SYSTEM, "joint_flexibility", times(0.5)),
    Fault("system: delta 0.1 % high", ("dda",), SYSTEM, "velocity_corrector", with_scheme(0, delta=thousandth)),
    Fault("system: delta forgotten", ("dda",), SYSTEM, "velocity_corrector", with_scheme(0, delta=no_damping)),
    Fault("system: one step late", ("dda",), SYSTEM._Stepper, "run", late),
    Fault("dda: springs 1e-9 stiff", ("dda",), dda.one_block.gap_form, "_stiffness", times(1 + 1e-9)),
    Fault("fem: nodal springs of half the length", ("fem",), FEM, "_carried", times(2.0)),
    Fault("fem: foundation 5 % soft", ("fem",), FEM, "_carried", times(1.05)),
    Fault("fem: mass 5 % heavy", ("fem",), FEM, "mass", times(1.05)),
    Fault("fem: rotation of the other sign", ("fem",), FEM, "_rotation", times(-1.0)),
    Fault(
        "fem: delta 0.1 % high", ("fem",), fem_reference.scheme.newmark, "velocity", with_scheme(2, delta=thousandth)
    ),
]
GATES = [gate for gate in SUBBLOCKS.gates() if not any(word in gate.scene for word in LEFT_OUT)]
CASES = [case for case in SUBBLOCKS.cases() if case.scene.name in {gate.scene for gate in GATES}]


def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    check_kill_matrix(SUBBLOCKS, CASES, GATES, FAULTS, tmp_path, finished_cases)
