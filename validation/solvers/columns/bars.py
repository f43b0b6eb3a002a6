"""Columns whose contacts open or slip as elastic bars, exact in space and time, as a solver."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from validation.models.column.tables import NEAR, ColumnSection
from validation.runs import extras
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.modes import Switch
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.columns.events import drive_of
from validation.solvers.columns.names import AT_HEIGHTS, FORCE, GAP, SLIP, STRESS, VELOCITY, column_of
from validation.solvers.contract import OF_SCHEMES, LineStyle, Prepared, Role, Solver, completed
from validation.solvers.events import KINDS, MOST_BAR_TERMS, Motion, digits_of_switches
from validation.solvers.translation import naming

if TYPE_CHECKING:
    from fem_reference.events.bars_events import BarsMotion
    from fem_reference.events.bars_model import Bar, BarJoint, BarsProblem


def bars_of(scene: Scene) -> tuple[BarsProblem, Array]:
    """Return the bars of a scene, and the heights of their feet [m].

    Blocks whose faces move alike are one bar where their layers are of one material and start alike, else bonded bars.
    """
    from fem_reference.events.bars_model import BarsProblem

    column = column_of(scene)
    impedance = column.impedance
    with naming(scene):
        feet, bars, joints = _bars_and_joints(column)
        problem = BarsProblem(
            bars=tuple(bars),
            joints=tuple(joints),
            gravity=column.gravity if column.law == "unilateral" else 0.0,
            base_impedance=np.inf if impedance is None else impedance,
            base=drive_of(scene, "base", integral=False),
            top=drive_of(scene, "top", integral=False),
            settled=column.settled,
        )
    return problem, np.array(feet)


def _bars_and_joints(column: ColumnSection) -> tuple[list[float], list[Bar], list[BarJoint | None]]:
    """Return the heights of the feet of the bars, the bars, and the joints at their feet."""
    from fem_reference.events.bars_model import BONDED, Bar, BarJoint

    near = NEAR * column.height
    laws: dict[float, BarJoint] = {}
    for contact in column.contacts:
        if column.law == "unilateral":
            laws[contact.height] = BarJoint("unilateral", contact.stiffness, contact.gap)
        else:
            laws[contact.height] = BarJoint("frictional", contact.stiffness, strength=contact.strength)
    feet: list[float] = []
    bars: list[Bar] = []
    joints: list[BarJoint | None] = []
    low = 0.0
    for layer in column.layer:
        high = low + layer.thickness
        cuts = [height for height in laws if low + near < height < high - near]
        for foot, head in itertools.pairwise([low, *cuts, high]):
            bar = Bar(head - foot, layer.density, column.modulus(layer), layer.velocity)
            at_foot = [law for height, law in laws.items() if abs(height - foot) <= near]
            if at_foot:
                joint: BarJoint | None = at_foot[0]
            elif foot == 0 and column.base == "free":
                joint = None
            elif bars and replace(bar, length=1.0) == replace(bars[-1], length=1.0):
                bars[-1] = replace(bars[-1], length=head - feet[-1])
                continue
            else:
                joint = BONDED
            feet.append(foot)
            bars.append(bar)
            joints.append(joint)
        low = high
    return feet, bars, joints


class BarsOfColumn(Motion):
    """A column of elastic bars."""

    motion: BarsMotion  # type: ignore[assignment]
    most_terms = MOST_BAR_TERMS

    def __init__(self, scene: Scene, name: str, full: bool) -> None:
        super().__init__(scene, name, full)
        self.column = column_of(scene)
        self.names = scene.run.columns
        self.problem, self.feet = bars_of(scene)

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches of the motion that was run; a contact is named by its height."""
        events = completed(self.switch_events)
        return tuple(Switch(event.time, event.corner, *KINDS[event.kind.split()[0]]) for event in events)

    def bounds(self) -> Iterable[str]:
        """Yield how far the switches are known."""
        yield digits_of_switches(self.motion)

    def solve_motion(self) -> Iterable[Array]:
        """Find the motion and its switches; return the columns that the scene asks for."""
        from fem_reference.events.bars_events import least_terms, solve
        from fem_reference.events.switches import TooMuchWorkError

        work = self.work()
        least = least_terms(self.problem, self.end)
        if least > work.limit:
            reason = f"its series would have at least {least:.3g} terms, more than {work.limit:.3g}"
            raise TooMuchWorkError(self.end * work.limit / least, reason)
        self.motion = solve(self.problem, self.end, work=work)
        self.switch_events = [
            replace(event, corner=contact_name(self.feet[int(event.corner)])) for event in self.motion.switches
        ]
        t = self.instants()
        return [self._values(name, t) for name in self.names]

    def _values(self, name: str, t: Array) -> Array:
        if name == DISPLACEMENT:
            return self.motion.point(len(self.feet) - 1, self.problem.bars[-1].length, t).displacement
        if name == PRESSURE:
            return self.motion.joint(0, t).force
        part, _, number = name.rpartition("_")
        height = self.column.heights[int(number) - 1]
        if part in (FORCE, GAP, SLIP):
            history = self.motion.joint(int(np.argmin(np.abs(self.feet - height))), t)
            return np.maximum(history.gap, 0.0) if part == GAP else getattr(history, part)
        # of two bars that meet at the height, the lower one
        bar = max(int(np.searchsorted(self.feet, height - NEAR * self.column.height)) - 1, 0)
        point = self.motion.point(bar, min(max(height - self.feet[bar], 0.0), self.problem.bars[bar].length), t)
        return {DISPLACEMENT: point.displacement, VELOCITY: point.velocity, STRESS: point.stress}[part]


def contact_name(height: float) -> str:
    """Return how a contact is called."""
    return f"{height:g} m"


class BarsEvents(Solver):
    """Columns whose contacts open or slip as elastic bars, exact in space and time: what `fem` tends to."""

    name = "bars-events"
    handles = features.SCHEMES | frozenset(
        {features.COLUMN, features.UNILATERAL_COLUMN, features.FRICTIONAL_COLUMN, features.RIGID_JOINTS}
    )
    only = features.COLUMN
    unread = ("column.solve_limit", *OF_SCHEMES)
    sources: tuple[str, ...] = ("fem_reference.events", "fem_reference.problem")
    role = Role.TRUTH
    rank = 6.5
    line = LineStyle("#333333", (1.0, 1.0), 0.9, 1)
    own_columns = (DISPLACEMENT, PRESSURE, *AT_HEIGHTS)
    libraries = extras.EXACT

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why there is no exact motion for this scene."""
        if scene.table(ColumnSection).law == "bonded":
            return 'it requires column.law = "unilateral" or "frictional"; layers is exact for a bonded one'
        if scene.time.discount != 1:
            return "the exact motion has no kinetic damping, and gg is below 1"
        if scene.stated_input is not None and scene.input.shape == "ricker":
            return "a Ricker pulse is no sum of exponentials times polynomials"
        return None

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene."""
        return BarsOfColumn(scene, self.name, full)
