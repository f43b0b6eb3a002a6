"""The ways to read a history's steps, signs and units, the likeliest first."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from validation.diagnosis.constants import UNIT_POWERS
from validation.diagnosis.fits.bar import last_digits
from validation.diagnosis.reading import FIELDS, Foreign, Stepping, steppings
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant
from validation.metrics.values import largest
from validation.runs.columns import unit_of
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.units import ratios
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.history_table import HeaderNames
from validation.solvers.registry import by_role, get_solver

POSITIVE = {DISPLACEMENT: "upwards", PRESSURE: "compression"}  # what is positive in a column
NEAR_POWER = 0.5  # given: of the exponent: the nearest power of ten
NEAR = 3.5  # powers of ten, a thousand and a half: swapped columns are so near to each other's size, not to their own


@dataclass(frozen=True)
class Slip:
    """An error of sign or unit in a column: what its values are over what they should be."""

    cause: str  # "sign" or "unit"
    column: str
    factor: float  # -1, or a power of ten

    @property
    def words(self) -> str:
        """The slip in words."""
        name = self.column.replace("_", " ")
        if self.cause == "sign":
            return f"the sign of the {name} is reversed: {POSITIVE.get(self.column, 'along the load')} is positive"
        unit = ratios("s" if self.column == "time" else unit_of(self.column)).get(self.factor)
        return f"the {name} is in other units, {self.factor:g} times the scene's" + (f" ({unit}?)" if unit else "")


def remedy_of(foreign: Foreign, slips: Sequence[Slip]) -> str:
    """Return the option by which a history is read without its errors of sign and unit, empty if it has none."""
    scale = foreign.header.factors
    factors: dict[str, float] = {}
    for slip in slips:
        factors[slip.column] = factors.get(slip.column, scale.get(slip.column, 1.0)) / slip.factor
    typed = {name: factor for name, factor in scale.items() if factor != 1} | factors
    return f"--scale {','.join(f'{name}={factor:g}' for name, factor in typed.items())}" if factors else ""


def words_of_slips(slips: Sequence[Slip]) -> dict[str, str]:
    """Return the words of the errors of sign and of unit, by their causes."""
    causes = sorted({slip.cause for slip in slips})
    return {cause: " and ".join(slip.words for slip in slips if slip.cause == cause) for cause in causes}


def exchanged(foreign: Foreign, first: str, second: str) -> Foreign:
    """Return a history with two columns in each other's place."""
    header = foreign.header
    others = {first: second, second: first}
    theirs = {name: header.theirs.get(other, other) for name, other in others.items()}
    factors = {name: header.factors.get(other, 1.0) for name, other in others.items()}
    columns: dict[str, Any] = {FIELDS[name]: foreign.column(other) for name, other in others.items()}
    roundings = {others.get(name, name): unit for name, unit in foreign.roundings.items()}
    header = HeaderNames({**header.theirs, **theirs}, {**header.factors, **factors})
    return replace(foreign, **columns, roundings=roundings, header=header)


def has_swapped_columns(scene: Scene, foreign: Foreign) -> bool:
    """Whether displacement and pressure have each other's size, and far from their own."""
    if foreign.pressure is None or largest(foreign.displacement) <= largest(foreign.pressure):
        return False  # metres are smaller numbers than pascals
    run = get_solver(by_role(Role.JUDGED)[0]).solve(scene)
    if run.history is None:
        return False
    with np.errstate(all="ignore"):
        expected = np.log10([largest(run.displacement), largest(run.contact_pressure)])
        recorded = np.log10([largest(foreign.displacement), largest(foreign.pressure)])
        near = np.abs(recorded[::-1] - expected) < NEAR
        far = np.abs(recorded - expected) > NEAR
    return bool(np.all(near & far))


@dataclass(frozen=True, eq=False)
class Reading:
    """A history as it is read: its steps, with errors of sign and unit corrected."""

    stepping: Stepping
    recorded: Array  # the displacement [m] and, if given, another column, (columns, rows)
    rounding: Array | None = None  # units of their last digits, seen from the values if not given
    corrected: tuple[Slip, ...] = ()

    @property
    def displacement(self) -> Array:
        """The displacement [m]."""
        return np.asarray(self.recorded[0])

    @property
    def slips(self) -> tuple[str, ...]:
        """Ids of the errors of sign and unit that were corrected, each once."""
        return tuple(sorted({slip.cause for slip in self.corrected}))

    @property
    def notes(self) -> tuple[str, ...]:
        """What differs in the times, and what was corrected."""
        return (*filter(None, [self.stepping.note]), *(slip.words for slip in self.corrected))

    def scene_of(self, scene: Scene) -> Scene:
        """Return the scene at the steps of the history, which are equal."""
        return scene.with_values(
            {
                "time.step": float(self.stepping.steps[0]),
                "time.steps": len(self.stepping.steps),
                "run.columns": ["displacement", "contact_pressure"],
            }
        )


def readings_of(scene: Scene, column: Rectangle, scene_variant: Variant, foreign: Foreign) -> list[Reading]:
    """Return the ways to read a history's steps, sign and units."""
    readings = []
    for stepping in steppings(foreign, scene.time.step):
        expected = histories(column, [scene_variant], stepping.steps)
        readings += slips(
            foreign, stepping, expected.displacement[stepping.rows, 0], expected.pressure[stepping.rows, 0]
        )
    return readings


def slips(foreign: Foreign, stepping: Stepping, reference: Array, contact: Array) -> list[Reading]:
    """Return the readings without slips of sign and unit, as sizes beside the scene's own history suggest."""
    of_pressure = [(1.0, 1.0)]
    if foreign.pressure is not None and np.any(foreign.pressure):
        first = _factors(foreign.pressure, contact)[0]
        of_pressure = list(dict.fromkeys([first, (first[0], 1.0), (1.0, 1.0)]))
    of_displacement = _factors(foreign.displacement, reference)
    readings = [
        without_slips(foreign, stepping, {DISPLACEMENT: own, PRESSURE: other})
        for own, other in product(of_displacement, of_pressure)
    ]
    # the one that corrects least is among the first two: wrong data look like wrong units
    plain = min(readings, key=lambda reading: len(reading.corrected))
    others = [reading for reading in readings if reading is not plain]
    return [plain, *others] if readings[0] is plain else [others[0], plain, *others[1:]]


AS_IT_IS = dict.fromkeys((DISPLACEMENT, PRESSURE), (1.0, 1.0))


def without_slips(
    foreign: Foreign, stepping: Stepping, factors: Mapping[str, tuple[float, float]] = AS_IT_IS
) -> Reading:
    """Return a history without a sign and a power of ten in each of some columns."""
    corrected = [Slip("unit", "time", stepping.factor)] if stepping.factor != 1 else []
    columns = []
    units = []
    for name, (sign, factor) in factors.items():
        values = foreign.column(name)
        if values is None:
            continue
        # units of the last digits as in the file: in other units they are not seen
        unit = foreign.roundings.get(name)
        if unit is None:
            unit = last_digits(values)
        columns.append(values * sign / factor)
        units.append(unit / factor)
        corrected += [Slip("sign", name, -1.0)] if sign < 0 else []
        corrected += [Slip("unit", name, factor)] if factor != 1 else []
    return Reading(stepping, np.array(columns), np.array(units), tuple(corrected))


def _factors(values: Array, reference: Array) -> list[tuple[float, float]]:
    """Return the sign and the powers of ten by which values may be off, the likeliest first."""
    with np.errstate(all="ignore"):
        bounded = np.nan_to_num(reference)
        sign = -1.0 if float(values @ bounded) < 0 else 1.0
    ratio = math.log10(largest(values) / (largest(bounded) or 1.0) or 1.0)
    near = [10.0**power for power in UNIT_POWERS if abs(ratio - power) < NEAR_POWER]
    return [(turn * sign, factor) for turn in (1.0, -1.0) for factor in (*near, 1.0)]
