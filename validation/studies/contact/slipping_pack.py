"""The part of the reference pack on contact that slips: exact motions with friction, and rigid blocks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from validation.errors import InputError
from validation.runs.history import History
from validation.runs.modes import Switch
from validation.scenes.scene import Scene, load_scene
from validation.solvers.events import BlockMotion
from validation.solvers.registry import get_solver
from validation.solvers.rigid.rocking import overturning_acceleration, quarter_period
from validation.solvers.rigid.sliding import harmonic_slide
from validation.studies.contact.pack import ROUNDED
from validation.studies.pack import Part, number, slug, two_digits

MOTION = "block-events"
HALF = math.degrees(math.atan(0.5))  # deg: tan(phi) = 0.5
INCLINE = {"load.pressure": 0.0, "load.gravity": 9.81, "load.slope": 20.0, "contact.shear_stiffness": 4.0e8}
CASES: dict[str, dict[str, Any]] = {
    "glued": {"load.eccentricity": 0.3, "time.steps": 30},
    "off-centre": {"load.eccentricity": 0.3, "contact.friction": HALF, "time.steps": 30},
    "sideways": {"load.traction": 2.0e6, "block.poisson": 0.25, "contact.friction": HALF, "time.steps": 30},
    "incline": {**INCLINE, "contact.friction": 30.0, "time.steps": 50},
    "creep": {**INCLINE, "contact.friction": 30.0, "time.steps": 400},
    "creep-low-friction": {**INCLINE, "contact.friction": 22.0, "time.steps": 400},
    "creep-stiff-shear": {
        **INCLINE,
        "contact.friction": 22.0,
        "contact.shear_stiffness": 1.0e9,
        "time.steps": 400,
    },
    "sliding": {**INCLINE, "load.slope": 28.9, "contact.friction": 15.0, "time.steps": 200},
}
STEP = 1e-3  # s, at which the motions are sampled
PRINTED = 1e-39  # s, by which forty digits of a midpoint may round it
LISTED_SWITCHES = 12  # switches of a motion that are numbers of their own
VALUES = {"horizontal_displacement": "m", "displacement": "m", "rotation": "rad"}
BASE = ("slide_m", "slide_n")
STATES = ("state_m", "state_n")
FORCES = ("normal_force_m", "normal_force_n", "shear_force_m", "shear_force_n")
# slope and phi [deg], A [m/s2], w [rad/s] and how long the base vibrates [s]; sampled at the end and a second later
SHAKES = (
    (0.0, HALF, 6.0, 10.0, 3.0),
    (20.0, 30.0, 6.0, 10.0, 3.0),
    (20.0, 30.0, 16.0, 10.0, 3.0),
    (15.0, 25.0, 4.0, 6.0, 5.0),
)
BLOCKS = ((1.0, 1.0), (1.0, 2.0), (0.5, 2.0))  # width and height [m]
TILTS = (1e-3, 0.5, 0.9)  # over alpha
PULSES = (0.2, 0.5)  # s
BISECTED = 1e-10  # of an overturning acceleration: integrated to 1e-13, which the balance of the block amplifies


def slipping_cases() -> Iterator[Scene]:
    """Yield the scenes of the part."""
    plain = load_scene("unlocked").with_values({"contact.stiffness": 1e9, "time.step": STEP, "run.solvers": [MOTION]})
    columns = [*VALUES, "gap_m", "gap_n", *BASE, *FORCES, *STATES]
    for name, values in CASES.items():
        titles = {"title": f"Block with friction: {name.replace('-', ' ')}", "run.columns": columns}
        yield plain.with_values(titles | values).model_copy(update={"name": name})


def write_slipping_pack(directory: Path) -> int:
    """Write the part into `friction` of a pack's directory, and return how many numbers it holds.

    Raises
    ------
    InputError
        The directory cannot be made or written.
    """
    part = Part(directory / "friction")
    rows: list[dict[str, Any]] = []
    enclosed: list[dict[str, Any]] = []
    for scene in slipping_cases():
        part.add_scene(scene)
        rows += numbers(scene, part, enclosed)
    shaken = list(shakes())
    rocked = list(rockings())
    tables = {"numbers": rows, "enclosures": enclosed, "newmark": shaken, "rocking": rocked}
    for name, table in tables.items():
        part.add_table(name, table)
    part.add_readme(__file__)
    return sum(map(len, tables.values()))


def numbers(scene: Scene, part: Part, enclosed: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Run an exact motion, write its history, add its switches to those that are enclosed and yield its single numbers.

    Raises
    ------
    InputError
        The motion did not complete.
    """
    prepared = get_solver(MOTION).prepare(scene)
    if not isinstance(prepared, BlockMotion):
        raise InputError("must be the suite's own solver to write its pack", source=MOTION)
    history = prepared.run().history
    if history is None:
        raise InputError(f"{scene.name} {MOTION}: no history")
    part.add_history(scene.name, MOTION, history)
    for corner, event, midpoint, radius in prepared.enclosures():
        identity = {"scene": slug(scene.name), "corner": corner, "kind": event}
        enclosed.append(identity | {"midpoint": midpoint, "radius": _rounded_up(radius)})
    for n, switch in enumerate(prepared.switches()[:LISTED_SWITCHES], start=1):
        quantity = f"switch {n}: {switch.corner} {kind(switch)}"
        yield number(scene, quantity, switch.time, "s", ROUNDED * switch.time)
    yield from _instants(scene, history)


def kind(switch: Switch) -> str:
    """Return what a corner begins to do."""
    if switch.opens is None:
        return "slips" if switch.slips else "sticks"
    return "opens" if switch.opens else "closes"


def _instants(scene: Scene, history: History) -> Iterator[dict[str, Any]]:
    """Yield the centroid and the mean slide of the base at the end, and at each 0.1 s of a longer motion."""
    mean = np.mean([history.columns[name] for name in BASE], axis=0)
    columns = {name: history.columns[name] for name in VALUES} | {"mean slide": mean}
    stride = min(100, scene.time.steps)
    for n in range(stride - 1, scene.time.steps, stride):
        for name, column in columns.items():
            quantity = f"{name} at {float(history.time[n])!r} s"
            uncertainty = ROUNDED * float(np.abs(column).max())
            yield number(scene, quantity, float(column[n]), VALUES.get(name, "m"), uncertainty)


def _rounded_up(radius: float) -> float:
    """Return a radius that is no smaller, of two digits; that of the printed midpoint is added."""
    return two_digits(1.1 * radius + PRINTED)


def shakes() -> Iterator[dict[str, float]]:
    """Yield the slide of rigid blocks on bases that vibrate."""
    for slope, phi, amplitude, rate, duration in SHAKES:
        for two_way in (True, False):
            end = np.array([duration + 1.0])
            motion = harmonic_slide(slope, phi, amplitude, rate, duration, end, two_way)
            parameters = {"slope": slope, "friction": phi, "amplitude": amplitude, "rate": rate, "duration": duration}
            answer = {"two_way": int(two_way), "slide": float(motion.slide[0]), "slip": motion.slip}
            yield parameters | answer | {"uncertainty": two_digits(ROUNDED * motion.slip)}


def rockings() -> Iterator[dict[str, Any]]:
    """Yield quarter periods of rigid blocks, and accelerations that overturn them."""
    for width, height in BLOCKS:
        tilts = [share * math.atan2(width, height) for share in TILTS]
        for quantity, function, instants, relative in (
            ("quarter period [s]", quarter_period, tilts, ROUNDED),
            ("overturning half sine [m/s2]", overturning_acceleration, PULSES, BISECTED),
        ):
            for at in instants:
                value = function(width, height, at)
                row = {"width": width, "height": height, "quantity": quantity, "at": at, "value": value}
                yield row | {"uncertainty": two_digits(relative * value)}
