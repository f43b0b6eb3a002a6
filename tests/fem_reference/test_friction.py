"""Elements that slide: a step that is cut starts from the state as it was, and the base from its place."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.elements import make

from fem_reference import Friction, Motion, Scheme, Unilateral
from fem_reference.contact.driver import Cut, cut_step
from fem_reference.contact.iteration import NONE
from fem_reference.contact.law import INSIDE
from fem_reference.contact.points import build
from fem_reference.contact.stepper import ContactStepper, Marched
from fem_reference.history.unilateral import block_at_start

CONSTANT = Scheme(0.5, 1.0, 1.0, 2e-4, "consistent")
RUBBING = Unilateral(shear="glued", friction=Friction(25.0))
SHAKE = Motion((0.0, 0.004, 0.011, 0.02, 0.03), (0.0, 1e-3, -2e-3, 1e-3, 0.0), (0.0, -5e-4, 1e-3, 0.0, 0.0))


def incline(slope, gravity=98.1, **more):
    """A square on its incline, nothing on its top."""
    own = {"elements": 4, "degree": 1, "poisson": 0.2, "shear": 4e8} | more
    return replace(make(**own), pressure=0.0, gravity=gravity, slope=slope)


class Refusing(ContactStepper):
    """A stepper that finds no contact in steps longer than 0.3 of its own."""

    def march(self, state, record, ratio=1.0):
        if ratio > 0.3 * (1 + 1e-9):
            return Marched(state, 0, 3, NONE)
        self.lengths.append(ratio)
        return super().march(state, record, ratio)

    def __post_init__(self):
        super().__post_init__()
        self.lengths = []  # of the accepted pieces over the step


def test_a_cut_step_starts_from_the_state_as_it_was_and_the_base_from_its_place():
    problem = replace(incline(25.0, elements=2), motion=SHAKE)
    model = build(problem)
    one, fresh = (
        kind(model.system("glued", Friction(10.0, 1e3)), replace(CONSTANT, gg=0.9, step=1e-3))
        for kind in (Refusing, ContactStepper)
    )
    first = state = again = one.march(block_at_start(one, model, RUBBING), one.record(1), 0.3).state

    saved = [np.copy(part) for part in first]
    for _ in range(4):
        one.lengths.clear()
        row = one.record(1)
        step = cut_step(one, one.march(state, row), Cut(RUBBING.cut, RUBBING.shortest), row)
        assert one.lengths == pytest.approx([0.3, 0.3, 0.3, 0.1])
        for piece in one.lengths:
            again = fresh.march(again, fresh.record(1), piece).state
        state = step.state
    assert all(np.array_equal(a, b) for a, b in zip(saved, first, strict=True))
    assert np.any(state.states[len(model.share) :] != INSIDE) and state.position == pytest.approx(4.3, rel=1e-12)
    for name, value in state._asdict().items():
        assert np.array_equal(value, getattr(again, name)), name
    # the base is where its record says, whatever the steps were cut into
    assert state.parts[1] == pytest.approx(np.interp(4.3e-3, SHAKE.time, SHAKE.x), rel=1e-12)
