"""The study `plates`: closed forms and linear elements against other programs; every gate is bitten by a fault."""

import math
from dataclasses import replace

import numpy as np
import pytest
from faults import seams
from faults.fault import Fault, times
from faults.kill_matrix import check_study

from validation.models.plane.glued import PlateSection
from validation.studies.plates.closed import disc_centre, disc_widening, hole_displacement

PLATE = PlateSection(hole=1.0, radius=4.0, tension=1e6, cells=8)
YOUNG, POISSON = 1e9, 0.25


def test_a_hole_and_a_disc_are_as_another_program_has_them():
    assert hole_displacement(1.0, 0.0, 1e6, 1e9, 0.25) == pytest.approx(0.003)
    assert hole_displacement(1.0, math.pi / 2, 1e6, 1e9, 0.25) == pytest.approx(-0.001)
    assert PLATE.stresses(np.array([[0.0, 1.0], [1.0, 0.0]])) == pytest.approx(
        np.array([[3e6, 0.0, 0.0], [0.0, -1e6, 0.0]]), abs=1e-6
    )
    pressure = 1e6 / (2 * math.pi / 8)
    assert disc_centre(pressure, math.pi / 8) == pytest.approx((254849.282066966, -891469.054434547), rel=1e-12)


def test_a_disc_under_a_pressure_all_round_and_without_poisson_shrinks_as_it_must():
    assert disc_widening(1e6, math.pi / 2, 1e9, 0.25) == pytest.approx(-1e6 * (1 - 0.25) / 1e9, rel=1e-6)


def stiffer(by):
    """Multiply Young's modulus of the blocks."""
    return lambda sound: lambda *a, **k: replace(sound(*a, **k), young=by * sound(*a, **k).young)


def glued_by(factor):
    """Multiply the springs across every shared edge."""
    return lambda sound: lambda blocks, normal, shear: sound(blocks, factor * normal, shear)


def pulled(factor):
    """Multiply all tractions."""
    return lambda sound: lambda start, end, value: sound(start, end, (factor * value[0], factor * value[1]))


DDA, FEM = ("dda",), ("fem",)
FAULTS = [
    Fault("modulus a millionth high", DDA, seams.PLANE_MATERIAL, stiffer(1 + 1e-6)),
    Fault("modulus a hundredth high", DDA, seams.PLANE_MATERIAL, stiffer(1.01)),
    Fault("glue across a thousandth high", DDA, seams.GLUED_EDGES, glued_by(1.001)),
    Fault("modulus a fifth high", DDA, seams.PLANE_MATERIAL, stiffer(1.2)),
    Fault("tractions a thousandth high", DDA, seams.TRACTION, pulled(1.001)),
    Fault("tractions a fifth high", DDA, seams.TRACTION, pulled(1.2)),
    Fault("modulus three hundredths high", FEM, seams.FEM_PLANE_STIFFNESS, times(1.03)),
]


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    check_study("plates", FAULTS, tmp_path, finished_cases, lambda gate: "fenicsx" not in str(gate.pair))
