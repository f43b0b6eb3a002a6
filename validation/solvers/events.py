"""Adapters of the exact motions: the block of one strain, locked or on contact that opens, and the bar."""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Iterable, Sequence
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from validation.runs import extras
from validation.runs.contact import LOST, LOST_AT_IMPACTS, STORED, ContactRecord, Rebound
from validation.runs.history import Array, History
from validation.runs.modes import Switch
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.record import base_record
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.contract import OF_SCHEMES, LineStyle, Prepared, Role, Solver, completed
from validation.solvers.translation import check_columns
from validation.theory import statics

if TYPE_CHECKING:
    from fem_reference.events import bar_events, block_events
    from fem_reference.events import switches as events
    from fem_reference.events.bars_events import BarsMotion
    from fem_reference.events.block_model import BlockProblem
    from fem_reference.events.report import ProvenMotion
    from fem_reference.problem.bar import BarProblem
    from fem_reference.problem.motion import Motion as BaseMotion

FORCES = ("normal_force_m", "normal_force_n")  # N, on the block, at the two ends of the base
GAPS = ("gap_m", "gap_n")  # m, negative where the contact is pressed
SHEAR = ("shear_force_m", "shear_force_n", "slide_m", "slide_n")  # N, towards +x, and m, over the base
STATES = ("state_m", "state_n")  # 0 open, 1 sticks, 2 slips towards +x, -2 towards -x
BLOCK_COLUMNS = (
    *("displacement", "contact_pressure", "horizontal_displacement", "rotation"),
    *(*GAPS, *FORCES, *SHEAR, *STATES),
)
BAR_COLUMNS = ("displacement", "contact_pressure", *GAPS, *FORCES)
LEAST_SAMPLES = 400  # instants of the motion in which peaks are sought
SAMPLES_IN_CONTACT = 9  # further ones in each contact
# of a switch: whether it opens or closes, whether it slips or sticks
KINDS = {"opens": (True, None), "closes": (False, None), "slips": (None, True), "sticks": (None, False)}
# Terms of series by which a motion ends, in about 10 s of a processor of 2024: of columns, and of the waves in bars.
MOST_TERMS = 2.5e6
MOST_BAR_TERMS = 6e7
SWITCHES_LISTED = 6  # switches that a note names


def data_of(scene: Scene) -> dict[str, float]:
    """Return what block and bar of a scene have in common: size, material, loads, gap and velocity."""
    width, height = statics.size(scene)
    b = scene.block
    c = scene.contact
    q = scene.load
    size = {"width": width, "height": height, "gap": c.gap, "velocity": b.velocity}
    return size | {"density": b.density, "young": b.young, "pressure": q.pressure, "gravity": q.gravity}


def block_of(scene: Scene) -> BlockProblem:
    """Return the block of a scene."""
    from fem_reference.events.block_model import BlockProblem

    b = scene.block
    c = scene.contact
    q = scene.load
    return BlockProblem(
        **data_of(scene),
        stiffness=c.stiffness,
        shear_stiffness=c.shear,
        poisson=b.poisson,
        hypothesis=b.hypothesis,
        eccentricity=q.eccentricity,
        traction=q.traction,
        slope=q.slope,
        friction=c.friction,
        cohesion=c.cohesion,
        base=base_of(scene),
        locked=c.law == "locked",
        damping=opened.dashpot_of(scene),
        restitution=c.restitution if c.rule == "impact" else None,
    )


def base_of(scene: Scene) -> BaseMotion | None:
    """Return the motion of a scene's base, or None where it is fixed."""
    from fem_reference.problem.motion import Motion as BaseMotion

    record = base_record(scene)
    if record is None:
        return None
    return BaseMotion(*(tuple(map(float, part)) for part in (record.time, record.x, record.y)))


def bar_of(scene: Scene) -> BarProblem:
    """Return the bar of a scene."""
    from fem_reference.problem.bar import BarProblem

    return BarProblem(**data_of(scene), base_stiffness=2 * scene.contact.stiffness)


class Motion(Prepared):
    """A scene whose motion is found from switch to switch, without step, mesh or saving."""

    names: tuple[str, ...]  # of the columns
    motion: ProvenMotion
    most_terms = math.inf  # of series, see `work`

    def __init__(self, scene: Scene, name: str, full: bool = False) -> None:
        self.scene = scene
        self.name = name
        self.full = full
        self.switch_events: Sequence[events.Switch] | None = None

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches of the motion that was run."""
        events = completed(self.switch_events)
        return tuple(Switch(event.time, event.corner, *KINDS[event.kind]) for event in events)

    def instants(self) -> Array:
        """Return the instants that are reported [s]."""
        return np.asarray(self.scene.time.step * np.arange(1.0, self.scene.time.steps + 1), dtype=np.float64)

    def sampling_instants(self, *corners: str) -> Array:
        """Return the instants in which peaks are sought [s]: at least `LEAST_SAMPLES`, further ones in each contact."""
        t = self.scene.time
        samples_per_step = math.ceil(LEAST_SAMPLES / t.steps)
        samples = [t.step / samples_per_step * np.arange(1.0, t.steps * samples_per_step + 1)]
        for corner in corners:
            for closing, opening in self.contact_spans(corner):
                samples.append(np.linspace(closing, opening or self.end, SAMPLES_IN_CONTACT + 2)[1:-1])
        return np.unique(np.concatenate(samples).clip(max=self.end))

    @property
    def end(self) -> float:
        """Last instant [s]."""
        return float(self.instants()[-1])

    def contact_spans(self, corner: str) -> list[tuple[float, float | None]]:
        """Return when each contact of a corner begins and ends [s]; None where it goes on."""
        events = [event for event in self.switch_events or () if event.corner == corner]
        closings = [event.time for event in events if event.kind == "closes"]
        if self.starts_closed(corner):
            closings.insert(0, 0.0)
        if not closings:
            return []
        openings = [event.time for event in events if event.kind == "opens" and event.time > closings[0]]
        return [(closing, openings[i] if i < len(openings) else None) for i, closing in enumerate(closings)]

    def starts_closed(self, corner: str) -> bool:
        """Whether a corner is closed just after t = 0."""
        raise NotImplementedError

    def work(self) -> events.Work:
        """Return what counts the work of a motion, which ends at `most_terms` unless it is full."""
        from fem_reference.events.switches import Work

        report = self.progress
        end = self.end
        of_time = None if report is None else lambda time: report(time / end)
        return Work(math.inf if self.full else self.most_terms, of_time)

    def history_run(self) -> Run:
        """Run the scene."""
        check_columns(self.scene, self.names)
        from fem_reference.events.switches import HorizonError, NoContactStateError, TooMuchWorkError

        began = perf_counter()
        try:
            columns = dict(zip(self.names, self.solve_motion(), strict=True))
        except NoContactStateError as error:
            return Run(Outcome.NO_CONTACT_STATE, notes=(f"{error}; any other load, however near, has one",))
        except HorizonError as error:
            steps = math.floor(error.time / self.scene.time.step)
            advice = f"the scene may have {steps} steps"
            if isinstance(error, TooMuchWorkError):
                advice += f", or run {self.name}:full, which has no limit of work"
            return Run(Outcome.HORIZON, notes=(f"{error}; {advice}",))
        requested_columns = {name: columns[name] for name in self.scene.run.columns}
        work = {"switches": len(self.switch_events or ()), "steps": self.scene.time.steps}
        seconds = {"setup": 0.0, "stepping": perf_counter() - began}
        notes = ("exact in time", switches_in_words(self.switch_events or ()), *self.bounds())
        return Run(Outcome.COMPLETED, History(self.instants(), requested_columns), work, seconds, notes)

    def bounds(self) -> Iterable[str]:
        """Yield the proven radius of the instants of the motion that was run, and where it came near to a switch."""
        motion = self.motion
        if motion.switches:
            yield f"proven: each switch is the first, and its instant lies within {motion.radius:.1e} s of the midpoint"
        if motion.touches:
            times = ", ".join(f"{time:.9g}" for time in motion.touches[:SWITCHES_LISTED])
            yield f"grazing: at {times} s a switch can be neither proven nor excluded, and none is taken"

    def solve_motion(self) -> Iterable[Array]:
        """Find the motion and its switches; return the columns in the order of `names`."""
        raise NotImplementedError


def digits_of_switches(bars: BarsMotion) -> str:
    """Return in how many digits the switches of bars are the same."""
    return f"the same switches in {bars.digits // 2} and in {bars.digits} digits"


def landings(rebounds: Iterable[Rebound]) -> tuple[Rebound, ...]:
    """Return the contacts that begin with a landing, not with rest on the springs at t = 0."""
    return tuple(rebound for rebound in rebounds if rebound.closing > 0)


def switches_in_words(switches: Sequence[events.Switch]) -> str:
    """Return the first switches with their times, and how many there are."""
    if not switches:
        return "the contact does not change after t = 0"
    listed = ", ".join(f"{switch.corner} {switch.kind} at {switch.time:.9g} s" for switch in switches[:SWITCHES_LISTED])
    more = f" and {len(switches) - SWITCHES_LISTED} more" if len(switches) > SWITCHES_LISTED else ""
    return f"{listed}{more}"


class BlockMotion(Motion):
    """The block of one strain."""

    names = BLOCK_COLUMNS
    motion: block_events.BlockMotion
    radius: float  # greatest proven distance of the displacement from the true one [m]

    def starts_closed(self, corner: str) -> bool:
        """Whether a corner is closed just after t = 0."""
        return self.motion.closed_at_start["MN".index(corner)]

    def solve_motion(self) -> Iterable[Array]:
        """Find the motion and its switches; return all columns."""
        from fem_reference.events.block_events import solve

        self.motion = solve(block_of(self.scene), self.end)
        self.switch_events = self.motion.switches
        state = self.motion.at(self.instants())
        u, v, r = state.displacement[:3]
        self.radius = float(state.displacement_radius[1].max())
        return (
            v,
            state.contact_pressure,
            u,
            r,
            *state.gap,
            *state.normal_force,
            *state.shear_force,
            *state.slide,
            *state.states,
        )

    def bounds(self) -> Iterable[str]:
        """Yield as well the proven radius of the displacement, and whether both corners switch together."""
        motion = self.motion
        yield from super().bounds()
        yield f"proven: the displacement is off by at most {self.radius:.1e} m, of which floats round the most"
        if motion.simultaneous:
            yield f"both corners switch within one ball {len(motion.simultaneous)} times"
        if motion.impacts:
            impulses = ", ".join(f"{impact.impulse:.9g}" for impact in motion.impacts[:SWITCHES_LISTED])
            yield f"{len(motion.impacts)} impacts, whose impulses are no part of the forces; the first: {impulses} N s"
        for cascade in motion.cascades[:SWITCHES_LISTED]:
            rest = f"accumulate at {cascade.time:.9g} s, within {cascade.radius:.1e} s, and the contact rests"
            yield f"proven: the impacts after {cascade.start:.9g} s {rest}; their impulse is {cascade.impulse:.9g} N s"

    def contact_record(self) -> ContactRecord:
        """Return what the contact did; its impulse is that of the momentum, m (V - V0) + F t."""
        completed(self.switch_events)
        t = self.sampling_instants(*"MN")
        push = opened.resultant_load(self.scene)
        state = self.motion.at(t)
        velocity = state.velocity[1]
        start = self.scene.block.velocity
        contacts: list[tuple[float, float | None, int]] = []
        for i, corner in enumerate("MN"):
            contacts += [(closing, opening, i) for closing, opening in self.contact_spans(corner)]
        return opened.record(
            self.scene,
            time=t,
            force=state.normal_force.sum(axis=0),
            impulse=self.scene.block.mass * (velocity - start) + push * t,
            penetration=np.maximum(0.0, -state.gap).max(axis=0),
            gap=np.maximum(0.0, state.gap).max(axis=0),
            open_share=1 - state.closed.mean(axis=0),
            velocity=velocity,
            rebounds=self._rebounds(contacts),
            energies=self._energies(state),
            slip=np.abs(state.slipped).max(axis=0),
        )

    def _energies(self, state: block_events.BlockHistory) -> dict[str, Array]:
        """Return the energies; the work of the base is counted as that of the loads."""
        stored = {name: getattr(state, name) for name in STORED}
        no_loss = dict.fromkeys(LOST[:2], np.zeros_like(state.time))
        losses = {"switching": state.released, "friction": state.friction}
        for name, feature in zip(LOST_AT_IMPACTS, (features.DASHPOTS, features.IMPACT), strict=True):
            if feature in features.of(self.scene):
                losses[name] = state.damped
        return stored | no_loss | losses

    def _rebounds(self, contacts: Iterable[tuple[float, float | None, int]]) -> tuple[Rebound, ...]:
        """Return the landings of all corners in the order of time; under a law of impact its impacts."""
        restitution = self.motion.problem.restitution
        if restitution is None:
            return landings(self._rebound(*contact) for contact in sorted(contacts, key=operator.itemgetter(0)))
        impacts = [impact for impact in self.motion.impacts if impact.time > 0]
        return landings(Rebound(impact.approach, restitution * impact.approach) for impact in impacts for _ in "MN")

    def _rebound(self, first: float, last: float | None, corner: int) -> Rebound:
        """Return the rates of a corner's gap as its contact begins and ends."""
        times = [first] if last is None else [first, last]
        closing, *opening = (float(rate) for rate in self.motion.at(times).gap_velocity[corner])
        opening_rate = opening[0] if opening else None
        return Rebound(-closing, opening_rate)


class BarMotion(Motion):
    """The bar."""

    names = BAR_COLUMNS
    motion: bar_events.BarMotion  # type: ignore[assignment]
    most_terms = MOST_BAR_TERMS

    def starts_closed(self, corner: str) -> bool:
        """Whether the base is closed just after t = 0."""
        return self.motion.closed_at_start

    def solve_motion(self) -> Iterable[Array]:
        """Find the motion and its switches; return all columns."""
        from fem_reference.events.bar_events import solve

        problem = bar_of(self.scene)
        self.motion = solve(problem, self.end, work=self.work())
        self.switch_events = self.motion.switches
        state = self.motion.at(self.instants())
        force = state.contact_pressure * problem.width / 2
        return (state.displacement, state.contact_pressure, state.gap, state.gap, force, force)

    def bounds(self) -> Iterable[str]:
        """Yield how far the switches are known."""
        yield digits_of_switches(self.motion.bars)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did; the bar reports no energies."""
        completed(self.switch_events)
        t = self.sampling_instants("base")
        width = self.motion.problem.width
        state = self.motion.at(t)
        return opened.record(
            self.scene,
            time=t,
            force=state.contact_pressure * width,
            impulse=state.impulse * width,
            penetration=np.maximum(0.0, -state.gap),
            gap=np.maximum(0.0, state.gap),
            open_share=np.asarray(state.gap > 0, dtype=np.float64),
            velocity=state.mean_velocity,
            rebounds=landings(itertools.starmap(self._rebound, self.contact_spans("base"))),
        )

    def _rebound(self, first: float, last: float | None) -> Rebound:
        """Return the velocities of the base as its contact begins and ends."""
        times = [first] if last is None else [first, last]
        closing, *opening = self.motion.bars.point(0, 0.0, times).velocity.tolist()
        return Rebound(-closing, opening[0] if opening else None)


UNSYMMETRIC = frozenset({features.OFF_CENTRE, features.SLOPE, features.BASE_MOTION})


class BlockEvents(Solver):
    """The block of one strain on springs without tension and with friction, exact in time: `dda` as dt -> 0."""

    name = "block-events"
    # An augmented Lagrangian tends to a rigid stop in displacements, which turns back as its steps happen to: no limit.
    handles = (
        features.LOADS
        | features.RULES
        | features.SCHEMES
        | {features.UNILATERAL, features.FRICTION, features.SLOPE, features.DASHPOTS, features.IMPACT}
    )
    # Under the law of impact both corners do the same, on a base at rest.
    apart: features.Apart = ((features.IMPACT, UNSYMMETRIC),)
    unread: tuple[str, ...] = OF_SCHEMES
    sources = ("fem_reference.events", "fem_reference.problem")
    role = Role.LIMIT
    rank = 5.5
    line: LineStyle | None = LineStyle("#cc79a7", (6.0, 1.5), 0.9, 3)
    own_columns: tuple[str, ...] | None = BLOCK_COLUMNS
    libraries = extras.EXACT

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the motion from switch to switch is not that of the scene."""
        if scene.block.rectangle is None:
            return "the block is not an upright rectangle on its lower edge"
        return None if scene.time.discount == 1 else "the exact motion has no kinetic damping, and gg is below 1"

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene."""
        return BlockMotion(scene, self.name)


class BarEvents(BlockEvents):
    """The bar on a spring that carries no tension, exact in space and time: what `fem` tends to."""

    name = "bar-events"
    handles = frozenset({features.UNILATERAL, features.WEIGHT}) | features.RULES | features.SCHEMES
    role = Role.TRUTH
    rank = 6.5
    line = LineStyle("#666666", (), 0.9, 1)
    own_columns = BAR_COLUMNS

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the bar is not exact for the scene."""
        if features.UNILATERAL not in features.of(scene):
            return 'it requires contact.law = "unilateral"'
        if scene.block.poisson != 0:
            return "the bar is exact at Poisson's ratio 0 only"
        return super().applicable(scene)

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene."""
        return BarMotion(scene, self.name, full)
