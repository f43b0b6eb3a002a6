"""The table of blocks in the plane, `[plane]`: glued ones in small displacements, or blocks that move and touch."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Self

import numpy as np
from pydantic import model_validator

from validation.models.plane import assembly, geometry
from validation.models.plane.assembly import Assembly
from validation.models.plane.blocks import Point as Point
from validation.models.plane.blocks import Vertices, cells, thickness, upright
from validation.models.plane.contents import GENERATORS, PlaneContents
from validation.models.plane.generators import MOST_BLOCKS
from validation.models.plane.glued import BodySection, ClampSection, DiscSection, Loads, ObserveSection, PlateSection
from validation.models.plane.joints import Segment as Segment
from validation.scenes.keys import Key
from validation.scenes.tables import Cut, Pattern, Positive, Real

OWN_STIFFNESS = 1.0e9  # N/m, of a corner: DDA's springs where a scene has rigid contact
OWN_STEP = 2.0e-3  # s: and its longest step there, that of the damping study that this suite began with
OF_MOTION = ("contact", "pair", "touch", "bond", "ramp", *GENERATORS)  # keys that go with moving blocks only
OF_GLUED = ("stress", "clamp", "clamp_glue", "width", "height", "subdivide", "pattern")  # with glued ones only
BODIES = ("plate", "disc")  # keys that draw a glued body
OF_MOVING_BLOCK = ("velocity", "spin", "fixed", "motion", "density", "young", "poisson", "subdivide")


class PlaneSection(PlaneContents):
    """Blocks in the plane, of unit thickness: rigid, or of one strain each.

    Glued (with `[plane.observe]`): blocks of one strain, glued along all edges that they share, and the elastic body of
    their outline. They are stated one by one, as an upright rectangle with its lower left corner at the origin that is
    cut into equal blocks (`width`, `height`, `subdivide`), or drawn as a body with a load of its own (`[plane.plate]`,
    `[plane.disc]`), of which the table says what is observed if the scene does not. At each end of a shared edge stand
    a normal and a shear spring of `glue` times Young's modulus.

    Moving: blocks stated one by one (`[[plane.block]]`) or generated (`[[plane.wall]]` and others), which touch by
    `[plane.contact]` where they meet, or by the corners of `[[plane.touch]]` alone. A history holds ``NAME.x``,
    ``NAME.y`` of a block's centroid, ``NAME.angle`` (`turned`, and the rotation since t = 0), and of contacts
    ``A.2-B.0.normal``, the normal force of corner 2 of A on edge 0 of B.
    """

    clamp_glue: Annotated[Positive, Key("m", "the same of a clamped edge")] = 1.0e6
    stress: Annotated[
        tuple[Real, Real, Real], Key("Pa", "s_xx, s_yy, s_xy, whose tractions act on all of the outline", "σ")
    ] = (0.0, 0.0, 0.0)
    width: Annotated[Positive | None, Key("m", "of a rectangle that is cut", "W")] = None
    height: Annotated[Positive | None, Key("m", "of a rectangle that is cut", "H")] = None
    subdivide: Annotated[Cut | None, Key("blocks", "of it in x and in y", "")] = None
    pattern: Annotated[
        Pattern,
        Key("", "of its blocks; triangles: each cell cut from lower left to upper right", "", ("subdivide",)),
    ] = "squares"
    plate: PlateSection | None = None
    disc: DiscSection | None = None
    clamp: tuple[ClampSection, ...] = ()
    observe: ObserveSection | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        stated = [name for name in ("width", "height", "subdivide") if getattr(self, name) is not None]
        sources = [name for name in ("block", *BODIES) if getattr(self, name)] + stated[:1]
        if len(sources) > 1:
            raise ValueError(f"{sources[0]} and {sources[1]} exclude each other, got both")
        if self.is_glued:
            self._check_glued(stated)
        else:
            if apart := [name for name in OF_GLUED if name in self.model_fields_set]:
                raise ValueError(f"observe: is required with {apart[0]}, got none")
            if self.contact is None and self.touch:
                raise ValueError("contact: is required with touch, got none")
            if not self.block and not self.generators:
                raise ValueError(f"needs blocks, [[plane.block]] or one of {', '.join(GENERATORS)}, got none")
            _ = self.assembly  # is checked when it is made, once: a scene that states no solvers is validated twice
        return self

    def _check_glued(self, stated: list[str]) -> None:
        if apart := [name for name in OF_MOTION if name in self.model_fields_set]:
            raise ValueError(f"{apart[0]} does not go with observe, got it of blocks that are glued")
        if not self.block and self.body is None and len(stated) < 3:
            rule = "needs blocks, a plate, a disc, or width, height and subdivide"
            raise ValueError(f"{rule}, got {' and '.join(stated) or 'none'}")
        for number, block in enumerate(self.block):
            if apart := sorted({*OF_MOVING_BLOCK} & block.model_fields_set):
                raise ValueError(f"block.{number}: {apart[0]} does not go with observe, got it of a glued block")
        count = math.prod(self.subdivide or (1,)) * (2 if self.pattern == "triangles" else 1)
        if count > MOST_BLOCKS:
            raise ValueError(f"subdivide must make at most {MOST_BLOCKS} blocks, got {count}")
        if math.isinf(self.young):
            raise ValueError("young must be finite with observe, got inf")
        for number, load in enumerate(self.load):
            if load.traction is None or load.edge is None or load.ramp or load.block is not None:
                raise ValueError(f"load.{number}: must be a traction on an edge at once with observe, got another load")
        if not self.tractions and not any(self.stress) and not any(self.gravity):
            raise ValueError("needs a load: stress, gravity or [[plane.load]], got none")

    @property
    def observed(self) -> ObserveSection:
        """What is observed of glued blocks."""
        if self.observe is not None:
            return self.observe
        if self.body is None:
            raise ValueError("observe: is needed for what is asked, got blocks that move")
        return self.body.observed

    @property
    def body(self) -> BodySection | None:
        """The body that one table draws."""
        return self.plate or self.disc

    @property
    def stressed_blocks(self) -> list[int]:
        """Numbers of the glued blocks that meet where the stress is observed, of the nearest ones if none is there."""
        place = np.array([self.observed.stress])
        polygons = self.polygons
        apart = [0.0 if geometry.inside(place, p)[0] else geometry.distances(place, p)[0] for p in polygons]
        near = min(apart) + assembly.TOUCHING * min(thickness(polygon) for polygon in polygons)
        return [number for number, distance in enumerate(apart) if distance <= near]

    @property
    def tractions(self) -> Loads:
        """The loads of glued blocks: edge [m] and traction [Pa]."""
        stated = tuple((load.edge, load.traction) for load in self.load if load.edge and load.traction)
        return stated if self.body is None else (*self.body.tractions, *stated)

    @property
    def is_glued(self) -> bool:
        """Whether the blocks are glued along all edges that they share, and observed as they deform."""
        return self.observe is not None or self.body is not None

    @property
    def moves(self) -> bool:
        """Whether the blocks move, turn and touch each other."""
        return not self.is_glued

    @cached_property
    def assembly(self) -> Assembly:
        """Moving blocks with their names resolved, checked."""
        assembled = assembly.assembled(self)
        assembly.check(self, assembled)
        return assembled

    @property
    def rectangle(self) -> tuple[float, float] | None:
        """Width and height of the rectangle that is cut [m], None where blocks are stated one by one."""
        return None if self.width is None or self.height is None else (self.width, self.height)

    @cached_property
    def polygons(self) -> tuple[Vertices, ...]:
        """Corners of every block, of a rectangle row by row from below."""
        if self.body is not None:
            return tuple(self.body.triangles())
        if self.rectangle is None or self.subdivide is None:
            return tuple(block.vertices for block in assembly.placed_blocks(self)[0])
        return tuple(outline for _, outline in cells(*self.rectangle, self.subdivide, self.pattern))

    @property
    def outline_polygons(self) -> tuple[Vertices, ...]:
        """Polygons that tile the body, as few as there are: the rectangle, or the blocks."""
        if self.rectangle is None:
            return self.polygons
        return (upright(0.0, 0.0, *self.rectangle),)
