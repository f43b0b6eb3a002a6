"""Histories of a column: what comes in is put into numbers, what comes out is named."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.bodies.column import NEAR, Column
from dda.bodies.column_march import Drive, base_of, blocks_of, body_of, course_of, laws_of, start_of, write_rows
from dda.bodies.column_step import (
    ABSENT,
    CARRIED,
    FOOT,
    FORCES,
    GAP,
    HALF_SPACE,
    KINETIC,
    MODES,
    RATES,
    RECORDED,
    SLIDE,
    SPRINGS,
    SPRUNG,
    STRAINED,
    SWITCHES,
    WELDED,
    Observed,
    make_column_steps,
    make_linear_steps,
)
from dda.contact.rows import INSIDE
from dda.contact.unilateral import OPEN, SLIP, STICK
from dda.march.compiled import run_loop
from dda.march.energy import energies_of
from dda.march.step import history_of, march_of, reached_history
from dda.model.arrays import Array, Columns
from dda.model.checks import check_columns, check_count
from dda.result.contact_result import MarchResult, run_fields
from dda.scheme.newmark import Scheme

DISPLACEMENT = "displacement"  # of the top [m]
PRESSURE = "contact_pressure"  # on the base [Pa]
IN_LISTS = 40  # blocks up to which plain Python is faster on lists than on arrays
AT_HEIGHTS = (DISPLACEMENT, "stress", "velocity", "force", "gap", "slip")  # the last three where a contact is


@dataclass(frozen=True)
class ColumnOptions:
    """How contacts are found and what is kept.

    Raises
    ------
    ValueError
        If the limit of solves, or how often steps are repeated, is no positive integer.
    """

    solve_limit: int | None = None  # solves of the open-close iteration that end the run; None: as many as it takes
    settled: bool = False  # start at rest under the weight alone, not unstrained with all gaps
    states: bool = False  # keep the states of all contacts at every step
    energies: bool = False  # keep energies, momentum and extremes of the contacts at every step
    bonded: bool = False  # contacts carry tension and never slip, whatever the column's law: a faulty program's
    repeats: int = 1  # runs of as many steps that will be made: compiling pays the earlier

    def __post_init__(self) -> None:
        """Check the numbers."""
        check_count(repeats=self.repeats)
        if self.solve_limit is not None:
            check_count(solve_limit=self.solve_limit)


@dataclass(frozen=True, eq=False, kw_only=True)
class ColumnResult(MarchResult):
    """Histories of a column; forces act on the block above a contact."""

    step_switches: NDArray[np.int64]  # contacts whose state changed in a step, (steps,)
    states: NDArray[np.int8] | None  # 0 open, 1 stuck, 2 and -2 slipping, (blocks, steps), by the block above
    record: Array | None  # (RECORDED, steps + 1) from t = 0 on: energies, momentum, extremes of contacts

    def state_of(self, contact: int) -> NDArray[np.int8]:
        """Return the states at the foot of a block, (steps,).

        Raises
        ------
        ValueError
            If the states were not asked for.
        """
        if self.states is None:
            raise ValueError("states: must be asked for before the steps are made, got none")
        return np.asarray(self.states[contact])


def solve_column(
    column: Column,
    scheme: Scheme,
    drive: Drive,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
    options: ColumnOptions | None = None,
) -> ColumnResult:
    """Step a column from its starting velocities.

    A numerical failure is an outcome, not an exception: the history then ends with the last step that was reached.

    Parameters
    ----------
    drive : Drive
        What drives it; it holds one instant more than there are steps.
    columns : sequence of str
        ``displacement`` of the top [m], ``contact_pressure``, the force of the base on the column [Pa], and at the
        heights ``displacement_1``, ... [m], ``velocity_1``, ... [m/s], ``stress_1``, ... [Pa, positive in compression;
        in shear minus the shear stress], and where a contact is ``force_1``, ... [Pa, on the block above], ``gap_1``,
        ... and ``slip_1``, ... [m].
    heights : sequence of float
        Heights above the base [m]; where two blocks meet, the lower one is observed.
    options
        How contacts are found and what is kept; the defaults if absent.

    Raises
    ------
    ValueError
        If a column is unknown, a height lies outside or has no contact, or column, scheme and options exclude each
        other.
    """
    options = options or ColumnOptions()
    check_column(column, scheme, options)
    began = perf_counter()
    steps = (len(drive.pressure) - 1) // len(scheme.stages)
    n = len(column.heights)
    blocks = blocks_of(column, observed_columns(column, columns, heights))
    body = body_of(column, blocks)
    course = course_of(drive, scheme, len(body.loads))
    march = march_of(body, laws_of(column, options.solve_limit, options.bonded), scheme, blocks.gap, blocks)
    write_rows(march)
    march.room.end[:] = course.value[0]
    start = start_of(column, scheme, drive, options.settled, march)
    march = march._replace(between=deepcopy(start))
    linear = n > IN_LISTS and not (options.energies or march.laws.opens.any() or np.isfinite(march.laws.upper).any())
    history = history_of(steps, len(columns) + (RECORDED if options.energies else 1), 0, 0, options.energies)
    history = history._replace(state=np.zeros((steps + 1 if options.states else 0, n), dtype=np.int8))
    ready = perf_counter()
    (reached, outcome), _, how = run_loop(
        make_column_steps,
        (),
        (march, start, deepcopy(start), course),  # compiled code works on these themselves
        (history, steps, 0.5),
        steps * options.repeats,
        make_linear_steps if linear else None,
    )
    solves = int(history.solves.sum())  # those of the step that was not reached, too
    history = reached_history(history, reached)
    record = history.motion[:, len(columns) :].T

    def balance() -> Columns:
        """Return the energies; that of the load is minus the work of all that drives, less what is stored at first."""
        kinetic, strain, springs = record[[KINETIC, STRAINED, SPRINGS]]
        load = np.full_like(kinetic, -(strain[0] + springs[0]))
        return energies_of((kinetic, strain, springs, load), history.sums, scheme.table is not None)

    lowest = int(blocks.base in (ABSENT, CARRIED, HALF_SPACE))
    contacts = {"unilateral": "contacts open and close", "frictional": "contacts slip", "bonded": "bonded"}
    note = f"stepped, {how}: {contacts[column.law]}"
    return ColumnResult(
        **run_fields(history, outcome, scheme, [note], (began, ready)) | {"solves": solves},
        columns=dict(zip(columns, history.motion[1:, : len(columns)].T + 0.0, strict=True)),
        unknowns=n + int(np.count_nonzero(blocks.half)),
        nonzeros=3 * (n - lowest) - 2,
        factorisations=0,
        step_switches=record[SWITCHES, 1:].astype(int),
        states=states_of(history.state[1:].T, march.laws.opens) if options.states else None,
        record=record if options.energies else None,
        balance=balance if options.energies else None,
    )


def states_of(states: NDArray[np.int8], opens: Array) -> NDArray[np.int8]:
    """Return the states of contacts by those of their rows, (blocks, steps)."""
    slipping = np.where(opens[:, None] == 1, OPEN, -SLIP * states)
    return np.where(states == INSIDE, STICK, slipping).astype(np.int8)


def check_column(column: Column, scheme: Scheme, options: ColumnOptions) -> None:
    """Raise ValueError where column, scheme and options exclude each other."""
    if scheme.damped:
        values = f"{scheme.mass_damping:g}, {scheme.stiffness_damping:g}"
        raise ValueError(f"mass_damping, stiffness_damping: must be 0 of a column, got {values}")
    base = base_of(column)
    if scheme.lag and base in (HALF_SPACE, SPRUNG):
        raise ValueError(f"impedance: a half-space does not go with {scheme.name}, got {column.impedance!r}")
    if base == SPRUNG and (scheme.start == "consistent" or scheme.delta == 0):
        field, needed = ("start", "'zero'") if scheme.start == "consistent" else ("delta", "positive")
        raise ValueError(f"{field}: must be {needed} where a spring lies between half-space and column")
    if scheme.explicit and any(math.isinf(joint.stiffness) for joint in column.joints):
        raise ValueError("stiffness: must be finite in an explicit scheme (alpha = 0), got inf")
    if options.settled and not (column.law == "unilateral" and column.rests_on_base):
        foot = "such a base" if column.rests_on_base else "another base"
        raise ValueError(
            f"settled: goes with law = 'unilateral' on a base of prescribed motion only, got {column.law!r} on {foot}"
        )


# ---- what is observed ------------------------------------------------------------------------------------------------


def observed_columns(column: Column, columns: Sequence[str], heights: Sequence[float]) -> Observed:
    """Return what the columns read."""
    names = [f"{part}_{number + 1}" for part in AT_HEIGHTS for number in range(len(heights))]
    check_columns((DISPLACEMENT, PRESSURE, *names), columns)
    rows = np.array([_observed_column(column, name, heights) for name in columns]).reshape(-1, 4)
    kind, place, lower, upper = rows.T.copy()
    return Observed(kind.astype(np.int64), place.astype(np.int64), lower, upper)


def _observed_column(column: Column, name: str, heights: Sequence[float]) -> tuple[int, int, float, float]:
    """Return what is read, of which block, and its two weights."""
    if name == PRESSURE:
        return FOOT, 0, 0.0, 0.0
    if name == DISPLACEMENT:
        return MODES, *of_block(column, len(column.heights) - 1, 1.0)
    part, _, number = name.rpartition("_")
    height = heights[int(number) - 1]
    block, share = column.block_at(height)
    if part in (DISPLACEMENT, "velocity"):
        return (MODES if part == DISPLACEMENT else RATES), *of_block(column, block, share)
    modulus = column.moduli[block]
    if part == "stress":
        if block == 0 and base_of(column) == WELDED:
            return FORCES, 0, 1.0, 0.0
        if math.isinf(modulus):
            return FORCES, block, 0.5, 0.5
        top = of_block(column, block, 1.0)[2]
        return MODES, block, 0.0, -2 * top * modulus / column.heights[block]
    kind = {"force": FORCES, "gap": GAP, "slip": SLIDE}[part]
    for joint in column.joints:
        if abs(joint.height - height) <= NEAR * column.faces[-1]:
            return kind, column.face_of(joint), 1.0, 0.0
    raise ValueError(f"heights: {name} needs a contact there, got {height!r} m")


def of_block(column: Column, block: int, share: float) -> tuple[int, float, float]:
    """Return the weights of the modes of a block in the displacement at a share of its height."""
    root = math.sqrt(column.densities[block] * column.heights[block])
    if block == 0 and base_of(column) in (WELDED, CARRIED):  # the weight of its top, and of the base
        return (0, share * math.sqrt(3) / root, 1 - share) if base_of(column) == WELDED else (0, 0.0, 1.0)
    stretch = 0.0 if math.isinf(column.moduli[block]) else math.sqrt(12) / root
    return block, 1 / root, (share - 0.5) * stretch
