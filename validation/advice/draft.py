"""Scenes of one's own as text: what `dda-validate new` writes, with springs and steps that fit the block."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from validation.advice.limits import Limit, check_choice
from validation.errors import InputError
from validation.runs.beside import table_beside
from validation.runs.numbers import significant

TABLES: dict[str, Any] = table_beside(__file__)
ROCKS: dict[str, dict[str, float]] = TABLES["rock"]
KINDS = tuple(TABLES["text"])
MOVING = tuple(TABLES["moving"]["title"])  # kinds of blocks in the plane that move
GLUED_BODIES = ("plate", "disc")  # of glued triangles, by one table each
SPRING_SHARE = 0.05  # of what the block shortens to its middle, by which springs give way
FIRST_OMEGA_DT = 0.2  # w dt of the first mode, at which constant acceleration damps it at w dt / 4 = 5 %
STATIC_TRAVELS = 1000  # of a wave along a body, in a step of statics: off by about a millionth
BLOCKS_OF_WAVELENGTH = 10
STEPS_OF_PERIOD = 40
SINK_SHARE = 1e-3  # of a block's height, by which one spring gives way under the weight of all blocks
RADIANS_OF_STEP = 1.0  # of a block on one spring
DIGITS = {"stiffness": 2, "step": 2, "speed": 4}  # of what follows; places have six
GRAVITY = 9.81  # m/s2
MOST_BLOCKS = 100  # of a wall's rows, so that 10,000 are drawn
LIMITS = {  # of the numbers that may be no arbitrary positive ones
    "pressure": Limit("--pressure", "must be finite", above=-math.inf),
    "slope": Limit("--slope", "must be above -90 and below 90 degrees", above=-90.0, below=90.0),
    "blocks": Limit("--blocks", f"must be from 2 to {MOST_BLOCKS}", above=1, below=MOST_BLOCKS + 1),
    "friction": Limit("--friction", "must be from 0 to below 90 degrees", below=90.0, ends=(0.0,)),
}


def draft(options: Mapping[str, Any], ask: Callable[[str, float], float]) -> str:
    """Return the text of a scene file; `ask` returns the answer to a question, given its default.

    `options` are `kind` and `rock`, block and granite if absent, and numbers by the names of the kind's questions.

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
    numbers: dict[str, Any] = {}
    for name, (question, default) in questions.items():
        numbers[name] = float(options[name]) if name in options else ask(question, default)
        LIMITS.get(name, Limit(f"--{name}")).check(numbers[name])
    if "blocks" in numbers:
        numbers["blocks"] = round(numbers["blocks"])
    material = ROCKS[rock]
    derived = _of_moving_blocks if kind in MOVING else _derived
    for name, value in derived(kind, numbers, material).items():
        numbers[name] = significant(value, DIGITS.get(name, 6)) if isinstance(value, float) else value
    numbers |= material
    words = {name: _written(value) for name, value in numbers.items()}
    text: str = TABLES["text"][kind]
    if kind in MOVING:
        moving = TABLES["moving"]
        text = f'title = "{moving["title"][kind]}"\n\n{moving["head"]}\n{text}\n{moving["tail"]}'
    return text.lstrip().format(rock=rock, **words)


def _derived(kind: str, numbers: Mapping[str, float], material: Mapping[str, float]) -> dict[str, Any]:
    young = material["young"]
    density = material["density"]
    width = numbers.get("width", 0.0)
    height = numbers.get("height", 0.0)
    if kind in GLUED_BODIES:
        return {"radius": width / 2, "step": STATIC_TRAVELS * max(width, height) * math.sqrt(density / young)}
    if kind == "column":
        speed = math.sqrt(young / (2 * (1 + material["poisson"]) * density))
        frequency = numbers["frequency"]
        step = significant(1 / (STEPS_OF_PERIOD * frequency), 2)
        duration = 4 / frequency + 4 * height / speed  # the pulse, and its way up and down
        blocks = max(4, math.ceil(BLOCKS_OF_WAVELENGTH * height * frequency / speed))
        return {"speed": significant(speed, 4), "blocks": blocks, "step": step, "steps": math.ceil(duration / step)}
    if kind == "beam":
        shorter = min(width, height)
        return {"subdivide": [4 * max(1, round(length / shorter)) for length in (width, height)]}
    first = math.sqrt(3 * young / density) / height  # of one strain on a rigid base
    return {"stiffness": young * width / (height * SPRING_SHARE), "step": FIRST_OMEGA_DT / first}


def _of_moving_blocks(kind: str, numbers: Mapping[str, Any], material: Mapping[str, float]) -> dict[str, Any]:
    """Return what follows for blocks in the plane that move: places, springs by their weight, and steps."""
    width = numbers["width"]
    height = numbers.get("height", width)
    blocks = numbers["blocks"]
    count = blocks**2 if kind == "wall" else blocks
    size = width * height
    inner = math.ceil(math.sqrt(blocks)) * width  # of a box so wide that the pile is about as high
    if kind == "arch":
        size = math.pi * width / 2 * height / blocks
    mass = material["density"] * size
    stiffness = significant(count * mass * GRAVITY / (SINK_SHARE * height), 2)
    falls = kind == "pile"  # in whose lower half the blocks begin
    places = {
        "stack": {"floor": 4 * width, "middle": height / 2},
        "wall": {"floor": (blocks + 4) * width, "centre": blocks * width / 2, "middle": height / 2},
        "arch": {"radius": width / 2},
        "blocks-on-slope": {"length": (blocks + 3) * width, "rectangles": [[width, height]] * blocks},
        "pile": {
            "across": math.ceil(math.sqrt(blocks)),
            "least": 0.35 * width,
            "middle": width / 2,
            "floor": inner + 2 * width,
            "centre": inner / 2,
            "box": 2 * inner,
            "inside": inner,
            "right": inner + width / 2,
        },
    }
    return places[kind] | {
        "stiffness": stiffness,
        "step": significant(RADIANS_OF_STEP * math.sqrt(mass / stiffness), 1),
        "steps": 2000 if falls else 500,
        "ramp": 0.0 if falls else 0.1,
    }


def _written(value: Any) -> str:
    """Return a value as TOML: a large or small number with its power of ten, a count without a point."""
    if not isinstance(value, float):
        return repr(value)
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return repr(value)
    mantissa, power = f"{value:e}".split("e")
    return f"{float(mantissa)!r}e{int(power)}"
