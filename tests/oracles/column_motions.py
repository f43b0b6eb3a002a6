"""The columns of `column_motions.toml`, whose contacts open or slip, with numbers of an independent program."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

from fem_reference.events import column_drive as drives
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem

RIGID = math.inf


@dataclass(frozen=True)
class KnownColumn:
    """A column and what is known of its motion."""

    problem: ColumnProblem
    end: float  # [s]
    count: int  # of all switches
    switches: str  # the first ones
    values: list[tuple[float, str, str]]  # instant, what of the history, a number for each block (joint)
    last: str = ""  # the last ones


def blocks(count, density, modulus, velocity=0.0, height=1.0):
    """Equal blocks."""
    return (ColumnBlock(height, density, modulus, velocity),) * count


def kind_of(kind, sign):
    """The letter of a switch."""
    return {"opens": "O", "closes": "C", "sticks": "K", "slips": "+" if sign > 0 else "-"}[kind]


def half_unit(printed):
    """Half a unit of the last printed digit."""
    number = Decimal(printed)
    return Decimal(1).scaleb(number.as_tuple().exponent) / 2


def drive_of(shape, numbers, **more):
    return getattr(drives, shape)(*numbers, **more)


def known_column(end, count, switches, values, last="", **tables):
    """Return a column of the file."""
    problem = dict(tables)
    problem["blocks"] = sum((blocks(**({"count": 1} | block)) for block in tables["blocks"]), ())
    joints = []
    for joint in tables["joints"]:
        number = joint.pop("count", 1)
        joints += [ColumnJoint(**joint) if joint else None] * number
    problem["joints"] = tuple(joints)
    if "base_motion" in tables:
        problem["base_motion"] = drives.integrated(drive_of(**tables["base_motion"]))
    if "pressure" in tables:
        problem["pressure"] = drive_of(**tables["pressure"])
    return KnownColumn(ColumnProblem(**problem), end, count, switches, values, last)


TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
COLUMNS = {name: known_column(**table) for name, table in TABLES.items()}
