"""Scenes of one's own as text: what `dda-validate new` writes, with springs and steps that fit the block."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from validation.advice.limits import Limit, check_choice
from validation.errors import InputError
from validation.runs.numbers import significant

TABLES: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
ROCKS: dict[str, dict[str, float]] = TABLES["rock"]
KINDS = tuple(TABLES["text"])
SPRING_SHARE = 0.05  # of what the block shortens to its middle, by which springs give way
FIRST_OMEGA_DT = 0.2  # w dt of the first mode, at which constant acceleration damps it at w dt / 4 = 5 %
BLOCKS_OF_WAVELENGTH = 10
STEPS_OF_PERIOD = 40
LIMITS = {  # of the numbers that may be no arbitrary positive ones
    "pressure": Limit("--pressure", "must be finite", above=-math.inf),
    "slope": Limit("--slope", "must be above -90 and below 90 degrees", above=-90.0, below=90.0),
    "friction": Limit("--friction", "must be from 0 to below 90 degrees", below=90.0, ends=(0.0,)),
}


def draft(options: Mapping[str, Any], ask: Callable[[str, float], float]) -> str:
    """Return the text of a scene file.

    Parameters
    ----------
    options
        `kind` and `rock` by name, block and granite if absent, and numbers by the names of the kind's questions.
    ask
        Returns the answer to a question, given its default.

    Raises
    ------
    InputError
        A name is unknown, a number is out of range, or the kind has no such number.
    """
    kind = options.get("kind", "block")
    rock = options.get("rock", "granite")
    check_choice("--kind", kind, KINDS)
    check_choice("--rock", rock, ROCKS)
    questions = TABLES[kind]
    for name in options:
        if name not in ("kind", "rock", *questions):
            listed = ", ".join(f"--{question}" for question in questions)
            raise InputError(f"does not go with --kind {kind}, which takes {listed}", field=f"--{name}")
    numbers: dict[str, float] = {}
    for name, (question, default) in questions.items():
        numbers[name] = float(options[name]) if name in options else ask(question, default)
        LIMITS.get(name, Limit(f"--{name}")).check(numbers[name])
    material = ROCKS[rock]
    numbers |= material | _derived(kind, numbers, material)
    words = {name: _written(value) for name, value in numbers.items()}
    text: str = TABLES["text"][kind]
    return text.lstrip().format(rock=rock, **words)


def _derived(kind: str, numbers: Mapping[str, float], material: Mapping[str, float]) -> dict[str, Any]:
    """Return what follows of size and material: springs, blocks and steps."""
    young = material["young"]
    height = numbers["height"]
    if kind == "column":
        speed = math.sqrt(young / (2 * (1 + material["poisson"]) * material["density"]))
        frequency = numbers["frequency"]
        step = significant(1 / (STEPS_OF_PERIOD * frequency), 2)
        duration = 4 / frequency + 4 * height / speed  # the pulse, and its way up and down
        blocks = max(4, math.ceil(BLOCKS_OF_WAVELENGTH * height * frequency / speed))
        return {"speed": significant(speed, 4), "blocks": blocks, "step": step, "steps": math.ceil(duration / step)}
    width = numbers["width"]
    if kind == "beam":
        shorter = min(width, height)
        return {"subdivide": [4 * max(1, round(length / shorter)) for length in (width, height)]}
    first = math.sqrt(3 * young / material["density"]) / height  # of one strain on a rigid base
    stiffness = young * width / (height * SPRING_SHARE)
    return {"stiffness": significant(stiffness, 2), "step": significant(FIRST_OMEGA_DT / first, 2)}


def _written(value: Any) -> str:
    """Return a value as TOML: a large or small number with its power of ten, a count without a point."""
    if not isinstance(value, float):
        return repr(value)
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return repr(value)
    mantissa, power = f"{value:e}".split("e")
    return f"{float(mantissa)!r}e{int(power)}"
