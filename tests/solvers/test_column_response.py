"""Frequency responses of columns: against stepped histories, closed forms and the exact layers."""

import numpy as np
import pytest
from conftest import thinned
from oracles.stepped_vibration import fit

import dda
import fem_reference
from dda.bodies.bonded_column import Drive, solve_column
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_equations import equations
from dda.result.result import Result
from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.column.stepping import solve_line
from fem_reference.column.vibration import line_response
from fem_reference.problem.result import Result as FemResult
from validation import load_scene, response

NAMES = ("displacement", "contact_pressure")
Drawn = tuple[Column, Ground, list[int], dict[str, float]]


def draw(rng: np.random.Generator) -> Drawn:
    """Return a random column as blocks and as elements, its elements a layer, and a scheme that damps."""
    count, motion = int(rng.integers(1, 4)), str(rng.choice(["pressure", "shear"]))
    layers = [
        Layer(
            rng.uniform(1, 4),
            rng.uniform(1500, 2500),
            10 ** rng.uniform(7, 9),
            rng.uniform(0, 0.4),
            int(rng.integers(1, 4)),
        )
        for _ in range(count)
    ]
    faces = np.cumsum([layer.thickness for layer in layers])
    joints = [Spring(float(face), 10 ** rng.uniform(7, 9)) for face in faces[:-1] if rng.random() < 0.5]
    if rng.random() < 0.4:
        joints.append(Spring(0.0, 10 ** rng.uniform(7, 9)))
    impedance = None if rng.random() < 0.5 else 10 ** rng.uniform(5, 6.5)
    glue = None if rng.random() < 0.5 else 10 ** rng.uniform(8, 10)
    column = Column(layers, motion, glue, joints, impedance)  # type: ignore[arg-type]
    strata = tuple(Stratum(x.thickness, x.density, x.young, x.poisson) for x in layers)
    ground = Ground(strata, motion, tuple((j.height, j.stiffness) for j in joints), impedance)  # type: ignore[arg-type]
    delta = rng.uniform(0.6, 1.1)
    scheme = {
        "alpha": rng.uniform(0.55, 0.8) * delta,
        "delta": delta,
        "gg": rng.uniform(0.85, 0.98),
        "step": 10 ** rng.uniform(-3.5, -2),
    }
    return column, ground, [layer.blocks for layer in layers], scheme


def check(seed: int) -> bool:
    """Compare a random column with its histories under a sine; return whether their transients have gone."""
    rng = np.random.default_rng([seed, 77])
    column, ground, elements, numbers = draw(rng)
    at_top, degree = bool(rng.random() < 0.5), int(rng.integers(1, 3))
    w = rng.uniform(0.1, 1.5) / numbers["step"]
    steps = 2000
    t = numbers["step"] * np.arange(steps + 1.0)
    wave, rate, turn = np.sin(w * t), w * np.cos(w * t), -w * w * np.sin(w * t)
    still = np.zeros_like(t)
    parts = (still, still, still, wave) if at_top else (wave, rate, turn, still)
    blocks = solve_column(column, dda.Scheme(**numbers), Drive(*parts), NAMES)
    line = solve_line(ground, elements, degree, fem_reference.Scheme(**numbers), Excitation(*parts), NAMES)
    f = np.array([w / 2 / np.pi])
    answers = (
        dda.response(equations(column), dda.Scheme(**numbers), f, along=None if at_top else (1.0, 0.0)),
        line_response(ground, elements, degree, fem_reference.Scheme(**numbers), f, at_top),
    )
    both = [ends_there(*pair, w) for pair in zip((blocks, line), answers, strict=True)]
    return all(both)


def ends_there(history: Result | FemResult, found: dict[str, np.ndarray], w: float) -> bool:
    """Compare a history with a response; return whether its transients have gone, so that the comparison is sharp."""
    sharp = True
    for name in NAMES:
        values, amplitude = history.columns[name], found[name][0]
        parts = slice(-600, -300), slice(-300, None)
        early, late = (1j * fit(values[part, None], w, history.time[part])[0] for part in parts)
        left = abs(late - early)  # of the transients
        assert abs(late - amplitude) <= 1e-10 * abs(amplitude) + 10 * left, name
        sharp &= bool(left <= 1e-11 * abs(amplitude))
    return sharp


@pytest.mark.parametrize("seed", thinned([12, 3, 5], 3))  # a told base, a half-space, a pressure on the top
def test_stepped_columns_end_where_the_closed_form_says(seed: int) -> None:
    assert check(seed)


@pytest.mark.long
def test_many_stepped_columns_end_where_the_closed_form_says() -> None:
    assert sum(check(seed) for seed in range(6, 26)) > 15


def test_a_pressure_on_the_top_has_the_scenes_size() -> None:
    scene = load_scene("waves-base").expand()[0]
    drive = {"at": "top", "shape": "half-sine", "pressure": 3e5, "duration": 0.01}
    pressed = scene.with_values({"input": drive})
    for solver in ("dda", "fem", "layers"):
        found = response(pressed, [1e-3], solver)
        assert not found.base
        assert abs(found.contact_pressure[0]) == pytest.approx(3e5, rel=1e-3)
