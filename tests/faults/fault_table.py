"""Seeded faults as a table, `studies/faults.toml`, whose functions are those of `faults.fault` and of a test."""

import functools
import tomllib
from pathlib import Path

from faults import fault, seams

TABLE = Path(__file__).parents[1] / "studies/faults.toml"


def faults_of(study, functions):
    """Return the faults of a table; what they are made by is looked up in ``functions`` too."""
    known = vars(fault) | functions
    faults = []
    for solvers, rows_by_seam in tomllib.loads(TABLE.read_text(encoding="utf-8"))[study].items():
        for seam, rows in rows_by_seam.items():
            for function, *arguments in rows:
                replacement = made(known[function], arguments, known) if arguments else known[function]
                name = f"{seam} {function} {arguments}"
                faults.append(fault.Fault(name, tuple(solvers.split()), getattr(seams, seam), replacement))
    return faults


def made(function, arguments, known):
    """Return what a function makes of arguments, of which the last may be a table of named ones."""
    named = arguments[-1] if isinstance(arguments[-1], dict) else {}
    places = arguments[: len(arguments) - bool(named)]
    by_name = {name: argument(value, known) for name, value in named.items()}
    return function(*(argument(value, known) for value in places), **by_name)


def argument(value, known):
    """Return what a text means: a function of this name, what is done to a value, or itself."""
    if not isinstance(value, str):
        return value
    sign, _, number = value.partition(" ")
    if sign in CHANGES:
        return functools.partial(CHANGES[sign], float(number))
    return known[value] if callable(known.get(value)) else value


def multiplied(number, value):
    return None if value is None else value * number


def added(number, value):
    return value + number


def replaced(number, value):
    return number


CHANGES = {"*": multiplied, "+": added, "=": replaced}
