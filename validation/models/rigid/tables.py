"""The table of rigid boxes on a plane, `[rigid]`, in the place of a block: what contact engines simulate."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from validation.scenes.keys import Key, Section
from validation.scenes.tables import Angle, Index, NonNegative, Positive, Real

MOST_BOXES = 99
FrictionAngle = Annotated[Angle, Field(ge=0)]
Restitution = Annotated[Real, Field(ge=0, le=1)]
POSE = ("x", "y", "angle")  # of the centre of a box [m, m, rad]
FORCE = "force"  # normal force between a box and what it stands on [N]


class BoxSection(Section):
    """A rigid box of unit depth. Boxes stand on each other in the order of the file, the first one on the ground."""

    width: Annotated[Positive, Key("m", "along the ground")]
    height: Annotated[Positive, Key("m", "upwards")]
    density: Annotated[Positive, Key("kg/m3", "mass of a volume")]
    x: Annotated[Real, Key("m", "of the centre at t = 0, along the ground")] = 0.0
    lift: Annotated[NonNegative, Key("m", "of the lowest corner at t = 0 above what is below")] = 0.0
    tilt: Annotated[Angle, Key("deg", "at t = 0, counter-clockwise; of a box that is alone")] = 0.0
    velocity: Annotated[tuple[Real, Real], Key("m/s", "of the centre at t = 0, along the ground and upwards")] = (
        0.0,
        0.0,
    )
    spin: Annotated[Real, Key("rad/s", "at t = 0, counter-clockwise")] = 0.0

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
        tilt = math.radians(abs(self.tilt))
        return self.width / 2 * math.sin(tilt) + self.height / 2 * math.cos(tilt)


class RigidSection(Section):
    """Rigid boxes on a plane: what every contact engine can be asked, whatever its contact is made of.

    The plane is level in its own frame, x along it and y upwards; on a slope gravity turns instead,
    (g sin(slope), -g cos(slope)). Friction and restitution are those of every contact, the latter by Newton's law.
    Programs with contact of finite stiffness take their own, except where `stiffness` is given.
    """

    box: Annotated[tuple[BoxSection, ...], Field(min_length=1, max_length=MOST_BOXES)]
    gravity: Annotated[NonNegative, Key("m/s2", "downwards", "g")] = 9.81
    slope: Annotated[Angle, Key("deg", "of the plane, down towards +x")] = 0.0
    friction: Annotated[FrictionAngle, Key("deg", "angle of friction of every contact; 0 is frictionless", "φ")] = 0.0
    restitution: Annotated[Restitution, Key("", "rebound over approach speed of every contact", "e")] = 0.0
    stiffness: Annotated[
        Positive | None, Key("N/m", "of the contact of a box with the ground; absent: rigid, or the program's own")
    ] = None
    base_amplitude: Annotated[Real, Key("m", "A of the ground's motion A (1 - cos(2 pi f t)) along itself")] = 0.0
    base_frequency: Annotated[Positive, Key("Hz", "f of that motion", None, ("base_amplitude",))] = 1.0
    refine: Annotated[Annotated[Index, Field(ge=0, le=30)], Key("", "how often a program halves its own step")] = 0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if len(self.box) > 1 and (tilted := [box.tilt for box in self.box if box.tilt]):
            raise ValueError(f"box.tilt goes with a box that is alone only, got {tilted[0]:g} of {len(self.box)} boxes")
        return self

    @property
    def pull(self) -> tuple[float, float]:
        """Acceleration of gravity along the ground and upwards [m/s2]."""
        slope = math.radians(self.slope)
        return self.gravity * math.sin(slope), -self.gravity * math.cos(slope)

    @property
    def friction_coefficient(self) -> float:
        """tan(phi) of every contact."""
        return math.tan(math.radians(self.friction))

    @property
    def starts(self) -> tuple[tuple[float, float, float], ...]:
        """Position of the centre [m, m] and angle [rad] of each box at t = 0."""
        poses = []
        top = 0.0
        for box in self.box:
            y = top + box.lift + box.reach
            poses.append((box.x, y, math.radians(box.tilt)))
            top = y + box.reach
        return tuple(poses)

    def base(self, time: float) -> tuple[float, float]:
        """Return displacement [m] and velocity [m/s] of the ground along itself at an instant [s]."""
        rate = 2 * math.pi * self.base_frequency
        phase = rate * time
        return self.base_amplitude * (1 - math.cos(phase)), self.base_amplitude * rate * math.sin(phase)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns that a history may have: position and angle of each box, and the force below it."""
        return columns_of_boxes(len(self.box))


def columns_of_boxes(count: int) -> tuple[str, ...]:
    """Return the names of the columns of a number of boxes, ``x_1``, ``y_1``, ``angle_1``, ``force_1``, ``x_2``, ..."""
    return tuple(f"{part}_{number}" for number in range(1, count + 1) for part in (*POSE, FORCE))
