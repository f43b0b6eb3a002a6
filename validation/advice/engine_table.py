"""Contact parameters of other programs: one description of each, for both directions, and the defaults."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from validation.advice.limits import Limit

GRAVITY = 9.81  # m/s2
BOX2D_LIMIT = 0.125  # of the rate of substeps: the greatest hertz of a contact between moving bodies
BOX2D_STATIC = 2.0  # a contact with a static body has this many times the hertz
MUJOCO_STEPS = 2.0  # steps that timeconst must have
MUJOCO_IMPEDANCES = (0.0001, 0.9999)  # into which MuJoCo clips dmin and dmax


Settings = dict[str, float | tuple[float, ...]]


@dataclass(frozen=True)
class Parameter:
    """A number of a program, and what it is as spring and dashpot."""

    name: str
    unit: str = ""
    meaning: str = ""
    formula: str = ""  # of the spring and the dashpot on an effective mass m
    default: tuple[float, ...] = ()  # of the program; empty where it has none
    limit: Limit | None = None  # None where other numbers decide
    absent: str | None = None  # what to say where it must be stated
    option: dict[str, Any] = field(default_factory=dict)  # help and metavar of the option of `translate`


@dataclass(frozen=True)
class Program:
    """Contact of a program: its parameters, its step, and where that is written."""

    name: str
    title: str
    version: str  # with which the formulas were checked
    points: int  # contact points of a flat box on flat ground
    parameters: tuple[Parameter, ...]
    source: str
    step: float | None = None  # s, as it comes: the one over which a contact is solved; None where it must be stated

    def default(self, name: str) -> tuple[float, ...]:
        """Return the default of a parameter, of one number or of several."""
        return next(one.default for one in self.parameters if one.name == name)

    @property
    def defaults(self) -> Settings:
        """The parameters that have a default."""
        stated = {one.name: one.default for one in self.parameters if one.default}
        return {name: numbers if len(numbers) > 1 else numbers[0] for name, numbers in stated.items()}


def _programs() -> dict[str, Program]:
    """Return the programs of the table beside this module, and "spring", the numbers of the suite itself."""
    programs = {}
    for name, entry in tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")).items():
        parameters = []
        for parameter, stated in entry.pop("parameters").items():
            limit = Limit(parameter, **stated.pop("limit")) if "limit" in stated else None
            default = tuple(stated.pop("default", ()))
            parameters.append(Parameter(parameter, default=default, limit=limit, **stated))
        programs[name] = Program(name, parameters=tuple(parameters), **entry)
    return programs


TRANSLATED = _programs()
PROGRAMS = {name: program for name, program in TRANSLATED.items() if name != "spring"}
PARAMETERS = {name: tuple(one.name for one in program.parameters) for name, program in TRANSLATED.items()}
OPTIONAL = {"dmax", "damping", "restitution"}  # where a program has no default
