"""Blocked histories: equal to stepped ones, as many digits, logarithmic work."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from faults import seams

from dda import BaseMotion, Block, Contact, Load, Material, Scheme, TwoBlockModel, modal_form, named_scheme, solve
from dda.bodies.locked_block import modal_histories
from dda.scheme import blocked as blocks
from dda.scheme.roots import roots

COLUMNS = ("displacement", "contact_pressure")


def model(ratio=1.0, mu=0.3):
    block = Block.rectangle(1.7, 1.3, Material(2350.0, 4.3e9, mu, "plane strain"))
    return TwoBlockModel(block, Contact(ratio * 4.3e9, 0.4 * ratio * 4.3e9), 3.7e6)


def both(m, scheme, steps):
    """Return the blocked and the stepped columns."""
    form = m.reached
    modal = modal_form(form)
    assert blocks.why_stepped(scheme, modal.frequencies) is None
    rows = m.pressure * np.array([form.observers[name] @ modal.shapes for name in COLUMNS])
    return [modal_histories(scheme, modal, rows, steps, blocked) for blocked in (True, False)]


VISCOUS = [{}, {"mass_damping": 30.0}, {"stiffness_damping": 1e-3}]


@pytest.mark.parametrize(("steps", "viscous"), thinned(product([1, 2, 3, 127, 128, 129, 700], VISCOUS), 8))
def test_every_number_of_steps(steps, viscous):
    blocked, stepped = both(model(), Scheme(0.3025, 0.6, 0.98, 1e-3, **viscous), steps)
    assert blocked.shape == stepped.shape == (2, steps)
    np.testing.assert_allclose(blocked, stepped, rtol=0, atol=1e-12 * np.max(np.abs(stepped)))


def test_work_grows_with_the_logarithm(monkeypatch):
    squares = []
    seams.DDA_SQUARES.wrap(
        monkeypatch, lambda sound: lambda step, levels: (squares.append(levels), sound(step, levels))[1]
    )
    solve(model(mu=0.0), Scheme(0.5, 1, 1, 1e-3), 100_000)
    assert squares == [17, 17]  # two modes, 2^17 > 1e5


def test_what_grows_and_no_other_is_stepped_and_says_so():
    weights = [(0.0, 0.5, 0.9), (0.1, 0.8, 0.6), (0.1, 0.4, 0.9), (0.2, 0.9, 0.0), (0.25, 0.4, 1.0), (0.3, 0.6, 1.0)]
    schemes = [Scheme(*numbers, 1.0) for numbers in weights]
    schemes += [Scheme(0.0, 0.5, 0.95, 1.0, "zero", 0.2), Scheme(0.1, 0.6, 1.0, 1.0, "zero", 0.01, 0.3)]
    schemes += [named_scheme("leapfrog", step=1.0, gg=0.9), named_scheme("composite", step=1.0)]
    for scheme, omega in product(schemes, [*np.linspace(0.02, 4.3, 50), 30.0]):
        reason = "a mode grows" if abs(roots(scheme, omega)[0]) > 1 + 1e-9 else None
        assert blocks.why_stepped(scheme, np.array([0.5 * omega, omega])) == reason, (scheme, omega)
    assert "stepped: w dt is outside 1e-15 to 1e+15" in solve(model(), Scheme(0.5, 1.0, 1.0, 1e-30), 4).notes
    moved = Load(motion=BaseMotion([0.0], [[0.0, 0.0]]))
    average = Scheme(0.25, 0.5, 1.0, 1e3)
    for load, note in ((Load(1.0), "blocked"), (Load(ramp=0.1), "in a ramp"), (moved, "the base moves")):
        assert note in solve(replace(model(), load=load), average, 4).notes[-1]
