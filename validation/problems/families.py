"""Changes of one thing, of the scene or of the rows, by which an answer may depart from the exact motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias

import numpy as np

from validation.diagnosis.numbers import Values
from validation.diagnosis.one_change import UNITS, CandidateChange, of_discount, of_numbers
from validation.problems.models import Base, Columns, Runs
from validation.runs.history import Array, History
from validation.scenes import features
from validation.scenes.scene import Scene

Change: TypeAlias = CandidateChange[Columns | None]  # to the columns of its number; None where there are none
FACTORS = (1.0, 0.5, 0.75, 0.88, 1.12, 1.3, 2.0)  # to begin from where a run costs nothing; elsewhere the first
LARGEST = 3.0  # of the logarithm of a factor; what is further away is forgotten, or in other units
NEAR_UNITS = 0.3  # the same, from that of other units
DISCOUNTS = (0.99, 0.95, 0.8)  # of the velocity of a step
DAMPINGS = (3.0, 30.0)  # 1/s, of the mass; of the stiffness over the square of the frequency of the steps
MOST_LATE = 2.0  # steps
FASTEST, SLOWEST = 1.1, 0.5  # of the rate at which time may run


def of_data(runs: Runs, base: Base, cheap: bool) -> Iterator[Change]:
    """Yield wrong numbers of the scene, run by a base, and another discount, which acts at every step of the scene."""
    scene = runs.scene
    if "column.layer" in base.values:  # the base cuts the scene's layers finer
        scene = scene.with_values({"column.layer": base.values["column.layer"]})
    changes = [*of_numbers(scene, FACTORS if cheap else FACTORS[:1], units=cheap)]
    if base.every == 1:
        changes.append(of_discount(scene, DISCOUNTS))
    for change in changes:

        def run(u: float, values: Callable[[float], Values] = change.changed) -> Columns | None:
            sensible = abs(u) <= LARGEST or any(abs(u - math.log(unit)) <= NEAR_UNITS for unit in UNITS)
            return runs.sampled(base, values(u)) if sensible else None

        yield change.giving(run)


def of_damping(runs: Runs, base: Base) -> Iterator[Change]:
    """Yield viscous damping of the mass and of the stiffness, which DDA knows for linear motions."""
    if not features.linear(runs.scene):
        return
    step = runs.scene.time.step
    for key, unit, scale, symbol in (("mass", "1/s", 1.0, "a0"), ("stiffness", "s", step**2, "a1")):
        yield CandidateChange(
            f"{key}-damping",
            lambda c, key=key, unit=unit, symbol=symbol: (  # type: ignore[misc]
                f"viscous damping of the {key} is there, {symbol} = {c:.4g} {unit}"
            ),
            lambda u, scale=scale: max(u, 0.0) * scale,  # type: ignore[misc]
            lambda u, key=key, scale=scale: runs.sampled(base, {f"damping.{key}": max(u, 0.0) * scale}),  # type: ignore[misc]
            DAMPINGS,
            0.1,
        )


def of_output(runs: Runs, base: Base, names: Sequence[str]) -> Iterator[Change]:
    """Yield what may be wrong with rows and columns alone: a factor, a shift of the rows, the rate of time."""
    plain, dense = runs.sampled(base), runs.dense(base)
    if plain is None or dense is None:
        return
    groups = [tuple(names), *((name,) for name in names if len(names) > 1)]
    for group in groups:
        which = "all columns" if group == tuple(names) else group[0]
        yield CandidateChange(
            "factor",
            lambda f, which=which: f"{which} {_are(which)} {f:.4g} times the exact motion's",  # type: ignore[misc]
            lambda u: 1 + u,
            lambda u, group=group: {name: x * (1 + u * (name in group)) for name, x in plain.items()},  # type: ignore[misc]
            (0.0,),
        )
        yield CandidateChange(
            "shift",
            lambda late, which=which: f"{which} {_are(which)} {_steps(late)}",  # type: ignore[misc]
            lambda u: u,
            lambda u, group=group: _moved(runs, base, dense, plain, group, 1.0, u),  # type: ignore[misc]
            (0.0, 1.0, -1.0),
            1e-2,
        )
    yield CandidateChange(
        "time-factor",
        lambda rate: f"time runs {rate:.4g} times as fast as in the exact motion{_by_mass(runs.scene, rate)}",
        math.exp,
        lambda u: _moved(runs, base, dense, plain, tuple(names), math.exp(u), 0.0),
        (0.0, math.log(0.8), math.log(0.9)),
    )


def springs_alike(scene: Scene, number: str, factor: float) -> str:
    """Return the springs that do the same: vertically, mass, stiffness and loads go with the width, 2 p does not."""
    vertical = {features.UNILATERAL, features.WEIGHT, features.DEAD_BAND}
    if number != "width-factor" or not {*features.of(scene)} <= vertical:
        return ""
    return f", as springs of {1 / factor:.4g} times the scene's do"


def _by_mass(scene: Scene, rate: float) -> str:
    """Return the density that does the same: of M x'' + K x = F from rest, without weight, it sets the rate of time."""
    if scene.column is not None or scene.load.gravity or scene.block.velocity or scene.load.base_motion:
        return ""
    return f", as a density of {rate**-2:.4g} times the scene's does"


def _are(which: str) -> str:
    return "are" if which == "all columns" else "is"


def _steps(late: float) -> str:
    return f"{abs(late):.3g} steps {'late' if late > 0 else 'early'}"


def _moved(
    runs: Runs, base: Base, dense: History, plain: Columns, group: Sequence[str], rate: float, late: float
) -> Columns | None:
    """Return columns at other instants: rate (t - late dt); what is before t = 0 is the motion's first row."""
    if not SLOWEST <= rate <= FASTEST or abs(late) > MOST_LATE:
        return None
    step = runs.scene.time.step
    instants = rate * (step * np.arange(1.0, runs.scene.time.steps + 1) - late * step)
    if instants[-1] > dense.time[-1]:
        return None
    return {name: _at(dense, name, instants) if name in group else x for name, x in plain.items()}


def _at(dense: History, name: str, instants: Array) -> Array:
    from scipy.interpolate import CubicSpline

    time, column = np.concatenate([[0.0], dense.time]), np.concatenate([[0.0], dense.columns[name]])
    values = CubicSpline(time, column)(np.maximum(instants, 0.0))
    return np.asarray(values, dtype=np.float64)
