"""The band of an answer: what one per cent of the scene's data changes in the exact motion.

Data of a block are not known to better than one per cent. An error of an answer that is smaller than what such a per
cent does to the exact motion changes nothing for who uses the answer; a larger one does.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.diagnosis.hooks import DiagnosisHooks
from validation.diagnosis.numbers import Values
from validation.metrics.values import largest
from validation.models.column.tables import ColumnSection
from validation.problems.numbered import UNKNOWN
from validation.problems.problem import Problem, ProblemHooks
from validation.problems.truth import exact, truth_of
from validation.runs.history import Array, History
from validation.runs.numbers import share_text
from validation.scenes.scene import Scene

# What one per cent of a datum moves further than this is not determined by the data any more: an answer of zeros, whose
# error is 1, must not come near to it. The column is judged up to the instant at which that happens.
LARGEST = 0.2
LEAST = 4  # rows that are judged, at least
# A change below that is rounding of the exact motion (1e-7 in a column's) or of printed numbers (six digits).
ROUNDED = 1e-6
DRIVE = "what drives it"  # the datum of a motion that no other one changes


@dataclass(frozen=True, eq=False)
class Band:
    """The band [0, `high`] of the relative L2 error of a column."""

    high: float  # upper edge [1]
    datum: str  # of which one per cent changes the column most
    rows: int  # of the exact motion that are judged
    until: float  # instant of the last of them [s]

    @property
    def reason(self) -> str:
        """Why the band ends there."""
        if self.datum == DRIVE:
            return (
                "no datum of block, layers or contact changes the exact motion: it is in proportion to what drives it "
                f"(loads, velocity, base), of which {share_text(self.high, 2)} changes it by as much"
            )
        return (
            f"one per cent of {self.datum} changes the exact motion by {share_text(self.high, 2)}: data of a block are "
            "not known to better than one per cent, an error below that changes nothing for its user"
        )


@dataclass(frozen=True, eq=False)
class Standard:
    """What answers to a problem are held against: the exact motion, those of changed data, and the bands of columns.

    A column whose exact motion is zero throughout has no band: no relative error of it exists.
    """

    exact: History
    changed: Mapping[str, History]  # name of a datum to the exact motion with it one per cent larger
    bands: Mapping[str, Band]  # column to band


# The data that are not known to better than one per cent, and their names. Not among them: loads, which scale a linear
# motion by themselves; the velocity, gap, tilt and slope from which a scene starts and its height, which are the
# question that it asks; what a column's base is made of.
DATA = {
    "springs-factor": "the springs",
    "young-factor": "Young's modulus",
    "density-factor": "the density",
    "width-factor": "the width",  # of a rectangle: its slenderness, by which it rocks
    "friction-factor": "tan(phi) of friction",
}


def changes(scene: Scene) -> dict[str, Values]:
    """Return what one per cent of each datum of a scene is: datum to keys and values."""
    own = ProblemHooks.of(scene).changes(scene)
    if own is not None:
        return own
    changed = {number.id: number.changed(1 + UNKNOWN) for number in DiagnosisHooks.of(scene).numbers(scene)}
    block = scene.stated_block
    if block is not None and block.vertices is not None:
        changed.pop("width-factor", None)
    return {name: changed[number] for number, name in DATA.items() if number in changed}


def contact_values(column: ColumnSection, stiffness: float = 1.0, strength: float = 1.0) -> Values:
    """Return the contacts of a column as joints of their own, their data larger by factors.

    Infinite data stay so; strengths of friction are stated as what they amount to.
    """
    values: Values = {}
    joints = []
    for contact in column.contacts:
        if contact.height == 0 and column.base_stiffness is not None:
            values["column.base_stiffness"] = contact.stiffness * stiffness
            continue
        joint: dict[str, Any] = {"height": contact.height, "stiffness": contact.stiffness * stiffness}
        if contact.gap:
            joint["gap"] = contact.gap
        if math.isfinite(contact.strength):
            joint["strength"] = contact.strength * strength
        joints.append(joint)
    if joints:
        values["column.joint"] = joints
    return values


def changed_scenes(scene: Scene) -> dict[str, Scene]:
    """Return the scene with each of its data one per cent larger."""
    return {name: scene.with_values(values) for name, values in changes(scene).items()}


def standard(problem: Problem) -> Standard:
    """Return what answers to a problem are held against, computed once a scene; InputError without an exact motion."""
    return _standard(problem.scene)


@functools.lru_cache(maxsize=32)
def _standard(scene: Scene) -> Standard:
    return standard_of(_motion(scene), {name: _motion(other) for name, other in changed_scenes(scene).items()})


def _motion(scene: Scene) -> History:
    return exact(scene, truth_of(scene))


def standard_of(motion: History, changed: Mapping[str, History]) -> Standard:
    """Return the standard of exact motions that are there already: the problem's and those of changed data."""
    bands = {}
    for name, column in motion.columns.items():
        band_of_column = band(motion.time, column, {datum: other.columns[name] for datum, other in changed.items()})
        if band_of_column is not None:
            bands[name] = band_of_column
    return Standard(motion, changed, bands)


def band(time: Array, column: Array, changed: Mapping[str, Array]) -> Band | None:
    """Return the band of a column; None where nothing of it can be judged.

    e_d(n) = ||x_d - x|| / ||x|| over the first n rows, d a datum; the rows that are judged are the most for which no
    e_d is larger than `LARGEST`, and the band ends at the largest e_d there. A motion that no datum changes, as free
    flight or sliding without friction, is in proportion to what drives it, of which it is judged to one per cent.
    """
    rows = min([len(column), *(len(other) for other in changed.values())])
    moved = {datum: moved_by(other[:rows], column[:rows]) for datum, other in changed.items()}
    if not moved or not np.any(column[:rows]):
        return None
    most = np.max([*moved.values()], axis=0)
    within: Sequence[int] = np.flatnonzero(most <= LARGEST).tolist()
    judged = within[-1] + 1 if within else 0
    if judged < LEAST:
        return None
    if most[judged - 1] < ROUNDED:
        return Band(UNKNOWN, DRIVE, judged, float(time[judged - 1]))
    datum = max(moved, key=lambda name: moved[name][judged - 1])
    return Band(float(most[judged - 1]), datum, judged, float(time[judged - 1]))


def moved_by(other: Array, column: Array) -> Array:
    """Return ||other - column|| / ||column|| over the first n rows, for every n; 0 where both are zero so far."""
    size = largest(column) or 1.0
    difference, size_so_far = (np.sqrt(np.cumsum(np.square(x / size))) for x in (other - column, column))
    return np.asarray(
        np.divide(difference, size_so_far, out=np.where(difference > 0, np.inf, 0.0), where=size_so_far > 0)
    )
