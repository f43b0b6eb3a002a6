"""Blocked histories: equal to stepped ones, as many digits, logarithmic work."""

from itertools import product

import numpy as np
import pytest
from conftest import thinned
from faults import seams

from dda import Block, Contact, Material, Scheme, TwoBlockModel, modal_form, solve
from dda.bodies.locked_block import modal_histories
from dda.scheme import blocked as blocks

COLUMNS = ("displacement", "contact_pressure")


def model(ratio=1.0, mu=0.3):
    block = Block.rectangle(1.7, 1.3, Material(2350.0, 4.3e9, mu, "plane strain"))
    return TwoBlockModel(block, Contact(ratio * 4.3e9, 0.4 * ratio * 4.3e9), 3.7e6)


def both(m, scheme, steps):
    """Return the blocked and the stepped columns."""
    form = m.gap_form.reduced()
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


@pytest.mark.parametrize(
    ("scheme", "reason"),
    [
        (Scheme(0.0, 0.5, 1.0, 1.0), "a mode grows"),
        (Scheme(0.25, 0.4, 1.0, 1e-3), "a mode grows"),
        (Scheme(0.0, 0.5, 1.0, 1.0, mass_damping=1.0), "a mode grows"),
        (Scheme(0.5, 1.0, 1.0, 1e-30), "w dt is outside 1e-15 to 1e+15"),
    ],
)
def test_what_cannot_be_blocked_is_stepped_and_says_so(scheme, reason):
    assert f"stepped: {reason}" in solve(model(), scheme, 40).notes
    assert "blocked" in solve(model(), Scheme(0.25, 0.5, 1.0, 1e3), 40).notes
