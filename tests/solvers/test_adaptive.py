"""Self-adaptive kinetic damping: the rule, its energies, its rest, and who refuses it."""

import numpy as np
import pytest
from conftest import thinned
from oracles.matrices_of_scenes import matrices, rule_of
from oracles.stepped_vibration import Rule

import dda
import fem_reference
from validation import advise, damping, load_scene, response, solve
from validation.advice.wave_advice import advise_wave
from validation.diagnosis.judgement import compare
from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.solvers.dda import model_of
from validation.solvers.fem import problem_of
from validation.solvers.registry import get_solver

COLUMNS = ("displacement", "contact_pressure", "discount", "kinetic_damping_loss")
STEPPED = {"time.step": 5e-4, "time.steps": 150, "run.columns": COLUMNS}
PLAIN = load_scene("figures-3-4").with_values(STEPPED | {"fem.elements": 3})
BLOCK = PLAIN.with_values({"damping.kinetic": "adaptive"})
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
CASES = [
    ("dda", {}),
    ("dda", {"block.poisson": 0.25, "load.traction": 1e6} | AVERAGE),
    ("dda", {"time.alpha": 0.0, "time.delta": 0.5, "time.step": 2e-4, "damping.floor": 0.3}),
    ("dda", {"load.gravity": 9.81, "load.eccentricity": 0.3, "damping.floor": 0.95}),
    ("fem", {}),
    ("fem", {"damping.floor": 0.9} | AVERAGE),
    ("fem", {"block.poisson": 0.3, "load.traction": 1e6, "fem.elements": 2} | AVERAGE),
]


def columns(scene: Scene, solver: str) -> dict[str, np.ndarray]:
    history = solve(scene, solver).history
    return history.columns


def plain(rule: Rule, system: tuple[np.ndarray, ...], steps: int, consistent: bool, floor: float) -> np.ndarray:
    """Return displacement, pressure, gg, energy taken and mechanical energy of every step by the printed scheme."""
    (M, K, F, rows), dt, taken = system, rule.step, 0.0
    D, V, A = np.zeros_like(F), np.zeros_like(F), np.linalg.solve(M, F) if consistent else np.zeros_like(F)
    T, found = [0.0, 0.0], []
    for _ in range(steps):
        gg = max(floor, np.sqrt(T[-1] / T[-2])) if T[-1] < T[-2] else 1.0
        V, taken = gg * V, taken + (1 - gg * gg) * T[-1]
        D, V = D + dt * V + dt**2 * (0.5 - rule.alpha) * A, V + dt * (1 - rule.delta) * A
        A = np.linalg.solve(M + rule.alpha * dt**2 * K, F - K @ D)
        D, V = D + rule.alpha * dt**2 * A, V + rule.delta * dt * A
        T.append(V @ M @ V / 2)
        found.append([*(rows @ D), gg, taken, T[-1] + D @ K @ D / 2 - F @ D])
    return np.array(found).T


@pytest.mark.parametrize(("solver", "values"), thinned(CASES, 3))
def test_histories_are_those_of_the_printed_scheme_with_the_rule(solver: str, values: dict[str, object]) -> None:
    scene = BLOCK.with_values(values)
    still = scene.with_values({"damping.kinetic": "constant", "damping.floor": 0.0})
    system = matrices(get_solver(solver).prepare(still))
    consistent = scene.time.start == "consistent"
    expected = plain(rule_of(scene), system, scene.time.steps, consistent, scene.damping.floor)
    found = columns(scene, solver)
    assert expected[2].min() < 0.96 and expected[2].max() == 1
    for column, own in zip(COLUMNS, expected, strict=False):
        # rounding; a discount is a ratio of velocities and keeps fewer digits where they nearly vanish
        assert np.max(np.abs(found[column] - own)) <= 1e-8 * np.max(np.abs(own)), column
    if consistent:  # average acceleration has no loss of its own
        assert np.max(np.abs(found[COLUMNS[3]] + expected[4])) <= 1e-8 * found[COLUMNS[3]][-1]


def test_who_needs_a_linear_motion_refuses_it() -> None:
    asks = (
        lambda: damping(BLOCK),
        lambda: response(BLOCK, [1.0], "fem"),
        lambda: advise(BLOCK, 0.05),
        lambda: advise_wave(BLOCK, 5.0, 0.1),
        lambda: compare(BLOCK, None),  # type: ignore[arg-type]
    )
    for ask in asks:
        with pytest.raises(InputError, match="self-adaptive damping"):
            ask()


def test_settings_that_do_not_go_together_are_refused() -> None:
    for values, named in (({"time.gg": 0.9}, "time: gg"), ({"damping.floor": 1.5}, "damping.floor")):
        with pytest.raises(InputError, match=named):
            BLOCK.with_values(values)
    with pytest.raises(InputError, match="floor goes with"):
        PLAIN.with_values({"damping.floor": 0.5})
    block, mesh = model_of(PLAIN), problem_of(PLAIN)
    for scheme in ((0.5, 1.0, 0.9, 1e-3), (0.5, 1.0, 1.0, 1e-3, "zero", 1.0)):
        with pytest.raises(ValueError, match="adapt"):
            dda.solve(block, dda.Scheme(*scheme), 3, floor=0.0)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="adapt"):
            fem_reference.solve_adaptive(mesh, fem_reference.Scheme(*scheme), 3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="floor"):
        dda.solve(block, dda.Scheme(0.5, 1.0, 1.0, 1e-3), 3, floor=-0.1)
    with pytest.raises(ValueError, match="floor"):
        fem_reference.solve_adaptive(mesh, fem_reference.Scheme(0.5, 1.0, 1.0, 1e-3), 3, floor=-0.1)
