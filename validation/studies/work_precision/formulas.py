"""The study `work-precision`: error against run time and work, and the orders behind it.

Steps and meshes are refined together, so that one line per method shows what its error costs; elsewhere one of the
two is refined alone, large steps for orders in h and smooth blocks for orders in dt, to keep the two fits apart.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping
from typing import Any

from validation.engine.finished import Derived, Finished
from validation.metrics.pairs import relative_l2
from validation.metrics.values import or_nan
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.row import Value
from validation.scenes.scene import Scene, load_scene
from validation.suite.bands import fitted_order

SCHEMES = {"constant": (0.5, 1.0), "average": (0.25, 0.5)}
LEVELS = 6
ORDER_LEVELS = 5
COARSEST = 1.6e-3  # s, the step with 4 elements a side
WINDOW = 0.04  # s, the length of the histories
ORDER_STEP = 2.5e-5  # s, the coarsest of the steps whose order is fitted
ORDER_STEPS = 200  # how many of them
REFERENCE = 2**8  # how much finer the reference of the orders in dt is
MESHES = (8, 16, 32, 64)
SAFETY = 1.25  # of the grid-convergence index, for three meshes and more
QUANTITIES = {"displacement": DISPLACEMENT, "pressure": PRESSURE}
STARTS = (("constant", "zero"), ("constant", "consistent"), ("average", "zero"), ("average", "consistent"))


def scene(name: str, title: str, values: Mapping[str, Any], sweep: Mapping[str, Any]) -> Scene:
    """Return the square block of the paper with other values, swept."""
    base = load_scene("mesh-convergence").with_values({"fem.elements": 16})
    changed = base.model_copy(update={"sweep": {}}).with_values(dict(values))
    return changed.model_copy(update={"name": name, "title": title, "sweep": dict(sweep)})


def scheme_values(scheme: str, start: str, solvers: tuple[str, ...]) -> dict[str, Any]:
    """Return the values of a scene under a scheme."""
    alpha, delta = SCHEMES[scheme]
    values = {"time.alpha": alpha, "time.delta": delta, "time.start": start}
    return values | {"time.step": 1e-3, "time.steps": 50, "run.solvers": list(solvers)}


def refined_together() -> Iterator[Scene]:
    """Yield the scenes whose step and mesh are refined together."""
    factors = [2**k for k in range(LEVELS)]
    sweep = {
        "mode": "zip",
        "time.step": [COARSEST / f for f in factors],
        "time.steps": [round(WINDOW / COARSEST) * f for f in factors],
        "fem.elements": [4 * f for f in factors],
    }
    for scheme in SCHEMES:
        start = "zero" if scheme == "constant" else "consistent"
        for degree, solvers in ((1, ("dda", "fem", "bar", "continuum")), (2, ("fem", "bar", "continuum"))):
            values = scheme_values(scheme, start, solvers) | {"fem.degree": degree}
            kind = "linear" if degree == 1 else "quadratic"
            yield scene(f"work-{scheme}-{kind}", f"{scheme.title()} acceleration, {kind} elements", values, sweep)


def refined_steps() -> Iterator[Scene]:
    """Yield the scenes of the block alone whose step is refined."""
    for scheme, start in STARTS:
        values = scheme_values(scheme, start, ("dda",))
        factors = [2**k for k in range(ORDER_LEVELS)]
        if (scheme, start) == ("average", "consistent"):
            factors.append(REFERENCE)
        sweep = {
            "mode": "zip",
            "time.step": [ORDER_STEP / f for f in factors],
            "time.steps": [ORDER_STEPS * f for f in factors],
        }
        yield scene(f"work-dt-{scheme}-{start}", f"Order in dt, {scheme} acceleration, {start} start", values, sweep)


def refined_meshes() -> Iterator[Scene]:
    """Yield the scenes whose mesh is refined under a step that resolves the front."""
    for degree in (1, 2):
        values = scheme_values("constant", "zero", ("fem", "bar")) | {"fem.degree": degree}
        title = f"Order in h, degree {degree}"
        yield scene(f"work-h-degree-{degree}", title, values, {"fem.elements": list(MESHES)})
    values = scheme_values("constant", "zero", ("dda", "fem")) | {"fem.degree": 1, "block.poisson": 0.25}
    yield scene("work-h-poisson", "Where no closed form exists: mu = 0.25", values, {"fem.elements": list(MESHES)})


@functools.cache
def scenes() -> tuple[Scene, ...]:
    """Return all scenes."""
    return (*refined_together(), *refined_steps(), *refined_meshes())


# ---- orders ---------------------------------------------------------------------------------------------------------


def named(name: str) -> Scene:
    """Return one of the scenes."""
    return next(scene for scene in scenes() if scene.name == name)


def _columns(finished: Finished, case: str, solver: str, every: int = 1) -> dict[str, Array]:
    history = finished.needed_history(case, solver)
    return {name: history.columns[column][every - 1 :: every] for name, column in QUANTITIES.items()}


def order_in_time(name: str) -> Derived:
    """Return the row of the order in dt, against a step so fine that its own error does not count."""
    levels = named(name).expand()[:ORDER_LEVELS]
    reference = named("work-dt-average-consistent").expand()[-1].name

    def compute(finished: Finished) -> Mapping[str, Value]:
        exact = _columns(finished, reference, "dda", REFERENCE)
        solutions = [_columns(finished, case.name, "dda", 2**k) for k, case in enumerate(levels)]
        return _orders([case.time.step for case in levels], solutions, [exact] * len(levels))

    needs = ((reference, "dda"), *((case.name, "dda") for case in levels))
    return Derived(name, "order", needs, compute)


def _orders(
    sizes: list[float], solutions: list[dict[str, Array]], exact: list[dict[str, Array]]
) -> Mapping[str, Value]:
    orders: dict[str, Value] = {}
    for quantity in QUANTITIES:
        errors = [or_nan(relative_l2(a[quantity], b[quantity])) for a, b in zip(solutions, exact, strict=True)]
        orders[f"order.{quantity}"] = fitted_order(sizes, errors)
    return orders


def order_in_mesh(name: str) -> Derived:
    """Return the row of the order in h, against the bar."""
    levels = named(name).expand()

    def compute(finished: Finished) -> Mapping[str, Value]:
        solutions = [_columns(finished, case.name, "fem") for case in levels]
        exact = [_columns(finished, case.name, "bar") for case in levels]
        return _orders([1 / n for n in MESHES], solutions, exact)

    needs = itertools.product((case.name for case in levels), ("fem", "bar"))
    return Derived(name, "order", tuple(needs), compute)


def grid_convergence() -> Derived:
    """Return the row of the grid-convergence index: order from successive changes, uncertainty of the finest mesh."""
    name = "work-h-poisson"
    levels = named(name).expand()

    def compute(finished: Finished) -> Mapping[str, Value]:
        histories = [_columns(finished, case.name, "fem") for case in levels]
        metrics: dict[str, Value] = {}
        for quantity in QUANTITIES:
            changes = [or_nan(relative_l2(a[quantity], b[quantity])) for a, b in itertools.pairwise(histories)]
            order = fitted_order([1 / n for n in MESHES[1:]], changes)
            metrics[f"order.{quantity}"] = order
            metrics[f"gci.{quantity}"] = SAFETY * changes[-1] / (2**order - 1)
        return metrics

    return Derived(name, "gci", tuple((case.name, "fem") for case in levels), compute)


@functools.cache
def derived() -> tuple[Derived, ...]:
    """Return the rows of orders and of the grid-convergence index."""
    times = [order_in_time(f"work-dt-{scheme}-{start}") for scheme, start in STARTS]
    meshes = [order_in_mesh(f"work-h-degree-{degree}") for degree in (1, 2)]
    return (*times, *meshes, grid_convergence())
