"""Long histories: the block in its natural modes, its contact compiled, against the same steps as they stand."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

from fem_reference import Friction, Scheme, Unilateral, solve_unilateral
from fem_reference.contact import columns, compilation, law
from fem_reference.contact.march import march

ENERGIES = (*columns.ENERGY_COLUMNS, *columns.LOSS_COLUMNS)
LENGTHS = ("displacement", "horizontal_displacement", "rotation", "largest_gap", "largest_penetration", "largest_slide")
SPEEDS = Scheme(0.5, 1.0, 1.0, 2e-4)


def off(found, expected):
    """Greatest difference of two histories over the size of their columns: of all energies, of all displacements."""
    assert found.outcome == expected.outcome and len(found.time) == len(expected.time)
    largest = {name: np.abs(values).max(initial=0.0) for name, values in expected.columns.items()}
    for group in (ENERGIES, LENGTHS, ("contact_pressure", "base_shear")):
        largest |= dict.fromkeys(group, max(largest[name] for name in group))
    pairs = ((largest[name] or 1.0, found.columns[name] - values) for name, values in expected.columns.items())
    return max(np.abs(difference).max(initial=0.0) / size for size, difference in pairs)


@pytest.fixture
def long(monkeypatch):
    """Every history is a long one."""
    monkeypatch.setattr(compilation, "LONG", 1)
    return monkeypatch


LAWS = [
    Unilateral(gap=1e-3, velocity=-0.2, shear="glued", friction=Friction(20.0, 1e4)),
    Unilateral(gap=1e-3, velocity=-0.2, shear="glued", rule="implicit"),
]


def block(contact, young):
    """A problem of a contact, and its scheme."""
    problem = make(elements=3, degree=1, eccentricity=0.3, poisson=0.2, shear=4e8, p=1e9)
    scheme = Scheme(0.25, 0.5, 0.99, 1e-4, "consistent") if contact.rule == "implicit" else Scheme(0.5, 1.0, 0.99, 1e-4)
    return replace(problem, young=young), scheme


@pytest.mark.long
@pytest.mark.parametrize("contact", LAWS)
@pytest.mark.parametrize("limit", [1, 6])
def test_what_is_compiled_gives_the_same_numbers(long, contact, limit):
    pytest.importorskip("numba")
    problem, scheme = block(contact, 1e9)
    contact = replace(contact, limit=limit)
    with long.context() as patch:
        patch.setattr(compilation, "compiled", lambda: (None, "plain"))
        plain = solve_unilateral(problem, scheme, 100, contact)
    found = solve_unilateral(problem, scheme, 100, contact)
    assert found.notes[-1].startswith("contact compiled by numba")
    assert off(found, plain) <= 1e-13
    assert np.count_nonzero(np.diff(plain.columns["open_share"])) > 1
    assert np.any(plain.columns["solves"] > limit) or limit > 1


@pytest.mark.parametrize("contact", LAWS)
@pytest.mark.parametrize("young", thinned([1e9, 1e15], 2))
def test_natural_modes_are_the_same_block(long, contact, young):
    problem, scheme = block(contact, young)
    long.setattr(compilation, "compiled", lambda: (None, "plain"))
    modal = solve_unilateral(problem, scheme, 40, contact)
    whole = solve_unilateral(problem, scheme, 40, contact, full=True)
    assert modal.notes[-2] == f"stepped in its {modal.unknowns} natural modes" and modal.solves == 0
    assert 0 < whole.columns["open_share"].mean() < 1
    # the highest mode is 1e3 to 1e4 times as stiff as the lowest one, and 60 % of all numbers are rounded by it
    assert off(modal, whole) <= 1e-9


def test_a_march_without_a_fallback_is_helped_where_its_iteration_does_not_end(long):
    """As the compiled one, whose place plain Python takes here."""
    problem, scheme = block(LAWS[0], 1e9)
    problem = replace(problem, elements=2)
    contact = replace(LAWS[0], gap=1e-5, limit=1)
    runs = []
    for run in (None, march):
        long.setattr(compilation, "compiled", lambda run=run: (run, "plain"))
        runs.append(solve_unilateral(problem, scheme, 20, contact))
    assert off(*runs) == 0 and np.count_nonzero(runs[0].columns["solves"] > 1) > 1


def test_a_short_history_runs_as_it_stands():
    run = solve_unilateral(make(elements=2), SPEEDS, 3)
    assert run.notes[-1] == f"contact in plain Python: below {compilation.LONG:,} steps"


def test_more_unknowns_than_can_be_turned_to_modes_run_as_they_stand(long):
    long.setattr(compilation, "MODES", 10)
    assert solve_unilateral(make(elements=4), SPEEDS, 3, full=True).notes[-1].endswith("not in natural modes")


def test_what_stands_in_the_place_of_a_function_bites_a_long_history_too(long):
    problem = make(elements=2)
    with long.context() as patch:  # the sound history need not be compiled, which takes half a minute in a fresh clone
        patch.setattr(compilation, "compiled", lambda: (None, "plain"))
        sound = solve_unilateral(problem, SPEEDS, 60, Unilateral(velocity=0.1))
    long.setattr(law, "agreed_state", lambda law, trial, gap, states, guess, following, row: guess[row])
    welded = solve_unilateral(problem, SPEEDS, 60, Unilateral(velocity=0.1))
    assert welded.notes[-1].endswith("a function of the step was replaced")
    assert sound.columns["open_share"].max() == 1 and welded.columns["open_share"].max() == 1
    assert welded.columns["contact_pressure"].min() < 0 <= sound.columns["contact_pressure"].min()


def refusing(*failures):
    """A numba whose compilations fail in turn, and the calls that it gets."""
    calls = []

    def njit(function, cache, error_model, forceinline):
        calls.append(cache)
        failure = failures[len(set(calls)) - 1]
        if failure is not None:
            raise failure
        return function

    return SimpleNamespace(__version__="9.9", njit=njit), calls


@pytest.mark.parametrize(
    ("failures", "note", "caches"),
    [
        ((), "contact in plain Python: numba is not installed", []),
        ((None,), "contact compiled by numba 9.9", [True]),
        (
            (RuntimeError("cannot cache function: no locator available"), None),
            "contact compiled by numba 9.9",
            [True, False],
        ),
        ((OSError("read-only"), NotImplementedError("opcode")), "fails with NotImplementedError", [True, False]),
    ],
)
def test_where_nothing_can_be_written_or_compiled_a_history_runs_all_the_same(long, failures, note, caches):
    fake, calls = refusing(*failures)
    long.setitem(sys.modules, "numba", fake if failures else None)
    long.setattr(compilation, "compiled", compilation.compiled.__wrapped__)
    run = solve_unilateral(make(elements=2), SPEEDS, 20)
    assert run.outcome == "completed" and run.notes[-1].endswith(note)
    assert sorted(set(calls), reverse=True) == caches
