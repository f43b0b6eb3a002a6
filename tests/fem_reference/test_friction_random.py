"""Random blocks that slide on slopes and on moving bases: what must hold of every step of every one of them."""

import numpy as np
import pytest
from oracles.random_contact import at_every_point, sliding

from fem_reference.contact.points import build

STORED = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOST = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")


def check(seed):
    problem, scheme, contact = sliding(seed)
    run = at_every_point(problem, scheme, 80, contact)
    if not len(run.time):
        return np.zeros(3)
    columns, model = run.columns, build(problem)
    cohesion = contact.friction.cohesion * 2.0 * model.share
    limit = contact.friction.tangent * run.normal + cohesion * (run.states != 0)
    assert run.normal.min() >= 0 and not run.normal[run.gap > 0].any() and not run.shear[run.states == 0].any()
    # the points share one solution, so that the largest force of a step rounds them all
    largest = np.maximum(run.normal, np.abs(run.shear)).max(axis=1, keepdims=True)
    assert np.all(np.abs(run.shear) <= limit + 1e-12 * largest)
    slides = np.abs(run.states) == 2
    assert np.allclose(run.shear[slides], -np.sign(run.states[slides]) * limit[slides], rtol=1e-9)
    moved = np.diff(run.slid, axis=0, prepend=0.0)
    whole = columns["cuts"] == 0
    assert np.all((moved * run.states)[whole] >= 0) and not moved[whole][~slides[whole]].any()
    energies, lost = (np.array([columns[name] for name in names]) for names in (STORED, LOST))
    begun = 10800.0 * contact.velocity**2 / 2
    size = np.abs(np.vstack([energies, lost])).max() + begun
    # squares of what eighty solutions have rounded
    assert np.abs(energies.sum(axis=0) + lost.sum(axis=0) - begun).max() <= 1e-10 * size
    assert np.diff(lost[3], prepend=0.0).min() >= 0 and np.diff(lost[1]).min(initial=0) >= 0
    # a step of delta = 1 takes energy, whatever sticks, slides or switches
    if (scheme.alpha, scheme.delta) == (0.5, 1.0) or contact.rule == "implicit":
        first = 0 if scheme.start == "consistent" else 1
        assert np.diff(lost[0] + lost[2])[first:].min(initial=0) >= -1e-11 * size
    return np.array([slides.sum(), np.count_nonzero(np.diff(run.states, axis=0)), lost[3, -1] > 1e-3 * size])


def test_what_holds_of_every_step_that_slides():
    assert np.all(sum(map(check, range(3))) > [20, 20, 0])


@pytest.mark.long
def test_what_holds_of_every_step_that_slides_of_many():
    assert np.all(sum(map(check, range(3, 64))) > [1200, 450, 20])
