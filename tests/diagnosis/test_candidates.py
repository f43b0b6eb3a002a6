"""What is tried on a history, as numbers kept in `numbers.toml` beside this file; `KEEP_PAGES=1` writes it anew."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from oracles.stand_ins import assert_kept, numbers_in, summed

from validation.diagnosis.fits.target import Target
from validation.diagnosis.hooks import DiagnosisHooks
from validation.diagnosis.moves import moves
from validation.diagnosis.one_change import of_scene
from validation.diagnosis.variant import Rectangle, Variant
from validation.scenes.scene import load_scene

KEPT = Path(__file__).with_name("numbers.toml")
TURNS = {"load.gravity": 9.0, "load.slope": 7.0, "contact.friction": 25.0, "contact.cohesion": 3e3}
GAPS = {"column.gap": 2e-3, "column.joint": [{"height": 1.0, "stiffness": 3e8, "gap": 1e-3}]}
STRENGTHS = {
    "column.joint": [
        {"height": 40.0, "stiffness": 3e8, "strength": 3e4},
        {"height": 80.0, "stiffness": 5e8, "friction": 20.0},
    ]
}
SCENES = {
    "locked": ("field-locked", {"load.eccentricity": 0.2, "load.traction": 3e3, "block.poisson": 0.2}),
    "opening": ("field-opening", {"contact.gap": 0.1, "block.velocity": -0.5, "load.gravity": 9.81, "time.gg": 0.98}),
    "sliding": ("field-sliding", TURNS | {"contact.shear_stiffness": 3e8, "time.start": "consistent"}),
    "rocking": ("field-rocking", {}),
    "stack": ("field-stack", {"time.alpha": 0.3, "time.delta": 0.6}),
    "gaps": ("field-stack", GAPS),
    "settled": ("columns-shaken", {}),
    "weight": ("columns-weight", {}),
    "cradle": ("field-cradle", {}),
    "joint": ("field-joint", STRENGTHS | {"column.gravity": 9.0, "column.stiffness": 1e9}),
    "slips": ("columns-slips", {}),
    "springs": ("columns-mass-ratio", {"column.base": "springs", "column.base_stiffness": 3e9}),
    "column": ("field-column", {}),
    "boxes": ("rigid-impact", {}),
}
BLOCK = Rectangle(2.0, 1.5, 2700.0, 1e9, 0.0, False, 2e9, 1.5e9, 5e6)
OWN = Variant(0.5, 1.0, 1.0)
VARIANTS = {
    "locked": (BLOCK, OWN),
    "pulls": (
        replace(BLOCK, gravity=9.81, poisson=0.2),
        replace(OWN, alpha=0.25, delta=0.6, gg=0.97, start="consistent"),
    ),
    "opens": (BLOCK, replace(OWN, opens=True, band=1e-3, reopening=0.1)),
    "opens with poisson": (replace(BLOCK, poisson=0.1), replace(OWN, opens=True, gg=0.9)),
    "other": (BLOCK, replace(OWN, family="chung-hulbert", spectral=0.6, gg=0.99)),
    "explicit": (BLOCK, replace(OWN, family="leapfrog", opens=True)),
}


def changes_of(scene):
    """Yield what each candidate of a scene is called, begins from and changes."""
    hooks = DiagnosisHooks.of(scene)
    for number in (*hooks.numbers(scene), *hooks.numbers_of_layers(scene)):
        yield number.id, number.changed(1.3)
    for change in of_scene(scene, (1.0, 0.7)):
        number = change.value(-0.2)
        yield change.id, "none" if np.isnan(number) else number, change.starts, change.changed(-0.2)
    yield hooks.accurate(scene)


def moves_of(rectangle, variant, steps, columns):
    """Yield the moves of a variant, of a history at some steps."""
    target = Target(rectangle, steps, np.arange(len(steps)), np.ones((columns, len(steps))))
    for move in moves(target, variant):
        yield move.id, dict(move.changes), move.free, [*move.starts]


def test_what_is_tried_is_as_before():
    found = {}
    for name, (scene, values) in SCENES.items():
        found[name] = summed(numbers_in([*changes_of(load_scene(scene).with_values(values))]))
    for name, (rectangle, variant) in VARIANTS.items():
        for kind, steps, columns in (("equal", np.full(30, 2e-3), 2), ("unequal", 2e-3 + 1e-4 * np.arange(30.0), 1)):
            found[f"moves {name} {kind}"] = summed(numbers_in([*moves_of(rectangle, variant, steps, columns)]))
    assert_kept(KEPT, "candidates", found)
