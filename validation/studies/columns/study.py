"""The study of columns whose contacts open or slip.

The exact motions are held to an independent program's numbers, the blocks to the exact motions by their order, the
open-close iteration to its theorems, and what users meet (pieces of a spall, a joint that slips under a wave, slips
that remain, the time in which a stack rests) to closed forms and printed numbers.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping

import numpy as np

from validation.engine.finished import Derived, Finished, from_history
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Value
from validation.scenes.scene import Scene, load_scene
from validation.solvers.columns.names import column_of
from validation.studies.bands import OTHER, about, cases, fitted_order, gate, near
from validation.studies.columns import known
from validation.studies.declaration import Study
from validation.theory import columns

DDA = "dda"
SAMPLES, ORDER, PIECES, PARTS, REST = "samples", "order", "pieces", "parts", "rest"
DROPS = {"columns-drop-average": 2.0, "columns-drop-constant": 1.0}  # scene to order of its scheme
DOMINO = "columns-domino"
SPALL_BARS, SPALL_BLOCKS = "columns-spall-bars", "columns-spall-pieces"
JOINT = "columns-joint"
SLIPS = "columns-slips-steps"
SETTLE = "columns-settle"
SOLVES = {"columns-solves-rest": known.RESTING_SOLVES, "columns-solves-shaken": known.SHAKEN_SOLVES}
STIFF = 1264.911064  # 2 sqrt(k/m) of the stacks of rigid blocks [rad/s]
STEPS = (0.1, 0.5, 2.0, 10.0)  # these times their step
CRADLE = "columns-cradle"
OTHERS = (
    "columns-spall",
    "columns-weight",
    "columns-mass-ratio",
    "columns-shaken",
    "columns-slips",
    "columns-joints",
    CRADLE,
)
WHY_KNOWN = "an independent program; band: half a unit of its last digit, and 1e-12 of the value for rounding"


def jointed() -> Iterator[tuple[float, Scene]]:
    """Yield strength over the stress of the wave, and the scene of a joint that slips under it."""
    scene = load_scene(JOINT)
    (joint,) = scene.definition()["column"]["joint"]
    for strength in known.SLIPPING_JOINT:
        case = scene.with_values({"column.joint": [joint | {"strength": strength}]})
        yield strength, case.model_copy(update={"name": f"{JOINT}-{strength:g}"})


# ---- rows that are computed from finished cases ---------------------------------------------------------------------


@functools.cache
def derived() -> tuple[Derived, ...]:
    """Return the rows that are computed from finished cases."""
    rows = []
    for case_name, solver in dict.fromkeys((one.scene, one.solver) for one in known.KNOWN):
        compute = functools.partial(samples, case_name, solver)
        rows.append(Derived(case_name, SAMPLES, ((case_name, solver),), compute))
    for name in DROPS:
        levels = tuple(cases(name))
        needs = tuple((case.name, solver) for case in levels for solver in (DDA, known.EVENTS))
        rows.append(Derived(name, ORDER, needs, functools.partial(order, levels)))
    spalls = [(load_scene(SPALL_BARS), solver) for solver in (known.BARS, known.EVENTS, "fem")]
    spalls += [(case, DDA) for case in cases(SPALL_BLOCKS)]
    spalls += [(load_scene(CRADLE), solver) for solver in (known.BARS, "fem")]
    rows += [from_history(scene, solver, f"{solver} {PIECES}", pieces) for scene, solver in spalls]
    for _, scene in jointed():
        rows += [from_history(scene, solver, f"{solver} {PARTS}", parts) for solver in (DDA, known.BARS)]
    rows += [from_history(case, DDA, REST, rest) for case in cases(SETTLE)]
    rows += [from_history(case, DDA, SAMPLES, residual) for case in cases(SLIPS)]
    return tuple(rows)


def sample_name(sample: known.Sample) -> str:
    """Return the name under which a sample is kept."""
    return f"{sample.column} at {sample.time:g} s"


def samples(scene: str, solver: str, finished: Finished) -> Mapping[str, Value]:
    """Return the values of a history at the instants of the printed numbers."""
    history = finished.needed_history(scene, solver)
    values: dict[str, Value] = {}
    for sample in known.KNOWN:
        if (sample.scene, sample.solver) == (scene, solver):
            row = int(np.argmin(np.abs(history.time - sample.time)))
            values[sample_name(sample)] = float(history.columns[sample.column][row])
    return values


def order(levels: tuple[Scene, ...], finished: Finished) -> Mapping[str, Value]:
    """Return the order in the time step, fitted to the displacement's error of the blocks over the whole history."""
    errors = []
    for case in levels:
        history, exact = (finished.needed_history(case.name, solver) for solver in (DDA, known.EVENTS))
        errors.append(_error(history, exact))
    return {"displacement": fitted_order([case.time.step for case in levels], errors)}


def _error(history: History, exact: History) -> float:
    """Return the largest error of the blocks' displacements over the largest displacement."""
    names = [name for name in exact.columns if name.startswith("displacement")]
    differences = [np.max(np.abs(history.columns[name] - exact.columns[name])) for name in names]
    return float(max(differences) / max(np.max(np.abs(exact.columns[name])) for name in names))


def pieces(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return the velocities of the equal pieces of a column over the last 2 h / c, in which their waves average out."""
    column = column_of(scene)
    layer = column.layer[0]
    middles = [name for name in history.columns if name.startswith("displacement_")]
    speed = math.sqrt(column.modulus(layer) / layer.density)
    rows = round(2 * column.height / len(middles) / speed / scene.time.step)
    elapsed = rows * scene.time.step
    values: dict[str, Value] = {}
    for number, name in enumerate(middles, start=1):
        before, after = history.columns[name][[-1 - rows, -1]]
        values[f"piece {number}"] = float(after - before) / elapsed
    return values


def parts(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return transmitted, reflected and absorbed parts of the energy of a sine at a joint, as square roots.

    Above the joint there is the transmitted wave alone, below it the incident one, which is known, and the reflected
    one. They are measured over one period in which no wave from the top has arrived.
    """
    below, above = column_of(scene).heights
    drive = scene.input
    frequency, size = drive.frequency or 1.0, drive.velocity or 1.0
    layer = column_of(scene).layer[0]
    speed = math.sqrt(column_of(scene).modulus(layer) / layer.density)
    end = (2 * layer.thickness - above) / speed  # when the top's echo arrives above the joint
    window = (history.time > end - 1.05 / frequency) & (history.time <= end - 0.05 / frequency)
    incident = size * np.sin(2 * np.pi * frequency * (history.time[window] - below / speed))
    transmitted = history.columns["velocity_2"][window]
    reflected = history.columns["velocity_1"][window] - incident
    energy = float(np.mean(incident**2))
    squares = [float(np.mean(part**2)) / energy for part in (transmitted, reflected)]
    return {
        "transmitted": math.sqrt(squares[0]),
        "reflected": math.sqrt(squares[1]),
        "absorbed": math.sqrt(max(1 - sum(squares), 0.0)),
    }


def rest(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return the time after which the top stays within a thousandth of its settlement."""
    moved = history.displacement
    settled = settlement(scene)
    outside = np.flatnonzero(np.abs(moved - settled) > 1e-3 * abs(settled))
    if outside.size == len(moved):
        return {"time": "undefined"}
    return {"time": float(history.time[outside[-1]]) if outside.size else 0.0, "final": float(moved[-1] / settled)}


def settlement(scene: Scene) -> float:
    """Return the displacement of the top of a stack of rigid blocks at rest [m]."""
    column = column_of(scene)
    weights = [
        layer.density * column.gravity * layer.thickness / layer.blocks
        for layer in column.layer
        for _ in range(layer.blocks)
    ]
    forces = columns.static_forces(weights)
    return -sum(force / contact.stiffness for force, contact in zip(forces, column.contacts, strict=True))


def residual(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return the slips that remain of the lowest and the highest joint [m]."""
    return {"lowest": float(history.columns["slip_1"][-1]), "highest": float(history.columns["slip_5"][-1])}


# ---- gates ----------------------------------------------------------------------------------------------------------


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (
        *known_gates(),
        *order_gates(),
        *solve_gates(),
        *spall_gates(),
        *joint_gates(),
        *rest_gates(),
        *slip_gates(),
    )


def known_gates() -> Iterator[Gate]:
    """Yield the gates on the exact motions."""
    for sample in known.KNOWN:
        half = sample.half + 1e-12 * abs(sample.value)
        band = about(sample.value, half)
        yield gate(sample.scene, SAMPLES, sample_name(sample), band, WHY_KNOWN, OTHER, sample.half)


def order_gates() -> Iterator[Gate]:
    """Yield the gates on the orders of the blocks."""
    why_two = "average acceleration from a consistent start is of order 2, through switches too; three halvings"
    yield gate("columns-drop-average", ORDER, "displacement", (1.9, 2.1), why_two)
    why_one = (
        "constant acceleration is of order 1 with terms of order 2 beside it, which an independent program saw as 0.84 "
        "to 1.00 on eight columns"
    )
    yield gate("columns-drop-constant", ORDER, "displacement", (0.84, 1.05), why_one, OTHER)


def solve_gates() -> Iterator[Gate]:
    """Yield the gates on the solves of the open-close iteration."""
    for case in cases(DOMINO):
        most = columns.greatest_solves(len(column_of(case).contacts))
        why = "rigid blocks that touch close one contact in each solve: N + 1 solves, at every step and scheme"
        yield gate(case, DDA, "contact.most_solves", (most, most), why)
    why_mean = (
        "mean solves of an independent program from other velocities; band: 15 %, thrice what another draw of the "
        "velocities changes, beside the length of the run, which is not printed"
    )
    for name, table in SOLVES.items():
        for case in cases(name):
            if case.time.delta in table:
                index = STEPS.index(round(case.time.step * STIFF, 3))
                band = near(table[case.time.delta][index], 0.15)
                yield gate(case, DDA, "contact.mean_solves", band, why_mean, OTHER)
            most = columns.greatest_solves(len(column_of(case).contacts))
            why_most = "proven: at most N + 1 for rigid blocks, whatever step, delta and gg; one contact needs two"
            yield gate(case, DDA, "contact.most_solves", (2, most), why_most)


def spall_gates() -> Iterator[Gate]:
    """Yield the gates on the pieces of a spall."""
    why_bars = "an independent program; a free piece's waves average to nothing over 2 h / c"
    top, below = known.BAR_PIECES[5], known.BAR_PIECES[4]
    for name, value in (("piece 6", top), ("piece 5", below)):
        yield gate(SPALL_BARS, f"{known.BARS} {PIECES}", name, about(value, 1e-9), why_bars, OTHER, 5e-13)
    for number, value in enumerate(known.CRADLE_BARS, start=1):
        name = f"piece {number}"
        yield gate(CRADLE, f"{known.BARS} {PIECES}", name, about(value, 1e-9), why_bars, OTHER, 5e-15)
    why_fine = (
        "order 2 in blocks and steps, which an independent program saw as 6e-5 of the displacement with 64 a piece"
    )
    why_damped = "order 0.9 under (1/2, 1): an independent program is 3.2 % of the displacement low with 64 a piece"
    for case in cases(SPALL_BLOCKS):
        finest = column_of(case).layer[0].blocks == 64 * len(known.BAR_PIECES)
        if finest and case.time.delta == 0.5:
            yield gate(case, f"{DDA} {PIECES}", "piece 6", about(top, 1e-3), why_fine, OTHER)
        elif finest:
            low = top * (1 - 0.032)
            yield gate(case, f"{DDA} {PIECES}", "piece 6", near(low, 0.01), why_damped, OTHER)
    why_blocks = "an independent program, exact in time; band: half a unit of its last digit, and c dt/h"
    yield gate(SPALL_BARS, f"{known.EVENTS} {PIECES}", "piece 6", about(known.BLOCK_PIECES[5], 5e-3), why_blocks)


def joint_gates() -> Iterator[Gate]:
    """Yield the gates on a joint that slips under a wave."""
    why = "closed form of a rigid joint of fixed strength under a sine; band: the rows of one period"
    for strength, scene in jointed():
        for name, value in zip(("transmitted", "reflected", "absorbed"), known.SLIPPING_JOINT[strength], strict=True):
            yield gate(scene, f"{known.BARS} {PARTS}", name, about(value, 2e-3), why)


def rest_gates() -> Iterator[Gate]:
    """Yield the gates on stacks that come to rest."""
    why = "an independent program; band: one step, and a half period of the slowest vibration"
    for case in cases(SETTLE):
        t = case.time
        value = known.SETTLED[t.alpha, t.delta, t.discount, t.step]
        yield gate(case, REST, "time", near(value, 0.05), why, OTHER)
        yield gate(case, REST, "final", (0.999, 1.001), "the static solution is unique, whatever came before")


def slip_gates() -> Iterator[Gate]:
    """Yield the gates on what remains of a slip."""
    for case in cases(SLIPS):
        t = case.time
        values = known.RESIDUAL_SLIPS[t.alpha, t.delta, t.discount, t.step]
        for name, printed in zip(("lowest", "highest"), values, strict=True):
            half = known.half_unit(printed)
            why = "an independent program with the same step; band: half a unit of its last digit"
            yield gate(case, SAMPLES, name, about(float(printed), half), why, OTHER, half)


def study() -> Study:
    """Return the study."""
    return Study(
        name="columns",
        title="Columns whose contacts open and slip",
        purpose="Stacks that are dropped, shaken and put under their weight, pieces that a pulse tears off, joints "
        "that slip under a wave: the exact motions against an independent program, the blocks against the exact "
        "motions, and the open-close iteration against what is proven of it.",
        scenes=(
            *DROPS,
            DOMINO,
            *OTHERS,
            SPALL_BARS,
            SPALL_BLOCKS,
            *(scene for _, scene in jointed()),
            SLIPS,
            SETTLE,
            *SOLVES,
        ),
        gates=gates,
        derived=derived,
    )
