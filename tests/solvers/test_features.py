"""What each solver takes and refuses by name: one table of features, and one of those that do not go together."""

import math

import pytest

from validation import response, solve
from validation.errors import InputError
from validation.scenes import features
from validation.scenes.scene import load_scene, parse_scene
from validation.solvers.registry import BUILT_IN, get_solver

LOCKED = load_scene("figures-3-4").with_values({"time.step": 1e-3, "time.steps": 3, "fem.elements": 2})
OPEN = {"contact.law": "unilateral", "contact.shear_stiffness": 4e8}
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
VISCOUS = {"damping.mass": 20.0, "damping.stiffness": 3e-4}
KINETIC = {"damping.kinetic": "adaptive"}
RECORD = "base.csv"  # written for the time of a test
MOVED = {"load.base_motion": RECORD}
FRICTION = OPEN | {"contact.friction": 30.0}
TURNING = OPEN | {"run.geometry": "updated"}
IMPLICIT = OPEN | AVERAGE | {"contact.rule": "implicit"}
CONSERVING = OPEN | AVERAGE | {"contact.rule": "energy-conserving", "contact.shear_stiffness": 0.0}
RIGID = OPEN | {"contact.stiffness": math.inf, "contact.shear_stiffness": 0.0}
LAGGED = FRICTION | {"contact.rules": "lagged"}
SUB_BLOCKS = {"block.subdivide": [2, 1]}
DASHPOTS = OPEN | {"contact.damping_ratio": 0.2}
IMPACT = OPEN | AVERAGE | {"contact.stiffness": math.inf, "contact.rule": "impact", "contact.restitution": 0.5}
AUGMENTED = OPEN | {"contact.rule": "augmented"}
COMPOSITE = {"time.scheme": "composite"}

SCENES = {  # a scene with each feature and as few others as may be
    features.SUB_BLOCKS: SUB_BLOCKS,
    features.OFF_CENTRE: {"load.traction": 1e5},
    features.WEIGHT: {"load.gravity": 9.81},
    "ramped load": {"load.ramp": 0.01},
    features.BASE_MOTION: MOVED,
    features.UNILATERAL: OPEN,
    features.DEAD_BAND: OPEN | {"contact.band": [1e-3, 0.0]},
    features.RIGID: RIGID,
    features.FRICTION: FRICTION,
    features.LAGGED: LAGGED,
    features.SLOPE: {"load.gravity": 9.81, "load.slope": 5.0},
    features.ROTATION: TURNING,
    features.DAMPING: VISCOUS,
    features.ADAPTIVE: KINETIC,
    features.IMPLICIT: IMPLICIT,
    features.CONSERVING: CONSERVING,
    features.DASHPOTS: DASHPOTS,
    features.IMPACT: IMPACT,
    features.AUGMENTED: AUGMENTED,
    features.GENERALISED_ALPHA: {"time.scheme": "hht", "time.rho_inf": 0.75},
    features.LEAPFROG: {"time.scheme": "leapfrog", "time.start": "consistent"},
    features.COMPOSITE: COMPOSITE,
}
# Newmark's scheme is stepped by all; others by these, and by none of what is exact in time, which takes them all.
OTHER_SCHEMES = {
    *("dda", "fem", "bar"),
    *("continuum", "layers", "block-events", "bar-events", "column-events", "bars-events", "rigid-exact"),
}
TAKES = {
    features.SUB_BLOCKS: {"dda", "fem", "fenicsx", "bar", "continuum"},
    features.OFF_CENTRE: {"dda", "fem", "fenicsx", "block-events"},
    features.WEIGHT: {"dda", "fem", "fenicsx", "bar", "block-events", "bar-events"},
    "ramped load": {"dda", "fem", "bar"},
    features.BASE_MOTION: {"dda", "fem", "fenicsx", "block-events"},
    features.UNILATERAL: {"dda", "fem", "bar", "block-events", "bar-events"},
    features.DEAD_BAND: {"dda"},
    features.RIGID: {"dda"},
    features.FRICTION: {"dda", "fem", "block-events"},
    features.LAGGED: {"dda"},
    features.SLOPE: {"dda", "fem", "fenicsx", "block-events"},
    features.ROTATION: {"dda"},
    features.COLUMN: {"dda", "fem", "layers"},
    features.UNILATERAL_COLUMN: {"dda", "fem", "column-events", "bars-events"},
    features.FRICTIONAL_COLUMN: {"dda", "fem", "column-events", "bars-events"},
    features.RIGID_BLOCKS: {"dda", "column-events"},
    features.RIGID_JOINTS: {"dda", "fem", "bars-events"},
    features.PLANE: {"dda", "fem", "fenicsx", "rigid-exact"},
    features.MOVING_BLOCKS: {"dda", "fem", "rigid-exact"},
    features.DAMPING: {"dda", "fem", "bar", "continuum"},
    features.ADAPTIVE: {"dda", "fem"},
    features.IMPLICIT: {"dda", "fem", "block-events", "bar-events"},  # exact motions have no time step
    features.CONSERVING: {"dda", "block-events", "bar-events"},
    features.DASHPOTS: {"dda", "block-events"},
    features.IMPACT: {"dda", "block-events"},
    features.AUGMENTED: {"dda"},  # its limit is a rigid stop that turns back as its steps happen to
    features.GENERALISED_ALPHA: OTHER_SCHEMES,
    features.LEAPFROG: OTHER_SCHEMES,
    features.COMPOSITE: OTHER_SCHEMES,
}
OF_CONTACTS = {  # what a column of two blocks on contacts has beside them
    features.UNILATERAL_COLUMN: {},
    features.FRICTIONAL_COLUMN: {"motion": "shear", "law": "frictional", "strength": 1e5},
    features.RIGID_BLOCKS: {
        "layer": [{"thickness": 2.0, "density": 2e3, "young": "inf", "blocks": 2, "velocity": -1.0}]
    },
    features.RIGID_JOINTS: {"stiffness": "inf"},
}
APART = [  # what a solver takes each by itself: solver, values, the two that are named
    ("dda", SUB_BLOCKS | KINETIC, features.SUB_BLOCKS, features.ADAPTIVE),
    ("dda", SUB_BLOCKS | RIGID, features.RIGID, features.SUB_BLOCKS),
    ("dda", SUB_BLOCKS | IMPLICIT, features.IMPLICIT, features.SUB_BLOCKS),
    ("dda", SUB_BLOCKS | CONSERVING, features.CONSERVING, features.SUB_BLOCKS),
    ("dda", SUB_BLOCKS | LAGGED, features.LAGGED, features.SUB_BLOCKS),
    ("dda", SUB_BLOCKS | TURNING, features.SUB_BLOCKS, features.ROTATION),
    ("dda", TURNING | {"contact.band": [1e-3, 0.0]}, features.DEAD_BAND, features.ROTATION),
    ("dda", TURNING | IMPLICIT, features.IMPLICIT, features.ROTATION),
    ("dda", MOVED | CONSERVING, features.BASE_MOTION, features.CONSERVING),
    ("dda", SUB_BLOCKS | DASHPOTS, features.SUB_BLOCKS, features.DASHPOTS),
    ("dda", MOVED | IMPACT, features.BASE_MOTION, features.IMPACT),
    ("dda", SUB_BLOCKS | AUGMENTED, features.SUB_BLOCKS, features.AUGMENTED),
    ("dda", DASHPOTS | {"contact.band": [1e-3, 0.0]}, features.DEAD_BAND, features.DASHPOTS),
    ("block-events", IMPACT | {"load.traction": 1e5}, features.OFF_CENTRE, features.IMPACT),
    *((solver, COMPOSITE | VISCOUS, features.COMPOSITE, features.DAMPING) for solver in ("dda", "fem", "bar")),
    *((solver, COMPOSITE | KINETIC, features.COMPOSITE, features.ADAPTIVE) for solver in ("dda", "fem")),
    *((solver, MOVED | VISCOUS, features.BASE_MOTION, features.DAMPING) for solver in ("dda", "fem")),
    *((solver, OPEN | VISCOUS, features.UNILATERAL, features.DAMPING) for solver in ("dda", "fem", "bar")),
    *((solver, MOVED | KINETIC, features.BASE_MOTION, features.ADAPTIVE) for solver in ("dda", "fem")),
    *((solver, OPEN | KINETIC, features.UNILATERAL, features.ADAPTIVE) for solver in ("dda", "fem")),
    *((solver, VISCOUS | KINETIC, features.DAMPING, features.ADAPTIVE) for solver in ("dda", "fem")),
]

TWO_BLOCKS = {
    "plane": {
        "young": 1e9,
        "density": 2700.0,
        "gravity": [0.0, -9.81],
        "contact": {"stiffness": 1e8, "friction": 20.0},
        "block": [
            {"name": "floor", "vertices": [[-2, -1], [3, -1], [3, 0], [-2, 0]], "fixed": True},
            {"name": "box", "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]},
        ],
        "touch": [{"block": "box", "corner": corner, "on": "floor", "edge": 2} for corner in (0, 1)],
    },
    "fem": {"foundation": "corner", "elements": 2},
    "time": {"step": 1e-4, "steps": 5},
    "run": {"solvers": ["dda"]},
}


def scene_with(values, directory):
    """Return the locked block with other values; a record of its base stands in the directory."""
    record = directory / RECORD
    record.write_text("time,x,y\n0,0,0\n0.01,1e-3,2e-4\n0.5,0,0\n")
    return LOCKED.with_values({key: str(record) if value == RECORD else value for key, value in values.items()})


def scene_of(feature, directory):
    if feature == features.COLUMN:
        return load_scene("waves-base").expand()[0]
    if feature == features.PLANE:
        return load_scene("patch-strip").expand()[0]
    if feature == features.MOVING_BLOCKS:
        return parse_scene(TWO_BLOCKS, feature)
    if feature in OF_CONTACTS:
        layer = {"thickness": 2.0, "density": 2e3, "young": 1e9, "blocks": 2, "velocity": -1.0}
        column = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "layer": [layer]} | OF_CONTACTS[feature]
        run = {"solvers": ["dda"], "columns": ["displacement"]}
        return parse_scene({"column": column, "time": {"step": 1e-4, "steps": 5}, "run": run}, feature)
    return scene_with(SCENES[feature], directory)


@pytest.mark.parametrize("feature", [feature.name for feature in features.FEATURES])
def test_a_feature_is_refused_by_name_by_all_solvers_but_some(feature, tmp_path):
    scene = scene_of(feature, tmp_path)
    assert feature in features.of(scene)
    for name in BUILT_IN:
        refusal = get_solver(name).refusal(scene)
        assert (refusal is not None and feature in refusal) == (name not in TAKES[feature]), (name, refusal)
        if refusal is not None:
            with pytest.raises(InputError) as refused:
                solve(scene, name)
            assert refusal in str(refused.value)


@pytest.mark.parametrize(("solver", "values", "first", "second"), APART)
def test_what_does_not_go_together_is_refused_by_both_names(solver, values, first, second, tmp_path):
    scene = scene_with(values, tmp_path)
    with pytest.raises(InputError, match=rf"{first}.* together with {second}"):
        solve(scene, solver)
    if features.linear(scene):
        with pytest.raises(InputError, match=rf"{first}.* together with {second}"):
            response(scene, 1.0, solver)
