"""Blocks of the package `dda` on contact that opens: one block, and glued sub-blocks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import dda
from validation.runs.contact import ContactRecord
from validation.runs.history import Array
from validation.runs.modes import Switch
from validation.runs.run import Run
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.blocks.closed import block_of, load_of, opening_frequency, opening_system_frequency
from validation.solvers.contract import Prepared, completed
from validation.solvers.translation import check_columns, naming, switches_between_steps, to_run

# What is a column of each of the corners M and N: forces on the block [N], gaps, negative where pressed, and slides
# along the base, less its own displacement [m], states: 0 open, 1 stick (closed without friction, too), 2 and -2 slip
# towards N and M
OF_CORNERS = {
    "gap": "gap",
    "normal_force": "normal",
    "shear_force": "shear",
    "slide": "slide",
    "state": "states",
}
CORNERS = tuple(f"{name}_{corner}" for name in OF_CORNERS for corner in "mn")
COUNTS = ("solves", "cuts")  # of the open-close iteration, a step
PASSES = "passes"  # column: of an augmented Lagrangian, a step
OPENING = (*CORNERS, *COUNTS)


class OpeningBlock(Prepared):
    """A whole block on corners that carry no tension."""

    def __init__(self, scene: Scene, scheme: dda.Scheme, motion: dda.BaseMotion | None, full: bool) -> None:
        self.scene = scene
        self.scheme = scheme
        self.full = full
        self.result: dda.ContactResult | None = None
        self.body: dda.UnilateralModel | dda.OpeningSystem
        b = scene.block
        with naming(scene):
            load = load_of(scene, motion)
            self.model = dda.UnilateralModel(block_of(scene), law_of(scene), load, b.base, b.top, velocity=b.velocity)
            self.body = self.model
            self.options = options_of(scene, full)

    def highest_frequency(self) -> float:
        """Return the largest frequency of the block on both corners [rad/s]."""
        return opening_frequency(self.scene)

    def history_run(self) -> Run:
        """Run the scene."""
        passes = (PASSES,) if self.options.rule == "augmented" else ()
        check_columns(self.scene, (*dda.COLUMNS, *OPENING, *passes))
        model_columns = [name for name in self.scene.run.columns if name in dda.COLUMNS]
        result = dda.solve_unilateral(self.body, self.scheme, self.scene.time.steps, model_columns, self.options)
        self.result = result
        return to_run(self.scene, result, {**result.columns, **self._contact(result)})

    def _contact(self, result: dda.ContactResult) -> dict[str, Array]:
        return {name: contact_column(result, name) for name in self.scene.run.columns if name in (*OPENING, PASSES)}

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches between the steps of the history that was run."""
        result = completed(self.result)
        is_open = {corner: ~result.closed[row] for corner, row in zip("MN", result.base_contacts, strict=True)}
        return switches_between_steps(is_open, result.time)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did in the history that was run."""
        result = completed(self.result)
        impulse = opened.impulse_of_contact(self.scene, result.normal.sum(axis=0), result.velocity)
        return record_of_steps(self.scene, result, impulse)


def contact_column(result: dda.ContactResult, name: str) -> Array:
    """Return a column of a corner of the base, or of the iteration."""
    quantity, _, corner = name.rpartition("_")
    if name in CORNERS:
        values = getattr(result, OF_CORNERS[quantity])[result.base_contacts["mn".index(corner)]]
    else:
        values = getattr(result, f"step_{name}")
    return np.asarray(values, dtype=float)


def law_of(scene: Scene) -> dda.Unilateral:
    """Return the contact law of a scene; a corner has half of the cohesion of the whole base."""
    c = scene.contact
    tangent = None if c.friction is None else math.tan(math.radians(c.friction))
    cohesion = c.cohesion * scene.block.base_length / 2  # N
    law = dda.Unilateral(c.stiffness, c.shear, c.gap, c.band, tangent, cohesion, c.rules)
    return replace(law, damping=opened.dashpot_of(scene)) if c.has_dashpots else law


def options_of(scene: Scene, full: bool) -> dda.UnilateralOptions:
    """Return how the steps of a scene take its contact, with the number that its rule needs."""
    c = scene.contact
    return dda.UnilateralOptions(
        c.rule,
        c.solve_limit,
        c.cut,
        energies=True,
        full=full,
        restitution=c.restitution if c.rule == "impact" else None,
        penetration=c.penetration,
    )


def record_of_steps(
    scene: Scene, result: dda.ContactResult, impulse: Array, base: Sequence[int] | slice = slice(None)
) -> ContactRecord:
    """Return what the contacts of a block did at its steps.

    The impulse is that of all contacts from t = 0 on [N s], shape (steps,); opening is measured by those of the base.
    """
    return opened.record(
        scene,
        time=result.time,
        force=result.normal.sum(axis=0),
        impulse=impulse,
        penetration=np.maximum(0.0, -result.gap).max(axis=0),
        gap=np.maximum(0.0, result.gap[base]).max(axis=0),
        open_share=1 - np.mean(result.closed[base], axis=0),
        velocity=result.velocity,
        rebounds=opened.rebounds(result.gap, scene.time.step),
        energies=result.energies or {},
        solves=result.step_solves.astype(float),
        cuts=result.step_cuts.astype(float),
        slip=result.slip,
    )


class OpeningSubBlocks(OpeningBlock):
    """Glued sub-blocks on points that carry no tension."""

    def __init__(self, scene: Scene, scheme: dda.Scheme, motion: dda.BaseMotion | None, full: bool) -> None:
        super().__init__(scene, scheme, motion, full)
        b = scene.block
        with naming(scene):
            self.body = dda.opening_subdivided(self.model, *b.cuts, b.glue_ratio * b.young, b.pattern)

    def highest_frequency(self) -> float:
        """Return the largest frequency of the sub-blocks while all points of the base are closed [rad/s]."""
        return opening_system_frequency(self.scene)
