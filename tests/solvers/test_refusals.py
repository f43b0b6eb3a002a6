"""What a scene may not state, or a solver does not take, by `refusals.toml`, and what is asked of it in vain.

What is refused for a feature by its name stands in the tables of `test_features`.
"""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from oracles.box_scenes import box_scene
from oracles.stated_scenes import made

import dda
import fem_reference
from validation import advise, damping, load_scene, response
from validation.advice.wave_advice import advise_wave
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.errors import InputError
from validation.models.plane.pages import recommended_cut
from validation.models.plane.problems import impact_of, problem_posed
from validation.scenes.scene import parse_scene
from validation.solvers.names import check_names
from validation.solvers.registry import get_solver, solve
from validation.solvers.rigid.sliding import rigid_slide

HERE = Path(__file__).parent
LOCKED = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 3, "fem.elements": 2})
OPEN = load_scene("unlocked").expand()[1].with_values({"time.step": 1e-3, "time.steps": 3, "fem.elements": 2})
CONTACT = {"law": "unilateral", "stiffness": 1e9, "shear_stiffness": 4e8}
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
EXPLICIT = {"time.alpha": 0.0, "time.delta": 0.5}
SITE = parse_scene(load_scene(HERE / "site.toml").definition(), "site")
LAYER = {"thickness": 2.0, "density": 2400.0, "young": 1e9, "poisson": 0.2, "blocks": 2, "velocity": -0.5}
STACK = parse_scene(
    {
        "column": {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "heights": [0.5], "layer": [LAYER]},
        "time": {"step": 1e-4, "steps": 3, "alpha": 0.25, "delta": 0.5},
        "run": {"columns": ["displacement"]},
    },
    "stack",
)
ADAPTIVE = LOCKED.with_values({"damping.kinetic": "adaptive"})
VISCOUS = LOCKED.with_values({"damping.mass": 20.0, "damping.stiffness": 3e-4})

SCENES = {
    "locked": LOCKED,
    "open": OPEN,
    "stuck": OPEN.with_values(AVERAGE | {"contact": CONTACT}),
    "rough": OPEN.with_values({"contact": CONTACT | {"friction": 25.0}, "fem.foundation": "corner"}),
    "adaptive": ADAPTIVE,
    "site": SITE,
    "stack": STACK,
    "springs": made("layers on springs", HERE),
    "cells": made("row of cells", HERE),
    "plate": made("pulled plate", HERE),
    "boxes": box_scene({}),
}
RAMP = SCENES["rough"].with_values({"load.ramp": 0.01})
HEAT = LOCKED.with_values({"run.columns": ["heat"]})
TABLE = tomllib.loads((HERE / "refusals.toml").read_text(encoding="utf-8"))["refused"]
OF_FENICSX = pytest.param(True, marks=pytest.mark.fenicsx)


def written(value, path):
    """Return a value with the texts of records in it as files."""
    if isinstance(value, dict):
        return {key: written(part, path) for key, part in value.items()}
    if isinstance(value, str) and value.startswith("time,"):
        path.write_text(value)
        return str(path)
    return value


@pytest.mark.parametrize("of_fenicsx", [False, OF_FENICSX])
def test_what_is_not_taken_is_said(of_fenicsx, tmp_path):
    for scene, solver, change, words in [*TABLE, ("site", "dda", {"input": None}, "got nothing")]:
        if (solver == "fenicsx") is of_fenicsx:
            with pytest.raises(InputError, match=words):
                solve(SCENES[scene].with_values(written(change, tmp_path / "record.csv")), solver)


ASKS = [
    *((ADAPTIVE, "self-adaptive damping", ask) for ask in (damping, lambda scene: response(scene, [1.0], "fem"))),
    *(
        (scene, words, ask)
        for scene, words in ((ADAPTIVE, "self-adaptive damping"), (VISCOUS, "damping tables"))
        for ask in (
            lambda scene: advise(scene, 0.05),
            lambda scene: advise_wave(scene, 5.0, 0.1),
            lambda scene: compare(scene, None),
        )
    ),
    (SCENES["stuck"], "contact.friction is required", rigid_slide),
    (SCENES["boxes"], "stiffness: must be finite in this problem", impact_of),
    (SCENES["boxes"], "plane: must be one of .*: blocks that move", problem_posed),
    (SCENES["plate"], "needs a rectangle that is cut", lambda scene: recommended_cut(scene, 0.1)),
    (SCENES["rough"].with_values({"contact.band": [0.0, 1e-6]}), "lagged rules only", get_solver("dda").prepare),
    (SITE, "solver bar: it does not handle column", get_solver("bar").prepare),
    (load_scene("figures-3-4"), "one value must be picked for time.step; take scene.with_values", damping),
    (RAMP, "takes loads that act at once only", lambda scene: compare(scene, None)),
    (HEAT, "must be among displacement, contact_p", lambda scene: check_names(scene, "mine.toml")),
    (SCENES["rough"], "load must be weight and base motion", rigid_slide),
    (SITE, "site: damping takes scenes of a block only", damping),
    (SITE, "compare takes scenes of a block, or of a column", lambda scene: compare(scene, Foreign(np.ones(1), {}))),
    (SITE, "load: is needed for what is asked, got a scene of a column", lambda scene: scene.load),
    (LOCKED, "input: is needed for what is asked, got a scene of a block", lambda scene: scene.input),
    (LOCKED, "frequencies: must be finite and not negative, got -1", lambda scene: response(scene, [1.0, -1.0], "dda")),
    (LOCKED, "must be a list of numbers", lambda scene: response(scene, [], "dda")),
    (
        LOCKED.with_values(EXPLICIT | {"time.step": 0.1}),
        "time.step: must not exceed",
        lambda scene: response(scene, 1.0, "dda"),
    ),
    (
        LOCKED.with_values({"time.gg": 0.0}),
        "gg: must be positive for a damping rate",
        lambda scene: response(scene, 1.0, "dda", exact=True),
    ),
    (load_scene("rocking").expand()[0], "does not apply", lambda scene: response(scene, 1.0, "bar")),
    *(
        (LOCKED, "figures-3-4: solver .*no frequency response", lambda scene, name=name: response(scene, 1.0, name))
        for name in ("dda-textbook", "dda-60")
    ),
]  # fmt: skip


def named(**gate):
    """Check the names in a scene with a gate."""
    whole = {"pair": ["dda", "fem"], "metric": "pressure.l2", "band": [0.0, 1.0], "reason": "a test"} | gate
    check_names(parse_scene(LOCKED.definition() | {"run": {"solvers": ["dda"]}, "gate": [whole]}, "mine"), "mine.toml")


UNKNOWN = ["dda", "nowhere.py:solve"]
ASKS += [
    (LOCKED, "gate.0.pair: must be solvers that run.solvers lists, got 'fem'", lambda scene: named()),
    (LOCKED, "gate.0.pair: must name a solver and a reference", lambda scene: named(pair=["dda"])),
    (LOCKED, "gate.0.metric: must be among", lambda scene: named(metric="pressure.l3")),
    (LOCKED, r"run\.columns", lambda scene: solve(scene.with_values({"run.columns": ["rotation"]}), "dda-60")),
    (LOCKED, "'nowhere.py:solve'", lambda scene: check_names(scene.with_values({"run.solvers": UNKNOWN}), "mine.toml")),
]


def test_what_is_asked_of_a_scene_that_does_not_have_it_is_said():
    check_names(SCENES["cells"], "mine.toml")  # whose columns no solver lists
    for scene, words, ask in ASKS:
        with pytest.raises(InputError, match=words):
            ask(scene)


@pytest.mark.parametrize("package", [dda, fem_reference])
def test_a_discount_that_adapts_goes_with_no_other(package):
    from validation.solvers.dda import model_of
    from validation.solvers.fem import problem_of

    model = {dda: model_of, fem_reference: problem_of}[package](LOCKED)

    def run(scheme, floor=0.0):
        package.solve(model, scheme, 3, floor=floor)

    for numbers in ((0.5, 1.0, 0.9, 1e-3), (0.5, 1.0, 1.0, 1e-3, "zero", 1.0)):
        with pytest.raises(ValueError, match="adapt"):
            run(package.Scheme(*numbers))
    with pytest.raises(ValueError, match="floor"):
        run(package.Scheme(0.5, 1.0, 1.0, 1e-3), floor=-0.1)


@pytest.mark.parametrize(
    ("record", "words"),
    [
        ("time,x,y\n0,0,0\n1,1,0\n2,1,1\n", "must run along one straight line"),
        ("time,y\n0,0\n1,0\n", "must move for a response"),
    ],
)
def test_a_base_without_a_direction_has_no_response(record, words, tmp_path):
    moved = LOCKED.with_values(written({"load.base_motion": record}, tmp_path / "record.csv"))
    with pytest.raises(InputError, match=words):
        response(moved, 1.0, "dda")
