"""The exact motion of a scene, by whichever exact solution has it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from validation.errors import InputError
from validation.models.column.tables import ColumnSection
from validation.runs.history import Array, History
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.kinds import kinds
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, get_solver
from validation.solvers.rigid.rocking import friction_needed, quarter_period, rocking

ROCKING = "rigid rocking"


@dataclass(frozen=True)
class Truth:
    """An exact solution of a scene, and up to when it is the scene's."""

    name: str  # of the solver, or of the closed form
    until: float  # instant up to which answers are judged [s]


def truth_of(scene: Scene) -> Truth:
    """Return the exact solution that a scene has, or raise InputError for a sweep or where none is known."""
    if scene.sweep:
        raise InputError(
            "must not be there, one problem has one scene",
            source=scene.name,
            field="sweep",
            advice="use --set key=value",
        )
    if features.ROTATION in features.of(scene):
        return Truth(ROCKING, _comes_down(scene))
    reasons = []
    of_kinds = {kind.feature for kind in kinds().values() if kind.feature}
    for name in by_role(_role(scene)):
        solver = get_solver(name)
        if scene.kind.feature not in (of_kinds & solver.handles or {""}):
            continue  # what it says of the other kind of scene tells nobody anything
        reason = solver.refusal(scene)
        if reason is None:
            return Truth(name, scene.time.duration)
        reasons.append(f"{name}: {reason}")
    raise InputError(f"no exact motion is known: {'; '.join(reasons)}", source=scene.name)


def _role(scene: Scene) -> Role:
    """Return which exact solution a scene asks for: that of blocks of one strain or rigid, or that of elastic bodies.

    Raises InputError where it asks for both.
    """
    scene_features = {*features.of(scene)}
    if features.RIGID_BLOCKS in scene_features:
        elastic = [layer.young for layer in scene.table(ColumnSection).layer if math.isfinite(layer.young)]
        if elastic:
            raise InputError(
                "must be inf in all layers or in none: no exact motion is known of rigid blocks beside elastic bars",
                source=scene.name,
                field="column.layer.young",
                value=format(elastic[0], "g"),
            )
        return Role.LIMIT
    return Role.TRUTH if {features.COLUMN, features.SUB_BLOCKS, features.MOVING_BLOCKS} & scene_features else Role.LIMIT


def exact(scene: Scene, truth: Truth) -> History:
    """Return the exact motion of a scene at its steps up to the truth's end; InputError if it cannot be computed."""
    if truth.name == ROCKING:
        return _rotation(scene, truth)
    run = get_solver(truth.name).solve(scene)
    if run.outcome is Outcome.NOT_RUN:
        raise InputError(f"NOT RUN: {'; '.join(run.notes)}", source=scene.name, field=truth.name)
    if run.outcome is not Outcome.COMPLETED or run.history is None:
        raise InputError(f"{run.outcome.sentence} {'; '.join(run.notes)}", source=scene.name, field=truth.name)
    return run.history


def _comes_down(scene: Scene) -> float:
    """Return when a block that is let go at rest from a tilt comes down on its base [s]; an impact is not judged.

    Raises InputError for any other scene.
    """
    _refuse_other_rocking(scene)
    width, height = _sizes(scene)
    return quarter_period(width, height, abs(math.radians(scene.block.tilt)), scene.load.gravity)


def _refuse_other_rocking(scene: Scene) -> None:
    refused = partial(InputError, source=scene.name)
    b, c, tilt = scene.block, scene.contact, abs(math.radians(scene.block.tilt))
    apart = [f.name for f in features.FEATURES if f.name in features.of(scene) and f.name not in OF_ROCKING]
    if apart:
        raise refused(f"no exact motion is known of a block that turns with {', '.join(apart)}")
    if tilt == 0 or scene.load.gravity <= 0 or scene.load.pressure or c.gap or b.velocity or c.cohesion:
        without = "without a gap, a velocity or cohesion"
        raise refused(f"a block that turns is known exactly where it is let go from a tilt, by weight alone, {without}")
    width, height = _sizes(scene)
    needed = math.degrees(math.atan(friction_needed(width, height, tilt)))
    if c.shear == 0 or (c.friction is not None and c.friction <= needed):
        friction = "no shear springs" if c.shear == 0 else format(c.friction, "g")
        rule = f"must be above {needed:.4g} degrees, else the corner slides"
        raise refused(rule, field="contact.friction", value=friction)
    weight = b.mass * scene.load.gravity
    settles = weight / min(c.stiffness, c.shear) + weight * height / (b.young * width)
    if settles > SETTLES * width * math.sin(tilt):
        raise refused("no exact motion is known: springs or block are not rigid beside the tilt")
    if set(scene.run.columns) != {"rotation"}:
        columns = ", ".join(scene.run.columns)
        raise refused("must be rotation alone, which is known exactly", field="run.columns", value=columns)


SETTLES = 1e-3  # of what the tilt lifts the other corner: what a corner that still counts as rigid gives way
OF_ROCKING = (features.WEIGHT, features.UNILATERAL, features.FRICTION, features.ROTATION)


def _sizes(scene: Scene) -> tuple[float, float]:
    if scene.block.rectangle is None:
        raise InputError("no exact motion is known of a block that turns and is no rectangle", source=scene.name)
    return scene.block.rectangle


def _rotation(scene: Scene, truth: Truth) -> History:
    """Return the rotation since t = 0 of a rigid block [rad], counter-clockwise positive."""
    t: Array = scene.time.step * np.arange(1.0, scene.time.steps + 1)
    t = t[t <= truth.until]
    tilt = math.radians(scene.block.tilt)
    fallen = abs(tilt) - rocking(*_sizes(scene), abs(tilt), t, gravity=scene.load.gravity).rotation
    return History(t, {"rotation": -math.copysign(1.0, tilt) * fallen})
