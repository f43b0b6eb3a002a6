"""Damping tables, C = a0 M + a1 K: histories, spectra, exact motions, the damping budget, and who refuses them."""

import numpy as np
import pytest
from oracles.matrices_of_scenes import matrices, rule_of
from oracles.plain_newmark import stepped

from validation import advise, damping, load_scene, solve
from validation.advice.rayleigh import Rayleigh
from validation.advice.wave_advice import advise_wave
from validation.diagnosis.judgement import compare
from validation.errors import InputError
from validation.solvers.registry import get_solver

TABLES = {"damping.mass": 20.0, "damping.stiffness": 3e-4}
BLOCK = load_scene("figures-3-4").with_values({"time.step": 5e-4, "time.steps": 120} | TABLES)
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
COLUMNS = ("displacement", "contact_pressure")


@pytest.mark.parametrize(
    ("solver", "values"),
    [
        ("dda", {}),
        ("dda", {"block.poisson": 0.25, "load.traction": 1e6, "time.gg": 0.97} | AVERAGE),
        ("dda", {"time.alpha": 0.0, "time.delta": 0.5, "time.step": 2e-4}),
        ("dda", {"block.subdivide": [2, 2], "block.glue_ratio": 50.0, "block.poisson": 0.2}),
        ("dda", {"block.subdivide": [1, 3], "block.pattern": "triangles", "block.glue_ratio": 10.0} | AVERAGE),
        ("dda", {"block.subdivide": [2, 1], "block.glue_ratio": 5.0, "time.alpha": 0.0, "time.step": 1e-5}),
        ("fem", {"fem.elements": 3}),
        ("fem", {"fem.elements": 2, "block.poisson": 0.3, "load.traction": 1e6, "time.gg": 0.95} | AVERAGE),
        ("fem", {"fem.elements": 2, "fem.degree": 1, "time.alpha": 0.0, "time.step": 2e-5}),
    ],
)
def test_histories_are_those_of_the_printed_scheme_with_c(solver: str, values: dict[str, object]) -> None:
    scene = BLOCK.with_values(values)
    M, K, F, rows = matrices(get_solver(solver).prepare(scene))
    rule, forces = rule_of(scene), np.tile(F, (scene.time.steps + 1, 1))
    expected = rows @ stepped(M, K, forces, rule, rule.a0 * M + rule.a1 * K).T
    history = solve(scene, solver).history
    for column, values_ in zip(COLUMNS, expected, strict=True):
        assert np.max(np.abs(history.columns[column] - values_)) <= 1e-10 * np.max(np.abs(values_))


def test_the_radius_of_the_step_is_the_predicted_one() -> None:
    found = get_solver("dda").prepare(BLOCK).diagnostics()
    assert found["spectral_radius"] == pytest.approx(found["predicted_radius"], rel=1e-10)


def test_the_budget_has_a_viscous_part_that_rayleighs_formula_gives() -> None:
    scene = BLOCK.with_values({"time.step": 1e-5, "time.gg": 0.9999})
    mode = damping(scene).modes[0]
    expected = float(Rayleigh(20.0, 3e-4).ratio(mode.frequency / 2 / np.pi))
    assert mode.viscous == pytest.approx(expected, rel=2e-2)  # the parts add up to leading order
    assert mode.damping is not None and mode.algorithmic is not None and mode.kinetic is not None
    assert mode.damping == pytest.approx(mode.algorithmic + mode.kinetic + mode.viscous, rel=1e-12)
    assert "viscous" in damping(scene).sentence
    free = damping(BLOCK.with_values({"damping.mass": 0.0, "damping.stiffness": 0.0})).modes[0]
    assert free.viscous == 0
    exact = get_solver("continuum").prepare(BLOCK).modes()[0]
    rate = -2 * np.log(abs(exact.eigenvalues[0])) / BLOCK.time.step
    assert rate == pytest.approx(20.0 + 3e-4 * exact.frequency**2, rel=1e-9)


def test_who_knows_the_schemes_own_damping_only_refuses_it() -> None:
    for act in (lambda: advise(BLOCK, 0.05), lambda: advise_wave(BLOCK, 5.0, 0.1), lambda: compare(BLOCK, None)):  # type: ignore[arg-type]
        with pytest.raises(InputError, match="damping tables"):
            act()
