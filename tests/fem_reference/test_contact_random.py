"""Random blocks on bases that carry no tension, without friction and with it: what must hold of every step."""

import numpy as np
import pytest
from oracles.elements import SQUARE
from oracles.random_contact import at_every_point, opening, sliding

from fem_reference.contact.points import build

STORED = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOST = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")


def followed(problem, scheme, contact, steps):
    """Return a history that keeps complementarity and energy, the increments of its losses, and its largest energy."""
    run = at_every_point(problem, scheme, steps, contact)
    if not len(run.time):
        return None
    energies, lost = (np.array([run.columns[name] for name in names]) for names in (STORED, LOST))
    begun = problem.density * problem.area * contact.velocity**2 / 2
    size = np.abs(np.vstack([energies, lost])).max() + begun
    # no tension, and no force where there is a gap
    assert run.normal.min() >= 0 and not run.normal[run.gap > 0].any() and not run.shear[run.states == 0].any()
    # squares of what the steps' solutions have rounded
    assert np.abs(energies.sum(axis=0) + lost.sum(axis=0) - begun).max() <= 1e-10 * size
    assert np.diff(lost[1]).min(initial=0) >= 0 and np.diff(lost[3], prepend=0.0).min() >= 0
    # What opens or closes loses by switching, and nothing else does.
    stays = np.all(np.diff(run.states == 0, axis=0) == 0, axis=1) & (run.columns["cuts"][1:] == 0)
    assert not np.diff(lost[2])[stays].any() and (stays.all() or lost[2].any())
    # A step of delta = 1 takes energy, whatever sticks, slides or switches. For alpha above one half that holds of the
    # energy with what the scheme counts beside it, (alpha - 1/2) dt^2 A' M A / 2.
    if (scheme.alpha, scheme.delta) == (0.5, 1.0) or contact.rule == "implicit":
        first = 0 if scheme.start == "consistent" else 1
        assert np.diff(lost[0] + lost[2])[first:].min(initial=0) >= -1e-11 * size
    return run, lost, size


def check_opening(seed):
    problem, scheme, contact = opening(seed)
    if (history := followed(problem, scheme, contact, 60)) is None:
        return 0
    run, _, _ = history
    assert np.array_equal(run.normal > 0, run.gap < 0)
    # momentum along y of the centre of mass, from the forces at both ends of each step
    if problem.vertices == SQUARE and scheme.start == "consistent" and not run.columns["cuts"].any():
        pushed = problem.pressure * (2 - 2 * abs(problem.eccentricity)) + 10800 * problem.gravity
        force = np.append(0.0, run.columns["contact_pressure"] * 2.0) - pushed
        gained = scheme.step * ((1 - scheme.delta) * force[:-1] + scheme.delta * force[1:]) / 10800
        speed = np.append(contact.velocity, run.columns["velocity"])
        scale = np.abs(speed).max() + np.abs(gained).max()
        assert np.abs(speed[1:] - scheme.gg * speed[:-1] - gained).max() <= 1e-10 * scale
    return np.array([np.count_nonzero(np.diff(run.gap > 0, axis=0))])


def check_sliding(seed):
    problem, scheme, contact = sliding(seed)
    if (history := followed(problem, scheme, contact, 60)) is None:
        return np.zeros(3)
    run, lost, size = history
    cohesion = contact.friction.cohesion * 2.0 * build(problem).share
    limit = contact.friction.tangent * run.normal + cohesion * (run.states != 0)
    # the points share one solution, so that the largest force of a step rounds them all
    largest = np.maximum(run.normal, np.abs(run.shear)).max(axis=1, keepdims=True)
    assert np.all(np.abs(run.shear) <= limit + 1e-12 * largest)
    slides = np.abs(run.states) == 2
    assert np.allclose(run.shear[slides], -np.sign(run.states[slides]) * limit[slides], rtol=1e-9)
    moved = np.diff(run.slid, axis=0, prepend=0.0)
    whole = run.columns["cuts"] == 0
    assert np.all((moved * run.states)[whole] >= 0) and not moved[whole][~slides[whole]].any()
    return np.array([slides.sum(), np.count_nonzero(np.diff(run.states, axis=0)), lost[3, -1] > 1e-3 * size])


@pytest.mark.parametrize(
    ("check", "seeds", "least"),
    [
        (check_opening, range(1, 2), [2]),
        (check_sliding, range(1, 2), [5, 5, -1]),
        pytest.param(check_opening, range(4, 24), [75], marks=pytest.mark.long),
        pytest.param(check_sliding, range(2, 12), [150, 70, 3], marks=pytest.mark.long),
    ],
)
def test_what_holds_of_every_step(check, seeds, least):
    """And so much has opened, slid and rubbed."""
    assert np.all(sum(map(check, seeds)) > least)
