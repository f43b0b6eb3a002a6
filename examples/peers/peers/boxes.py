"""Boxes on a ground for programs of contact: the program's own step beside the instants of a scene, and the columns."""

import math

import numpy as np

from peers.bodies import moving_names
from validation.models.plane.boxes import boxes_of as read_boxes
from validation.models.plane.history import POSE
from validation.solvers.foreign import PROGRAM_STEPS

ROUNDING = 1e-9
SLOW_CORRECTION = 0.2  # 1/s
FAST_CORRECTION = 20.0  # 1/s
SPRING_RESOLUTION = 0.005  # angular frequency times step of the lightest box on a contact of given stiffness


def boxes_of(scene):
    """Return the boxes on a ground of a scene of blocks in the plane.

    Raises
    ------
    NotImplementedError
        The scene is of something else.
    """
    try:
        return read_boxes(scene)
    except ValueError as error:
        raise NotImplementedError(str(error)) from None


def on_endless_ground(scene):
    """Return the boxes of a scene for a program whose ground is a plane without end.

    Raises
    ------
    NotImplementedError
        The scene is of something else, or a box stands, or would be carried by its velocity, beyond an end.
    """
    if ground_ends(scene):
        raise NotImplementedError("a ground that ends below a box: this program's is a plane without end")
    return boxes_of(scene)


def ground_ends(scene):
    """Whether a box stands, or would be carried by its velocity, beyond an end of the ground."""
    pile = boxes_of(scene)
    for box in pile.boxes:
        reach = max(box.width, box.height) / 2
        carried = 0.0 if box.spin else box.velocity[0] * scene.time.duration  # one that spins turns about its corner
        places = (box.x, box.x + carried)
        if min(places) - reach < pile.ends[0] or max(places) + reach > pile.ends[1]:
            return True
    return False


def is_pile(scene):
    """Whether a scene is of boxes on a ground, below each of which there is a force."""
    try:
        read_boxes(scene)
    except ValueError:
        return False
    return True


def substeps(scene, own_step):
    """Return how many steps a program makes in one of the scene's, at most as long as the one it is used with [s]."""
    return max(1, math.ceil(scene.time.step / own_step - ROUNDING))


def spring_step(scene):
    """Return a step that resolves a contact of given stiffness [s]; no bound where none is given."""
    pile = boxes_of(scene)
    if pile.stiffness is None:
        return math.inf
    return SPRING_RESOLUTION * math.sqrt(min(box.mass for box in pile.boxes) / pile.stiffness)


def corners_of(box):
    """Return the corners of a box from its centre, the two lower ones first [m]."""
    half_width = box.width / 2
    half_height = box.height / 2
    return [(side * half_width, end * half_height) for end in (-1, 1) for side in (-1, 1)]


def correction_rate(scene):
    """Return the rate at which overlap is to decay in a program that corrects it by a velocity that stays [1/s].

    A landing overlaps by as much as the program's step, and what a box is pushed out by it keeps: energy that no one
    brought. Boxes that stand on each other overlap more and more where their impulses are not solved to the end; there
    it is to go.
    """
    pile = boxes_of(scene)
    piled = len(pile.boxes) > 1 and not pile.rebound
    return FAST_CORRECTION if piled else SLOW_CORRECTION


def base_velocity(scene, start, step, position):
    """Return the velocity [m/s] that takes the ground from where it is [m] to where it must be at the end of a step.

    Read back from the program before every step, so that its rounding does not add up.
    """
    end, _ = boxes_of(scene).base(start + step)
    return (end - position) / step


def record(
    scene,
    own_step,
    advance,
    poses,
    forces=None,
):
    """Step a program through a scene and return its columns.

    Parameters
    ----------
    scene
        A scene of rigid blocks in the plane.
    own_step
        The step that the program is used with [s]; see `substeps`.
    advance
        Makes one step: called with the instant at which it begins [s] and its length [s].
    poses
        Position and angle of each box, in the order of the scene.
    forces
        Normal force below each box [N]; absent where the program tells none, not asked of other scenes.

    Returns
    -------
    Column name to values, one a step of the scene, and how many steps the program made. Rows after a position that is
    no number are NaN.
    """
    per_row = substeps(scene, own_step)
    step = scene.time.step / per_row
    count = len(moving_names(scene))
    if forces is not None and not is_pile(scene):
        forces = None
    rows = np.full((scene.time.steps, count, 3 if forces is None else 4), np.nan)
    for row in range(scene.time.steps):
        for part in range(per_row):
            advance((row * per_row + part) * step, step)
        reached = poses()
        rows[row, :, :3] = reached
        if forces is not None:
            rows[row, :, 3] = forces()
        if not np.isfinite(reached).all():
            break
    return named(scene, rows, per_row * scene.time.steps)


def named(scene, rows, program_steps):
    """Return the columns of an answer.

    Parameters
    ----------
    scene
        A scene of rigid blocks in the plane.
    rows
        x, y, angle and perhaps force of each block, shape (steps, boxes, 3 or 4).
    program_steps
        How many steps the program made, for the curves of error over cost.
    """
    columns = {PROGRAM_STEPS: np.array(float(program_steps))}
    for number, name in enumerate(moving_names(scene)):
        columns |= {f"{name}.{part}": rows[:, number, place] for place, part in enumerate(POSE)}
    if rows.shape[2] > len(POSE):
        columns |= {force: rows[:, number, len(POSE)] for number, force in enumerate(boxes_of(scene).force_columns)}
    return columns
