"""Random blocks that slide on slopes and on moving bases: what must hold of every step of every one of them."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.elements import SQUARE, make

from fem_reference import Friction, Motion, Scheme, Unilateral, solve_unilateral
from fem_reference.contact.points import build

STORED = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOST = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")
SHAKE = Motion((0.0, 0.004, 0.011, 0.02, 0.03), (0.0, 1e-3, -2e-3, 1e-3, 0.0), (0.0, -5e-4, 1e-3, 0.0, 0.0))


def drawn(seed):
    """A problem with friction, slope and perhaps a moving base, a scheme and a contact."""
    rng = np.random.default_rng(seed)
    foundation = str(rng.choice(["distributed", "distributed", "corner", "nodes", "patch"]))
    mesh = {"elements": int(rng.integers(2, 5)), "degree": int(rng.integers(1, 3)), "foundation": foundation}
    mesh |= {"patch_width": 0.6} if foundation == "patch" else {}
    p = 10 ** rng.uniform(8, 11)
    problem = make(SQUARE, p=p, shear=p * 10 ** rng.uniform(-1, 0), poisson=rng.uniform(0, 0.4), **mesh)
    loads = {"traction": rng.uniform(-1e6, 1e6), "gravity": 10 ** rng.uniform(0, 2), "slope": rng.uniform(-60, 60)}
    problem = replace(problem, pressure=10 ** rng.uniform(4, 6.5), **loads, motion=SHAKE if seed % 2 else None)
    alpha, delta = [(0.5, 1.0), (0.5625, 1.0), (0.25, 0.5), (0.3025, 0.6)][rng.integers(4)]
    rule = "implicit" if (alpha, delta) == (0.25, 0.5) and rng.random() < 0.5 else "newmark"
    gg = 1.0 if rng.random() < 0.5 else rng.uniform(0.95, 1.0)
    scheme = Scheme(alpha, delta, gg, 10 ** rng.uniform(-4.5, -3), str(rng.choice(["zero", "consistent"])))
    friction = Friction(rng.uniform(5, 50), 0.0 if rng.random() < 0.5 else 10 ** rng.uniform(3, 6))
    contact = Unilateral(10 ** rng.uniform(-6, -4), -(10 ** rng.uniform(-2, 0)), "glued", rule=rule, friction=friction)
    return problem, scheme, contact


def check(seed):
    problem, scheme, contact = drawn(seed)
    run = solve_unilateral(problem, scheme, 80, contact, every_point=True)
    if not len(run.time):
        return np.zeros(3)
    columns, model = run.columns, build(problem)
    cohesion = contact.friction.cohesion * 2.0 * model.share
    limit = contact.friction.tangent * run.normal + cohesion * (run.states != 0)
    assert run.normal.min() >= 0 and not run.normal[run.gap > 0].any() and not run.shear[run.states == 0].any()
    assert np.all(np.abs(run.shear) <= limit * (1 + 1e-12))
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
    assert np.all(sum(map(check, range(3, 125))) > [2400, 900, 42])
