"""What the room of advice asks of the kind of a scene."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

from validation.advice.alarm import Alarm
from validation.errors import InputError
from validation.runs.history import Complex
from validation.runs.row import RowsBySolver
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene
from validation.theory.waves import Column


@dataclass(frozen=True)
class Motion:
    """What a step must follow."""

    name: str
    frequency: float  # [rad/s]


@dataclass(frozen=True)
class Layer:
    """A part of the column: what it is made of, and how it is cut."""

    thickness: float  # [m]
    density: float  # [kg/m^3]
    modulus: float  # of the wave [Pa]
    blocks: int
    glue: float | None = None  # of the springs between blocks [Pa/m]; None where they are perfectly bonded
    joints: tuple[float, ...] = ()  # heights of joints over the layer's foot, as shares of its thickness [1]

    @property
    def height(self) -> float:
        """Height of a block [m]."""
        return self.thickness / self.blocks

    @property
    def speed(self) -> float:
        """Speed of the wave [m/s]."""
        return math.sqrt(self.modulus / self.density)

    def wavenumber(self, w2: Complex) -> Complex:
        """Return k [rad/m] of the blocks at squared frequencies."""
        return Column(self.height, self.density, self.modulus, self.glue).wavenumber(w2)


@dataclass(frozen=True)
class ColumnLimits:
    """What follows of a scene with a column whose contacts open or slip, before anything is run."""

    contacts: int
    solves: int | None  # that a step can need; None where no bound is proven
    far_face_step: float  # below which some block's far face moves the wrong way [s]
    blocks: tuple[int, ...]  # of each layer with which it does not at the present step
    lowest: float | None  # lowest frequency of a stack of equal rigid blocks [rad/s]
    ring_down: float | None  # in which that vibration falls to a thousandth while no contact opens or slips [s]


class AdviceHooks(Hooks):
    """What steps must follow, and what is known of contacts and waves before anything is run."""

    module = "advice"
    has_budget: ClassVar[bool] = False  # whether the damping of its modes is known by closed forms

    def motions(self, scene: Scene, frequency: float | None = None) -> Iterator[Motion]:
        """Yield what the motion of a scene is made of, the first mode with its frequency, if that is known [rad/s]."""
        yield from ()

    def alarms(self, scene: Scene, rows: RowsBySolver | None = None) -> Iterator[Alarm]:
        """Yield alarms of a scene's contacts from its finished rows by solver; before a run, of what may happen."""
        yield from ()

    def contact_limits(self, scene: Scene) -> ColumnLimits | None:
        """Return what is known of contacts of a column that open or slip, None of other scenes."""
        return None

    def layers(self, scene: Scene) -> tuple[Layer, ...]:
        """Return the layers that a wave runs through, from below, or raise InputError where none does."""
        raise InputError("is needed for what is asked", source=scene.name, field="block", value=scene.kind_in_words)

    def cut(self, scene: Scene, counts: Sequence[int]) -> Scene:
        """Return the scene with so many blocks in each of its layers."""
        raise InputError("is needed for what is asked", source=scene.name, field="block", value=scene.kind_in_words)
