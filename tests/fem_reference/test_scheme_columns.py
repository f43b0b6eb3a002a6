"""Columns under schemes of stages: steps settle in the frequency response."""

import math
from itertools import product

import numpy as np
import pytest
from conftest import thinned

from fem_reference import named_scheme
from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.column.stepping import solve_line
from fem_reference.column.vibration import line_response

IMPLICIT = [
    ("chung-hulbert", {"rho_inf": 0.8}),
    ("chung-hulbert", {"rho_inf": 0.2}),
    ("hht", {"rho_inf": 0.6}),
    ("wbz", {"rho_inf": 0.5}),
    ("composite", {"split": 0.5}),
    ("composite", {"rho_inf": 0.4}),
]
EVERY = [*IMPLICIT, ("leapfrog", {})]
STRATA = (Stratum(4.0, 2000.0, 5e7, 0.3), Stratum(3.0, 1900.0, 2e7, 0.25))


def rest(scheme, steps, **parts):
    """What drives a column at the ends of the stages, nothing where no part says so."""
    t = scheme.stage_times(steps)
    return Excitation(**{
        name: parts.get(name, np.zeros_like)(t) for name in ("displacement", "velocity", "acceleration", "pressure")
    })  # fmt: skip


@pytest.mark.parametrize(("case", "base"), thinned(product(EVERY, ["half-space", "prescribed"]), 14))
def test_steps_settle_in_the_frequency_response(case, base):
    """A wave below and a pressure on top that vibrate; what begins dies in the half-space, or by gg."""
    name, options = case
    explicit = name == "leapfrog"
    if explicit and base == "half-space":
        return
    step, gg, steps = (1e-3, 0.96, 1300) if explicit else (3e-3, 0.89, 420)
    scheme = named_scheme(name, step=step, gg=gg, **options)
    ground = Ground(STRATA, "shear", ((2.0, 1e8),), 2e5 if base == "half-space" else None)
    frequency = 12.0
    w = 2 * math.pi * frequency
    names = ("displacement", "contact_pressure")
    moving = rest(
        scheme,
        steps,
        displacement=lambda t: np.cos(w * t),
        velocity=lambda t: -w * np.sin(w * t),
        acceleration=lambda t: -w * w * np.cos(w * t),
    )
    pressing = rest(scheme, steps, pressure=lambda t: 1e6 * np.cos(w * t))
    for drive, at_top, size in ((moving, False, 1.0), (pressing, True, 1e6)):
        history = solve_line(ground, [3, 2], 2, scheme, drive, names)
        amplitudes = line_response(ground, [3, 2], 2, scheme, np.array([frequency]), at_top, names)
        late = slice(-90, None)
        for column in names:
            expected = (size * amplitudes[column][0] * np.exp(1j * w * history.time[late])).real
            # Above a half-space the beginning may have shifted the whole column for good.
            change = np.diff(history.columns[column][late])
            assert np.abs(change - np.diff(expected)).max() < 1e-8 * np.abs(expected).max()
