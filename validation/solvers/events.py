"""Adapters of the exact motions with contact that opens: the block of one strain, and the bar."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from validation.runs.history import Array, History
from validation.runs.modes import Switch
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import LineStyle, NotReported, Prepared, Role, Solver
from validation.solvers.translation import check_columns, naming, no_fields

if TYPE_CHECKING:
    from fem_reference.events import switches as events
    from fem_reference.events.bar_model import BarProblem
    from fem_reference.events.block_model import BlockProblem

FORCES = ("normal_force_m", "normal_force_n")  # N, on the block, at the two ends of the base
GAPS = ("gap_m", "gap_n")  # m, negative where the contact is pressed
BLOCK_COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation", *GAPS, *FORCES)
BAR_COLUMNS = ("displacement", "contact_pressure", *GAPS, *FORCES)
TOLD = 6  # switches that a note names


def rectangle(scene: Scene) -> tuple[float, float] | None:
    """Return width and height of an upright rectangle on its lower edge, None for another outline [m]."""
    points = scene.block.outline
    if len(points) != 4 or (scene.block.base, scene.block.top) != (0, 2):
        return None
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = points
    upright = y0 == y1 and y2 == y3 and x0 == x3 and x1 == x2
    return (x1 - x0, y2 - y0) if upright else None


def block_of(scene: Scene) -> BlockProblem:
    """Return the block of a scene."""
    from fem_reference.events.block_model import BlockProblem

    width, height = rectangle(scene) or (0.0, 0.0)
    b, c, q = scene.block, scene.contact, scene.load
    with naming(scene):
        return BlockProblem(
            width=width,
            height=height,
            density=b.density,
            young=b.young,
            stiffness=c.stiffness,
            pressure=q.pressure,
            shear_stiffness=c.shear,
            poisson=b.poisson,
            hypothesis=b.hypothesis,
            eccentricity=q.eccentricity,
            traction=q.traction,
            gravity=q.gravity,
            gap=c.gap,
            velocity=b.velocity,
        )


def bar_of(scene: Scene) -> BarProblem:
    """Return the bar of a scene."""
    from fem_reference.events.bar_model import BarProblem

    width, height = rectangle(scene) or (0.0, 0.0)
    b, c, q = scene.block, scene.contact, scene.load
    with naming(scene):
        return BarProblem(
            width=width,
            height=height,
            density=b.density,
            young=b.young,
            base_stiffness=2 * c.stiffness,
            pressure=q.pressure,
            gravity=q.gravity,
            gap=c.gap,
            velocity=b.velocity,
        )


class Motion(Prepared):
    """A scene whose motion is found from switch to switch; nothing in it is a step, a mesh or a saving."""

    def __init__(self, scene: Scene, name: str) -> None:
        self.scene, self.name = scene, name
        self.found: Sequence[events.Switch] | None = None

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches of the motion that was run."""
        if self.found is None:
            raise NotReported(f"{self.name}: the scene was not run")
        return tuple(Switch(one.time, one.corner, one.kind == "opens") for one in self.found)

    def instants(self) -> Array:
        """Return the instants that are reported [s]."""
        return np.asarray(self.scene.time.step * np.arange(1.0, self.scene.time.steps + 1), dtype=np.float64)

    def observed(self, columns: Mapping[str, Array], switches: Sequence[events.Switch], began: float) -> Run:
        """Return the run of the columns that are asked for."""
        self.found = switches
        asked = {name: columns[name] for name in self.scene.run.columns}
        work = {"switches": len(switches), "steps": self.scene.time.steps}
        seconds = {"setup": 0.0, "stepping": perf_counter() - began}
        history = History(self.instants(), asked)
        return Run(Outcome.COMPLETED, history, work, seconds, ("exact in time", switches_in_words(switches)))


def switches_in_words(switches: Sequence[events.Switch]) -> str:
    """Return the first switches with their times, and how many there are."""
    if not switches:
        return "the contact neither opens nor closes after t = 0"
    told = ", ".join(f"{one.corner} {one.kind} at {one.time:.9g} s" for one in switches[:TOLD])
    more = f" and {len(switches) - TOLD} more" if len(switches) > TOLD else ""
    return f"{told}{more}"


class BlockMotion(Motion):
    """The block of one strain."""

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene."""
        from fem_reference.events.block_events import solve

        no_fields(self.name, self.scene, fields)
        check_columns(self.scene, BLOCK_COLUMNS)
        began, problem, t = perf_counter(), block_of(self.scene), self.instants()
        with naming(self.scene):
            motion = solve(problem, float(t[-1]))
        found = motion.at(t)
        named = (found.displacement[1], found.contact_pressure, found.displacement[0], found.displacement[2])
        columns = (*named, *found.gap, *found.normal_force)
        return self.observed(dict(zip(BLOCK_COLUMNS, columns, strict=True)), motion.switches, began)


class BarMotion(Motion):
    """The bar."""

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene."""
        from fem_reference.events.bar_events import solve

        no_fields(self.name, self.scene, fields)
        check_columns(self.scene, BAR_COLUMNS)
        began, problem, t = perf_counter(), bar_of(self.scene), self.instants()
        with naming(self.scene):
            motion = solve(problem, float(t[-1]))
        found = motion.at(t)
        force = found.contact_pressure * problem.width / 2
        columns = (found.displacement, found.contact_pressure, found.gap, found.gap, force, force)
        return self.observed(dict(zip(BAR_COLUMNS, columns, strict=True)), motion.switches, began)


class BlockEvents(Solver):
    """The block of one strain on springs that carry no tension, exact in time: what `dda` tends to as dt -> 0."""

    name = "block-events"
    handles = frozenset({features.UNILATERAL, features.OFF_CENTRE, features.WEIGHT}) | features.RULES
    sources = ("fem_reference.events", "fem_reference.problem")
    role, rank = Role.LIMIT, 5.5
    line: LineStyle | None = LineStyle("#cc79a7", (6.0, 1.5), 0.9, 3)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return BLOCK_COLUMNS

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the motion from switch to switch is not that of the scene."""
        if features.UNILATERAL not in features.of(scene):
            return 'it requires contact.law = "unilateral"'
        if rectangle(scene) is None:
            return "the block is not an upright rectangle on its lower edge"
        return None if scene.time.discount == 1 else "the exact motion has no kinetic damping, and gg is below 1"

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene."""
        return BlockMotion(scene, self.name)


class BarEvents(BlockEvents):
    """The bar on a spring that carries no tension, exact in space and time: what `fem` tends to."""

    name = "bar-events"
    handles = frozenset({features.UNILATERAL, features.WEIGHT}) | features.RULES
    role, rank = Role.TRUTH, 6.5
    line = LineStyle("#666666", (), 0.9, 1)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return BAR_COLUMNS

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the bar is not exact for the scene."""
        if scene.block.poisson != 0:
            return "the bar is exact at Poisson's ratio 0 only"
        return super().applicable(scene)

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene."""
        return BarMotion(scene, self.name)
