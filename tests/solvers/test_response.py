"""Frequency responses: the closed form against stepped histories, its limits, what refuses it, and what it costs."""

import numpy as np
import pytest
from conftest import thinned
from oracles.matrices_of_scenes import matrices, rule_of
from oracles.stepped_vibration import amplitudes, steady_modes

from validation import load_scene, response
from validation.advice.response import Response
from validation.scenes.scene import Scene
from validation.solvers.bar import NewmarkBar
from validation.solvers.registry import get_solver

BLOCK = load_scene("figures-3-4").with_values({"time.step": 0.002})
FAMILIES = ("dda", "squares", "triangles", "fem", "bar")
PAPER = [  # Hz; mm and MPa: exact in time, dt = 2 ms with (1/2, 1), dt = 2 ms with (1/4, 1/2) and gg = 0.98
    ("dda", 20, (11.557512, 5.985548), (11.545937, 5.978494), (11.575518, 5.997081)),
    ("dda", 52, (100.592776, 62.986511), (31.441911, 19.566325), (220.917269, 140.551930)),
    ("dda", 80, (9.196829, 7.547915), (7.181528, 5.746814), (6.766508, 6.045844)),
    ("dda", 150, (1.899760, 4.112440), (1.136584, 1.896587), (1.041105, 15.419430)),
    ("bar", 20, (11.833857, 6.001957), (11.819792, 5.994367), (11.855327, 6.013750)),
    ("bar", 52, (1829.342453, 1009.589564), (32.473854, 17.852683), (137.596784, 76.523901)),
    ("bar", 80, (8.670163, 5.529513), (6.934957, 4.308803), (6.688912, 4.493665)),
    ("bar", 150, (3.127179, 4.683431), (1.248102, 0.887978), (0.730972, 2.454982)),
]
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.98}


def sizes(found: Response) -> tuple[float, float]:
    """Return the amplitudes in mm and MPa."""
    return 1e3 * abs(complex(found.displacement[0])), 1e-6 * abs(complex(found.contact_pressure[0]))


@pytest.mark.parametrize(("solver", "frequency", "exact", "constant", "average"), PAPER)
def test_the_papers_block_answers_as_an_independent_computation_does(
    solver: str,
    frequency: float,
    exact: tuple[float, float],
    constant: tuple[float, float],
    average: tuple[float, float],
) -> None:
    assert sizes(response(BLOCK, frequency, solver, exact=True)) == pytest.approx(exact, rel=2e-7)
    assert sizes(response(BLOCK, frequency, solver)) == pytest.approx(constant, rel=6e-7)
    assert sizes(response(BLOCK.with_values(AVERAGE), frequency, solver)) == pytest.approx(average, rel=6e-7)


def random_scene(rng: np.random.Generator, family: str) -> Scene:
    """Return a linear scene with a scheme that damps, and no step limit."""
    delta = rng.uniform(0.55, 1.2)
    values: dict[str, object] = {
        "block.density": rng.uniform(1500, 3000),
        "block.young": 10 ** rng.uniform(8, 10),
        "contact.stiffness": 10 ** rng.uniform(8, 10.5),
        "time.step": 10 ** rng.uniform(-3.5, -2),
        "time.alpha": rng.uniform(delta / 2, 1.0),
        "time.delta": delta,
        "time.gg": rng.choice([1.0, rng.uniform(0.8, 1.0)]),
        "damping.mass": rng.choice([0.0, 10 ** rng.uniform(0, 2)]),
        "damping.stiffness": rng.choice([0.0, 10 ** rng.uniform(-5, -3)]),
    }
    base = BLOCK.with_values({"block.height": rng.uniform(1, 4), "block.width": rng.uniform(1, 4)} | values)
    if family == "bar":
        return base
    values = {
        "block.poisson": rng.uniform(0, 0.4),
        "contact.shear_stiffness": 10 ** rng.uniform(8, 10.5),
        "load.traction": rng.choice([0.0, rng.uniform(-4e6, 4e6)]),
        "load.eccentricity": rng.choice([0.0, rng.uniform(-0.3, 0.3)]),
        "load.gravity": rng.choice([0.0, 9.81]),
    }
    if family == "fem":
        kind = str(rng.choice(["distributed", "corner"]))
        values |= {
            "fem.elements": int(rng.integers(1, 4)),
            "fem.degree": int(rng.integers(1, 3)),
            "fem.foundation": kind,
        }
    elif family != "dda":
        cut = [int(rng.integers(1, 3)), int(rng.integers(1, 4))]
        values |= {"block.subdivide": cut, "block.pattern": family, "block.glue_ratio": 10 ** rng.uniform(0, 2)}
    return base.with_values(values)


def check_against_steps(seed: int, family: str) -> None:
    """Compare one random scene under its loads with its stepped matrices, or with stepped modes of the bar."""
    rng = np.random.default_rng([seed, FAMILIES.index(family)])
    while True:
        scene = random_scene(rng, family)
        w = rng.uniform(0.05, 2.2) / scene.time.step
        solver = family if family in ("dda", "fem") else "dda"
        M, K, F, rows = matrices(get_solver(solver).prepare(scene))
        stepped = amplitudes(rule_of(scene), M, K, F, rows, w)
        if stepped is not None:
            break
    agree(scene, w, solver, stepped)


def agree(scene: Scene, w: float, solver: str, stepped: np.ndarray) -> None:
    """Compare stepped amplitudes with the closed form; what is rounding at rest is rounding in a small vibration."""
    found, static = response(scene, w / 2 / np.pi, solver), get_solver(solver).prepare(scene).static()
    for amplitude, column in zip(stepped, ("displacement", "contact_pressure"), strict=True):
        closed = complex(found.columns[column][0])
        assert abs(amplitude - closed) <= 1e-10 * abs(closed) + 1e-12 * abs(static[column]), (scene.definition(), w)


def check_bar(seed: int) -> None:
    """Compare the bar with the sum of its stepped modes; the rest falls with the third power of their number."""
    rng = np.random.default_rng([seed, 9])
    while True:
        scene = random_scene(rng, "bar")
        prepared = get_solver("bar").prepare(scene)
        assert isinstance(prepared, NewmarkBar)
        bar = prepared.bar
        w = rng.uniform(0.05, min(2.2, 8.0 * scene.time.step / bar.travel)) / scene.time.step
        squares = bar.frequencies(3000) ** 2
        squares = np.append(squares, 1e12 * squares[-1])  # what all modes beyond tend to
        steady = steady_modes(rule_of(scene), squares, w)
        if steady is not None:
            break
    static, answers = bar.static(), squares * steady
    beyond = answers[-1]
    sums = [
        static[c] * (beyond + bar.shares(c, 3000) @ (answers[:-1] - beyond))
        for c in ("displacement", "contact_pressure")
    ]
    agree(scene, w, "bar", np.array(sums))


@pytest.mark.parametrize("family", thinned(FAMILIES[:4], 4))
def test_stepped_vibrations_end_where_the_closed_form_says(family: str) -> None:
    for seed in range(2):
        check_against_steps(seed, family)


def test_the_stepped_modes_of_the_bar_end_where_the_closed_form_says() -> None:
    check_bar(0)


@pytest.mark.long
@pytest.mark.parametrize("family", FAMILIES[:4])
def test_many_stepped_vibrations_end_where_the_closed_form_says(family: str) -> None:
    for seed in range(2, 42):
        check_against_steps(seed, family)


@pytest.mark.long
def test_many_stepped_bars_end_where_the_closed_form_says() -> None:
    for seed in range(1, 41):
        check_bar(seed)
