"""The adviser and its inverse: what is advised is what runs, all of it is found, and what is out of reach is."""

import math

import numpy as np
import pytest
from conftest import thinned
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from validation import InputError, advise, damping, load_scene
from validation.advice.advice import Search

BASE = load_scene("figures-3-4").with_values({"time.step": 0.002})
EXAMPLES = settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
SCHEMES = st.sampled_from([(0.5, 1.0), (0.25, 0.5), (0.5625, 1.0), (0.3025, 0.6), (0.7, 1.3), (1 / 6, 0.5), (1.1, 1.7)])


def decades(low, high):
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


@st.composite
def scenes(draw):
    side, young = draw(st.floats(0.3, 6.0)), draw(decades(7, 10.5))
    density, alpha_delta = draw(st.floats(1500, 3500)), draw(SCHEMES)
    wave = side / math.sqrt(young / density)
    values = {
        "block.side": side,
        "block.young": young,
        "block.density": density,
        "block.poisson": draw(st.sampled_from([0.0, 0.2, 0.45])),
        "contact.stiffness": young * draw(decades(-2, 4)),
        "time.step": wave * draw(decades(-3, 0.7)),
        "time.alpha": alpha_delta[0],
        "time.delta": alpha_delta[1],
        "time.allow_unstable": True,
    }
    kind = draw(st.sampled_from(["none", "gg", "rate"]))
    if kind == "gg":
        values["time.gg"] = draw(st.floats(0.3, 0.9999))
    if kind == "rate":
        values["time.gg_rate"] = draw(decades(-2, 0.5)) / wave
    return BASE.with_values(values)


@pytest.mark.long
@EXAMPLES
@given(scenes(), decades(-3, 0.2), st.sampled_from(["dt", "gg", "scheme"]))
def test_what_is_advised_is_what_runs(scene, target, solve_for):
    advice = advise(scene, damping=target, solve_for=solve_for)
    assert advice.reachable == bool(advice.solutions)
    for solution in advice.solutions:
        runs = damping(scene.with_values(solution.settings)).modes[0]
        assert runs.damping == pytest.approx(target, rel=1e-6)
        assert solution.damping == runs.damping
    if not advice.reachable and advice.greatest is not None:
        assert target > advice.greatest or target < advice.least


LOADS = {
    "pressure": {"load.pressure": 2e6},
    "weight": {"load.gravity": 9.81},
    "both": {"load.pressure": 2e6, "load.gravity": 9.81},
    "ramp": {"load.pressure": 2e6, "load.gravity": 9.81, "load.ramp": 0.2},
}


@pytest.mark.parametrize("load", thinned(LOADS.values(), 3), ids=LOADS)
def test_settling_is_that_of_the_history_under_the_loads_of_the_scene(load):
    from validation.engine.case import Case
    from validation.engine.measure import execute

    scene = BASE.with_values({"load.pressure": 0.0} | load)
    solution = advise(scene, damping=0.2).solutions[0]
    case = scene.with_values(solution.settings | {"time.steps": 500})
    row, _ = execute(Case(case, "dda"), "key", "test")
    assert solution.settling_steps == row.metrics["displacement.settling_step"]
    assert solution.settling_seconds == pytest.approx(solution.settling_steps * solution.value)


def test_loads_without_a_static_displacement_settle_nowhere():
    from validation.advice.advice import NO_STATIC

    sheared = BASE.with_values({"load.pressure": 0.0, "load.traction": 1e5})
    for scene in (sheared, load_scene("response-base").expand()[0]):
        solution = advise(scene, damping=0.02).solutions[0]
        assert (solution.settling_steps, solution.settling_from) == (None, NO_STATIC)


def test_a_long_settling_is_the_envelope_of_the_history():
    from validation.advice import advice

    case = BASE.with_values({"time.step": 1e-4, "time.gg_rate": 10.0})
    exact, source = advice._settling(case)
    assert source == "history"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(advice, "LONGEST", 100)
        rough, source = advice._settling(case)
    assert source == "envelope"
    assert rough == pytest.approx(exact, rel=0.1)


def test_the_scheme_family_is_the_boundary_of_14():
    solution = advise(BASE, damping=0.05, solve_for="scheme").solutions[0]
    assert solution.alpha == pytest.approx((0.5 + solution.delta) ** 2 / 4, rel=1e-15)  # above it roots turn real
    assert solution.settings == {"time.alpha": solution.alpha, "time.delta": solution.value}


def test_what_is_sought_ends_where_the_highest_mode_would_grow():
    for omega, end in ((lambda s: s, 2.0), (lambda s: 1 / s, 0.5)):  # of central differences
        search = Search(np.linspace(0.1, 3.0, 30), lambda s, omega=omega: (omega(s), 0.0, 0.5, 1.0), dict, "", 1.0)
        coordinates, ratios = search.samples
        ends = coordinates[np.isfinite(ratios)][[0, -1]]
        assert ends == pytest.approx([0.1, end] if end == 2 else [end, 3.0], rel=1e-9)


def test_no_damping_wanted_of_a_scheme_that_has_none():
    undamped = load_scene("figure-9").with_values({"time.gg": 1.0})
    advice = advise(undamped, damping=0.0)
    assert advice.reachable and advice.solutions[0].settling_steps is None
    assert advise(undamped, damping=0.01, solve_for="dt").reachable is False


@pytest.mark.parametrize(
    ("wanted", "solve_for", "field"), [(-0.1, "dt", "damping"), (math.nan, "dt", "damping"), (0.1, "p", "solve_for")]
)
def test_bad_input_is_named(wanted, solve_for, field):
    with pytest.raises(InputError) as refusal:
        advise(BASE, damping=wanted, solve_for=solve_for)
    assert refusal.value.field == field
    with pytest.raises(InputError) as refusal:
        damping(load_scene("figures-3-4"))
    assert refusal.value.field == "sweep"
