"""The tables of a scene file: their fields, units and rules, checked with pydantic; unknown keys are refused."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, PlainSerializer, model_validator

from validation.errors import InputError
from validation.runs.history import Array
from validation.scenes.keys import Key, Section
from validation.scenes.outline import Point, area, check_polygon, convex_quadrilateral

FINE_ELEMENTS = 16
SMALLEST = 1e-60
"""Smallest positive value of a quantity, in its unit: fourth powers of lengths and squares of time steps, and their
inverses, keep all digits of double precision."""


def _not_tiny(number: float) -> float:
    """Accept a positive number whose powers are numbers too."""
    if number < SMALLEST:
        raise ValueError(f"must be at least {SMALLEST:g}")
    return number


def _infinite(value: object) -> object:
    """Accept the word inf of plain data for a rigid stop."""
    return math.inf if value == "inf" else value


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


Real = Annotated[float, Field(strict=True, allow_inf_nan=False)]  # nothing that merely converts to a number
Angle = Annotated[Real, Field(gt=-90, lt=90)]  # deg
Positive = Annotated[Real, Field(gt=0), AfterValidator(_not_tiny)]
Stiffness = Annotated[
    float,
    BeforeValidator(_infinite),
    Field(gt=0, strict=True),
    AfterValidator(_not_tiny),
    PlainSerializer(_stiffness_as_data, when_used="json"),
]
NonNegative = Annotated[Real, Field(ge=0)]
Share = Annotated[Real, Field(ge=0, le=1)]
FrictionAngle = Annotated[Angle, Field(ge=0)]  # deg
PoissonRatio = Annotated[Real, Field(gt=-1, lt=0.5)]
Hypothesis = Literal["plane stress", "plane strain"]
Pattern = Literal["squares", "triangles"]  # of blocks that others are cut into
Index = Annotated[int, BeforeValidator(_count)]
Count = Annotated[Index, Field(ge=1)]
Cut = tuple[Count, Count]  # into so many blocks along two directions
Flag = Annotated[bool, Field(strict=True)]
Words = Annotated[tuple[str, ...], Field(min_length=1), AfterValidator(_distinct)]


OPENS = 'law = "unilateral"'
STEPPED = 'rule = "newmark" or "implicit"'
WITH_RHO_INF = 'scheme = "chung-hulbert" or "hht" or "wbz" or "composite"'
UPDATED = 'geometry = "updated"'


class BlockSection(Section):
    """The loaded block A: outline and material.

    The outline is a square (`side`), an upright rectangle (`width`, `height`) with its lower left corner at the
    origin, or a counter-clockwise polygon (`vertices` with the indices of its `base` and `top` edges).
    """

    side: Annotated[Positive | None, Key("m", "side of a square", "a")] = None
    width: Annotated[Positive | None, Key("m", "width of a rectangle", "w")] = None
    height: Annotated[Positive | None, Key("m", "height of a rectangle", "h")] = None
    vertices: Annotated[tuple[tuple[Real, Real], ...] | None, Key("m", "corners, counter-clockwise")] = None
    base: Annotated[Index, Key("", "edge on the base; edge i runs from vertex i to i + 1", needs=("vertices",))] = 0
    top: Annotated[Index, Key("", "edge that is loaded", needs=("vertices",))] = 2
    density: Annotated[Positive, Key("kg/m3", "mass of a volume", "ρ")]
    young: Annotated[Positive, Key("Pa", "Young's modulus", "E")]
    velocity: Annotated[Real, Key("m/s", "at t = 0, upwards", "v", ("contact." + OPENS,))] = 0.0
    tilt: Annotated[
        Angle, Key("deg", "at t = 0, counter-clockwise about the lower corner", None, ("run." + UPDATED,))
    ] = 0.0
    poisson: Annotated[Annotated[Real, Field(gt=-1, le=0.5)], Key("", "Poisson's ratio", "μ")] = 0.0
    hypothesis: Annotated[Hypothesis, Key("", "of the plane problem", "")] = "plane stress"
    subdivide: Annotated[Cut | None, Key("sub-blocks", "along the base and upwards", "")] = None
    pattern: Annotated[
        Pattern,
        Key("", "of the sub-blocks; triangles: each square cut from lower left to upper right", "", ("subdivide",)),
    ] = "squares"
    glue_ratio: Annotated[Positive, Key("m", "end spring of a joint over young", "glue", ("subdivide",))] = 1.0e6

    @model_validator(mode="after")
    def _check(self) -> Self:
        stated = {
            "side": self.side is not None,
            "width and height": self.width is not None or self.height is not None,
            "vertices": self.vertices is not None,
        }
        names = [name for name, present in stated.items() if present]
        if len(names) > 1:
            raise ValueError(f"{names[0]} and {names[1]} exclude each other, got both")
        if not names:
            raise ValueError("one of side, width and height, or vertices must be given, got none")
        if stated["width and height"] and (self.width is None or self.height is None):
            raise ValueError("width and height must be given together, got one")
        if self.subdivide is not None and not convex_quadrilateral(self.outline):
            raise ValueError(f"subdivide goes with convex quadrilaterals only, got {len(self.outline)} vertices")
        if self.hypothesis == "plane strain" and self.poisson >= 0.5:
            raise ValueError(f"poisson must be below 0.5 in plane strain, got {self.poisson:g}")
        if self.vertices is not None:
            check_polygon(self.vertices, self.base, self.top)
        return self

    @property
    def outline(self) -> tuple[Point, ...]:
        """Vertices [m], counter-clockwise."""
        if self.vertices is not None:
            return self.vertices
        w, h = (self.side, self.side) if self.side is not None else (self.width, self.height)
        return ((0.0, 0.0), (w, 0.0), (w, h), (0.0, h))  # type: ignore[return-value]

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height that the outline takes up [m]."""
        width, height = np.ptp(self.outline, axis=0).tolist()
        return width, height

    @property
    def rectangle(self) -> tuple[float, float] | None:
        """Width and height of an upright rectangle that lies on its lower edge, None of another outline [m]."""
        if len(self.outline) != 4 or (self.base, self.top) != (0, 2):
            return None
        (x0, y0), (x1, y1), (x2, y2), (x3, y3) = self.outline
        is_upright = y0 == y1 < y2 == y3 and x0 == x3 < x1 == x2
        return (x1 - x0, y2 - y0) if is_upright else None

    @property
    def cuts(self) -> tuple[int, int]:
        """Sub-blocks along the base and upwards; one of a whole block."""
        return self.subdivide or (1, 1)

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

    law: Annotated[Literal["locked", "unilateral"], Key("", "whether the springs carry tension")] = "locked"
    stiffness: Annotated[Stiffness, Key("N/m", "of each corner spring; inf is a rigid stop", "p")]
    shear_stiffness: Annotated[NonNegative | None, Key("N/m", "that of stiffness if absent; 0 is frictionless")] = None
    friction: Annotated[
        FrictionAngle | None,
        Key("deg", "angle of friction; a closed corner is bonded in shear without", "φ", (OPENS, STEPPED)),
    ] = None
    cohesion: Annotated[NonNegative, Key("Pa", "over the whole base, half at each corner", None, ("friction",))] = 0.0
    rule: Annotated[
        Literal["newmark", "implicit", "energy-conserving", "impact", "augmented"],
        Key("", "how a step takes the contact force", "", (OPENS,)),
    ] = "newmark"
    damping_ratio: Annotated[
        NonNegative,
        Key("", "c / (2 sqrt(k m)) of dashpots beside the springs, k both springs", "ζ", (OPENS, 'rule = "newmark"')),
    ] = 0.0
    restitution: Annotated[
        Share | None,
        Key(
            "",
            "rebound over landing speed: of the impact law, or in place of damping_ratio",
            "e",
            (OPENS, 'rule = "newmark" or "impact"'),
        ),
    ] = None
    penetration: Annotated[
        Positive, Key("m", "that the passes of the augmented Lagrangian leave", None, ('rule = "augmented"',))
    ] = 1e-9
    rules: Annotated[
        Literal["consistent", "lagged"],
        Key("", "lagged: friction of the iteration before", "", ("friction", 'rule = "newmark"')),
    ] = "consistent"
    gap: Annotated[NonNegative, Key("m", "between block and springs at t = 0", None, (OPENS,))] = 0.0
    band: Annotated[
        tuple[NonNegative, NonNegative],
        Key("m", "closes below -band[0], opens above band[1]", None, (OPENS, STEPPED)),
    ] = (0.0, 0.0)
    solve_limit: Annotated[
        Count, Key("", "solves of the open-close iteration before every contact state is tried", None, (OPENS,))
    ] = 6
    cut: Annotated[
        Annotated[Real, Field(gt=0, lt=1)],
        Key("", "length of a step that is repeated, over the failed one", None, (OPENS,)),
    ] = 0.3

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.friction is not None and self.shear_stiffness == 0:
            raise ValueError("shear_stiffness must be greater than 0 with friction, got 0")
        if math.isinf(self.stiffness):
            if self.law == "locked" or self.rule in ("energy-conserving", "augmented"):
                stated_rule = 'law = "locked"' if self.law == "locked" else f'rule = "{self.rule}"'
                raise ValueError(f"stiffness must be finite with {stated_rule}, got inf")
            if self.shear_stiffness is None:
                raise ValueError("shear_stiffness is required where stiffness = inf, got nothing; 0 is frictionless")
            if self.band[1] > 0:
                raise ValueError(f"band must open at once, band[1] = 0, where stiffness = inf, got {list(self.band)}")
        if self.rule == "impact":
            if math.isfinite(self.stiffness):
                raise ValueError(f'stiffness must be inf with rule = "impact", got {self.stiffness:g}')
            if self.restitution is None:
                raise ValueError('restitution is required with rule = "impact", got nothing; 0 is plastic, 1 elastic')
        if self.damping_ratio and self.restitution is not None:
            raise ValueError("damping_ratio and restitution exclude each other, got both")
        if self.has_dashpots and math.isinf(self.stiffness):
            raise ValueError(
                'stiffness must be finite where dashpots stand beside it, got inf; rule = "impact" takes restitution'
            )
        if self.rule == "newmark" and self.restitution == 0:
            raise ValueError('restitution must be greater than 0 of dashpots, got 0; rule = "impact" takes 0')
        if self.friction is not None and (self.has_dashpots or self.rule in ("impact", "augmented")):
            method = "dashpots" if self.has_dashpots else f'rule = "{self.rule}"'
            raise ValueError(f"friction does not go with {method}, got {self.friction:g} deg")
        if self.law == "locked" and self.shear_stiffness == 0:
            raise ValueError('shear_stiffness must be greater than 0 where law = "locked", got 0')
        return self

    @property
    def is_rigid_stop(self) -> bool:
        """Whether a rigid stop acts on displacements, and turns back as its steps happen to; an impact has a law."""
        return math.isinf(self.stiffness) and self.rule != "impact"

    @property
    def has_dashpots(self) -> bool:
        """Whether dashpots stand beside the springs, by their damping ratio or by the rebound that they leave."""
        return self.damping_ratio > 0 or (self.rule == "newmark" and self.restitution is not None)

    @property
    def shear(self) -> float:
        """Shear stiffness of a corner spring [N/m]."""
        return self.stiffness if self.shear_stiffness is None else self.shear_stiffness


class LoadSection(Section):
    """What acts from t = 0 on: loads that are switched on, and the motion of the base; each alone or together."""

    pressure: Annotated[Real, Key("Pa", "downwards on the top edge", "q")] = 0.0
    eccentricity: Annotated[
        Real, Key("m", "shift towards +x of the middle of the pressed part, L - 2 |e| long", "e", ("pressure",))
    ] = 0.0
    traction: Annotated[Real, Key("Pa", "towards +x on the whole top edge", "τ")] = 0.0
    gravity: Annotated[Real, Key("m/s2", "downwards", "g")] = 0.0
    slope: Annotated[Angle, Key("deg", "of the base: gravity acts as g (sin, -cos) in x and y", "β", ("gravity",))] = (
        0.0
    )
    ramp: Annotated[
        NonNegative,
        Key("s", "in which pressure, traction and gravity rise linearly from zero", feature="ramped load"),
    ] = 0.0
    base_motion: Annotated[str | None, Key("", "CSV file with the header time,x or time,y or time,x,y, in s and m")] = (
        None
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.model_fields_set & {"pressure", "traction", "gravity", "base_motion"}:
            raise ValueError("one of pressure, traction, gravity or base_motion is required, got none")
        return self

    @property
    def numbers(self) -> dict[str, float]:
        """The loads by their names, which are those of both solver packages."""
        return self.model_dump(exclude={"base_motion"})

    @property
    def off_centre(self) -> bool:
        """Whether pressure or traction would turn the block."""
        return self.eccentricity != 0 or self.traction != 0

    @property
    def centred(self) -> bool:
        """Whether a centred pressure is all there is."""
        return not self.off_centre and self.gravity == 0 and self.base_motion is None

    def acted(self, time: Array) -> Array:
        """Return how long the loads would act in full to give the impulse that they have given by each time [s]."""
        if self.ramp == 0:
            return time
        return np.where(time < self.ramp, time**2 / (2 * self.ramp), time - self.ramp / 2)


class TimeSection(Section):
    """The time scheme, Newmark's of equations (6) and (7) or another by its name, and its steps."""

    step: Annotated[Positive, Key("s", "time step", "dt")]
    steps: Annotated[Count, Key("", "number of steps")]
    scheme: Annotated[
        Literal["newmark", "chung-hulbert", "hht", "wbz", "leapfrog", "composite"],
        Key("", "time scheme; dda-validate list schemes describes them", ""),
    ] = "newmark"
    rho_inf: Annotated[
        Share | None,
        Key("", "spectral radius at infinite frequency; of the composite scheme 0 if absent", "ρ∞", (WITH_RHO_INF,)),
    ] = None
    split: Annotated[
        Annotated[Real, Field(gt=0, lt=1)] | None,
        Key("", "share of the step that the composite scheme's first solve spans", "γ", ('scheme = "composite"',)),
    ] = None
    stated_alpha: Annotated[NonNegative, Key("", "Newmark's weight of the acceleration in the displacement", "α")] = (
        Field(0.5, alias="alpha")
    )
    stated_delta: Annotated[NonNegative, Key("", "Newmark's weight of the acceleration in the velocity", "δ")] = Field(
        1.0, alias="delta"
    )
    gg: Annotated[Share | None, Key("", "factor on the velocity at the start of each step")] = None
    gg_rate: Annotated[NonNegative | None, Key("1/s", "in place of gg: gg = exp(-gg_rate step)", "c")] = None
    start: Annotated[Literal["zero", "consistent"], Key("", "initial acceleration")] = "zero"
    allow_unstable: Annotated[Flag, Key("", "whether a step beyond the stability limit is run")] = False

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.gg is not None and self.gg_rate is not None:
            raise ValueError("gg and gg_rate exclude each other, got both")
        if self.scheme != "newmark":
            named = f'scheme = "{self.scheme}"'
            for weight, value in (("alpha", self.stated_alpha), ("delta", self.stated_delta)):
                if f"stated_{weight}" in self.model_fields_set:
                    raise ValueError(f"{weight} is Newmark's and does not go with {named}, got {value:g}")
            if self.rho_inf is None and self.scheme in ("chung-hulbert", "hht", "wbz"):
                raise ValueError(f"rho_inf is required with {named}, got nothing")
            if self.scheme == "hht" and self.rho_inf is not None and self.rho_inf < 0.5:
                raise ValueError(
                    f"rho_inf must be at least 0.5 with {named}, got {self.rho_inf:g}; "
                    "HHT's alpha = -(1 - rho_inf) / (1 + rho_inf) lies between -1/3 and 0"
                )
            if self.scheme == "leapfrog" and self.start != "consistent":
                raise ValueError(f'start must be "consistent" with {named}, got "{self.start}"')
        return self

    @property
    def alpha(self) -> float:
        """Newmark's weight of the acceleration in the displacement; refused of another scheme."""
        return self._newmark("alpha", self.stated_alpha)

    @property
    def delta(self) -> float:
        """Newmark's weight of the acceleration in the velocity; refused of another scheme."""
        return self._newmark("delta", self.stated_delta)

    def _newmark(self, field: str, value: float) -> float:
        """Return a weight of Newmark's scheme: no one may take another scheme for it."""
        if self.scheme != "newmark":
            raise InputError(
                'is needed for what is asked, of scheme = "newmark"',
                field=f"time.{field}",
                value=f'scheme = "{self.scheme}"',
            )
        return value

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

    mass: Annotated[NonNegative, Key("1/s", "a0 of C = a0 M + a1 K")] = 0.0
    stiffness: Annotated[NonNegative, Key("s", "a1 of C = a0 M + a1 K")] = 0.0
    kinetic: Annotated[
        Literal["constant", "adaptive"], Key("", "gg of [time], or from the kinetic energies of the steps")
    ] = "constant"
    floor: Annotated[Share, Key("", "least adaptive gg", None, ('kinetic = "adaptive"',))] = 0.0

    @property
    def present(self) -> bool:
        """Whether there is viscous damping."""
        return self.mass > 0 or self.stiffness > 0


class FemSection(Section):
    """The finite-element pair: mesh and foundation."""

    elements: Annotated[Count | None, Key("", f"per side of a structured mesh, {FINE_ELEMENTS} if absent", "n")] = None
    mesh: Annotated[str | None, Key("", "file with the tagged edges base and top")] = None
    degree: Annotated[Annotated[Index, Field(ge=1, le=2)], Key("", "of the elements")] = 2
    foundation: Annotated[
        Literal["distributed", "patch", "corner", "nodes"], Key("", "where the springs of the base act")
    ] = "distributed"
    cells: Annotated[Literal["quadrilaterals", "triangles"], Key("", "of a structured mesh")] = "quadrilaterals"
    patch_width: Annotated[Positive | None, Key("m", "of each end of the base that has springs")] = None

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

    solvers: Annotated[Words, Key("", "that run the scene")] = ("dda", "fem", "bar")
    columns: Annotated[Words, Key("", "of the histories")] = ("displacement", "contact_pressure")
    geometry: Annotated[
        Literal["small", "updated"],
        Key("", "updated: outline, contact points and directions anew at every step", None, ("contact." + OPENS,)),
    ] = "small"
    rotation: Annotated[
        Literal["exact", "first-order"],
        Key("", "of an updated outline; first-order is that of older programs", None, (UPDATED,)),
    ] = "exact"


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
