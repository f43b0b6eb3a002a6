"""The robust step: the printed scheme, energy, savings, loads without bounds, overflow."""

import numpy as np
import pytest

from dda import COLUMNS, Block, Contact, Material, Scheme, TwoBlockModel, solve


def model(pressure=3e6, mu=0.3, **edges):
    block = Block.rectangle(1.4, 2.1, Material(2450.0, 2e9, mu, "plane strain"))
    return TwoBlockModel(block, Contact(5e9, 1e9), pressure, **edges)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_dropping_unknowns_changes_nothing(mu):
    scheme = Scheme(0.25, 0.5, 0.99, 5e-4, "consistent")
    part, whole = solve(model(mu=mu), scheme, 80, COLUMNS), solve(model(mu=mu), scheme, 80, COLUMNS, full=True)
    assert part.unknowns == (3 if mu else 2)
    assert whole.unknowns == 6
    assert part.notes
    assert whole.notes == ("stepped: all savings off",)
    for name in COLUMNS:  # the modes are found in another order, and blocked: a few roundings
        peak = np.max(np.abs(whole.columns[name]))
        np.testing.assert_allclose(part.columns[name], whole.columns[name], rtol=0, atol=1e-13 * peak, err_msg=name)


def test_work_is_one_factorisation_and_one_solve_a_step_where_it_steps():
    result = solve(model(), Scheme(0.5, 1, 1, 1e-3), 70)
    assert (result.factorisations, result.solves) == (1, 0)
    stepped = solve(model(), Scheme(0.5, 1, 1, 1e-3), 70, full=True)
    assert (stepped.factorisations, stepped.solves) == (1, 70)
    assert tuple(result.columns) == ("displacement", "contact_pressure")


def test_no_load_no_motion_even_when_unstable():
    result = solve(model(0.0), Scheme(0.0, 0.5, 1, 1.0), 500)
    for values in result.columns.values():
        assert np.array_equal(values, np.zeros(500))
        assert not np.any(np.signbit(values))


def test_growth_ends_in_infinity_and_is_named():
    result = solve(model(), Scheme(0.0, 0.5, 1, 1.0), 500)
    values = result.columns["displacement"]
    first = int(np.flatnonzero(np.isinf(values))[0])
    assert 10 < first < 100
    assert np.all(np.isinf(values[first:]))
    assert any(note.startswith("overflow at step") for note in result.notes)
