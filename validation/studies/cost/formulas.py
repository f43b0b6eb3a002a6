"""The study `cost`: error against run time and work of three blocks, and the orders behind it.

For the blocks `validation.studies.cost.ladder` refines steps and meshes together, so that one line per method shows
what its error costs; here one of the two is refined alone, large steps for orders in h and smooth blocks for orders in
dt, to keep the two fits apart.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from typing import Any

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.errors import InputError
from validation.metrics.pairs import relative_l2
from validation.metrics.values import or_nan
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, History
from validation.runs.records import Annotations
from validation.runs.row import Metrics, Value
from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import get_solver
from validation.studies.cost.ladder import Ladder
from validation.studies.cost.measures import BlockRows
from validation.suite.bands import Runs, fitted_order

BLOCKS = ("paper", "granite", "opening")
OWN_BLOCK = "own"  # what the block of a user's scene is called in the rows
ORDER_LEVELS = 5
REFERENCE = 2**8  # how much finer the last case of the last of `IN_TIME` is, the reference of the orders in dt
MESHES = (8, 16, 32, 64)
SAFETY = 1.25  # of the grid-convergence index, for three meshes and more
QUANTITIES = {"displacement": DISPLACEMENT, "pressure": PRESSURE}
IN_TIME = ("cost-dt-constant-zero", "cost-dt-constant-consistent", "cost-dt-average-zero", "cost-dt-average-consistent")
IN_MESH = ("cost-h-degree-1", "cost-h-degree-2")
WITHOUT_EXACT = "cost-h-poisson"


@functools.cache
def scenes() -> tuple[str | Scene, ...]:
    """Return the blocks by all methods, and the scenes in which steps or meshes alone are refined."""
    blocks = itertools.chain.from_iterable(ladder_of(name).scenes() for name in BLOCKS)
    return (*blocks, *IN_TIME, *IN_MESH, WITHOUT_EXACT)


@functools.cache
def ladder_of(name: str) -> Ladder:
    """Return a block with its window."""
    return Ladder.of(load_scene(f"cost-{name}"))


def of_scene(base: Scene) -> dict[str, Any]:
    """Return the fields of the study of a user's block: the same methods, no gates.

    Raises
    ------
    InputError
        The scene is of no block that comes down on its springs, or there is no reference for it.
    """
    ladder = Ladder.of(base)
    case = ladder.scene(ladder.reference).expand()[-1]
    if reason := get_solver(ladder.reference.solver).refusal(case):
        raise InputError(f"has no reference: {reason}", source=base.name, field="--scene", value=base.name)
    purpose = "Which method gives which error at which cost for this block; what a discount, springs and steps buy."
    rows = tuple(BlockRows(ladder, OWN_BLOCK).rows())
    applying = []
    for scene in ladder.scenes():
        (solver,) = scene.run.solvers
        if get_solver(solver).refusal(scene.expand()[0]) is None:
            applying.append(scene)
    return {"purpose": purpose, "scenes": applying, "derived": lambda: rows}


def nothing(scenes: Sequence[Scene], finished: Finished) -> Annotations:
    """Return no alarms: steps are long here on purpose."""
    return {"alarms": [], "budgets": []}


# ---- orders ----


def _columns(history: History, every: int = 1) -> dict[str, Array]:
    return {name: history.columns[column][every - 1 :: every] for name, column in QUANTITIES.items()}


def order_in_time(name: str) -> Derived:
    """Return the row of the order in dt, against a step whose own error does not count."""
    levels = load_scene(name).expand()[:ORDER_LEVELS]
    reference = load_scene(IN_TIME[-1]).expand()[-1].name

    def compute(finished: Finished) -> Metrics:
        exact = _columns(finished.needed_history(reference, "dda"), REFERENCE)
        histories = [finished.needed_history(case.name, "dda") for case in levels]
        solutions = [_columns(history, 2**k) for k, history in enumerate(histories)]
        return _orders([case.time.step for case in levels], solutions, [exact] * len(levels))

    needs = ((reference, "dda"), *((case.name, "dda") for case in levels))
    return Derived(name, "order", needs, compute)


def _orders(sizes: list[float], solutions: list[dict[str, Array]], exact: list[dict[str, Array]]) -> Metrics:
    orders = {}
    for quantity in QUANTITIES:
        errors = [or_nan(relative_l2(a[quantity], b[quantity])) for a, b in zip(solutions, exact, strict=True)]
        orders[f"order.{quantity}"] = fitted_order(sizes, errors)
    return orders


def order_in_mesh(runs: Sequence[tuple[Scene, History, History]]) -> Metrics:
    """Return the order in h, against the bar."""
    solutions = [_columns(history) for _, history, _ in runs]
    return _orders([1 / n for n in MESHES], solutions, [_columns(exact) for *_, exact in runs])


def grid_convergence(runs: Runs) -> Metrics:
    """Return the grid-convergence index: order from successive changes, uncertainty of the finest mesh."""
    histories = [_columns(history) for _, history in runs]
    metrics: dict[str, Value] = {}
    for quantity in QUANTITIES:
        changes = [or_nan(relative_l2(a[quantity], b[quantity])) for a, b in itertools.pairwise(histories)]
        order = fitted_order([1 / n for n in MESHES[1:]], changes)
        metrics[f"order.{quantity}"] = order
        metrics[f"gci.{quantity}"] = SAFETY * changes[-1] / (2**order - 1)
    return metrics


@functools.cache
def derived() -> DerivedRows:
    """Return the rows of orders in dt, and of the blocks."""
    times = map(order_in_time, IN_TIME)
    blocks = itertools.chain.from_iterable(BlockRows(ladder_of(name), name).rows() for name in BLOCKS)
    return (*times, *blocks)
