"""Every gate of the sub-block study is bitten: seeded faults in joints, systems, loads and the mesh's point springs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from faults import seams
from faults.fault import Fault, late, no_damping, thousandth, times, with_scheme
from faults.kill_matrix import check_kill_matrix

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


FAULTS = [
    Fault("joints: base springs 1e-6 stiff", ("dda",), seams.SYSTEM_BASE, times(1 + 1e-6)),
    Fault("joints: glue of half the stiffness", ("dda",), seams.SYSTEM_GLUE, soft_glue),
    Fault("joints: rows of a point 1e-6 long", ("dda",), seams.SYSTEM_JOINT_ROWS, times(1 + 1e-6)),
    Fault("system: mass 0.1 % heavy", ("dda",), seams.SYSTEM_MASS, times(1.001)),
    Fault("system: loads 1e-6 high", ("dda",), seams.SYSTEM_LOAD, times(1 + 1e-6)),
    Fault("system: forces of half the flexibility", ("dda",), seams.SYSTEM_FLEXIBILITY, times(0.5)),
    Fault("system: delta 0.1 % high", ("dda",), seams.SYSTEM_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("system: delta forgotten", ("dda",), seams.SYSTEM_VELOCITY, with_scheme(0, delta=no_damping)),
    Fault("system: one step late", ("dda",), seams.SYSTEM_RUN, late),
    Fault("dda: springs 1e-9 stiff", ("dda",), seams.DDA_STIFFNESS, times(1 + 1e-9)),
    Fault("fem: nodal springs of half the length", ("fem",), seams.FEM_FOUNDATION, times(2.0)),
    Fault("fem: foundation 5 % soft", ("fem",), seams.FEM_FOUNDATION, times(1.05)),
    Fault("fem: mass 5 % heavy", ("fem",), seams.FEM_MASS, times(1.05)),
    Fault("fem: rotation of the other sign", ("fem",), seams.FEM_ROTATION, times(-1.0)),
    Fault("fem: delta 0.1 % high", ("fem",), seams.FEM_VELOCITY, with_scheme(2, delta=thousandth)),
]


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    gates = [gate for gate in SUBBLOCKS.gates() if not any(word in gate.scene for word in LEFT_OUT)]
    scenes = {gate.scene for gate in gates}
    cases = [case for case in SUBBLOCKS.cases() if case.scene.name in scenes]
    check_kill_matrix(SUBBLOCKS, cases, gates, FAULTS, tmp_path, finished_cases)
