r"""The study `meeting`: scenes of `[plane]` beside scenes of `[block]` and `[column]` that state the same problem.

`meeting-NAME-plane` stands beside `meeting-NAME-block` or `meeting-NAME-column`, case by case. Three things can be
said:

1. One model, stepped by two programs: places agree to n eps L, forces to that times the spring, with n steps and L the
   largest coordinate: each step rounds places, and a spring multiplies what is rounded.
2. The block that turns has its inertia from its outline at rest, the plane has it from the outline as it is strained
   (`dda.plane.bodies`: J = tr U S U, centrifugal forces). What lies between is a multiple of the strain, 1/E; the next
   term is of springs and block in series, a share p/E of it.
3. Small motion keeps the directions and arms of t = 0, which change with the load N: by the turn, N h over its
   stiffness p l^2 / 2, by sinking, N / (p h), by strain, N / (E l), twice that while the block swings. What
   lies between is, over the motion, a multiple of the load; the next term is that share of it.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.models.plane.canon import moving_blocks, stiffness_of
from validation.models.plane.tables import PlaneSection
from validation.runs.history import Array, History
from validation.runs.row import Metrics, Value
from validation.scenes.scene import Scene
from validation.suite.bands import Band, Bands, cases
from validation.theory.spectra import EPS

SAME = ("locked", "drop", "land", "stack", "weight", "cradle", "tower")  # one model
BY_STRAIN = ("rocking", "sliding", "falling", "spinning")  # swept over E and, ten times, E
BY_LOAD = ("leaning", "slope", "row")  # swept over a load and half of it
SPECIAL = {"stack": "column", "weight": "column", "cradle": "column"}  # of the others "block"


def pairs_of(name: str) -> list[tuple[Scene, Scene]]:
    """Return the cases of a scene in the plane, each with the special body's."""
    special = cases(f"meeting-{name}-{SPECIAL.get(name, 'block')}")
    return list(zip(cases(f"meeting-{name}-plane"), special, strict=True))


def derived() -> DerivedRows:
    """Return the rows that compare two bodies: a case of the plane, and two cases of a sweep."""
    rows = []
    for name in SAME + BY_STRAIN + BY_LOAD:
        for plane, special in pairs_of(name):
            needs = ((plane.name, "dda"), (special.name, "dda"))
            rows.append(Derived(plane.name, "special", needs, partial(differences, plane, special)))
    for name in BY_STRAIN + BY_LOAD:
        pairs = pairs_of(name)
        for large, small in zip(pairs[::2], pairs[1::2], strict=True):
            cases_needed = [case.name for case in (*large, *small)]
            histories = tuple((case, "dda") for case in cases_needed)
            rows.append(Derived(large[0].name, "order", histories, partial(order, name, large, small)))
    return tuple(rows)


def swept() -> list[Scene]:
    """Return the cases that own the row `order`: of each compared two the first."""
    return [pair[0] for name in BY_STRAIN + BY_LOAD for pair in pairs_of(name)[::2]]


# ---- two histories ----


def in_plane(plane: History, column: str) -> Array:
    """Return the values of the plane [m, rad, N] for a column of the special body.

    ``displacement_k`` and ``force_(k + 3)`` are of block ``bk`` of three and of the contact below it; a block that is
    cut has an odd number of parts, whose middle one has its centroid.
    """
    name, _, number = column.rpartition("_")
    if name == "displacement":
        return plane.columns[f"b{number}.y"]
    if name == "force":
        return contact_force(plane, f"b{int(number) - 3}.")
    if column == "contact_pressure":
        return contact_force(plane, "block")
    part = {"displacement": "y", "horizontal_displacement": "x", "rotation": "angle"}[column]
    (values,) = (values for name, values in plane.columns.items() if name.endswith(f".{part}"))
    return values


def contact_force(plane: History, block: str) -> Array:
    """Return the sum of the normal forces of a block's corners [N]."""
    forces = [values for name, values in plane.columns.items() if name.startswith(block) and name.endswith(".normal")]
    total: Array = np.sum(forces, axis=0)
    return total


def differences(case: Scene, special: Scene, finished: Finished) -> Metrics:
    """Return how far a case of the plane is from the special body: places and turns since the first row, and forces.

    ``place`` is over the largest coordinate, ``force`` over the spring times it; ``displacement`` and ``rotation`` are
    over the largest of the special body.
    """
    plane, other = (finished.needed_history(each.name, "dda") for each in (case, special))
    largest: dict[str, float] = {}
    apart: dict[str, float] = {}
    for column, values in other.columns.items():
        ours = in_plane(plane, column)
        if "force" in column or "pressure" in column:
            quantity = "force"
            values = values * (1.0 if special.kind.feature else special.block.base_length)  # a column is of unit width
        else:
            quantity = "rotation" if column == "rotation" else "displacement"
            ours = ours - ours[0]
            values = values - values[0]
        largest[quantity] = max(largest.get(quantity, 0.0), float(np.max(np.abs(values))))
        apart[quantity] = max(apart.get(quantity, 0.0), float(np.max(np.abs(ours - values))))
    size = largest_coordinate(case)
    found = {
        "place": apart["displacement"] / size,
        "force": apart["force"] / (stiffness_of(case) * size),
        "displacement": apart["displacement"] / largest["displacement"],
    }
    if largest.get("rotation"):
        found["rotation"] = apart["rotation"] / largest["rotation"]
    return found


def order(name: str, large: tuple[Scene, Scene], small: tuple[Scene, Scene], finished: Finished) -> Metrics:
    """Return the order in the strain, or in the load, of what lies between the two bodies over their motion."""
    first, second = (differences(*pair, finished) for pair in (large, small))
    ratio = 10.0 if name in BY_STRAIN else 2.0
    quantity = "rotation" if "rotation" in first else "displacement"
    return {quantity: math.log(_number(first[quantity]) / _number(second[quantity])) / math.log(ratio)}


def _number(value: Value) -> float:
    if not isinstance(value, float):
        raise ValueError(f"must be a number, got {value!r}")
    return value


# ---- bands ----


def largest_coordinate(case: Scene) -> float:
    """Return the largest coordinate of a moving block [m]."""
    return float(max(np.max(np.abs(block.vertices)) for block in moving_blocks(case)))


def rounding(case: Scene) -> Band:
    """Return n eps: places that n steps round, over the largest coordinate."""
    return 0.0, case.time.steps * EPS


def first_order(case: Scene) -> Bands:
    """Return 1 -/+ the next term's share, of the row `order` of a case: p/E by strain, what changes arms by load."""
    plane = case.table(PlaneSection)
    name = case.name.split("-")[1]
    if name in BY_STRAIN:
        half = stiffness_of(case) / plane.young / math.log(10)
        return {"rotation": (1 - half, 1 + half)}
    outline = np.concatenate([block.vertices for block in moving_blocks(case)])
    length, height = np.ptp(outline, axis=0)
    weight = plane.density * length * height * -plane.gravity[1]
    pressed = sum(math.dist(*load.edge) * -load.traction[1] for load in plane.load if load.edge and load.traction)
    force = weight + pressed
    spring = stiffness_of(case) * len(plane.touch) / 2  # of the corners on one side
    by_turn = force * height / (spring * length**2 / 2)
    by_sinking = force / (spring * height)
    by_strain = force / (plane.young * length)
    share = by_turn + by_sinking + by_strain
    half = 2 * share / math.log(2)
    return {"displacement" if name == "row" else "rotation": (1 - half, 1 + half)}
