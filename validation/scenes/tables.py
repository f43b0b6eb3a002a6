"""The tables of a scene file: their fields, units and rules, checked with pydantic; unknown keys are refused."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer, model_validator

from validation.scenes.outline import Point, area, check_polygon, convex_quadrilateral

FINE_ELEMENTS = 16
SMALLEST = 1e-60
"""Smallest positive value of a quantity, in its unit: fourth powers of lengths and squares of time steps, and their
inverses, keep all digits of double precision."""


def _real(value: object) -> float:
    """Accept a finite TOML number and nothing that merely converts to one."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError("must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError("must be a finite number")
    return number


def _not_tiny(number: float) -> float:
    """Accept a positive number whose powers are numbers too."""
    if number < SMALLEST:
        raise ValueError(f"must be at least {SMALLEST:g}")
    return number


def _stiffness(value: object) -> float:
    """Accept a number, or inf for a rigid stop, which plain data write as a word."""
    return math.inf if value in (math.inf, "inf") else _real(value)


def _stiffness_as_data(value: float) -> float | str:
    return "inf" if math.isinf(value) else value


def _count(value: object) -> int:
    """Accept a TOML integer that fits 64 bits."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError("must be a whole number")
    if abs(value) >= 2**63:
        raise ValueError("must fit 64 bits")
    return value


def _distinct(words: tuple[str, ...]) -> tuple[str, ...]:
    """Accept words that do not repeat."""
    if len(set(words)) < len(words):
        raise ValueError("must not repeat a word")
    return words


Real = Annotated[float, BeforeValidator(_real)]
Angle = Annotated[float, BeforeValidator(_real), Field(gt=-90, lt=90)]  # deg
Positive = Annotated[Real, Field(gt=0), AfterValidator(_not_tiny)]
Stiffness = Annotated[
    float,
    BeforeValidator(_stiffness),
    Field(gt=0),
    AfterValidator(_not_tiny),
    PlainSerializer(_stiffness_as_data, when_used="json"),
]
NonNegative = Annotated[Real, Field(ge=0)]
Count = Annotated[int, BeforeValidator(_count), Field(ge=1)]
Flag = Annotated[bool, Field(strict=True)]
Words = Annotated[tuple[str, ...], Field(min_length=1), AfterValidator(_distinct)]


class Section(BaseModel):
    """A table of a scene file: immutable, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", str_max_length=10_000)


class BlockSection(Section):
    """The loaded block A: outline and material.

    The outline is a square (`side`), an upright rectangle (`width`, `height`) with its lower left corner at the
    origin, or a counter-clockwise polygon (`vertices` with the indices of its `base` and `top` edges).
    """

    side: Positive | None = None  # m
    width: Positive | None = None  # m
    height: Positive | None = None  # m
    vertices: tuple[tuple[Real, Real], ...] | None = None  # m, counter-clockwise
    base: Annotated[int, BeforeValidator(_count)] = 0  # edge i runs from vertex i to i + 1
    top: Annotated[int, BeforeValidator(_count)] = 2
    density: Positive  # kg/m3
    young: Positive  # Pa
    velocity: Real = 0.0  # m/s at t = 0, upwards; for unilateral contact only
    tilt: Angle = 0.0  # deg at t = 0, counter-clockwise about the corner that stays down; for updated geometry only
    poisson: Annotated[Real, Field(gt=-1, le=0.5)] = 0.0  # 1
    hypothesis: Literal["plane stress", "plane strain"] = "plane stress"
    subdivide: tuple[Count, Count] | None = None  # sub-blocks along the base and upwards
    pattern: Literal["squares", "triangles"] = "squares"  # triangles: each square cut from lower left to upper right
    glue_ratio: Positive = 1.0e6  # stiffness of each end spring of a joint over young, m

    @model_validator(mode="after")
    def _check(self) -> Self:
        self._check_one_outline()
        self._check_subdivision()
        if self.hypothesis == "plane strain" and self.poisson >= 0.5:
            raise ValueError(f"poisson must be below 0.5 in plane strain, got {self.poisson:g}")
        if self.vertices is not None:
            check_polygon(self.vertices, self.base, self.top)
        return self

    def _check_one_outline(self) -> None:
        given = {
            "side": self.side is not None,
            "width and height": self.width is not None or self.height is not None,
            "vertices": self.vertices is not None,
        }
        names = [name for name, present in given.items() if present]
        if len(names) > 1:
            raise ValueError(f"{names[0]} and {names[1]} exclude each other, got both")
        if not names:
            raise ValueError("one of side, width and height, or vertices must be given, got none")
        if given["width and height"] and (self.width is None or self.height is None):
            raise ValueError("width and height must be given together, got one")
        if self.vertices is None and self.model_fields_set & {"base", "top"}:
            raise ValueError("base and top go with vertices only, got them with a rectangle")

    def _check_subdivision(self) -> None:
        alone = self.model_fields_set & {"pattern", "glue_ratio"}
        if self.subdivide is None and alone:
            raise ValueError(f"{min(alone)} goes with subdivide only, got it alone")
        if self.subdivide is not None and not convex_quadrilateral(self.outline):
            raise ValueError(f"subdivide goes with convex quadrilaterals only, got {len(self.outline)} vertices")

    @property
    def outline(self) -> tuple[Point, ...]:
        """Vertices [m], counter-clockwise."""
        if self.vertices is not None:
            return self.vertices
        w, h = (self.side, self.side) if self.side is not None else (self.width, self.height)
        return ((0.0, 0.0), (w, 0.0), (w, h), (0.0, h))  # type: ignore[return-value]

    @property
    def base_length(self) -> float:
        """Length a of the base edge [m]."""
        (x1, y1), (x2, y2) = self.edge(self.base)
        return math.hypot(x2 - x1, y2 - y1)

    @property
    def mass(self) -> float:
        """Mass of the block of unit thickness [kg]."""
        return self.density * area(self.outline)

    def edge(self, index: int) -> tuple[Point, Point]:
        """Return the end points of an edge [m]."""
        points = self.outline
        return points[index], points[(index + 1) % len(points)]


class ContactSection(Section):
    """Corner springs at the two ends of the base edge: locked, or unilateral, which carry no tension."""

    law: Literal["locked", "unilateral"] = "locked"
    stiffness: Stiffness  # p, N/m per corner spring; inf is a rigid stop, for unilateral contact only
    shear_stiffness: NonNegative | None = None  # N/m; p if absent; 0 is frictionless, for unilateral contact only
    friction: Annotated[Angle, Field(ge=0)] | None = None  # angle phi, deg; a closed corner is glued in shear without
    cohesion: NonNegative = 0.0  # Pa over the whole base, of which each corner carries half; goes with friction
    rule: Literal["newmark", "implicit", "energy-conserving"] = "newmark"  # how a step takes the contact force
    rules: Literal["consistent", "lagged"] = "consistent"  # lagged: friction of the iteration before, as programs do
    gap: NonNegative = 0.0  # m, between block and springs at t = 0
    band: tuple[NonNegative, NonNegative] = (0.0, 0.0)  # m: closes below -band[0], opens above band[1]
    solve_limit: Count = 6  # solves of the open-close iteration before every contact state is tried
    cut: Annotated[Real, Field(gt=0, lt=1)] = 0.3  # length of a step that is repeated, over the failed one

    @model_validator(mode="after")
    def _check(self) -> Self:
        alone = sorted(self.model_fields_set & {"rule", "gap", "band", "solve_limit", "cut", "friction"})
        if self.law == "locked" and alone:
            raise ValueError(f'{alone[0]} goes with law = "unilateral" only, got it with a locked contact')
        self._check_friction()
        if math.isinf(self.stiffness):
            self._check_rigid()
        if self.rule == "energy-conserving" and any(self.band):
            raise ValueError(f'band goes with rule = "newmark" or "implicit", got {list(self.band)} with {self.rule!r}')
        if self.law == "locked" and self.shear_stiffness == 0:
            raise ValueError('shear_stiffness must be greater than 0 where law = "locked", got 0')
        return self

    def _check_friction(self) -> None:
        alone = sorted(self.model_fields_set & {"cohesion", "rules"})
        if self.friction is None and alone:
            raise ValueError(f"{alone[0]} goes with friction only, got it without one")
        if self.friction is not None and self.shear_stiffness == 0:
            raise ValueError("shear_stiffness must be greater than 0 with friction, got 0")
        if self.friction is not None and self.rule == "energy-conserving":
            raise ValueError(f'friction goes with rule = "newmark" or "implicit", got it with {self.rule!r}')
        if self.rules == "lagged" and self.rule != "newmark":
            raise ValueError(f'rules = "lagged" goes with rule = "newmark" only, got it with {self.rule!r}')

    def _check_rigid(self) -> None:
        if self.law == "locked" or self.rule == "energy-conserving":
            held = 'law = "locked"' if self.law == "locked" else 'rule = "energy-conserving"'
            raise ValueError(f"stiffness must be finite with {held}, got inf")
        if self.shear_stiffness is None:
            raise ValueError("shear_stiffness is required where stiffness = inf, got nothing; 0 is frictionless")
        if self.band[1] > 0:
            raise ValueError(f"band must open at once, band[1] = 0, where stiffness = inf, got {list(self.band)}")

    @property
    def shear(self) -> float:
        """Shear stiffness of a corner spring [N/m]."""
        return self.stiffness if self.shear_stiffness is None else self.shear_stiffness


class LoadSection(Section):
    """What acts from t = 0 on: loads that are switched on, and the motion of the base; each alone or together."""

    pressure: Real = 0.0  # q, Pa, downwards on the top edge
    eccentricity: Real = 0.0  # m, shift towards +x of the middle of the pressed part, whose length is L - 2 |e|
    traction: Real = 0.0  # Pa, towards +x on the whole top edge
    gravity: Real = 0.0  # m/s2, downwards
    slope: Angle = 0.0  # deg: gravity is turned to g (sin, -cos) in x and y, so that the block stands on its incline
    base_motion: str | None = None  # CSV file with the header time,x or time,y or time,x,y (s, m)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.model_fields_set & {"pressure", "traction", "gravity", "base_motion"}:
            raise ValueError("one of pressure, traction, gravity or base_motion is required, got none")
        if self.eccentricity != 0 and self.pressure == 0:
            raise ValueError(f"eccentricity goes with a pressure only, got {self.eccentricity:g} without one")
        if self.slope != 0 and self.gravity == 0:
            raise ValueError(f"slope goes with gravity only, got {self.slope:g} without it")
        return self

    @property
    def centred(self) -> bool:
        """Whether a centred pressure is all there is."""
        return self.eccentricity == self.traction == self.gravity == 0 and self.base_motion is None


class TimeSection(Section):
    """The Newmark scheme of equations (6) and (7) and its steps."""

    step: Positive  # s
    steps: Count
    alpha: NonNegative = 0.5
    delta: NonNegative = 1.0
    gg: Annotated[Real, Field(ge=0, le=1)] | None = None  # kinetic discount per step
    gg_rate: NonNegative | None = None  # 1/s: gg = exp(-gg_rate * step)
    start: Literal["zero", "consistent"] = "zero"  # initial acceleration
    allow_unstable: Flag = False

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.gg is not None and self.gg_rate is not None:
            raise ValueError("gg and gg_rate exclude each other, got both")
        return self

    @property
    def discount(self) -> float:
        """Factor gg on the velocity at the start of each step."""
        if self.gg_rate is not None:
            return math.exp(-self.gg_rate * self.step)
        return 1.0 if self.gg is None else self.gg

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        return self.step * self.steps


class DampingSection(Section):
    """Viscous damping of Rayleigh's kind, C = a0 M + a1 K, springs of the contact included, and what chooses gg."""

    mass: NonNegative = 0.0  # a0, 1/s
    stiffness: NonNegative = 0.0  # a1, s
    kinetic: Literal["constant", "adaptive"] = "constant"  # gg of [time], or from the kinetic energies of the steps
    floor: Annotated[Real, Field(ge=0, le=1)] = 0.0  # least adaptive gg

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.floor and self.kinetic != "adaptive":
            raise ValueError(f'floor goes with kinetic = "adaptive" only, got {self.floor:g} without it')
        return self

    @property
    def present(self) -> bool:
        """Whether there is viscous damping."""
        return self.mass > 0 or self.stiffness > 0


class FemSection(Section):
    """The finite-element pair: mesh and foundation."""

    elements: Count | None = None  # per side
    mesh: str | None = None  # file with tagged edges base, top
    degree: Annotated[int, BeforeValidator(_count), Field(ge=1, le=2)] = 2
    foundation: Literal["distributed", "patch", "corner", "nodes"] = "distributed"
    cells: Literal["quadrilaterals", "triangles"] = "quadrilaterals"  # of a structured mesh
    patch_width: Positive | None = None  # m

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.elements is not None and self.mesh is not None:
            raise ValueError("elements and mesh exclude each other, got both")
        if self.mesh is not None and self.cells != "quadrilaterals":
            raise ValueError(f"cells goes with a structured mesh only, got {self.cells!r} and a mesh file")
        if (self.foundation == "patch") != (self.patch_width is not None):
            raise ValueError(
                'patch_width goes with foundation = "patch" and only with it, '
                f"got foundation {self.foundation!r} and patch_width {self.patch_width}"
            )
        return self

    @property
    def per_side(self) -> int:
        """Elements per side of a structured mesh."""
        return FINE_ELEMENTS if self.elements is None else self.elements


class RunSection(Section):
    """What to run and what to keep."""

    solvers: Words = ("dda", "fem", "bar")
    columns: Words = ("displacement", "contact_pressure")
    geometry: Literal["small", "updated"] = "small"  # updated: outline, contact points, directions anew at every step
    rotation: Literal["exact", "first-order"] = "exact"  # of an updated outline; first-order is that of older programs

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.geometry == "small" and self.rotation != "exact":
            raise ValueError(f'rotation goes with geometry = "updated" only, got {self.rotation!r} without it')
        return self


class GateSection(Section):
    """A user's own gate on a pair of solvers (or one solver)."""

    pair: Annotated[Words, Field(max_length=2)]
    metric: str
    band: tuple[Real, Real]
    reason: Annotated[str, Field(min_length=1)]

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.band[0] > self.band[1]:
            raise ValueError(f"band must be [low, high] with low <= high, got {list(self.band)}")
        return self
