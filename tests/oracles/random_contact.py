"""Random blocks on bases that carry no tension, without friction and with it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from oracles.elements import INCLINED, SQUARE, make

from fem_reference import Friction, Motion, Scheme, Unilateral
from fem_reference.contact.columns import columns_of
from fem_reference.contact.driver import Cut, make_steps
from fem_reference.contact.law import INSIDE
from fem_reference.contact.march import Record
from fem_reference.contact.points import build
from fem_reference.contact.stepper import ContactStepper
from fem_reference.history.unilateral import block_at_start

SCHEMES = ((0.5, 1.0), (0.5625, 1.0), (0.75, 1.0), (0.25, 0.5), (0.3025, 0.6))
SHAKE = Motion((0.0, 0.004, 0.011, 0.02, 0.03), (0.0, 1e-3, -2e-3, 1e-3, 0.0), (0.0, -5e-4, 1e-3, 0.0, 0.0))


def opening(seed):
    """A problem, a scheme and how the block stands on its base."""
    rng = np.random.default_rng(seed)
    outline = [{}, {"vertices": INCLINED, "base": 1, "top": 3}][rng.random() < 0.3]
    foundation = str(rng.choice(["distributed", "distributed", "corner", "nodes"]))
    mesh = {"elements": int(rng.integers(2, 5)), "degree": int(rng.integers(1, 3)), "foundation": foundation}
    shear = 0.0 if rng.random() < 0.5 else 10 ** rng.uniform(8, 10.5)
    problem = make(p=10 ** rng.uniform(8, 11.5), shear=shear, poisson=rng.uniform(0, 0.4), **mesh, **outline)
    sideways = {"traction": rng.uniform(-1e6, 1e6), "gravity": 10 ** rng.uniform(-1, 2)}
    problem = replace(problem, pressure=10 ** rng.uniform(4, 7), **sideways)
    if problem.vertices == SQUARE and foundation != "nodes":
        problem = replace(problem, eccentricity=rng.uniform(-0.6, 0.6))
    alpha, delta = SCHEMES[rng.integers(len(SCHEMES))]
    gg = 1.0 if rng.random() < 0.5 else rng.uniform(0.95, 1.0)
    scheme = Scheme(alpha, delta, gg, 10 ** rng.uniform(-4.5, -3), str(rng.choice(["zero", "consistent"])))
    contact = Unilateral(10 ** rng.uniform(-6, -3), -(10 ** rng.uniform(-2, 0)), "glued" if shear else "frictionless")
    return problem, scheme, contact


def sliding(seed):
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


def at_every_point(problem, scheme, steps, contact):
    """A history step by step: its columns, and what every point does, shape (steps, points)."""
    model = build(problem)
    system = model.system(contact.shear, contact.friction)
    stepper = ContactStepper(system, scheme, contact.limit, rule=contact.rule, energies=True, losses=True)
    state, cut = block_at_start(stepper, model, contact), Cut(contact.cut, contact.shortest)
    pieces = [kept for kept, _ in make_steps(stepper, state, steps, cut)]
    record = Record(*(np.concatenate(part) for part in zip(*pieces, strict=True)))
    points = len(model.share)
    columns = columns_of(record, model, system.rows)
    shear = record.force[:, points:] if record.force.shape[1] > points else np.zeros_like(record.force)
    # open 0, stuck 1, sliding towards +x 2 and towards -x -2
    held = record.states[:, points:] if record.force.shape[1] > points else np.zeros_like(record.states)
    named = np.where(record.states[:, :points] == INSIDE, np.where(held == 0, 1, -2 * held), 0)
    slid = record.slid[:, points:] if record.force.shape[1] > points else np.zeros_like(record.force)
    return SimpleNamespace(
        columns=columns,
        time=scheme.step * np.arange(1, len(record.solves) + 1),
        normal=record.force[:, :points],
        gap=record.place[:, :points],
        shear=shear,
        slid=slid,
        states=named,
    )
