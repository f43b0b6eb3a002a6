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

import math
from collections.abc import Iterator
from dataclasses import dataclass

from validation.advice.alarm import Alarm, alarm
from validation.advice.contact_alarms import gained
from validation.runs.row import Row
from validation.scenes.column import ColumnSection, LayerSection
from validation.scenes.scene import Scene
from validation.theory import columns
from validation.theory.stepping import Stepping

FEW_SOLVES = "solve limit"
FAR_FACE = "far face moves the wrong way"
GAINS = "gain by switching"
PATH = "residual slip by the step"
ROUNDING = 1e-12  # of a quotient that may be a whole number


@dataclass(frozen=True)
class ColumnLimits:
    """What follows of a scene with a column whose contacts open or slip, before anything is run."""

    contacts: int
    solves: int | None  # that a step can need; None where no bound is proven
    far_face_step: float  # below which some block's far face moves the wrong way [s]
    blocks: tuple[int, ...]  # of each layer with which it does not at the present step
    lowest: float | None  # lowest frequency of a stack of equal rigid blocks [rad/s]
    settling: float | None  # time in which such a stack comes to rest to a thousandth [s]


def limits(scene: Scene) -> ColumnLimits | None:
    """Return what is known of a scene before it is run, None of another scene."""
    column = scene.column
    if column is None or column.law == "bonded":
        return None
    t = scene.time
    stepping = Stepping.of(scene)
    turned = far_face_step(column, stepping.spring_weight)
    proven = column.law == "unilateral" and t.step >= turned
    count = len(column.contacts)
    lowest = _lowest(column)
    settling = None
    if lowest is not None and t.scheme == "newmark":
        settling = columns.settling_time(lowest, t.step, t.delta, t.discount)
    solves = columns.greatest_solves(count) if proven else None
    return ColumnLimits(count, solves, turned, _blocks(column, t.step, stepping.spring_weight), lowest, settling)


def far_face_step(column: ColumnSection, alpha: float) -> float:
    """Return the step below which a block of a column answers a push at one face the wrong way at the other [s]."""
    return max(
        columns.far_face_step(_speed(column, layer), layer.thickness / layer.blocks, alpha) for layer in column.layer
    )


def _blocks(column: ColumnSection, step: float, alpha: float) -> tuple[int, ...]:
    """Return the blocks of each layer, the present ones at least, whose far faces move the right way at a step."""
    counts = []
    for layer in column.layer:
        whole = columns.far_face_step(_speed(column, layer), layer.thickness, alpha)
        counts.append(max(layer.blocks, math.ceil(whole / step * (1 - ROUNDING))) if math.isfinite(whole) else 0)
    return tuple(counts)


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
    "rests": "The stack comes to rest to a thousandth in about {bound.settling:.3g} s: the scheme takes "
    "w1^2 (delta - 1/2) dt / 2 and the discount (1 - gg) / (2 dt) of the amplitude a second, w1 = "
    "{bound.lowest:.4g} rad/s.",
    "never rests": "The stack never comes to rest: delta = 1/2 and gg = 1 take no energy.",
}


def advised(scene: Scene, bound: ColumnLimits) -> Iterator[str]:
    """Yield in words what to allow and to choose for a column whose contacts open or slip."""
    step = scene.time.step
    if scene.column is not None and scene.column.law == "frictional":
        yield ADVICE["slips"].format(most=2 * bound.contacts + 1)
    else:
        kind = "unproven" if bound.solves is None else "solves"
        yield ADVICE[kind].format(bound=bound, most=bound.contacts + 1)
    if bound.far_face_step > step and all(bound.blocks):
        yield ADVICE["far face"].format(bound=bound, step=step, blocks=", ".join(map(str, bound.blocks)))
    if bound.settling is not None:
        kind = "rests" if math.isfinite(bound.settling) else "never rests"
        yield ADVICE[kind].format(bound=bound)


def column_alarms(scene: Scene, row: Row | None = None) -> Iterator[Alarm]:
    """Yield the alarms of a scene with a column whose contacts open or slip.

    Parameters
    ----------
    row
        Of the judged method's run; without one, what may happen is told.
    """
    column = scene.column
    bound = limits(scene)
    if column is None or bound is None:
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
