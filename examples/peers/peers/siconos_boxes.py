"""Rigid boxes for Siconos: their request to `siconos_program`, and the columns of its answer.

Contact is rigid, with Newton's law of impact and Coulomb friction. All four corners of the lowest box may touch the
ground; of two boxes on each other touch those corners which at t = 0 stand on, or carry, the face of the other. Where
the scene gives a stiffness, a level box without friction is a mass on springs without tension: a linear complementarity
system.
"""

import math

import numpy as np

from peers.boxes import named, on_endless_ground, substeps
from peers.siconos import corner_on_ground, times

DEFAULT_STEP = 5e-4  # s: h of MechanicsHdf5Runner.run, for Siconos' kernel has no default
CHOSEN_STEP = 1e-3  # s
ITERATIONS = 100_000  # at most, of a projected Gauss-Seidel solution for a pile; Siconos' own 1000 were too few
OF_VIBRATION = 0.02  # rad of a box on its springs in a step


def boxes(scene, fine, ask):
    """Return the columns of a scene of rigid boxes; `ask` runs the program's side."""
    pile = on_endless_ground(scene)
    if pile.stiffness is not None:
        return springs(scene, pile, fine, ask)
    parts = substeps(scene, CHOSEN_STEP if fine else DEFAULT_STEP)
    request = {
        "kind": "boxes",
        **times(scene, parts),
        "boxes": [
            {"inertia": [box.mass, box.mass, box.inertia], "q0": start, "v0": [*box.velocity, box.spin], "couple": 0.0}
            for box, start in zip(pile.boxes, pile.starts, strict=True)
        ],
        "pull": pile.pull,
        "contacts": contacts(pile),
        "restitution": pile.rebound,
        "friction": pile.friction_coefficient,
        "amplitude": pile.base_amplitude,
        "rate": 2 * math.pi * pile.base_frequency,
        "middle": fine,
        "turns": True,
        "size": max(math.hypot(box.width, box.height) for box in pile.boxes),
        # Pivots solve the contact of a box exactly, but those of a pile went wrong: ten boxes at rest moved by 0.2 m.
        "pivots": fine and len(pile.boxes) == 1,
        "iterations": ITERATIONS if fine and len(pile.boxes) > 1 else None,
    }
    answer = ask(request)
    rows = np.concatenate([answer["poses"], answer["forces"][:, :, None]], axis=2)
    instants = scene.time.step * np.arange(1, scene.time.steps + 1)
    rows[:, :, 0] += np.array([pile.base(float(instant))[0] for instant in instants])[:, None]
    return named(scene, rows, parts * scene.time.steps)


def contacts(pile):
    """Return a contact for each corner that may touch: corner and face in their bodies' frames, and who is carried."""
    first = pile.boxes[0]
    requests = []
    for side in (-1.0, 1.0):
        for end in (-1.0, 1.0):
            requests.append(corner_on_ground((side * first.width / 2, end * first.height / 2)))
    for number in range(1, len(pile.boxes)):
        requests += [between(pile, number, side) for side in (-1.0, 1.0)]
    return requests


def between(pile, number, side):
    """Return the contact of a box with the one below it on one side: of the corner that is the inner one of two."""
    upper = pile.boxes[number]
    lower = pile.boxes[number - 1]
    if side * edge(upper, side) <= side * edge(lower, side):
        corner = (side * upper.width / 2, -upper.height / 2)
        face = {"other": number - 1, "level": lower.height / 2, "outward": 1.0}
        return {"body": number, "corner": corner, **face, "carried": number}
    corner = (side * lower.width / 2, lower.height / 2)
    face = {"other": number, "level": upper.height / 2, "outward": -1.0}
    return {"body": number - 1, "corner": corner, **face, "carried": number}


def edge(box, side):
    """Return where the left or right side of a level box is [m]."""
    return box.x + side * box.width / 2


def springs(scene, pile, fine, ask):
    """Return the columns of a level box on two springs without tension: 0 <= N perp y + N / k >= 0 at each corner.

    The state is x, y, vx, vy, with y from where the springs are relaxed; l = N / (k d) and the gap come in units of a
    length d, so that the system is one of numbers of order 1.
    """
    box = pile.boxes[0]
    if len(pile.boxes) > 1 or box.angle or box.spin or pile.friction or pile.base_amplitude:
        why = "Siconos' springs without tension are here those of one level box without friction, on ground at rest"
        raise NotImplementedError(f"plane.contact.stiffness: {why}")
    corner_stiffness = pile.stiffness / 2
    rate = math.sqrt(pile.stiffness / box.mass)
    own_step = min(CHOSEN_STEP, OF_VIBRATION / rate) if fine else DEFAULT_STEP
    parts = substeps(scene, own_step)
    length = pile.gravity / rate**2 + abs(box.velocity[1]) / rate or 1.0
    A = np.zeros((4, 4))
    A[:2, 2:] = np.eye(2)
    B = np.zeros((4, 2))
    B[3] = corner_stiffness * length / box.mass
    C = np.zeros((2, 4))
    C[:, 1] = 1 / length
    start = [0.0, box.lift, *box.velocity]
    b = [0.0, 0.0, *pile.pull]
    request = {"A": A, "B": B, "C": C, "D": np.eye(2), "b": b, "e": np.zeros(2), "x0": start, "ends": 2}
    state = ask({"kind": "complementarity", **times(scene, parts), **request})["x"]
    level = state[:, 1]
    force = pile.stiffness * np.maximum(0.0, -level)
    columns = [box.x + state[:, 0], box.height / 2 + level, np.zeros(len(level)), force]
    return named(scene, np.stack(columns, axis=1)[:, None, :], parts * scene.time.steps)
