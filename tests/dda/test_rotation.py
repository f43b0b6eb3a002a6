"""A block that turns by any angle: invariants of its steps, small motion as its limit, named outcomes."""

import math
from copy import deepcopy
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from conftest import thinned
from oracles.rolling import random_rolling

import dda.rotation.solution as solution
import dda.rotation.step as step
from dda import BaseMotion, Block, Load, Material, Scheme, Unilateral, UnilateralModel
from dda import solve_unilateral as solve_small
from dda.contact.kernel import NONE
from dda.rotation.body import FIRST_ORDER, turned
from dda.rotation.solution import RollingModel, RollingOptions, solve_rolling
from dda.rotation.step import rolling_equations, set_matrices
from dda.stepping.driver import OUTCOMES, driver

COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation", "strain_x", "strain_y")
STORED = ("kinetic", "strain", "springs", "load")
LOST = ("algorithmic", "kinetic damping", "switching", "friction")
MATERIAL = Material(2700.0, 1e9, 0.2)
QUADRILATERAL = Block([[0, 0], [2, 0], [2.5, 1], [0.3, 1.7]], MATERIAL)
FAR = Unilateral(1e9, gap=100.0)
AVERAGE, CONSTANT = (0.25, 0.5), (0.5, 1.0)
HEAVY = RollingModel(Block.rectangle(1.0, 2.5, MATERIAL), Unilateral(1e8, 4e7), Load(gravity=9.81), tilt=0.3)


def losses(result):
    """Return total energy, and the increments of all losses as rows, over the largest energy."""
    e = result.energies
    size = max(np.max(np.abs(values)) for values in e.values())
    return sum(e[name] for name in STORED) / size, np.diff([e[name] for name in LOST]) / size


@pytest.mark.parametrize(
    ("seed", "steps"), [(1, 80), (2, 80), *(pytest.param(seed, 200, marks=pytest.mark.long) for seed in range(3, 53))]
)
def test_no_energy_is_gained_at_delta_one_however_far_a_block_turns(seed, steps):
    model, dt = random_rolling(seed)
    scheme = Scheme(*CONSTANT, 0.98 if seed % 5 == 0 else 1.0, dt, "consistent" if seed % 2 else "zero")
    result = solve_rolling(model, scheme, steps)
    total, lost = losses(result)
    assert result.outcome == "completed" and np.max(np.abs(np.diff(total) + lost.sum(axis=0))) < 1e-13
    assert np.max(np.diff(total)) < 1e-13 and np.min(lost) > -1e-13
    assert np.all(result.normal >= 0) and np.all(result.gap * model.contact.stiffness >= -result.normal * (1 + 1e-9))


@pytest.mark.parametrize(("alpha", "delta"), [AVERAGE, CONSTANT, pytest.param(0.3025, 0.6, marks=pytest.mark.long)])
def test_free_flight_keeps_momentum_angular_momentum_and_shape(alpha, delta):
    model, scheme = RollingModel(QUADRILATERAL, FAR), Scheme(alpha, delta, 1.0, 0.01)
    V = np.array([1.0, 2.0, 7.0, 0.3, -0.2, 0.4])  # it vibrates as it spins
    real = RollingModel.start
    with patch.object(RollingModel, "start", lambda *given: real(*given)._replace(V=V)):
        result = solve_rolling(model, scheme, 300)
    states, M, K = result.motion, result.body.M, result.body.K
    assert states.r[-1] > 6 * math.pi
    assert np.max(np.abs(states.V @ M[:, :3] / (M[:3] @ V) - 1)) < 1e-12
    kinetic = np.einsum("ki,ij,kj->k", states.V, M, states.V) / 2
    strain = np.einsum("ki,ij,kj->k", states.e, K, states.e) / 2
    gained = np.diff(kinetic + strain) / kinetic[0]
    assert np.max(gained) < 1e-13 and (delta > 0.5 or np.max(np.abs(gained)) < 1e-13)
    assert np.max(np.abs(np.linalg.det(states.Q) - 1)) < 1e-12
    assert np.ptp(strain) > 1e-5 * kinetic[0]


def test_a_turn_by_360_degrees_brings_the_outline_back():
    body = Block.rectangle(2.0, 2.0, MATERIAL)  # a square does not shear as it spins
    model = RollingModel(body, FAR, spin=2 * math.pi / 0.9)
    result = solve_rolling(model, Scheme(*AVERAGE, 1.0, 0.01), 90)
    start = result.body.xi + result.motion.c[0]
    assert abs(result.angle[-1] - 2 * math.pi) < 1e-12
    assert np.max(np.abs(result.outline[-1] - start)) < 1e-12


@pytest.mark.parametrize("steps", [45, 180])
def test_first_order_rotation_grows_the_outline_as_its_closed_form_says(steps):
    r = math.pi / steps
    model = RollingModel(Block.rectangle(2.0, 2.0, MATERIAL), FAR, spin=r / 0.01)
    result = solve_rolling(model, Scheme(*CONSTANT, 1.0, 0.01), steps, options=RollingOptions(FIRST_ORDER))
    assert result.area[-1] == pytest.approx((1 + r * r) ** steps, rel=1e-11)
    first, last = result.energies["kinetic"][[0, -1]]
    assert last / first == pytest.approx((1 + r * r) ** (2 * (steps - 1)), rel=1e-11)  # moments go with its square
    outline = result.outline[-1] - result.motion.c[-1]
    angle = math.atan2(*(outline[1] - outline[0])[::-1]) % (2 * math.pi)
    assert angle == pytest.approx(steps * math.atan(r), rel=1e-11)


def test_the_matrices_of_a_grown_outline_are_those_of_its_polygon():
    model = RollingModel(QUADRILATERAL, FAR)
    body = rolling_equations(model.setting(RollingOptions(FIRST_ORDER)), Scheme(*CONSTANT, 1.0, 1e-3))
    set_matrices(body, body.last, 1.0, 1.1 * turned(0.4), body.last.part)
    larger, made = Block(model.body.xi * 1.1, MATERIAL), body.last.part
    assert np.allclose(made.M, larger.mass(), rtol=1e-12, atol=1e-9)
    assert np.allclose(made.K, larger.elastic()[3:, 3:], rtol=1e-12)
    S = larger.mass()
    S[3:, 3:] += 0.5e-6 * larger.elastic()[3:, 3:]
    assert np.allclose(made.accelerating @ larger.mass(), np.eye(6), rtol=0, atol=1e-12)
    assert np.allclose(made.flexible @ S, 0.5e-6 * np.eye(6), rtol=0, atol=1e-18)


def test_small_motion_is_the_limit_of_small_loads():
    law, scheme, e = Unilateral(1e9, 4e8), Scheme(*CONSTANT, 1.0, 2e-3), 0.3
    block = Block([[0, 0], [2, 1], [1.5, 2.2], [-0.5, 1.0]], MATERIAL)  # its base leans
    off = []
    for size in (1.0, 0.5):
        q, g = 4e5 * size, 9.81 * size
        small = solve_small(UnilateralModel(block, law, Load(q, e, 0.3 * q, g)), scheme, 60, COLUMNS)
        load = Load(q, e, 0.3 * q, g)
        turned = solve_rolling(RollingModel(block, law, load), scheme, 60, COLUMNS)
        off.append([np.max(np.abs(turned.columns[n] - small.columns[n])) / np.ptp(small.columns[n]) for n in COLUMNS])
        rotation = np.max(np.abs(small.columns["rotation"]))
    ratio = np.array(off[0]) / np.array(off[1])
    assert np.all(np.array(off[0]) < 20 * 2 * rotation) and np.all(ratio > 1.7) and np.all(ratio < 2.3)


def test_a_base_that_moves_steadily_is_a_block_that_flies_the_other_way():
    scheme, V = Scheme(*AVERAGE, 1.0, 2e-3, "consistent"), np.array([0.4, 0.3])
    motion = BaseMotion([0.0, 1.0], [[0.0, 0.0], V])
    carried = solve_rolling(replace(HEAVY, load=Load(gravity=9.81, motion=motion)), scheme, 70)
    thrown = solve_rolling(replace(HEAVY, velocity=tuple(-V)), scheme, 70)
    assert np.max(np.abs(carried.gap - thrown.gap)) < 1e-11
    assert np.max(np.abs(carried.slide - thrown.slide)) < 1e-11
    for name in ("strain", *LOST):  # what is lost does not depend on who looks on
        assert np.max(np.abs(carried.energies[name] - thrown.energies[name])) < 1e-9 * np.max(
            thrown.energies["kinetic"]
        )
    total, lost = losses(carried)
    assert np.max(np.abs(np.diff(total) + lost.sum(axis=0))) < 1e-13


def test_a_dead_load_keeps_its_direction_and_its_point():
    """What it gives to a weightless block in flight is q L times the fall of its point."""
    block = Block.rectangle(1.0, 2.0, Material(2700.0, 1e12, 0.0))
    model = RollingModel(block, FAR, Load(1e4, 0.2, 2e3))
    result = solve_rolling(model, Scheme(*AVERAGE, 1.0, 4e-3, "consistent"), 150)
    assert abs(result.angle[-1]) > 0.25
    e = result.energies
    assert np.max(np.abs(e["kinetic"] + e["load"])) < 1e-4 * np.max(e["kinetic"])
    pressed = (result.outline[:, 3] * 0.3 + result.outline[:, 2] * 0.7)[-1] - np.array([0.7, 102.0])
    middle = result.outline[-1, 2:].mean(axis=0) - np.array([0.5, 102.0])
    assert e["load"][-1] == pytest.approx(1e4 * 0.6 * pressed[1] - 2e3 * middle[0], rel=1e-9)


def test_a_step_leaves_the_state_that_it_starts_from_and_is_bitwise_the_same_again():
    checked = []

    def twice(body, shear_law, state, after, *given):
        saved = deepcopy(state)
        outcome = step.advance(body, shear_law, state, after, *given)
        first = deepcopy(after)
        assert state == saved and step.advance(body, shear_law, state, after, *given) == outcome and first == after
        checked.append(outcome)
        return outcome

    with patch.object(solution, "make_steps", driver(twice, step.account, step.keep)):
        result = solve_rolling(HEAVY, Scheme(*CONSTANT, 0.99, 1e-3), 160)
    assert len(checked) == 160 and np.any(result.closed[:, -1])


def test_a_step_without_a_contact_state_is_cut_and_then_ends_by_name():
    tried = []

    def refused(body, shear_law, state, after, base, part):
        made = step.matrices_of(body, body.last, state.Q, part.ratio)
        tried.append(list(made.numbers))
        return NONE, 3

    with patch.object(solution, "make_steps", driver(refused, step.account, step.keep)):
        result = solve_rolling(HEAVY, Scheme(*CONSTANT, 0.9, 1e-3), 5)
    assert result.outcome == OUTCOMES[NONE] and len(result.time) == 0 and "at step 1" in result.notes[-1]
    assert [h for _, _, h in tried] == pytest.approx([1e-3, 3e-4, 9e-5, 2.7e-5, 1e-5])
    assert tried[1][1] == pytest.approx(0.9**0.3)


def test_the_parts_of_a_cut_step_are_a_whole_step():
    failed, bases = [], []

    def once(body, shear_law, state, after, base, part):
        outcome, solves = step.advance(body, shear_law, state, after, base, part)
        if not failed and part.ratio == 1 and state.q[2] != 0:
            failed.append(part.begun)
            return NONE, 1
        bases.append((part.begun + part.ratio, body.room.base[0]))
        return outcome, solves

    scheme = Scheme(*AVERAGE, 0.99, 1e-3)
    shaken = replace(HEAVY, load=Load(gravity=9.81, motion=BaseMotion([0.0, 1.0], [[0.0, 0.0], [0.4, 0.0]])))
    with patch.object(solution, "make_steps", driver(once, step.account, step.keep)):
        cut = solve_rolling(shaken, scheme, 40)
    whole = solve_rolling(shaken, scheme, 40)
    assert cut.step_cuts.sum() == 1 and len(bases) == 41
    ends, moved = np.transpose(bases)
    assert np.allclose(moved, 0.4 * scheme.step * ends, rtol=1e-12)
    assert np.count_nonzero(np.isclose(ends, np.round(ends))) == 40  # the parts of the cut step follow each other
    total, lost = losses(cut)
    assert np.max(np.abs(np.diff(total) + lost.sum(axis=0))) < 1e-13
    assert np.max(np.abs(cut.gap - whole.gap)) < 1e-5


def test_corners_that_were_not_thought_to_touch_are_found_by_the_step():
    scheme, rocking = Scheme(*CONSTANT, 1.0, 5e-3), replace(HEAVY, tilt=0.1)
    sound = solve_rolling(rocking, scheme, 80)
    with patch.object(step, "REACH", -100.0):
        blind = solve_rolling(rocking, scheme, 80)
    assert np.max(np.abs(blind.gap - sound.gap)) < 1e-9 and np.count_nonzero(np.diff(sound.states)) > 1


def test_overflow_is_an_outcome():
    model = RollingModel(QUADRILATERAL, FAR, Load(gravity=-1e300))
    result = solve_rolling(model, Scheme(*CONSTANT, 1.0, 1e6), 20)
    assert result.outcome == "overflow" and len(result.time) < 20


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"base": 4}, "base: must be an edge between 0 and 3"),
        ({"top": 0}, "top: must differ from base"),
        ({"tilt": math.nan}, "tilt: must be finite"),
        ({"velocity": (0.0, math.inf)}, "velocity: must be finite"),
        ({"contact": Unilateral(1e9, band=(1e-3, 0.0))}, "band: must be zero"),
        ({"block": Block([[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]], MATERIAL)}, "vertices: must be those of a convex"),
        ({"load": Load(1e3, 1.2)}, "eccentricity: must be below"),
    ],
)
def test_bad_models_are_refused_by_name(given, words):
    with pytest.raises(ValueError, match=words):
        replace(RollingModel(Block.rectangle(2.0, 2.0, MATERIAL), Unilateral(1e9)), **given)


@pytest.mark.parametrize(
    ("given", "words"),
    [({"rotation": "second"}, "rotation: must be"), ({"solve_limit": 0}, "solve_limit:"), ({"cut": 1.0}, "cut:")],
)
def test_bad_options_are_refused_by_name(given, words):
    with pytest.raises(ValueError, match=words):
        RollingOptions(**given)


def test_rigid_stops_and_explicit_schemes_exclude_each_other():
    with pytest.raises(ValueError, match="stiffness: must be finite in an explicit scheme"):
        solve_rolling(RollingModel(QUADRILATERAL, Unilateral(math.inf)), Scheme(0.0, 0.5, 1.0, 1e-3), 1)


@pytest.mark.parametrize(
    ("alpha", "delta", "gg"), thinned([(0.5, 1.0, 1.0), (0.25, 0.5, 0.99), (0.3025, 0.6, 0.97)], 2)
)
def test_while_all_corners_slip_the_centroid_moves_freely_along_the_slope(alpha, delta, gg):
    """Its u + tan(phi) v is the same recursion without contact, under g (sin b - tan(phi) cos b)."""
    b, friction = 35.0, 0.3
    block = Block.rectangle(2.0, 1.0, MATERIAL)
    sliding = RollingModel(block, Unilateral(1e9, 1e9, friction=friction), Load(gravity=9.81, slope=b))
    scheme = Scheme(alpha, delta, gg, 1e-3, "consistent")
    found = solve_rolling(sliding, scheme, 60, COLUMNS)
    assert set(np.unique(found.states[list(found.base_contacts)])) <= {0, 2} and np.max(found.normal) > 0
    across = 9.81 * (math.sin(math.radians(b)) - friction * math.cos(math.radians(b)))
    free = solve_rolling(RollingModel(block, FAR, Load(gravity=-across)), scheme, 60, COLUMNS)
    moved = found.columns["horizontal_displacement"] + friction * found.columns["displacement"]
    assert np.max(np.abs(moved - free.columns["displacement"])) < 1e-12  # m, of 100 m
    assert found.slip[-1] == pytest.approx(np.max(found.slide[list(found.base_contacts)]), rel=0.05)
    lost = np.diff(found.energies["friction"])
    assert np.min(lost) >= 0 and np.max(lost) > 0


def test_a_rigid_stop_takes_a_block_that_turns():
    model = replace(HEAVY, contact=Unilateral(math.inf, 4e9, friction=1.0))
    result = solve_rolling(model, Scheme(*CONSTANT, 1.0, 5e-3), 100)
    total, lost = losses(result)
    assert result.outcome == "completed" and np.max(np.diff(total)) < 1e-13 and np.min(lost) > -1e-13
    assert np.all(result.gap[result.closed] == 0) and np.min(result.gap) >= 0
