"""The study `boxes`: every gate is bitten by a fault of blocks that move, and every fault is seen."""

import pytest
from faults import seams
from faults.fault import Fault
from faults.kill_matrix import check_study

DDA = ("dda",)


def changed(name, factor):
    """Multiply what a model is made with, by its name; a vector in both parts."""

    def times(value):
        if value is None:
            return None
        return tuple(factor * part for part in value) if isinstance(value, tuple) else factor * value

    return lambda sound: lambda *a, **k: sound(*a, **{**k, name: times(k[name])})


def heavier(sound):
    """Raise the density by a millionth, which is stated second."""
    return lambda vertices, density, **k: sound(vertices, (1 + 1e-6) * density, **k)


FAULTS = [
    Fault("tan(phi) a thousandth high", DDA, seams.PLANE_SPRINGS, changed("friction", 1.001)),
    Fault("springs a millionth stiff", DDA, seams.PLANE_SPRINGS, changed("stiffness", 1 + 1e-6)),
    Fault("density a millionth high", DDA, seams.PLANE_BLOCK, heavier),
    Fault("velocity half a per cent low", DDA, seams.PLANE_BLOCK, changed("velocity", 0.995)),
    Fault("spin half a per cent high", DDA, seams.PLANE_BLOCK, changed("spin", 1.005)),
]


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    check_study("boxes", FAULTS, tmp_path, finished_cases)
