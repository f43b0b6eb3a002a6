"""The robust step: the printed scheme, energy, savings, loads without bounds, overflow."""

import numpy as np
import pytest

from dda import BaseMotion, Block, Contact, Material, Scheme, TwoBlockModel, solve


def model(pressure=3e6, mu=0.3, **edges):
    block = Block.rectangle(1.4, 2.1, Material(2450.0, 2e9, mu, "plane strain"))
    return TwoBlockModel(block, Contact(5e9, 1e9), pressure, **edges)


def test_no_load_no_motion_even_when_unstable():
    result = solve(model(0.0), Scheme(0.0, 0.5, 1, 1.0), 500)
    for values in result.columns.values():
        assert np.array_equal(values, np.zeros(500))
        assert not np.any(np.signbit(values))


@pytest.mark.parametrize("edges", [{}, {"motion": BaseMotion([0.0, 1.0], [[0.0, 0.0], [1e-3, 2e-3]])}])
def test_growth_ends_in_infinity_and_is_named(edges):
    result = solve(model(**edges), Scheme(0.0, 0.5, 1, 1.0), 500)
    values = result.columns["displacement"]
    first = int(np.flatnonzero(np.isinf(values))[0])
    assert 10 < first < 100
    assert np.all(np.isinf(values[first:]))
    assert any(note.startswith("overflow at step") for note in result.notes)
