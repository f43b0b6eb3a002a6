"""Features of scenes: what a scene has beyond one block under a centred pressure on locked springs.

A solver says which of them it handles; a scene that has another one is refused by name. A new feature is one line here.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass

from validation.errors import InputError
from validation.scenes.scene import Scene


@dataclass(frozen=True)
class Feature:
    """A word, the test that a scene has it, and whether the motion stays linear with it."""

    name: str
    present: Callable[[Scene], bool]
    linear: bool = True
    of_columns: bool = False  # whether a column can have it; the others are of a block, its contact and its load
    of_boxes: bool = False  # whether rigid boxes can have it


def _law(scene: Scene) -> str | None:
    """Return the law of a column's springs."""
    return None if scene.column is None else scene.column.law


Apart = tuple[tuple[str, frozenset[str]], ...]  # a feature to those that a solver does not take together with it

SUB_BLOCKS, OFF_CENTRE, WEIGHT, BASE_MOTION = "sub-blocks", "off-centre load", "own weight", "base motion"
RAMP = "ramped load"
UNILATERAL, DEAD_BAND, RIGID = "unilateral contact", "dead bands", "rigid contact"
FRICTION, LAGGED, SLOPE, ROTATION = "friction", "lagged friction", "slope", "large rotation"
COLUMN = "column"
UNILATERAL_COLUMN, FRICTIONAL_COLUMN = "column that opens", "column that slips"
RIGID_BLOCKS, RIGID_JOINTS = "rigid blocks", "rigid joints"
RIGID_BOXES = "rigid boxes"
DAMPING, ADAPTIVE = "damping tables", "self-adaptive damping"
IMPLICIT, CONSERVING = "implicit contact", "energy-conserving contact"
DASHPOTS, IMPACT, AUGMENTED = "contact dashpots", "impact law", "augmented Lagrangian"
GENERALISED_ALPHA, LEAPFROG, COMPOSITE = "generalised-alpha scheme", "leapfrog scheme", "composite scheme"
FEATURES = (
    Feature(SUB_BLOCKS, lambda scene: scene.block.subdivide is not None),
    Feature(OFF_CENTRE, lambda scene: scene.load.eccentricity != 0 or scene.load.traction != 0),
    Feature(WEIGHT, lambda scene: scene.load.gravity != 0),
    Feature(RAMP, lambda scene: scene.load.ramp > 0),
    Feature(BASE_MOTION, lambda scene: scene.load.base_motion is not None),
    Feature(UNILATERAL, lambda scene: scene.contact.law == "unilateral", linear=False),
    Feature(DEAD_BAND, lambda scene: any(scene.contact.band), linear=False),
    # The law of an impact is one of velocities; a rigid stop in displacements turns back as its steps happen to.
    Feature(
        RIGID,
        lambda scene: math.isinf(scene.contact.stiffness) and scene.contact.rule != "impact",
        linear=False,
    ),
    Feature(FRICTION, lambda scene: scene.contact.friction is not None, linear=False),
    Feature(LAGGED, lambda scene: scene.contact.rules == "lagged", linear=False),
    Feature(SLOPE, lambda scene: scene.load.slope != 0),
    Feature(
        ROTATION, lambda scene: scene.contact.law == "unilateral" and scene.run.geometry == "updated", linear=False
    ),
    Feature(COLUMN, lambda scene: scene.column is not None, of_columns=True),
    Feature(UNILATERAL_COLUMN, lambda scene: _law(scene) == "unilateral", linear=False, of_columns=True),
    Feature(FRICTIONAL_COLUMN, lambda scene: _law(scene) == "frictional", linear=False, of_columns=True),
    Feature(
        RIGID_BLOCKS,
        lambda scene: scene.column is not None and any(math.isinf(layer.young) for layer in scene.column.layer),
        linear=False,
        of_columns=True,
    ),
    Feature(
        RIGID_JOINTS,
        lambda scene: scene.column is not None and any(math.isinf(one.stiffness) for one in scene.column.contacts),
        linear=False,
        of_columns=True,
    ),
    Feature(RIGID_BOXES, lambda scene: scene.rigid is not None, linear=False, of_boxes=True),
    Feature(DAMPING, lambda scene: scene.damping.present, of_columns=True),
    Feature(ADAPTIVE, lambda scene: scene.damping.kinetic == "adaptive", linear=False, of_columns=True),
    Feature(IMPLICIT, lambda scene: scene.contact.rule == "implicit", linear=False),
    Feature(CONSERVING, lambda scene: scene.contact.rule == "energy-conserving", linear=False),
    Feature(DASHPOTS, lambda scene: scene.contact.has_dashpots, linear=False),
    Feature(IMPACT, lambda scene: scene.contact.rule == "impact", linear=False),
    Feature(AUGMENTED, lambda scene: scene.contact.rule == "augmented", linear=False),
    Feature(GENERALISED_ALPHA, lambda scene: scene.time.scheme in ("chung-hulbert", "hht", "wbz"), of_columns=True),
    Feature(LEAPFROG, lambda scene: scene.time.scheme == "leapfrog", of_columns=True),
    Feature(COMPOSITE, lambda scene: scene.time.scheme == "composite", of_columns=True),
)
OF_MOVING_COLUMN = frozenset({UNILATERAL_COLUMN, FRICTIONAL_COLUMN})
LOADS = frozenset({OFF_CENTRE, WEIGHT, BASE_MOTION})
RULES = frozenset({IMPLICIT, CONSERVING})  # of the time step: an exact motion has none
SCHEMES = frozenset({GENERALISED_ALPHA, LEAPFROG, COMPOSITE})  # other than Newmark's; an exact motion has none either
CONTACT_METHODS = frozenset({DASHPOTS, IMPACT, AUGMENTED})
# Viscous damping is defined where the motion is linear, and written for Newmark's scheme; the discount follows the
# kinetic energy of one block.
DAMPING_APART: Apart = (
    (DAMPING, SCHEMES | {BASE_MOTION, UNILATERAL, COLUMN}),
    (ADAPTIVE, SCHEMES | {BASE_MOTION, UNILATERAL, COLUMN, DAMPING}),
)
FIRST = frozenset({SUB_BLOCKS, OFF_CENTRE, WEIGHT, BASE_MOTION})  # older than the declaration: users' solvers see them


def _present(scene: Scene) -> tuple[Feature, ...]:
    candidates = {
        "block": [feature for feature in FEATURES if not feature.of_boxes],
        "column": [feature for feature in FEATURES if feature.of_columns],
        "rigid": [feature for feature in FEATURES if feature.of_boxes],
    }
    return tuple(feature for feature in candidates[scene.kind] if feature.present(scene))


def of(scene: Scene) -> tuple[str, ...]:
    """Return the names of the features that a scene has."""
    return tuple(feature.name for feature in _present(scene))


def linear(scene: Scene) -> bool:
    """Whether the motion is linear: modes, spectra, a static solution and closed forms exist."""
    return all(feature.linear for feature in _present(scene))


def clash(scene: Scene, apart: Apart) -> str | None:
    """Return None, or which features of a scene do not go together by the table of a solver, in words."""
    scene_features = set(of(scene))
    for name, others in apart:
        if name in scene_features and (incompatible := scene_features & others):
            return f"it does not handle {', '.join(sorted(incompatible))} together with {name}"
    return None


def refuse_sweep(scene: Scene, source: str = "") -> None:
    """Refuse a scene with a sweep where one case is needed.

    Parameters
    ----------
    scene
        The scene.
    source
        What the command line was given; empty for who calls from Python, whose remedy is another.

    Raises
    ------
    InputError
        One value must be picked for a swept field.
    """
    if scene.sweep:
        swept = {field: values for field, values in scene.sweep.items() if field != "mode"}
        advice = "use --set KEY=VALUE"
        if not source:
            first_values = {field: values[0] for field, values in swept.items()}
            advice = f"take scene.with_values({json.dumps(first_values)}), or a case of scene.expand()"
        raise InputError(
            f"one value must be picked for {', '.join(swept)}",
            source=source or scene.name,
            field="sweep",
            advice=advice,
        )


def refuse_nonlinear(scene: Scene, what: str) -> None:
    """Refuse a scene whose motion is not linear where the answer, `what`, exists for linear motion only.

    Raises
    ------
    InputError
        The motion is not linear.
    """
    if not linear(scene):
        raise InputError(f"{what} for linear scenes only", source=scene.name, value=f"one with {', '.join(of(scene))}")


def refuse_damping(scene: Scene, what: str) -> None:
    """Refuse a scene with damping tables where the answer knows the scheme's own damping only.

    Raises
    ------
    InputError
        The scene has mass or stiffness damping.
    """
    if scene.damping.present:
        raise InputError(f"{what} takes scenes without damping tables only", source=scene.name, value="one with them")


def refuse_ramp(scene: Scene, what: str) -> None:
    """Refuse a scene with a ramp where the answer knows loads only that act at once.

    Raises
    ------
    InputError
        The load rises in a ramp.
    """
    if scene.load.ramp:
        raise InputError(f"{what} takes loads that act at once only", source=scene.name, value="a ramp")


def refuse_column(scene: Scene, what: str) -> None:
    """Refuse a scene with a column where only a block has an answer.

    Raises
    ------
    InputError
        The scene has a column.
    """
    if scene.kind != "block":
        raise InputError(f"{what} takes scenes of a block only", source=scene.name, value=scene.kind_in_words)


def refuse_bonded_column(scene: Scene, what: str) -> None:
    """Refuse rigid boxes and columns whose springs are bonded, where a block or a moving column has an answer.

    Raises
    ------
    InputError
        The scene has such a column, or rigid boxes.
    """
    if scene.rigid is not None or (scene.column is not None and not OF_MOVING_COLUMN & {*of(scene)}):
        raise InputError(
            f"{what} takes scenes of a block, or of a column whose contacts open or slip, only",
            source=scene.name,
            value="one with a bonded column" if scene.rigid is None else scene.kind_in_words,
        )
