"""The tables in `[plane]` that say which blocks there are, what joins them and what drives them."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from validation.models.plane.blocks import PlaneBlockSection, PlaneMaterialSection
from validation.models.plane.generators import (
    MOST_BLOCKS,
    ArchSection,
    ColumnsSection,
    GeneratorSection,
    RandomSection,
    SlopeSection,
    StackSection,
    WallSection,
)
from validation.models.plane.joints import (
    PlaneBondSection,
    PlaneContactSection,
    PlaneLoadSection,
    PlanePairSection,
    PlaneTouchSection,
)
from validation.scenes.keys import Key
from validation.scenes.tables import NonNegative, Positive, Real

GENERATORS = ("stack", "wall", "arch", "columns", "slope", "random")


class PlaneContents(PlaneMaterialSection):
    """Blocks, contacts, glue and loads."""

    glue: Annotated[Positive, Key("m", "end spring of a shared edge over young", "g")] = 1.0e6
    gravity: Annotated[tuple[Real, Real], Key("m/s2", "acceleration in x and y")] = (0.0, 0.0)
    ramp: Annotated[NonNegative, Key("s", "over which gravity grows from zero, linearly", None, ("gravity",))] = 0.0
    block: Annotated[tuple[PlaneBlockSection, ...], Field(max_length=MOST_BLOCKS)] = ()
    stack: tuple[StackSection, ...] = ()
    wall: tuple[WallSection, ...] = ()
    arch: tuple[ArchSection, ...] = ()
    columns: tuple[ColumnsSection, ...] = ()
    slope: tuple[SlopeSection, ...] = ()
    random: tuple[RandomSection, ...] = ()
    contact: PlaneContactSection | None = None
    pair: tuple[PlanePairSection, ...] = ()
    touch: tuple[PlaneTouchSection, ...] = ()
    bond: tuple[PlaneBondSection, ...] = ()
    load: tuple[PlaneLoadSection, ...] = ()

    @property
    def generators(self) -> tuple[GeneratorSection, ...]:
        """The tables that draw several blocks."""
        return tuple(table for name in GENERATORS for table in getattr(self, name))
