"""Columns whose contacts open or slip: what is known before a step is made, and the alarms of such scenes.

solve limit
    The open-close iteration is ended before the solves that the contacts can need: a stack that touches is never solved
    by cutting the step.
far face moves the wrong way
    The step is so short that a push at the foot of a block of one strain opens the contact above it at once, before
    any wave arrives there.
gain by switching
    Average acceleration without discount, before a run: a contact that opens may gain energy, and a stack does not come
    to rest. After a run what it has gained is told, as "energy gained by switching".
residual slip by the step
    Algorithmic or kinetic damping changes what slips, and what has slipped stays.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from validation.advice.alarm import Alarm, alarm
from validation.advice.contact_alarms import gained
from validation.models.column.tables import MOST_HEIGHTS, ColumnSection, LayerSection
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
class ColumnLimits:
    """What follows of a scene with a column whose contacts open or slip, before anything is run."""

    contacts: int
    solves: int | None  # that a step can need; None where no bound is proven
    far_face_step: float  # below which some block's far face moves the wrong way [s]
    blocks: tuple[int, ...]  # of each layer with which it does not at the present step
    lowest: float | None  # lowest frequency of a stack of equal rigid blocks [rad/s]
    ring_down: float | None  # in which that vibration falls to a thousandth while no contact opens or slips [s]


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
    turned = far_face_step(column, stepping.spring_weight)
    proven = column.law == "unilateral" and t.step >= turned
    count = len(column.contacts)
    lowest = _lowest(column)
    ring_down = None if lowest is None else columns.ring_down(lowest, stepping)
    solves = columns.greatest_solves(count) if proven else None
    # The blocks of each layer, the present ones at least, whose far faces move the right way at a step.
    counts = []
    for layer in column.layer:
        whole = columns.far_face_step(_speed(column, layer), layer.thickness, stepping.spring_weight)
        counts.append(max(layer.blocks, math.ceil(whole / t.step * (1 - ROUNDING))) if math.isfinite(whole) else 0)
    return ColumnLimits(count, solves, turned, tuple(counts), lowest, ring_down)


def rest(scene: Scene) -> Rest | None:
    """Return when a stack comes to rest under its weight, by a run of `dda` of its own length; None of another scene.

    A start far from rest and contacts that open have no closed form. The run is doubled until its second half stays
    within the band: a flight or a swing that passes the band is shorter than what came before it.
    """
    column = scene.table(ColumnSection)
    stepping = Stepping.of(scene)
    if not _comes_to_rest(scene) or (not stepping.damps and stepping.gg == 1):
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


def _comes_to_rest(scene: Scene) -> bool:
    """Whether a scene is a stack that its weight alone brings to rest from another state."""
    column = scene.table(ColumnSection)
    if column.law != "unilateral" or scene.stated_input is not None:
        return False
    return column.base in ("rigid", "springs") and column.gravity > 0 and not column.settled


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


def far_face_step(column: ColumnSection, alpha: float) -> float:
    """Return the step below which a block of a column answers a push at one face the wrong way at the other [s]."""
    return max(
        columns.far_face_step(_speed(column, layer), layer.thickness / layer.blocks, alpha) for layer in column.layer
    )


def _speed(column: ColumnSection, layer: LayerSection) -> float:
    return math.sqrt(column.modulus(layer) / layer.density)


def _lowest(column: ColumnSection) -> float | None:
    """Return the lowest frequency of a stack of equal rigid blocks on a base [rad/s], None of another column."""
    masses = {layer.density * layer.thickness / layer.blocks for layer in column.layer}
    stiffnesses = {contact.stiffness for contact in column.contacts}
    blocks = sum(layer.blocks for layer in column.layer)
    rigid = all(math.isinf(layer.young) for layer in column.layer)
    if not rigid or len(masses) + len(stiffnesses) > 2 or len(column.contacts) != blocks:
        return None
    (stiffness,) = stiffnesses
    (mass,) = masses
    return None if math.isinf(stiffness) else columns.lowest_frequency(stiffness, mass, blocks)


ADVICE = {
    "slips": "Cut no step: the joints have one solution at any step; where all states change at once no known column "
    "took more than {most} solves.",
    "solves": "Allow {bound.solves} solves of the open-close iteration in a step, one more than there are contacts, "
    "and cut no step: more are never needed, and a shorter step does not spare them where blocks touch.",
    "unproven": "Cut no step: the contacts have one solution at any step. How many solves it takes is proven only "
    "above dt = {bound.far_face_step:.3g} s; no known column took more than {most}.",
    "far face": "At dt = {step:g} s a block of one strain answers a push with its far face moving the wrong way; "
    "{blocks} blocks in the layers, or dt >= {bound.far_face_step:.3g} s, do not.",
    "rests": "Under its weight the stack comes to rest in {rest.seconds:.3g} s, as dda runs it: from then on its "
    "blocks stay within a thousandth of its settlement, {rest.settlement:.3g} m.",
    "rests late": "As dda runs it, it is not at rest to a thousandth of its settlement, {rest.settlement:.3g} m, "
    "within {half:.3g} s.",
    "rings down": "While {contacts} its lowest vibration, w1 = {bound.lowest:.4g} rad/s, falls to a thousandth in "
    "{bound.ring_down:.3g} s.",
    "never rests": "The stack never comes to rest: while {contacts} neither the scheme nor a discount takes energy.",
}


def advised(scene: Scene, bound: ColumnLimits, resting: Rest | None = None) -> Iterator[str]:
    """Yield in words what to allow and to choose for a column whose contacts open or slip."""
    step = scene.time.step
    slips = scene.table(ColumnSection).law == "frictional"
    if slips:
        yield ADVICE["slips"].format(most=2 * bound.contacts + 1)
    else:
        kind = "unproven" if bound.solves is None else "solves"
        yield ADVICE[kind].format(bound=bound, most=bound.contacts + 1)
    if bound.far_face_step > step and all(bound.blocks):
        yield ADVICE["far face"].format(bound=bound, step=step, blocks=", ".join(map(str, bound.blocks)))
    if resting is not None:
        kind = "rests late" if resting.seconds is None else "rests"
        yield ADVICE[kind].format(rest=resting, half=resting.run / 2)
    if bound.ring_down is not None:
        kind = "rings down" if math.isfinite(bound.ring_down) else "never rests"
        contacts = "no contact slips" if slips else "all contacts are closed"
        yield ADVICE[kind].format(bound=bound, contacts=contacts)


def column_alarms(scene: Scene, row: Row | None = None) -> Iterator[Alarm]:
    """Yield the alarms of a scene with a column whose contacts open or slip.

    Parameters
    ----------
    row
        Of the judged method's run; without one, what may happen is told.
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
