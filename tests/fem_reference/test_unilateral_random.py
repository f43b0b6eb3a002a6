"""Random blocks on bases that carry no tension: what must hold of every step of every one of them."""

import numpy as np
import pytest
from oracles.elements import SQUARE
from oracles.random_contact import at_every_point, opening

STORED = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOST = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss")


def check(seed):
    problem, scheme, contact = opening(seed)
    run = at_every_point(problem, scheme, 60, contact)
    if not len(run.time):
        return 0
    columns = run.columns
    energies, lost = (np.array([columns[name] for name in names]) for names in (STORED, LOST))
    begun = problem.density * problem.area * contact.velocity**2 / 2
    size = np.abs(np.vstack([energies, lost])).max() + begun
    # complementarity: no tension, and no force where there is a gap
    assert run.normal.min() >= 0 and not run.normal[run.gap > 0].any()
    assert np.array_equal(run.normal > 0, run.gap < 0)
    # The energy budget closes; a step of delta = 1 takes energy, whatever switches. For alpha above one half that holds
    # of the energy with what the scheme counts beside it, (alpha - 1/2) dt^2 A' M A / 2.
    assert np.abs(energies.sum(axis=0) + lost.sum(axis=0) - begun).max() <= 1e-10 * size
    if (scheme.alpha, scheme.delta) == (0.5, 1.0):
        first = 0 if scheme.start == "consistent" else 1
        assert np.diff(lost[0] + lost[2])[first:].min(initial=0) >= -1e-11 * size
    assert np.diff(lost[1]).min(initial=0) >= 0
    # momentum along y of the centre of mass, from the forces at both ends of each step
    if problem.vertices == SQUARE and scheme.start == "consistent" and not columns["cuts"].any():
        pushed = problem.pressure * (2 - 2 * abs(problem.eccentricity)) + 10800 * problem.gravity
        force = np.append(0.0, columns["contact_pressure"] * 2.0) - pushed
        gained = scheme.step * ((1 - scheme.delta) * force[:-1] + scheme.delta * force[1:]) / 10800
        speed = np.append(contact.velocity, columns["velocity"])
        scale = np.abs(speed).max() + np.abs(gained).max()
        assert np.abs(speed[1:] - scheme.gg * speed[:-1] - gained).max() <= 1e-10 * scale
    return np.count_nonzero(np.diff(run.gap > 0, axis=0))


def test_what_holds_of_every_step():
    assert sum(map(check, range(8))) > 25


@pytest.mark.long
def test_what_holds_of_every_step_of_many():
    assert sum(map(check, range(8, 136))) > 500
