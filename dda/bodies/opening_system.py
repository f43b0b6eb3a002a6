r"""A block cut into sub-blocks over a base that carries no tension.

The sub-blocks and their glue are those of `dda.bodies.subdivision`; in place of the locked springs every base edge of
a sub-block has a contact point at each end, with its share p l / a of the corner springs. A step is that of
`dda.bodies.glued_step`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import ClassVar

import numpy as np

from dda.bodies.block_system import BlockSystem
from dda.bodies.glued_step import glued_march, run_glued
from dda.bodies.joints import FIXED
from dda.bodies.subdivision import Pattern, subdivided
from dda.bodies.two_block import TwoBlockModel
from dda.bodies.unilateral import NEWMARK, UnilateralModel, UnilateralOptions
from dda.contact.rows import laws_of
from dda.contact.springs import Contact, base_axes
from dda.contact.unilateral import CONSISTENT, LAGGED, Unilateral
from dda.march.compiled import COMPILED, PLAIN
from dda.march.energy import energies_of
from dda.march.step import course_of
from dda.model.arrays import Array, Columns
from dda.model.load import BaseMotion
from dda.result.contact_result import ContactResult, run_fields
from dda.result.result import step_times
from dda.scheme.newmark import Scheme


@dataclass(frozen=True, eq=False)
class OpeningSystem:
    """Sub-blocks, glue and the points of the base, in their order from M to N."""

    system: BlockSystem  # without supports
    contact: Unilateral  # of a corner of the block
    share: float  # of it in the law of a point
    rows: Array  # (2, points, unknowns) gap, and displacement along the base, by the unknowns of the blocks
    velocity: float  # at t = 0, upwards positive [m/s]
    axes: Array  # (2, 2) unit tangent of the base from M to N, and its normal into the blocks
    motion: BaseMotion | None  # of the base
    rules: ClassVar[tuple[str, ...]] = (NEWMARK,)

    def __post_init__(self) -> None:
        law = self.contact
        if law.damping:
            raise ValueError(f"damping: sub-blocks take springs without dashpots alone, got {law.damping:g}")
        if law.rules == LAGGED:
            raise ValueError(f"rules: sub-blocks take {CONSISTENT} friction alone, got {LAGGED!r}")

    def history(self, scheme: Scheme, steps: int, columns: Sequence[str], options: UnilateralOptions) -> ContactResult:
        """Make the steps; all unknowns are kept."""
        import scipy.sparse.linalg  # noqa: F401  (before the clock starts)

        began = perf_counter()
        law = self.contact
        equations = self.system.equations
        points = self.rows.shape[1]
        rows = np.concatenate(self.rows if law.shear else self.rows[:1])
        laws = laws_of(law, points, len(rows), options.solve_limit, self.share)
        load = self.system.load_size * equations.F
        by_modes = np.concatenate([equations.rows(columns)[0], self.rows[1] @ equations.shapes, [load]])
        observed = by_modes, np.zeros((len(by_modes), len(equations.pressure)))
        march = glued_march(equations, self.system.load_size, scheme, laws, rows, observed, options.energies, steps)
        glue = march.method
        nonzeros = glue.solver(march.last.numbers, 1.0).nonzeros
        opened = np.where(np.arange(len(rows)) < points, law.gap, 0.0)
        upwards = self.velocity * equations.rigid[:, 1]
        course = course_of(self.motion and self.motion.along(self.axes), 0.0)
        ready = perf_counter()
        history, outcome = run_glued(march, course, steps, opened, upwards, np.zeros(2), options.cut)
        reached = len(history.solves) - 1
        pressure = history.force[1:, :points].sum(axis=1) / self.system.base_length
        mass = math.fsum(block.total_mass for block in self.system.blocks)
        _, slides, done, momentum, stored = np.split(history.motion.T, np.cumsum([len(columns), points, 1, 2]))

        def slide() -> Array:
            base = 0.0 if self.motion is None else self.motion.at(step_times(scheme, reached)) @ self.axes[0]
            return slides[:, 1:] - base

        def balance() -> Columns:
            springs = (history.force * history.force) @ laws.compliance / 2
            return energies_of((*stored, springs, 0.0 - done[0]), history.sums, scheme.table is not None)

        how = COMPILED if glue.compiled else PLAIN
        return ContactResult(
            **run_fields(history, outcome, scheme, [f"stepped, {how}: contact opens and closes"], (began, ready)),
            columns={
                name: (pressure if name == "contact_pressure" else history.motion[1:, i]) + 0.0
                for i, name in enumerate(columns)
            },
            unknowns=len(equations.F),
            nonzeros=nonzeros,
            factorisations=glue.solver.cache_info().misses,
            contacts=points,
            base_contacts=(0, -1),
            make_slide=slide,
            make_velocity=lambda: momentum[:, 1:] / (mass * scheme.step),
            balance=balance if options.energies else None,
        )


def opening_subdivided(
    model: UnilateralModel, columns: int, rows: int, glue: float, pattern: Pattern = "squares"
) -> OpeningSystem:
    """Return the block over corners that open, cut into sub-blocks; see `dda.subdivided` for parameters and errors."""
    load = replace(model.load, motion=None)
    locked = TwoBlockModel(model.block, Contact(1.0), load, model.base, model.top)
    cut = subdivided(locked, columns, rows, glue, pattern)
    axes = base_axes(model.block, model.base)
    supports = [joint for joint in cut.joints if joint.second == FIXED]
    ends = [(joint.first, place) for joint in supports for place in (joint.start, joint.end)]
    contact = np.zeros((2, len(ends), len(cut.blocks), 6))
    for i, (number, place) in enumerate(ends):
        contact[:, i, number] = axes[::-1] @ cut.blocks[number].T(*place)
    return OpeningSystem(
        system=replace(cut, joints=[joint for joint in cut.joints if joint.second != FIXED]),
        contact=model.contact,
        share=supports[0].normal,  # a side that is cut evenly has edges of one length
        rows=contact.reshape(2, len(ends), -1),
        velocity=model.velocity,
        axes=axes,
        motion=model.load.motion,
    )
