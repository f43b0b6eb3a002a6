"""Transfer functions of the exact layers against the equations of a column."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from fem_reference.column.problem import Ground, Stratum
from fem_reference.exact import layers


def propagated(ground, w, heights, base):
    """Return the displacements at the heights (at a joint of its lower face) and the base's pressure.

    The base, or the wave that comes up, has a unit velocity; else 1 Pa presses on the top. (u, sigma) goes up by
    u' = sigma / E, sigma' = -rho w^2 u from two starts, of which the condition at the top takes a sum.
    """
    springs = {round(height, 9): k for height, k in ground.joints}
    state, below, found = np.eye(2), 0.0, {}
    for level in np.unique(np.round([0.0, *ground.tops, *springs, *heights], 9)):
        stratum = ground.strata[
            min(int(np.searchsorted(ground.tops - 1e-7, (below + level) / 2)), len(ground.tops) - 1)
        ]
        E = stratum.modulus(ground.motion)
        state = expm((level - below) * np.array([[0, 1 / E], [-stratum.density * w**2, 0]])) @ state
        upper = np.array([[1, 1 / springs[level]], [0, 1]]) @ state if level in springs else state
        found[level] = state[0] if level else upper[0]
        state, below = upper, level
    z = ground.impedance
    foot = [1, 0] if z is None else [1j * w * z, -1]
    known = base / (1j * w) if z is None else 2 * z * base
    start = np.linalg.solve([foot, state[1]], [known, base - 1.0])
    return [found[round(height, 9)] @ start for height in heights], -start[1]


GROUND = Ground(
    (Stratum(4.0, 1900.0, 3e8, 0.25), Stratum(1.7, 2300.0, 9e7, 0.4), Stratum(2.6, 1600.0, 2e9, 0.1)),
    "shear",
    ((0.0, 3e8), (2.9, 5e7), (4.0, 2e8), (5.7, 9e8)),
)


@pytest.mark.parametrize("motion", ["shear", "pressure"])
@pytest.mark.parametrize("impedance", [None, 7e5])
def test_transfer_functions_are_those_of_the_equations_of_a_column(motion, impedance):
    """Joints at the foot, within a layer and where two meet; heights at joints and between them."""
    ground = replace(GROUND, motion=motion, impedance=impedance)
    heights = [5.7, 0.0, 8.3, 2.9, 1.1]
    names = [f"displacement_{number + 1}" for number in range(len(heights))]
    stiffness = max((x.density * x.modulus(motion)) ** 0.5 for x in ground.strata)
    for omega in (7.3, 211.0):
        both = layers.amplitudes(ground, [omega], (*names, "contact_pressure"), heights)
        for found, base in zip(both, (True, False), strict=True):
            displaced, pressure = propagated(ground, omega, heights, base)
            size = max(map(abs, displaced))
            assert max(abs(found[name][0] - x) for name, x in zip(names, displaced, strict=True)) < 1e-8 * size
            off = 1e-8 * (omega * stiffness * size + abs(pressure))
            assert abs(found["contact_pressure"][0] - pressure) < off
