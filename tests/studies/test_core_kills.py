"""Every gate is bitten: gates x seeded faults of solver code, printed as the kill matrix, a gate until it is bitten.

A fault patches a named line of a solver; production code has no switch for it. Only the cases of the solvers that
a fault reaches run again, the others are taken from the sound run.
"""

import pytest
from faults import seams
from faults.fault import (
    Fault,
    first_times,
    late,
    no_damping,
    no_discount,
    scaled,
    soft_springs,
    swapped,
    thousandth,
    times,
    undiscounted,
    with_scheme,
)
from faults.kill_matrix import check_study

FAULTS = [
    Fault("dda: gg missing in the predictor", ("dda",), seams.DDA_PREDICTOR, no_discount(0)),
    Fault("dda: gg missing in the velocity", ("dda",), seams.DDA_VELOCITY, no_discount(0)),
    Fault("dda: delta 0.1 % high", ("dda",), seams.DDA_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("dda: delta forgotten", ("dda",), seams.DDA_VELOCITY, with_scheme(0, delta=lambda d: 0.6)),
    Fault("dda: other start", ("dda",), seams.DDA_START, with_scheme(0, start=swapped)),
    Fault("dda: springs p/2", ("dda",), seams.DDA_STIFFNESS, soft_springs(0.5)),
    Fault("dda: springs 1e-9 stiff", ("dda",), seams.DDA_STIFFNESS, soft_springs(1 + 1e-9)),
    Fault("dda: one step late", ("dda",), seams.DDA_HISTORIES, late),
    Fault("dda: load reversed", ("dda",), seams.DDA_LOAD, times(-1.0)),
    Fault("dda: load 0.2 % high", ("dda",), seams.DDA_LOAD, times(1.002)),
    Fault(
        "dda: histories with another delta",
        ("dda",),
        seams.DDA_HISTORIES,
        with_scheme(0, delta=lambda d: d + 1e-3),
    ),
    Fault("fem: histories with another delta", ("fem",), seams.FEM_STEPPER, with_scheme(3, delta=lambda d: d + 1e-3)),
    Fault("fem: gg missing in the predictor", ("fem",), seams.FEM_PREDICTOR, undiscounted(2)),
    Fault("fem: gg missing in the velocity", ("fem",), seams.FEM_VELOCITY, undiscounted(2)),
    Fault("fem: delta 0.1 % high", ("fem",), seams.FEM_VELOCITY, with_scheme(0, gamma=thousandth)),
    Fault("fem: foundation k/2", ("fem",), seams.FEM_FOUNDATION, times(0.5)),
    Fault("fem: foundation 0.1 % stiff", ("fem",), seams.FEM_FOUNDATION, times(1.001)),
    Fault("fem: column's spring 1e-6 stiff", ("fem",), seams.FEM_COLUMN, scaled(stiffness=1 + 1e-6)),
    Fault("fem: one step late", ("fem",), seams.FEM_BOUNDED, late),
    Fault("fem: mass 0.1 % heavy", ("fem", "fem:full"), seams.FEM_MASS, times(1.001)),
    Fault("bar: base spring k/2", ("bar",), seams.BAR_WAVE_NUMBERS, first_times(0.5)),
    Fault("bar: base spring 0.1 % stiff", ("bar",), seams.BAR_WAVE_NUMBERS, first_times(1.001)),
    Fault("bar: gg missing in the histories", ("bar",), seams.BAR_HISTORIES, no_discount(2)),
    Fault("bar: gg missing in the roots", ("bar",), seams.BAR_ROOTS, no_discount(1)),
    Fault("bar: delta missing in the step", ("bar",), seams.BAR_STEP, with_scheme(0, delta=no_damping)),
    Fault("bar: other start", ("bar",), seams.BAR_HISTORIES, with_scheme(2, start=swapped)),
    Fault("bar: delta 0.1 % high", ("bar",), seams.BAR_STEP, with_scheme(0, delta=thousandth)),
]


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    check_study("core", FAULTS, tmp_path, finished_cases)
