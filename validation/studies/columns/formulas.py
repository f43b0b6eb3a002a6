"""The study of columns whose contacts open or slip.

The exact motions are held to an independent program's numbers, the blocks to the exact motions by their order, the
open-close iteration to its theorems, and what users meet (pieces of a spall, a joint that slips under a wave, slips
that remain, the time in which a stack rests) to closed forms and printed numbers.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from validation.runs.beside import table_beside
from validation.runs.history import History
from validation.runs.row import Metrics
from validation.scenes.scene import Scene, load_scene
from validation.solvers.columns.names import column_of
from validation.suite.bands import Band, fitted_order
from validation.theory import columns
from validation.theory.stepping import Stepping

BARS = "bars-events"
SAMPLES, PIECES, PARTS, REST = "samples", "pieces", "parts", "rest"
SPALL_BARS, SPALL_BLOCKS = "columns-spall-bars", "columns-spall-pieces"
JOINT = "columns-joint"
SLIPS = "columns-slips-steps"
SETTLE = "columns-settle"
STIFF = 1264.911064  # 2 sqrt(k/m) of the stacks of rigid blocks [rad/s]
PART_NAMES = ("transmitted", "reflected", "absorbed")


def exact_parts() -> dict[float, list[float]]:
    """Return what a joint transmits, reflects and absorbs by its strength over the stress of the wave."""
    return {float(name.rpartition("-")[2]): [*parts.values()] for name, parts in printed(f"{BARS} {PARTS}").items()}


def jointed() -> Iterator[Scene]:
    """Yield the scenes of joints that slip under a wave."""
    scene = load_scene(JOINT)
    (joint,) = scene.definition()["column"]["joint"]
    for strength in exact_parts():
        case = scene.with_values({"column.joint": [joint | {"strength": strength}]})
        yield case.model_copy(update={"name": f"{JOINT}-{strength:g}"})


# ---- rows that are computed from finished cases ----


def samples(scene: Scene, history: History) -> Metrics:
    """Return the values of a history that were printed, as ``displacement_1 at 0.02 s``."""
    values = {}
    for name in printed("samples")[scene.name]:
        column, _, time = name.removesuffix(" s").partition(" at ")
        row = int(np.argmin(np.abs(history.time - float(time))))
        values[name] = float(history.columns[column][row])
    return values


@functools.cache
def printed(row: str) -> dict[str, dict[str, Any]]:
    """Return the printed numbers of a row, by case and metric."""
    numbers: dict[str, dict[str, Any]] = {}
    for entry in table_beside(__file__, "study.toml")["gate"]:
        if entry["pairs"] == [[row]] and isinstance(entry.get("numbers"), dict):
            numbers |= entry["numbers"]
    return numbers


def order(runs: Sequence[tuple[Scene, History, History]]) -> Metrics:
    """Return the order in the time step of the blocks' displacement error over the whole history."""
    errors = []
    for _, history, exact in runs:
        names = [name for name in exact.columns if name.startswith("displacement")]
        differences = [np.max(np.abs(history.columns[name] - exact.columns[name])) for name in names]
        errors.append(float(max(differences) / max(np.max(np.abs(exact.columns[name])) for name in names)))
    return {"displacement": fitted_order([case.time.step for case, *_ in runs], errors)}


def pieces(scene: Scene, history: History) -> Metrics:
    """Return the velocities of the equal pieces of a column over the last 2 h / c, in which their waves average out."""
    column = column_of(scene)
    layer = column.layer[0]
    middles = [name for name in history.columns if name.startswith("displacement_")]
    speed = math.sqrt(column.modulus(layer) / layer.density)
    rows = round(2 * column.height / len(middles) / speed / scene.time.step)
    elapsed = rows * scene.time.step
    values = {}
    for number, name in enumerate(middles, start=1):
        before, after = history.columns[name][[-1 - rows, -1]]
        values[f"piece {number}"] = float(after - before) / elapsed
    return values


def parts(scene: Scene, history: History) -> Metrics:
    """Return transmitted, reflected and absorbed parts of the energy of a sine at a joint, as square roots.

    Above the joint is the transmitted wave alone, below it the incident one, which is known, and the reflected one.
    They are measured over one period before any wave from the top has arrived.
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


def rest(scene: Scene, history: History) -> Metrics:
    """Return the time after which the top stays within a thousandth of its settlement."""
    moved = history.displacement
    settled = settlement(scene)
    outside = np.flatnonzero(np.abs(moved - settled) > 1e-3 * abs(settled))
    if outside.size == len(moved):
        return {"time": "undefined"}
    return {"time": history.time[outside[-1]] if outside.size else 0.0, "final": moved[-1] / settled}


def settlement(scene: Scene) -> float:
    """Return the top displacement of a stack of rigid blocks at rest [m]."""
    column = column_of(scene)
    weights = [
        layer.density * column.gravity * layer.thickness / layer.blocks
        for layer in column.layer
        for _ in range(layer.blocks)
    ]
    forces = columns.static_forces(weights)
    return -sum(force / contact.stiffness for force, contact in zip(forces, column.contacts, strict=True))


def residual(scene: Scene, history: History) -> Metrics:
    """Return the remaining slips of the lowest and the highest joint [m]."""
    return {"lowest": history.columns["slip_1"][-1], "highest": history.columns["slip_5"][-1]}


def exact_joint(case: Scene) -> Metrics:
    """Return the strength of a joint over the stress of the wave, and its parts in closed form."""
    strength = float(case.name.rpartition("-")[2])
    return {"strength": strength} | dict(zip(PART_NAMES, exact_parts()[strength], strict=True))


def stiffness_of_steps(case: Scene) -> Metrics:
    """Return w dt of the stiffest mode of a stack of rigid blocks."""
    return {"omega dt": round(STIFF * case.time.step, 3)}


def blocks_of_pieces(case: Scene) -> Metrics:
    """Return how many blocks stand for a piece."""
    column = column_of(case)
    return {"blocks a piece": column.layer[0].blocks // len(column.heights)}


def settling(case: Scene) -> Metrics:
    """Return the time in which a stack's lowest vibration falls to a thousandth, contacts closed [s]."""
    column = column_of(case)
    layer = column.layer[0]
    mass = layer.density * layer.thickness / layer.blocks
    lowest = columns.lowest_frequency(column.contacts[0].stiffness, mass, layer.blocks)
    return {"settling": columns.ring_down(lowest, Stepping.of(case))}


def one_contact_a_solve(case: Scene) -> Band:
    """Return the solves of blocks that touch, which close one by one."""
    most = columns.greatest_solves(len(column_of(case).contacts))
    return most, most


def proven_solves(case: Scene) -> Band:
    """Return the solves that a step may take."""
    return 2, columns.greatest_solves(len(column_of(case).contacts))


def scenes() -> tuple[str | Scene, ...]:
    """Return the scenes of files, and joints of every strength."""
    return (
        "columns-drop-average",
        "columns-drop-constant",
        "columns-domino",
        "columns-spall",
        "columns-weight",
        "columns-mass-ratio",
        "columns-shaken",
        "columns-slips",
        "columns-joints",
        "columns-cradle",
        SPALL_BARS,
        SPALL_BLOCKS,
        *jointed(),
        SLIPS,
        SETTLE,
        "columns-solves-rest",
        "columns-solves-shaken",
    )
