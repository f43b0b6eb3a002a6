"""Features of scenes: what a scene has beyond one block under a centred pressure on locked springs.

A solver says which of them it handles; a scene that has another one is refused by name.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

from validation.errors import InputError
from validation.scenes.keys import is_fulfilled, keys_of
from validation.scenes.kinds import kinds
from validation.scenes.scene import Scene
from validation.scenes.tables import LoadSection


@dataclass(frozen=True)
class Feature:
    """A word, what the tables of a scene say where it has it, and whether the motion stays linear with it."""

    name: str
    when: str  # `table.key` that is not at its default, or `table.key = "word"`, as in `Key.needs`
    linear: bool = True


Apart = tuple[tuple[str, frozenset[str]], ...]  # a feature to those that a solver does not take together with it

SUB_BLOCKS, OFF_CENTRE, WEIGHT, BASE_MOTION = "sub-blocks", "off-centre load", "own weight", "base motion"
UNILATERAL, DEAD_BAND, RIGID = "unilateral contact", "dead bands", "rigid contact"
FRICTION, LAGGED, SLOPE, ROTATION = "friction", "lagged friction", "slope", "large rotation"
COLUMN = "column"
UNILATERAL_COLUMN, FRICTIONAL_COLUMN = "column that opens", "column that slips"
RIGID_BLOCKS, RIGID_JOINTS = "rigid blocks", "rigid joints"
PLANE, MOVING_BLOCKS = "blocks in the plane", "blocks that move"
DAMPING, ADAPTIVE = "damping tables", "self-adaptive damping"
IMPLICIT, CONSERVING = "implicit contact", "energy-conserving contact"
DASHPOTS, IMPACT, AUGMENTED = "contact dashpots", "impact law", "augmented Lagrangian"
GENERALISED_ALPHA, LEAPFROG, COMPOSITE = "generalised-alpha scheme", "leapfrog scheme", "composite scheme"

OF_LOADS = tuple(Feature(key.feature, f"load.{name}") for name, _, key in keys_of(LoadSection) if key.feature)
OF_KINDS = tuple(
    Feature(kind.feature, f"{kind.name}.present", kind.linear) for kind in kinds().values() if kind.feature
)
FEATURES = (
    Feature(SUB_BLOCKS, "block.subdivide"),
    Feature(OFF_CENTRE, "load.off_centre"),
    Feature(WEIGHT, "load.gravity"),
    *OF_LOADS,
    Feature(BASE_MOTION, "load.base_motion"),
    Feature(UNILATERAL, 'contact.law = "unilateral"', linear=False),
    Feature(DEAD_BAND, "contact.band", linear=False),
    Feature(RIGID, "contact.is_rigid_stop", linear=False),
    Feature(FRICTION, "contact.friction", linear=False),
    Feature(LAGGED, 'contact.rules = "lagged"', linear=False),
    Feature(SLOPE, "load.slope"),
    Feature(ROTATION, 'run.geometry = "updated"', linear=False),
    *OF_KINDS,
    Feature(UNILATERAL_COLUMN, 'column.law = "unilateral"', linear=False),
    Feature(FRICTIONAL_COLUMN, 'column.law = "frictional"', linear=False),
    Feature(RIGID_BLOCKS, "column.has_rigid_blocks", linear=False),
    Feature(RIGID_JOINTS, "column.has_rigid_joints", linear=False),
    Feature(MOVING_BLOCKS, "plane.moves", linear=False),
    Feature(DAMPING, "damping.present"),
    Feature(ADAPTIVE, 'damping.kinetic = "adaptive"', linear=False),
    Feature(IMPLICIT, 'contact.rule = "implicit"', linear=False),
    Feature(CONSERVING, 'contact.rule = "energy-conserving"', linear=False),
    Feature(DASHPOTS, "contact.has_dashpots", linear=False),
    Feature(IMPACT, 'contact.rule = "impact"', linear=False),
    Feature(AUGMENTED, 'contact.rule = "augmented"', linear=False),
    Feature(GENERALISED_ALPHA, 'time.scheme = "chung-hulbert" or "hht" or "wbz"'),
    Feature(LEAPFROG, 'time.scheme = "leapfrog"'),
    Feature(COMPOSITE, 'time.scheme = "composite"'),
)
COURSES = frozenset(feature.name for feature in OF_LOADS)  # loads that do not act in full from t = 0 on
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
    tables = scene.tables()
    return tuple(feature for feature in FEATURES if is_fulfilled(feature.when, "", tables))


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
    """Raise InputError for a scene with a sweep where one case is needed.

    `source` is what the command line was given; empty for who calls from Python, whose remedy is another.
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
    """Raise InputError for a scene whose motion is not linear where `what` exists for linear motion only."""
    present = [feature.name for feature in _present(scene) if not feature.linear]
    if not present:
        return
    advice = None
    if not set(present).isdisjoint(OF_MOVING_COLUMN):
        advice = "dda-validate advise contact shows what opens and slips"
    elif UNILATERAL in present:
        advice = 'dda-validate advise contact shows how it opens and lands; contact.law = "locked" keeps it closed'
    rule = f"{what} for linear scenes only"
    raise InputError(rule, source=scene.name, value=f"one with {', '.join(present)}", advice=advice)


def refuse_damping(scene: Scene, what: str) -> None:
    """Raise InputError for a scene with damping tables where the answer knows the scheme's own damping only."""
    if scene.damping.present:
        raise InputError(f"{what} takes scenes without damping tables only", source=scene.name, value="one with them")


def refuse_ramp(scene: Scene, what: str) -> None:
    """Raise InputError for a load that does not act in full from t = 0 on where the answer knows no such load."""
    if courses := COURSES & {*of(scene)}:
        raise InputError(f"{what} takes loads that act at once only", source=scene.name, value=", ".join(courses))


def refuse_column(scene: Scene, what: str, field: str | None = None) -> None:
    """Raise InputError for a scene of a column or of blocks in the plane where only a block has an answer."""
    if scene.kind.feature:
        rule = f"{what} takes scenes of a block only"
        raise InputError(rule, source=scene.name, field=field, value=scene.kind_in_words)
