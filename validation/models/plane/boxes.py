"""Boxes on a ground: scenes of the plane whose motion may be known, and what every contact engine can be asked."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.models.plane.assembly import TOUCHING
from validation.models.plane.blocks import PlacedBlock
from validation.models.plane.history import POSE, pair_column
from validation.models.plane.tables import BODIES, PlaneSection
from validation.runs.history import Array
from validation.scenes.record import read_record
from validation.scenes.scene import Scene

UPRIGHT = 1e-9  # rad, and of the sides of a rectangle: what rounding makes of it
HARMONIC = 1e-6  # of A: what the digits of a file may leave
LANDS_BY = "contact.restitution must be stated of a box that lands"


@dataclass(frozen=True)
class Box:
    """A rigid rectangle of unit depth at t = 0; x along the ground, y upwards from it."""

    name: str
    width: float  # before it is turned [m]
    height: float  # the same [m]
    density: float  # kg/m3
    x: float  # of the centre [m]
    y: float
    angle: float  # counter-clockwise [rad]
    lift: float  # height of the lowest corner above what is below [m]
    velocity: tuple[float, float]  # of the centre [m/s]
    spin: float  # rad/s

    @property
    def mass(self) -> float:
        """Mass of unit depth [kg]."""
        return self.density * self.width * self.height

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centre [kg m2]: m (w^2 + h^2) / 12."""
        return self.mass * (self.width**2 + self.height**2) / 12

    @property
    def reach(self) -> float:
        """Height of the centre above the lowest corner at t = 0 [m]."""
        return reach_of(self.width, self.height, self.angle)


def reach_of(width: float, height: float, angle: float) -> float:
    """Return the height of the centre of a rectangle above its lowest corner [m]."""
    return width / 2 * math.sin(abs(angle)) + height / 2 * math.cos(angle)


@dataclass(frozen=True)
class BoxesOnGround:
    """Rigid boxes above each other on a ground whose top is y = 0.

    A slope is gravity that leans: g (sin s, -cos s) in the frame of the ground.
    """

    ground: str  # name of the block that is the ground
    boxes: tuple[Box, ...]  # from the lowest up
    pull: tuple[float, float]  # acceleration of gravity along the ground and upwards [m/s2]
    friction: float  # angle of friction of every contact [deg]; 90 where none slips
    restitution: float | None  # Newton's, of every contact; None where the scene does not say
    stiffness: float | None  # of a box that lies on the ground, by its two corners [N/m]; None of rigid contact
    ends: tuple[float, float]  # the ground's least and greatest x [m]
    base_amplitude: float  # A [m] of the ground's motion A (1 - cos(2 pi f t)) along itself, 0 at rest
    base_frequency: float  # f [Hz]

    def base(self, time: float) -> tuple[float, float]:
        """Return displacement [m] and velocity [m/s] of the ground along itself at an instant [s]."""
        rate = 2 * math.pi * self.base_frequency
        phase = rate * time
        return self.base_amplitude * (1 - math.cos(phase)), self.base_amplitude * rate * math.sin(phase)

    @property
    def starts(self) -> tuple[tuple[float, float, float], ...]:
        """Position of the centre [m, m] and rotation [rad] of each box at t = 0."""
        return tuple((box.x, box.y, box.angle) for box in self.boxes)

    @property
    def rebound(self) -> float:
        """Newton's restitution; 0 where the scene does not say."""
        return self.restitution or 0.0

    @property
    def gravity(self) -> float:
        """Magnitude of gravity [m/s2]."""
        return math.hypot(*self.pull)

    @property
    def slope(self) -> float:
        """Dip of the ground towards +x [deg]."""
        return math.degrees(math.atan2(self.pull[0], -self.pull[1])) if self.pull[0] else 0.0

    @property
    def friction_coefficient(self) -> float:
        """tan(phi) of every contact."""
        return math.tan(math.radians(self.friction))

    @property
    def force_columns(self) -> tuple[str, ...]:
        """Columns of the normal force below each box."""
        names = [self.ground, *(box.name for box in self.boxes)]
        return tuple(pair_column(upper, lower) for lower, upper in itertools.pairwise(names))

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of position and angle of each box, then those of the forces."""
        poses = [f"{box.name}.{part}" for box in self.boxes for part in POSE]
        return (*poses, *self.force_columns)


def boxes_of(scene: Scene) -> BoxesOnGround:
    """Return the boxes on a ground that a scene is of; a ValueError if it is of something else."""
    if "plane" not in scene.tables():
        raise ValueError(f"it must be of boxes on a ground, got {scene.kind_in_words}")
    return boxes_on_ground(scene.table(PlaneSection))


def boxes_on_ground(plane: PlaneSection) -> BoxesOnGround:
    """Return the boxes on a ground that a table of the plane states; a ValueError if it states something else."""
    others = [name for name in (*BODIES, "observe", "pair", "bond", "load", "touch") if getattr(plane, name)]
    if others or plane.ramp:
        raise ValueError(f"boxes on a ground must have one contact and weight alone, got {', '.join(others) or 'ramp'}")
    contact = plane.contact
    if contact is None or contact.cohesion or contact.tension:
        raise ValueError("boxes on a ground must have a contact of friction alone")
    blocks = plane.assembly.blocks
    held = [block for block in blocks if block.held]
    heights = sorted(y for block in held for _, y in block.vertices)[-2:]  # of the ends of the highest edge
    if len(held) != 1 or max(map(abs, heights)) > UPRIGHT:
        rule = "the ground must be one block that is fixed or driven, its top level at y = 0, and a slope be gravity"
        raise ValueError(f"{rule} that leans, got {len(held)} such blocks")
    amplitude, frequency = (0.0, 1.0) if held[0].motion is None else harmonic(held[0].motion)
    return BoxesOnGround(
        ground=held[0].name,
        boxes=tuple(_boxes(plane.assembly.moving)),
        pull=plane.gravity,
        friction=90.0 if contact.friction is None else contact.friction,
        restitution=contact.restitution,
        stiffness=None if math.isinf(contact.stiffness) else 2 * contact.stiffness,
        ends=(min(x for x, _ in held[0].vertices), max(x for x, _ in held[0].vertices)),
        base_amplitude=amplitude,
        base_frequency=frequency,
    )


@functools.cache
def harmonic(path: str) -> tuple[float, float]:
    """Return A [m] and f [Hz] of a record that is A (1 - cos(2 pi f t)) along x; a ValueError if it is another."""
    from scipy.optimize import curve_fit

    record = read_record(Path(path))

    def motion(time: Array, amplitude: float, frequency: float) -> Array:
        return np.asarray(amplitude * (1 - np.cos(2 * np.pi * frequency * time)))

    halfway = record.time[np.argmax(np.abs(record.x))]
    first_guess = float(record.x[np.argmax(np.abs(record.x))]) / 2, 1 / (2 * halfway) if halfway else 1.0
    (amplitude, frequency), _ = curve_fit(motion, record.time, record.x, first_guess, xtol=1e-15, ftol=1e-15)
    off = np.abs(record.x - motion(record.time, amplitude, frequency))
    if np.any(record.y) or not np.max(off) <= HARMONIC * abs(amplitude):
        raise ValueError(f"the ground must move by A (1 - cos(2 pi f t)) along x, got another motion in {path}")
    return float(amplitude), float(frequency)


def _boxes(blocks: list[PlacedBlock]) -> Iterator[Box]:
    """Yield the blocks as rectangles, each on the one before."""
    top = 0.0
    for block in blocks:
        corners = block.corners
        along = corners[1] - corners[0]
        up = corners[-1] - corners[0]
        width = math.hypot(*along)
        height = math.hypot(*up)
        is_parallelogram = len(corners) == 4 and np.allclose(corners[0] + corners[2], corners[1] + corners[3])
        skew = abs(float(along @ up)) / (width * height)
        turned = math.remainder(math.atan2(along[1], along[0]) - block.angle, 2 * math.pi)
        if not is_parallelogram or max(skew, abs(turned)) > UPRIGHT or not math.isinf(block.young):
            rule = "blocks on a ground must be rigid rectangles from their lower left corner"
            raise ValueError(f"{rule}, got {block.name}")
        x, y = corners.mean(axis=0)
        reach = reach_of(width, height, block.angle)
        lift = float(y) - reach - top
        if abs(lift) < TOUCHING * min(width, height):
            lift = 0.0
        if lift < 0:
            raise ValueError(f"boxes must stand on each other in the order of the file, got {block.name} below another")
        yield Box(
            name=block.name,
            width=width,
            height=height,
            density=block.density,
            x=float(x),
            y=float(y),
            angle=block.angle,
            lift=lift,
            velocity=block.velocity,
            spin=block.spin,
        )
        top = float(y) + reach
