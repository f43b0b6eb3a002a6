"""Columns of blocks: waves in them against closed forms, the system of blocks, and the laws of joints and bases."""

from itertools import product

import numpy as np
import pytest
from conftest import thinned

import dda
from dda.bodies.bonded_column import Drive, solve_column
from dda.bodies.column import Column, Layer, Motion, Spring
from validation.metrics.transform import spectrum
from validation.theory import waves
from validation.theory.stepping import Stepping

CONSTANT, AVERAGE = (0.5, 1.0), (0.25, 0.5)
HEIGHT, DENSITY, YOUNG, BLOCKS = 0.5, 2000.0, 1.8e9, 12
WATCHED = [3.5 * HEIGHT, 4.5 * HEIGHT, 5.5 * HEIGHT]  # the middles of three neighbours
NAMES = [f"displacement_{number}" for number in (1, 2, 3)]


def ricker(time: np.ndarray, frequency: float) -> Drive:
    """Return a wave of a Ricker velocity of 1 m/s at the base."""
    a = np.pi * frequency * (time - 2 / frequency)
    bell = np.exp(-a * a)
    rise = (4 * a**3 - 6 * a) * np.pi * frequency
    return Drive((time - 2 / frequency) * bell, (1 - 2 * a * a) * bell, rise * bell, 0 * time)


def wavenumber(
    count: float,
    courant: float,
    scheme: tuple[float, float],
    gg: float = 1.0,
    ratio: float | None = None,
    motion: Motion = "pressure",
    poisson: float = 0.0,
    passes: int = 8,
) -> tuple[complex, complex]:
    """Return k of a stepped column and of the closed form: `count` blocks a wavelength, glue over E / h."""
    layer = Layer(BLOCKS * HEIGHT, DENSITY, YOUNG, poisson, BLOCKS)
    modulus = layer.modulus(motion)
    glue = None if ratio is None else ratio * modulus / HEIGHT
    softer = 1.0 if ratio is None else 1 / (1 + 1 / ratio)
    column = Column([layer], motion, glue, impedance=(softer * modulus * DENSITY) ** 0.5)
    speed = (modulus / DENSITY) ** 0.5
    step, frequency = courant * HEIGHT / speed, speed / (count * HEIGHT)
    lasts = 4 / (0.4 * frequency) + passes * 2 * BLOCKS * HEIGHT / speed
    instants = step * np.arange(int(lasts / step))
    stepped = dda.Scheme(*scheme, gg, step)
    found = solve_column(column, stepped, ricker(instants, 0.4 * frequency), NAMES, WATCHED)
    omega = 2 * np.pi * frequency
    low, middle, high = (spectrum(found.time, found.columns[name], omega) for name in NAMES)
    guide = waves.Column(HEIGHT, DENSITY, modulus, glue)
    exact = guide.wavenumber(Stepping(step, *scheme, gg).squared_frequency(omega))
    half_sine = np.sqrt((1 - (low + high) / (2 * middle)) / 2)
    return complex(2 * np.arcsin(half_sine) / HEIGHT), complex(exact)


WELDED = [(8, 0.25), (10, 0.25), (10, 0.5), (10, 1), (20, 0.25)]  # blocks a wavelength, Courant's number
GLUED = [(1, 20), (10, 8), (100, 8), (1e4, 8), (1e12, 8)]  # glue over E / h, passes of the wave


@pytest.mark.parametrize(("wave", "scheme"), thinned(product(WELDED, [CONSTANT, AVERAGE]), 3))
def test_waves_in_welded_blocks(wave: tuple[float, float], scheme: tuple[float, float]) -> None:
    found, exact = wavenumber(*wave, scheme)
    assert abs(found - exact) < 1e-10 * abs(exact)


@pytest.mark.parametrize(("glue", "scheme"), thinned(product(GLUED, [CONSTANT, AVERAGE]), 3))
def test_waves_in_glued_blocks(glue: tuple[float, int], scheme: tuple[float, float]) -> None:
    ratio, passes = glue
    found, exact = wavenumber(10, 0.5, scheme, ratio=ratio, passes=passes)
    assert abs(found - exact) < 1e-10 * abs(exact)


@pytest.mark.parametrize("motion", ["pressure", "shear"])
@pytest.mark.parametrize("ratio", [None, 30.0])
def test_waves_with_kinetic_damping_and_poissons_ratio(motion: Motion, ratio: float | None) -> None:
    found, exact = wavenumber(14, 0.3, (0.4, 0.7), 0.99, ratio, motion, 0.3)
    assert abs(found - exact) < 1e-10 * abs(exact)


def test_the_moduli_are_those_of_plane_waves() -> None:
    layer = Layer(1.0, 1.0, 1.0, 0.25)
    assert layer.modulus("shear") == pytest.approx(0.4)
    assert layer.modulus("pressure") == pytest.approx(1.2)
    assert Layer(1.0, 1.0, 1.0).modulus("pressure") == 1.0


def test_a_column_is_the_system_of_blocks_on_its_springs() -> None:
    """Five squares under a pressure: the two-dimensional blocks, whose two end springs of p make 2 p / a a joint."""
    a, p, glue, pressure, step, steps = 2.0, 3e9, 5e9, 1e6, 2e-4, 60
    block = dda.Block([(0, 0), (a, 0), (a, 5 * a), (0, 5 * a)], dda.Material(2700.0, 1e9, 0.0, "plane stress"))
    model = dda.TwoBlockModel(block, dda.Contact(p, p), pressure)
    scheme = dda.Scheme(0.4, 0.7, 0.98, step)
    system = dda.solve_system(dda.subdivided(model, 1, 5, glue), scheme, steps)
    column = Column([Layer(5 * a, 2700.0, 1e9, 0.0, 5)], "pressure", 2 * glue / a, [Spring(0.0, 2 * p / a)])
    still = np.zeros(steps + 1)
    drive = Drive(still, still, still, np.full(steps + 1, pressure))
    found = solve_column(column, scheme, drive, ("displacement_1", "contact_pressure"), [2.5 * a])
    for mine, other in (("displacement_1", "displacement"), ("contact_pressure", "contact_pressure")):
        size = np.abs(system.columns[other]).max()
        assert np.abs(found.columns[mine] - system.columns[other]).max() < 1e-10 * size


def test_the_surface_over_a_rigid_base_answers_by_mass_and_stiffness() -> None:
    """Welded to the base, whose inertia of half a block counts: (K - W2 M) x = -(K_b - w^2 M_b) d, here by hand."""
    n, step, omega = 6, 5e-4, 400.0
    column = Column([Layer(n * HEIGHT, DENSITY, YOUNG, 0.0, n)])
    time = step * np.arange(4000)
    drive = ricker(time, 60.0)
    found = solve_column(column, dda.Scheme(0.5, 1.0, 1.0, step), drive)
    A, B = waves.Column(HEIGHT, DENSITY, YOUNG).ends(Stepping(step).squared_frequency(omega))
    a, b = waves.Column(HEIGHT, DENSITY, YOUNG).ends(omega**2)
    matrix = np.diag([2 * A] * (n - 1) + [A]) + np.diag([B] * (n - 1), 1) + np.diag([B] * (n - 1), -1)
    x = np.linalg.solve(matrix, [-b, *[0.0] * (n - 1)])
    moved = spectrum(time, drive.displacement, omega)
    seen = {name: spectrum(found.time, values, omega) / moved for name, values in found.columns.items()}
    assert abs(seen["displacement"] - x[-1]) < 1e-9 * abs(x[-1])
    assert abs(seen["contact_pressure"] - (a + B * x[0])) < 1e-9 * abs(a + B * x[0])


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"layers": []}, "layers: must be at least one"),
        ({"glue": 0.0}, "glue: must be finite and positive"),
        ({"impedance": -1.0}, "impedance: must be finite and positive"),
        ({"joints": [Spring(0.3, 1e9)]}, "joints: must lie where blocks meet"),
        ({"joints": [Spring(4.0, 1e9)]}, "joints: must lie where blocks meet, below the top"),
        ({"joints": [Spring(1.0, 1e9), Spring(1.0, 2e9)]}, "joints: must not share a height"),
    ],
)
def test_bad_columns_are_refused(change: dict[str, object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Column(**({"layers": [Layer(4.0, DENSITY, YOUNG, 0.0, 4)]} | change))
