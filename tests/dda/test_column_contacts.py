"""Columns whose contacts open or slip: the step, the theorems of its open-close iteration, and exact motions."""

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import thinned
from oracles.column_cases import CASES, error_of, layers, unilateral
from oracles.column_checks import check_history, random_column, random_drive, random_scheme, run_all, still

import dda
from dda import highest_frequency, named_scheme
from dda.bodies import contact_column as contacts
from dda.bodies.bonded_column import Drive, solve_column
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_equations import equations
from dda.bodies.contact_column import ColumnOptions, observed_columns, solve_contact_column
from dda.bodies.open_column import blocks_of, body_of, laws_of
from dda.contact.band import find_in_band
from dda.contact.rows import FOUND, INSIDE, LIMIT, LOWER, Laws, flexibility_for, rows_of, work_for
from dda.contact.unilateral import OPEN
from dda.march import compiled
from dda.march.step import march_of
from dda.scheme.newmark import Scheme, Start

AVERAGE, CONSTANT = (0.25, 0.5), (0.5, 1.0)
MANY, FEW = 250, 10  # columns drawn, and those of the short set
PROBLEMS, FEW_PROBLEMS = 2000, 60
RIGID = math.inf


def short_and_long(few: int, many: int) -> list[object]:
    """Return the seeds of the short set, and all others as long."""
    return [range(few), pytest.param(range(few, many), marks=pytest.mark.long)]


# ---- the step --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seeds", short_and_long(FEW, MANY))
def test_random_columns_obey_newmark_their_contacts_and_the_balance_of_energy(seeds: range) -> None:
    for seed in seeds:
        rng = np.random.default_rng(seed)
        column = random_column(rng, frictional=seed % 2 == 1)
        scheme = random_scheme(rng, 10 ** rng.uniform(-5, -2.5))
        drive = random_drive(rng, scheme.step * np.arange(121), column)
        result = run_all(column, scheme, drive)
        assert result.outcome == "completed"
        check_history(column, scheme, drive, result, 1e-12)


@pytest.mark.parametrize("name", thinned(CASES, 3))
def test_average_acceleration_tends_to_the_exact_motion_with_order_two(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiled, "SHORT", math.inf)  # 6,000 steps are faster than their compilation
    coarse, fine = (error_of(CASES[name], AVERAGE, steps) for steps in (2000, 4000))
    assert fine < 2e-3
    assert 1.7 < math.log2(coarse / fine) < 2.4


# ---- one solution ----------------------------------------------------------------------------------------------------


def problem(rng: np.random.Generator, rigid: bool, adversarial: bool) -> tuple[Laws, np.ndarray, np.ndarray]:
    """Return the laws of contacts, their flexibility, and openings without forces, often near the border of opening."""
    n = int(rng.integers(2, 21))
    alpha = float(rng.choice([0.25, 0.5]))
    heights = np.exp(rng.uniform(-3, 3, n)) if adversarial else np.exp(rng.uniform(-0.5, 0.5, n))
    threshold = 1 / math.sqrt(6 * alpha)
    step = 1e-3
    courant = threshold * (1 + rng.uniform(0, 1, n) ** (3 if adversarial else 1))
    young = 2000 * (courant * heights / step) ** 2
    if rigid:
        young[:] = RIGID
    layered = layers(list(heights), [2000.0] * n, [float(E) for E in young], [0.0] * n)
    stiffness = [RIGID if rng.random() < 0.3 else 2e9 * math.exp(rng.uniform(-3, 3)) for _ in range(n)]
    column = unilateral(layered, stiffness, [0.0] * n)
    blocks = blocks_of(column, observed_columns(column, [], []))
    laws = laws_of(column, None, bonded=False)
    march = march_of(body_of(column, blocks), laws, Scheme(alpha, 0.5, 1.0, step), np.zeros(n), blocks)
    W = march.last.whole.flexible.W
    # openings that a chosen set of forces nearly closes: contacts at the border of their states
    force = np.where(rng.random(n) < 0.6, np.exp(rng.uniform(-3, 3, n)), 0.0)
    own = W[0] + laws.compliance
    openings = np.where(force > 0, 0.0, rng.exponential(1e-3 if adversarial else 1.0, n) * own)
    return laws, W, openings - matrix_of(laws, W) @ force


def matrix_of(laws: Laws, W: np.ndarray) -> np.ndarray:
    """Return W + diag(c)."""
    return np.asarray(np.diag(W[0] + laws.compliance) + np.diag(W[1, :-1], 1) + np.diag(W[1, :-1], -1))


def solved(
    laws: Laws, W: np.ndarray, q: np.ndarray, states: np.ndarray, outcome: int = FOUND
) -> tuple[np.ndarray, np.ndarray, int]:
    """Return forces, states and the number of solves from given states."""
    n = len(q)
    work = work_for(n, n, banded=True)
    work.q[:] = q
    after = rows_of(q, states)
    flexible = flexibility_for(n, banded=True)._replace(W=W)
    ended, solves = find_in_band(laws, rows_of(q, states), flexible, after, work)
    assert ended == outcome
    return after.force, work.tried, solves


def check_solution(laws: Laws, W: np.ndarray, q: np.ndarray, force: np.ndarray) -> None:
    """Assert the conditions of the least of the convex function within its bounds: there is no other solution."""
    A = matrix_of(laws, W)
    z = q + A @ force
    slack = 1e-9 * (np.abs(q).max() + np.diag(A).max() * np.abs(force).max())
    assert np.all((force >= laws.lower) & (force <= laws.upper))
    assert np.all((z > -slack) | (force == laws.upper))
    assert np.all((z < slack) | (force == laws.lower))


@pytest.mark.parametrize("seeds", short_and_long(FEW_PROBLEMS, PROBLEMS))
def test_no_contact_leaves_from_the_second_solve_on_and_n_plus_one_are_enough(seeds: range) -> None:
    for seed in seeds:
        rng = np.random.default_rng(seed)
        laws, W, q = problem(rng, rigid=seed % 3 == 0, adversarial=seed % 2 == 0)
        n = len(q)
        assert np.all(W[1] <= 0)
        assert np.linalg.eigvalsh(matrix_of(laws, W)).min() > 0
        states = rng.choice([LOWER, INSIDE], n)
        force, _, solves = solved(laws, W, q, states)
        assert solves <= n + 1
        check_solution(laws, W, q, force)
        for other in (LOWER, INSIDE):  # from any start, the same forces
            again, _, _ = solved(laws, W, q, np.full(n, other))
            np.testing.assert_allclose(again, force, rtol=0, atol=1e-9 * max(force.max(), 1e-300))
        closed = np.full(n, LOWER)
        for limit in range(1, solves):
            _, tried, _ = solved(laws._replace(most=limit), W, q, states, LIMIT)
            assert limit == 1 or np.all(tried >= closed)
            closed = tried


def test_changing_one_state_at_a_time_ends_in_the_same_solution() -> None:
    laws, W, q = problem(np.random.default_rng(3), rigid=True, adversarial=False)
    n = len(q)
    expected, _, together = solved(laws, W, q, np.full(n, LOWER))
    force, _, solves = solved(laws._replace(together=0), W, q, np.full(n, INSIDE))
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-9 * expected.max())
    assert solves > together


# ---- the domino ------------------------------------------------------------------------------------------------------


def thrown(
    n: int, young: float, step: float, alpha: float, limit: int | None = None
) -> dda.bodies.contact_column.ColumnContactResult:  # type: ignore[name-defined]
    """Return one step of touching blocks that are thrown on their base at 1 m/s."""
    blocks = layers([1.0] * n, [2500.0] * n, [young] * n, [-1.0] * n)
    column = unilateral(blocks, [1e9] * n, [0.0] * n, 0.0)
    scheme = Scheme(alpha, 2 * alpha, 1.0, step)
    return solve_contact_column(column, scheme, still(1), options=ColumnOptions(solve_limit=limit))


@pytest.mark.parametrize(("n", "alpha"), thinned(itertools.product([2, 5, 10, 20, 40], [0.25, 0.5]), 3))
def test_touching_rigid_blocks_close_one_by_one(n: int, alpha: float) -> None:
    for step in (1e-4, 1e-2):
        assert thrown(n, RIGID, step, alpha).step_solves[0] == n + 1


@pytest.mark.parametrize(("n", "alpha"), thinned(itertools.product([2, 5, 10, 20, 40], [0.25, 0.5]), 3))
def test_touching_elastic_blocks_close_at_once_below_the_threshold_and_one_by_one_above(n: int, alpha: float) -> None:
    speed = math.sqrt(1e9 / 2500)
    threshold = 1 / math.sqrt(6 * alpha)
    for courant, solves in (
        (0.8 * threshold, 2),
        (0.999999 * threshold, 2),
        (1.000001 * threshold, n + 1),
        (1.5, n + 1),
    ):
        assert thrown(n, 1e9, courant / speed, alpha).step_solves[0] == solves, courant


def test_a_limit_of_six_solves_ends_the_run_of_six_touching_rigid_blocks() -> None:
    result = thrown(6, RIGID, 1e-3, 0.5, limit=6)
    assert result.outcome == "solve limit exceeded"
    assert len(result.time) == 0
    assert result.solves == 6
    completed = thrown(6, RIGID, 1e-3, 0.5, limit=7)
    assert completed.outcome == "completed"
    assert completed.step_solves.tolist() == [7]


# ---- contacts that hold, and rigid blocks ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("base", "weights", "start"),
    thinned(
        itertools.product(["pulled", "welded", "spring", "half-space"], [AVERAGE, CONSTANT], ["zero", "consistent"]), 5
    ),
)
def test_contacts_that_never_switch_are_the_bonded_column(
    base: str, weights: tuple[float, float], start: Start
) -> None:
    """Without a strength to exceed, or told to hold tension where the base would open every contact."""
    pulled = base == "pulled"
    blocks = [Layer(4.0, 2500.0, 2e9, 0.2, 4), Layer(3.0, 2000.0, 1e9, 0.3, 3)]
    springs = [Spring(x, 1e9) for x in (*[0.0] * (base in ("spring", "pulled")), 1.0, 2.0, 4.0, 5.0)]
    impedance = 2e6 if base == "half-space" else None
    bonded = Column(blocks, "pressure" if pulled else "shear", joints=springs, impedance=impedance)
    never = replace(bonded, law="unilateral" if pulled else "frictional")
    t = 2e-4 * np.arange(401)
    w = 400.0
    moved = 1e-3 * (1 - np.cos(w * t)), 1e-3 * w * np.sin(w * t), 1e-3 * w * w * np.cos(w * t)
    drive = Drive(*moved, 0 * t if pulled else 1e5 * np.sin(w * t))
    names = ["displacement", "contact_pressure", "displacement_1", "stress_1", "displacement_2", "stress_2"]
    scheme = Scheme(*weights, 0.999, 2e-4, start)
    one = solve_contact_column(never, scheme, drive, names, [2.5, 0.25], ColumnOptions(bonded=pulled))
    other = solve_column(bonded, scheme, drive, names, [2.5, 0.25])
    assert one.step_switches.sum() == 0
    assert not pulled or solve_contact_column(never, scheme, drive, names, [2.5, 0.25]).step_switches.sum() > 0
    for name in names:
        largest = np.abs(other.columns[name]).max()
        np.testing.assert_allclose(one.columns[name], other.columns[name], rtol=0, atol=1e-9 * largest)


def test_runs_that_are_repeated_are_compiled_the_earlier(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = []

    def counted(*arguments: object) -> object:
        steps.append(arguments[4])
        return compiled.run_loop(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(contacts, "run_loop", counted)
    for repeats in (1, 50):
        column = unilateral(layers([1.0], [2500.0], [1e9], [0.0]), [1e9], [0.0])
        solve_contact_column(column, Scheme(0.5, 1.0, 1.0, 1e-3), still(1), options=ColumnOptions(repeats=repeats))
    assert steps == [1, 50]


def test_a_rigid_block_on_a_shaken_base_moves_as_the_base_does() -> None:
    t = 1e-4 * np.arange(301)
    w = 200.0
    drive = Drive(1e-3 * np.sin(w * t), 1e-3 * w * np.cos(w * t), -1e-3 * w * w * np.sin(w * t), 0 * t)
    blocks = layers([1.0, 1.0], [2500.0] * 2, [RIGID] * 2, [0.0] * 2)  # the welds give them the base's velocity
    for joints in ([], [Spring(1.0, math.inf)]):
        column = Column(blocks, "shear", law="frictional", joints=joints)
        names = ["displacement_1", "velocity_1", "contact_pressure"]
        for gg in (0.98, 1.0):  # which is not the base's
            result = solve_contact_column(column, Scheme(0.5, 1.0, gg, 1e-4), drive, names, [0.5])
            np.testing.assert_allclose(result.columns["displacement_1"], drive.displacement[1:], rtol=0, atol=1e-15)
            np.testing.assert_allclose(result.columns["velocity_1"], drive.velocity[1:], rtol=0, atol=1e-13)
        force = result.columns["contact_pressure"]
        np.testing.assert_allclose(force, 5000 * drive.acceleration[1:], rtol=0, atol=0.03 * force.max())


@pytest.mark.long
def test_compiled_and_plain_histories_are_the_same_bitwise(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    for seed in (0, 1, 2, 3, 4, 5):
        rng = np.random.default_rng(seed)
        column = random_column(rng, frictional=seed % 2 == 1)
        scheme = random_scheme(rng, 1e-4) if seed < 5 else named_scheme("composite", step=1e-4, gg=0.99)
        drive = random_drive(rng, scheme.instants(300), column)
        plain = run_all(column, scheme, drive)
        with monkeypatch.context() as patch:
            patch.setattr(compiled, "SHORT", 0)
            patch.setattr(compiled, "LONG", 0)
            fast = run_all(column, scheme, drive)
        assert "plain" in plain.notes[0]
        assert "compiled" in fast.notes[0]
        for name, values in plain.columns.items():
            assert np.array_equal(values, fast.columns[name])
        assert np.array_equal(plain.step_solves, fast.step_solves)
        assert np.array_equal(plain.states, fast.states)  # type: ignore[arg-type]
        assert np.array_equal(plain.record, fast.record)  # type: ignore[arg-type]
        assert plain.energies is not None and fast.energies is not None
        assert all(np.array_equal(values, fast.energies[name]) for name, values in plain.energies.items())


# ---- at rest ---------------------------------------------------------------------------------------------------------


def test_a_column_that_starts_settled_stays_there() -> None:
    column = CASES["A3"].column
    names = [f"displacement_{k + 1}" for k in range(6)]
    scheme = Scheme(0.25, 0.5, 1.0, 1e-5, "consistent")
    result = solve_contact_column(
        column, scheme, still(200), names, CASES["A3"].heights[:6], ColumnOptions(settled=True, energies=True)
    )
    for name in names:
        np.testing.assert_allclose(result.columns[name], result.columns[name][0], rtol=1e-11)
    assert result.step_switches.sum() == 0
    assert result.energies is not None
    total = np.sum(list(result.energies.values()), axis=0)  # of the loads less what the settled column stores
    assert np.max(np.abs(total)) < 1e-9 * np.max(result.energies["springs"])


@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e18, math.inf])
@pytest.mark.parametrize("step", [1e-9, 1e-3, 1.0, 1e6])
def test_neither_stiff_contacts_nor_long_steps_cost_digits(stiffness: float, step: float) -> None:
    """Rigid, soft and stiff blocks at rest: in a step of 1 s the weight alone would move them by ten metres."""
    column = unilateral(layers([1.0] * 6, [2500.0] * 6, [1e9, 1e12, RIGID] * 2, [0.0] * 6), [stiffness] * 6, [0.0] * 6)
    scheme = Scheme(0.5, 1.0, 1.0, step, "consistent")
    names = ["displacement", "contact_pressure", "stress_1"]
    result = solve_contact_column(column, scheme, still(60), names, [0.5], ColumnOptions(settled=True))
    weight = 2500 * 9.81
    stretch = -weight * (5.5 / 1e9 + 4.5 / 1e12 + 2.5 / 1e9 + 1.5 / 1e12)
    exact = (stretch - 21 * weight / stiffness, 6 * weight, 5.5 * weight)
    for name, value in zip(names, exact, strict=True):
        np.testing.assert_allclose(result.columns[name], value, rtol=1e-13)
    assert result.step_switches.sum() == 0


# ---- limits of a step, and refusals ----------------------------------------------------------------------------------


def test_the_highest_frequency_is_that_of_the_bonded_column() -> None:
    blocks = [Layer(4.0, 2500.0, 2e9, 0.2, 4), Layer(3.0, 2000.0, 1e9, 0.3, 3)]
    springs = [Spring(x, 1e9) for x in (0.0, 1.0, 2.0, 4.0, 5.0)]
    contacts = Column(blocks, law="unilateral", joints=springs)
    assert highest_frequency(equations(contacts)) == pytest.approx(
        highest_frequency(equations(Column(blocks, joints=springs)))
    )
    rigid = unilateral(layers([1.0] * 2, [2500.0] * 2, [RIGID] * 2, [0.0] * 2), [1e9], [0.0])
    assert highest_frequency(equations(rigid)) == pytest.approx(math.sqrt(2 * 1e9 / 2500))


@pytest.mark.parametrize(("blocks", "ratio"), thinned(itertools.product([2, 4], [0.01, 1.0, 3.0]), 5))
def test_the_limit_on_a_half_space_is_that_of_a_free_foot(blocks: int, ratio: float) -> None:
    """Whatever the impedance, explicit steps just below the limit are stable and those just above it grow."""
    joints = [Spring(float(k), 8e7) for k in range(1, blocks)]
    layer = Layer(float(blocks), 2000.0, 8e7, blocks=blocks)
    column = Column([layer], "shear", law="frictional", joints=joints, impedance=ratio * 3e5)
    largest = []
    for share in (0.99, 1.01):
        step = share * 2 / highest_frequency(equations(column))
        t = step * np.arange(1501)
        wave = Drive(0 * t, np.where(t < 20 * step, np.sin(np.pi * t / (20 * step)), 0.0), 0 * t, 0 * t)
        result = solve_contact_column(column, Scheme(0.0, 0.5, 1.0, step), wave)
        largest.append(np.abs(result.columns["displacement"]).max())
    assert largest[0] < 10
    assert not largest[1] < 1e6


def test_explicit_steps_stay_below_their_limit() -> None:
    column = CASES["A1"].column
    step = 1.8 / highest_frequency(equations(column))
    steps = int(0.04 / step)
    drive = random_drive(np.random.default_rng(0), step * np.arange(steps + 1), column)
    scheme = Scheme(0.0, 0.5, 1.0, step, "consistent")
    result = run_all(column, scheme, drive)
    check_history(column, scheme, drive, result, 1e-12)
    assert np.abs(result.columns["displacement"]).max() < 1


BLOCK = Layer(1.0, 2500.0, 1e9)
STANDING = Column([BLOCK], law="unilateral")


def stepped(column: Column, scheme: Scheme = Scheme(0.5, 1.0, 1.0, 1e-3), **more: Any) -> object:  # noqa: B008
    return solve_contact_column(column, scheme, still(1), **more)


@pytest.mark.parametrize(
    ("field", "build"),
    [
        ("young", lambda: Layer(1.0, 2500.0, math.nan)),
        ("velocity", lambda: Layer(1.0, 2500.0, 1e9, velocity=math.inf)),
        ("gap", lambda: Spring(0.0, 1e9, -1.0)),
        ("strength", lambda: Spring(0.0, 1e9, strength=-1.0)),
        ("young", lambda: Column([Layer(1.0, 2500.0, math.inf)])),
        ("stiffness", lambda: Column([BLOCK], joints=[Spring(0.0, math.inf)])),
        ("velocity", lambda: Column([replace(BLOCK, velocity=1.0)])),
        ("unsupported", lambda: Column([BLOCK], unsupported=True)),
        ("gravity", lambda: Column([BLOCK], gravity=9.81)),
        ("gap", lambda: Column([BLOCK], joints=[Spring(0.0, 1e9, 0.1)])),
        ("law", lambda: Column([BLOCK], "shear", law="unilateral")),
        ("law", lambda: Column([BLOCK], "pressure", law="frictional")),
        ("glue", lambda: Column([BLOCK], glue=1e9, law="unilateral")),
        ("strength", lambda: Column([BLOCK], joints=[Spring(0.0, 1e9, strength=1.0)], law="unilateral")),
        ("gap", lambda: Column([BLOCK], "shear", joints=[Spring(0.0, 1e9, gap=1.0)], law="frictional")),
        ("gravity", lambda: Column([BLOCK], "shear", law="frictional", gravity=9.81)),
        ("impedance", lambda: Column([BLOCK], law="unilateral", impedance=1e6, unsupported=True)),
        ("joints", lambda: Column([BLOCK], law="unilateral", impedance=1e6, joints=[Spring(0.0, 1e9)])),
        ("solve_limit", lambda: ColumnOptions(solve_limit=0)),
        ("repeats", lambda: ColumnOptions(repeats=0)),
        ("law", lambda: stepped(Column([BLOCK]))),
        ("stiffness", lambda: stepped(Column([BLOCK] * 2, law="unilateral"), Scheme(0.0, 0.5, 1.0, 1e-5))),
        ("mass_damping, stiffness_damping", lambda: stepped(STANDING, Scheme(0.5, 1.0, 1.0, 1e-3, mass_damping=1.0))),
        ("settled", lambda: stepped(replace(STANDING, unsupported=True), options=ColumnOptions(settled=True))),
        ("columns", lambda: stepped(STANDING, columns=["gap_1"])),
        ("heights", lambda: stepped(STANDING, columns=["gap_1"], heights=[0.5])),
    ],
)
def test_what_does_not_go_together_is_refused_by_field(field: str, build: object) -> None:
    with pytest.raises(ValueError, match=rf"^{field}: "):
        build()  # type: ignore[operator]


def test_a_load_beyond_doubles_is_a_named_outcome() -> None:
    column = unilateral(layers([1.0], [2500.0], [RIGID], [0.0]), [1e9], [0.0])
    drive = still(5)
    drive.pressure[3:] = 1.7e308
    result = solve_contact_column(column, Scheme(0.25, 0.5, 1.0, 10.0), drive)
    assert result.outcome == "overflow"
    assert len(result.time) < 5
    assert OPEN == 0
