"""Columns whose exact motion is known to all digits of doubles, and how to step them."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dda import Scheme
from dda.column.column import Column, Layer, Spring
from dda.column.contacts import ColumnContactResult, ColumnOptions, solve_contact_column
from dda.column.stepping import Drive

Motion = Callable[[np.ndarray], Drive]


class ColumnCase(NamedTuple):
    """A column, its drive, and what its blocks' middles (and joints) have done at an instant."""

    column: Column
    drive: Motion
    until: float
    exact: dict[str, float]  # a column of a history to its value at `until`; at a height by its number in `heights`
    heights: list[float]
    settled: bool = False


def nothing(t: np.ndarray) -> Drive:
    return Drive(0 * t, 0 * t, 0 * t, 0 * t)


def half_sine_on_top(t: np.ndarray) -> Drive:
    return Drive(0 * t, 0 * t, 0 * t, np.where(t < 0.004, 2e6 * np.sin(np.pi * t / 0.004), 0.0))


def wave(size: float) -> Motion:
    return lambda t: Drive(0 * t, np.where(t < 0.05, size * np.sin(np.pi * t / 0.05), 0.0), 0 * t, 0 * t)


def shaken(size: float, w: float) -> Motion:
    return lambda t: Drive(size * np.sin(w * t), size * w * np.cos(w * t), -size * w * w * np.sin(w * t), 0 * t)


def layers(heights: list[float], density: list[float], young: list[float], velocity: list[float]) -> list[Layer]:
    return [Layer(h, rho, E, 0.0, 1, v) for h, rho, E, v in zip(heights, density, young, velocity, strict=True)]


def unilateral(blocks: list[Layer], stiffness: list[float], gaps: list[float], gravity: float = 9.81) -> Column:
    """Return a column on contacts from the base upwards; one contact fewer than blocks: nothing is below."""
    feet = np.cumsum([0.0, *(layer.thickness for layer in blocks)])[:-1]
    free = len(stiffness) < len(blocks)
    joints = [Spring(float(x), k, g) for x, k, g in zip(feet[int(free) :], stiffness, gaps, strict=True)]
    return Column(blocks, law="unilateral", joints=joints, gravity=gravity, unsupported=free)


def frictional(
    blocks: list[Layer], stiffness: list[float], strength: list[float], impedance: float | None = None
) -> Column:
    """Return a column of frictional contacts: one fewer than blocks on a half-space."""
    feet = np.cumsum([0.0, *(layer.thickness for layer in blocks)])[:-1]
    above = feet[len(blocks) - len(stiffness) :]
    joints = [Spring(float(x), k, strength=s) for x, k, s in zip(above, stiffness, strength, strict=True)]
    return Column(blocks, motion="shear", law="frictional", joints=joints, impedance=impedance)


def middles(blocks: list[Layer]) -> list[float]:
    feet = np.cumsum([0.0, *(layer.thickness for layer in blocks)])
    return [float(x) for x in (feet[1:] + feet[:-1]) / 2]


def case(column: Column, drive: Motion, until: float, settled: bool = False, **exact: list[float | None]) -> ColumnCase:
    """Return a case; `exact` holds values of the blocks' middles, and of the joints from the lowest for `slip`."""
    heights = middles(list(column.layers))
    values = {}
    for part, row in exact.items():
        shift = len(heights) if part == "slip" else 0
        values.update({f"{part}_{shift + k + 1}": value for k, value in enumerate(row) if value is not None})
    return ColumnCase(column, drive, until, values, [*heights, *(joint.height for joint in column.joints)], settled)


RIGID, INF = math.inf, math.inf
SHAKE = 1.5 * 9.81 / (4 * np.pi) ** 2
SIX = layers([2.0] * 6, [2000.0] * 6, [4e8] * 6, [0.0] * 6)
FOUR = layers([1.0] * 4, [2500.0] * 4, [RIGID] * 4, [0.004 * 10 * np.pi] * 4)
UNLIKE = layers([0.5, 1.0, 2.0, 0.8], [2600.0, 2400.0, 2000.0, 2700.0], [3e9, 1e9, 5e8, 2e9], [-2.0] * 4)
STATIC_STRENGTH = [math.tan(math.pi / 6) * 2000 * 9.81 * 2 * (6 - joint) for joint in range(1, 6)]

CASES = {
    "A1": case(
        unilateral(layers([1.0] * 2, [2500.0] * 2, [1e9] * 2, [-1.0] * 2), [2e9, 1e9], [0.01, 0.001]),
        nothing,
        0.04,
        displacement=[0.008074626541482, 0.01092205296678],
        velocity=[0.7340446240766, 0.970801139392],
    ),
    "A2": case(
        unilateral(layers([1.0] * 5, [2500.0] * 5, [RIGID] * 5, [-1.0] * 5), [1e9] * 5, [0.005] + [0.0005] * 4),
        nothing,
        0.06,
        displacement=[0.01074499902223, 0.02156223743775, 0.02493494560588, 0.02665347708404, 0.03962539027349],
        velocity=[0.279686156761, 0.6061844245853, 0.7102532905343, 0.7510792363255, 1.030656757347],
    ),
    "A3": case(
        unilateral(layers([1.0] * 6, [2500.0] * 6, [1e9] * 6, [0.0] * 6), [1e10] * 6, [0.0] * 6),
        half_sine_on_top,
        0.01,
        settled=True,
        displacement=[
            -0.0009942924468433,
            -0.002645196854866,
            -0.003649613067974,
            -0.00387598727646,
            -0.003721306803229,
            -0.003449320491917,
        ],
    ),
    "A4": case(
        unilateral(layers([0.1, 10.0], [2500.0, 25000.0], [RIGID] * 2, [-1.0] * 2), [1e9] * 2, [0.001] * 2),
        nothing,
        0.03,
        displacement=[-0.01331442988, -0.02701654185475],
        velocity=[-1.564685134011, -0.5262339909032],
    ),
    "A5": case(
        unilateral(layers([1.0] * 10, [2500.0] * 10, [RIGID] * 10, [0.0] * 10), [1e9] * 10, [0.0] * 10),
        nothing,
        0.1,
        displacement=[-0.0004361966268446, *[None] * 8, -0.002651420005761],
    ),
    "A6": case(
        unilateral(layers([1.0] * 3, [2500.0] * 3, [1e8] * 3, [-SHAKE * 4 * np.pi] * 3), [1e8] * 3, [0.0] * 3),
        shaken(-SHAKE, 4 * np.pi),
        0.65,
        settled=True,
        displacement=[-0.08370234214322, -0.09190361830169, -0.09208629666771],
    ),
    "A7": case(
        unilateral(layers([1.0] * 5, [2500.0] * 5, [RIGID] * 5, [1.0, 0.0, 0.0, 0.0, 0.0]), [1e9] * 4, [0.0] * 4, 0.0),
        nothing,
        0.01,
        velocity=[-0.1322794847097, -0.07532916980257, -0.03101082901403, 0.2962177501414, 0.9424017333849],
    ),
    "A8": case(
        unilateral(UNLIKE, [4e9, 2e9, 1e9, 3e9], [0.002, 0.0003, 0.0002, 0.0001]),
        nothing,
        0.05,
        displacement=[0.01648849799093, 0.03774289485277, 0.05575324838637, 0.07643618678455],
        velocity=[0.3657343078984, 1.15723170612, 1.688731180854, 2.469539064854],
    ),
    "S1": case(
        frictional(SIX, [1e9] * 5, STATIC_STRENGTH, 2200 * 600.0),
        wave(0.6),
        0.4,
        displacement=[
            0.03817432077212,
            0.01419732135455,
            0.01194783587378,
            0.01080085289231,
            0.009353967732387,
            0.006960094591269,
        ],
        slip=[-0.0239896443309, -0.00226009928592, -0.00115601241612, -0.00145104920254, -0.00239640243354],
    ),
    "S2": case(
        frictional(SIX, [1e10, 1e10, 1e9, 1e10, 1e10], [INF, INF, 1e5, INF, INF], 2000 * 1e5**0.5),
        wave(0.5),
        0.05,
        displacement=[0.01720274822009, None, None, None, None, 0.002934989773856],
    ),
    "S3": case(
        frictional(FOUR, [5e8] * 4, [3e4, 2e4, 1.2e4, 5e3]),
        shaken(0.004, 10 * np.pi),
        0.25,
        displacement=[0.00409179201875, 0.004223236721786, 0.004481946923429, 0.00553559592065],
    ),
}


def stepped_case(
    case: ColumnCase, weights: tuple[float, float], steps: int, gg: float = 1.0, start: str = "consistent"
) -> ColumnContactResult:
    """Return the history of a case in so many steps."""
    step = case.until / steps
    scheme = Scheme(*weights, gg, step, start)  # type: ignore[arg-type]
    drive = case.drive(step * np.arange(steps + 1))
    return solve_contact_column(
        case.column, scheme, drive, list(case.exact), case.heights, ColumnOptions(settled=case.settled)
    )


def error_of(case: ColumnCase, weights: tuple[float, float], steps: int) -> float:
    """Return the largest error at the end over the largest value, of each kind of column."""
    result = stepped_case(case, weights, steps)
    assert result.outcome == "completed"
    errors = []
    for part in {name.rpartition("_")[0] for name in case.exact}:
        names = [name for name in case.exact if name.startswith(part)]
        exact = np.array([case.exact[name] for name in names])
        stepped = np.array([result.columns[name][-1] for name in names])
        errors.append(np.abs(stepped - exact).max() / np.abs(exact).max())
    return float(max(errors))
