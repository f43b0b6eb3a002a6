"""The studies `patch` and `beams`: every gate is bitten by a fault of glued blocks or elements, every fault is seen."""

from dataclasses import replace

import numpy as np
import pytest
from faults import seams
from faults.fault import Fault, times
from faults.kill_matrix import check_study

from validation.studies.beams.formulas import bending_ratio


def traction_times(factor):
    """Multiply the two components of a traction."""
    return lambda sound: lambda *a: tuple(factor * part for part in sound(*a))


def without_half_of_the_shear(sound):
    """Lose the half of g_xy in the displacement of a point: x then takes none of it, and y all."""

    def rows(*a):
        values = np.array(sound(*a))
        if values.shape[1] == 6:
            values[:, 5] = [0.0, 2 * values[1, 5]]
        return values

    return rows


def in_plane_strain(sound):
    return lambda *a, **k: replace(sound(*a, **k), hypothesis="plane strain")


def stiffer(sound):
    return lambda *a, **k: replace(sound(*a, **k), young=1.06 * sound(*a, **k).young)


def glued_by(factor):
    """Change the springs at the first end of each shared edge."""

    def wrap(sound):
        return lambda blocks, normal, shear: sound(blocks, factor * normal, shear)

    return wrap


DDA, FEM = ("dda",), ("fem",)
FAULTS = {
    "patch": [
        Fault("plane strain for plane stress", DDA, seams.PLANE_MATERIAL, in_plane_strain),
        Fault("half of the shear lost in T", DDA, seams.SYSTEM_JOINT_ROWS, without_half_of_the_shear),
        Fault("glue across half", DDA, seams.GLUED_EDGES, glued_by(0.5)),
        Fault("traction a thousandth high", DDA, seams.GLUED_LOAD, traction_times(1.001)),
        Fault("modulus a millionth high", FEM, seams.FEM_PLANE_STIFFNESS, times(1 + 1e-6)),
    ],
    "beams": [
        Fault("rotary inertia a fiftieth high", DDA, seams.SYSTEM_MASS, times(1.02)),
        Fault("modulus six per cent high", DDA, seams.PLANE_MATERIAL, stiffer),
        Fault("modulus a thousandth high", FEM, seams.FEM_PLANE_STIFFNESS, times(1.001)),
    ],
}


@pytest.mark.parametrize(("n", "glue", "ratio"), [
    (4, 2.0, 1.81914893617), (8, 2.0, 1.07487539647), (8, 20.0, 4.30646296355),
    (3, 20.0, 21.0021786492), (4, 0.856117, 1.0), (8, 1.702458, 1.0), (16, 3.355015, 1.0),
])  # fmt: skip
def test_the_bending_stiffness_of_squares_is_that_of_an_independent_program(n, glue, ratio):
    assert bending_ratio(n, glue) == pytest.approx(ratio, rel=2e-6)


@pytest.mark.long
@pytest.mark.parametrize("name", FAULTS)
def test_every_gate_is_bitten_and_every_fault_is_seen(name, tmp_path, finished_cases):
    check_study(name, FAULTS[name], tmp_path, finished_cases, lambda gate: "fenicsx" not in str(gate.pair))
