"""Columns whose contacts open or slip: what is known before a step is made, and the alarms of such scenes.

That average acceleration without discount may gain energy by switching is told before a run; after it what it has
gained is, as "energy gained by switching".
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from validation.advice.alarm import Alarm, alarm
from validation.advice.contact_alarms import gained
from validation.advice.hooks import AdviceHooks, ColumnLimits
from validation.advice.words import say
from validation.models.column.tables import MOST_HEIGHTS, ColumnSection
from validation.runs.history import DISPLACEMENT
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.solvers.registry import solve
from validation.theory import columns
from validation.theory.stepping import Stepping

FEW_SOLVES = "solve limit"
FAR_FACE = "far face moves the wrong way"
GAINS = "gain by switching"
PATH = "residual slip by the step"
ROUNDING = 1e-12  # of a quotient that may be a whole number
REST_SHARE = 1e-3  # of the settlement, within which a stack is at rest
FIRST_RUN = 500  # steps
LONGEST = 400_000  # steps times blocks: some two seconds


@dataclass(frozen=True)
class Rest:
    """When a stack comes to rest under its weight, as `dda` runs it."""

    seconds: float | None  # until all blocks stay within `REST_SHARE` of the settlement; None: not in half the run
    run: float  # time that was run [s]
    settlement: float  # of the top by springs and strains, gaps left out [m]


def limits(scene: Scene) -> ColumnLimits | None:
    """Return what is known of a scene before it is run, None where its contacts are bonded."""
    column = scene.table(ColumnSection)
    if column.law == "bonded":
        return None
    t = scene.time
    stepping = Stepping.of(scene)
    layers = AdviceHooks.of(scene).layers(scene)
    weight = stepping.spring_weight
    turned = max(columns.far_face_step(layer.speed, layer.height, weight) for layer in layers)
    proven = column.law == "unilateral" and t.step >= turned
    count = len(column.contacts)
    solves = columns.greatest_solves(count) if proven else None
    # The lowest frequency of equal rigid blocks on a base; of another column it is not told.
    masses = {layer.density * layer.height for layer in layers}
    stiffnesses = {contact.stiffness for contact in column.contacts}
    rigid = all(math.isinf(layer.modulus) for layer in layers)
    based = count == sum(layer.blocks for layer in layers)
    lowest = None
    if rigid and based and len(masses) == len(stiffnesses) == 1:
        stiffness = min(stiffnesses)
        lowest = columns.lowest_frequency(stiffness, min(masses), count) if math.isfinite(stiffness) else None
    ring_down = None if lowest is None else columns.ring_down(lowest, stepping)
    # The blocks of each layer, the present ones at least, whose far faces move the right way at a step.
    counts = []
    for layer in layers:
        whole = columns.far_face_step(layer.speed, layer.thickness, weight)
        counts.append(max(layer.blocks, math.ceil(whole / t.step * (1 - ROUNDING))) if math.isfinite(whole) else 0)
    return ColumnLimits(count, solves, turned, tuple(counts), lowest, ring_down)


def rest(scene: Scene) -> Rest | None:
    """Return when a stack comes to rest under its weight, by a run of `dda` of its own length; None of another scene.

    A start far from rest and contacts that open have no closed form. The run is doubled until its second half stays
    within the band: a flight or a swing that passes the band is shorter than what came before it.
    """
    column = scene.table(ColumnSection)
    stepping = Stepping.of(scene)
    driven = scene.stated_input is not None or column.law != "unilateral" or column.base not in ("rigid", "springs")
    by_weight = column.gravity > 0 and not column.settled
    if driven or not by_weight or (not stepping.damps and stepping.gg == 1):
        return None
    middles, at_rest, settlement = _at_rest(column)
    if settlement == 0:
        return None
    names = [f"{DISPLACEMENT}_{number}" for number in range(1, len(middles) + 1)]
    longest = max(FIRST_RUN, LONGEST // sum(layer.blocks for layer in column.layer))
    steps = FIRST_RUN
    while True:
        values = {"column.heights": middles, "run.columns": names, "time.steps": steps}
        run = solve(scene.with_values(values), "dda")
        if run.history is None or run.outcome is not Outcome.COMPLETED:
            return None
        moved = np.array([run.history.columns[name] for name in names])
        away = np.abs(moved - np.array(at_rest)[:, None]).max(axis=0)
        outside = np.flatnonzero(away > REST_SHARE * settlement)
        last = int(outside[-1]) + 1 if outside.size else 0  # a history begins with the end of the first step
        if last <= steps // 2:
            return Rest((last + 1) * stepping.step, steps * stepping.step, settlement)
        if steps >= longest:
            return Rest(None, steps * stepping.step, settlement)
        steps = min(2 * steps, longest)


def _at_rest(column: ColumnSection) -> tuple[list[float], list[float], float]:
    """Return middles of blocks, of very many evenly taken, their displacements at rest, and the top's without gaps [m].

    Each contact carries the weight above it, and the mean stress of a block is that of its middle.
    """
    middles = []
    at_rest = []
    contacts = list(column.contacts)
    faces = iter(itertools.pairwise(column.faces))
    foot = 0.0
    gaps = 0.0
    for layer in column.layer:
        for low, high in itertools.islice(faces, layer.blocks):
            while contacts and contacts[0].height < (low + high) / 2:
                contact = contacts.pop(0)
                foot -= contact.gap + column.static_stress(contact.height) / contact.stiffness
                gaps += contact.gap
            middle = (low + high) / 2
            shortening = column.static_stress(middle) * (high - low) / column.modulus(layer)
            middles.append(middle)
            at_rest.append(foot - shortening / 2)
            foot -= shortening
    chosen = np.unique(np.linspace(0, len(middles) - 1, min(len(middles), MOST_HEIGHTS)).round().astype(int))
    return [middles[i] for i in chosen], [at_rest[i] for i in chosen], -foot - gaps


def advised(scene: Scene, bound: ColumnLimits, resting: Rest | None = None) -> Iterator[str]:
    """Yield in words what to allow and to choose for a column whose contacts open or slip."""
    law = scene.table(ColumnSection).law
    kind = "solves of slips" if law == "frictional" else "solves unproven"
    yield say(kind if bound.solves is None else "solves", bound, bound.contacts + 1, 2 * bound.contacts + 1)
    if bound.far_face_step > scene.time.step and all(bound.blocks):
        yield say("far face", bound, scene.time, ", ".join(map(str, bound.blocks)))
    if resting is not None:
        yield say("rests late" if resting.seconds is None else "rests", resting, resting.run / 2)
    if bound.ring_down is not None:
        kind = "stack rings down" if math.isfinite(bound.ring_down) else "never rests"
        yield say(kind, bound, "no contact slips" if law == "frictional" else "all contacts are closed")


def column_alarms(scene: Scene, row: Row | None = None) -> Iterator[Alarm]:
    """Yield the alarms of a scene with a column whose contacts open or slip.

    `row` is of the judged method's run; without one, what may happen is told.
    """
    column = scene.table(ColumnSection)
    bound = limits(scene)
    if bound is None:
        return
    t = scene.time
    if column.law == "frictional":
        stepping = Stepping.of(scene)
        if stepping.damps or t.discount < 1:
            yield alarm(PATH, scene.name, {"delta": stepping.delta, "gg": t.discount, "step": t.step})
        return
    needed = columns.greatest_solves(bound.contacts)
    if column.solve_limit is not None and column.solve_limit < needed:
        values = {"solve_limit": column.solve_limit, "needed": needed}
        yield alarm(FEW_SOLVES, scene.name, values, contacts=bound.contacts)
    if t.step < bound.far_face_step:
        yield alarm(FAR_FACE, scene.name, {"step": t.step, "far_face_step": bound.far_face_step})
    if row is not None:
        yield from gained(scene, row)
    elif t.scheme == "newmark" and t.delta == 0.5 and t.discount == 1:
        yield alarm(GAINS, scene.name, {"delta": t.delta})
