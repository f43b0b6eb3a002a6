"""Scenes: what is simulated, as TOML in SI units, checked with pydantic; unknown keys are refused.

A scene holds problem data only; no solver is imported here. Every defect of a scene file is reported as one
:class:`SceneError` line that names the file, the field, the rule and the value.
"""

from __future__ import annotations

import itertools
import json
import math
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from validation.errors import SceneError as SceneError
from validation.outline import Point, check_polygon, convex_quadrilateral

SCENE_DIRECTORY = Path(__file__).parent / "scenes"
FINE_ELEMENTS = 16
LARGEST_FILE, MOST_CASES = 1_000_000, 100_000  # bytes; cases of one sweep


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
Positive = Annotated[Real, Field(gt=0)]
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

    def edge(self, index: int) -> tuple[Point, Point]:
        """Return the end points of an edge [m]."""
        points = self.outline
        return points[index], points[(index + 1) % len(points)]


class ContactSection(Section):
    """Locked corner springs at the two ends of the base edge."""

    stiffness: Positive  # p, N/m per corner spring
    shear_stiffness: Positive | None = None  # N/m; p if absent

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
    base_motion: str | None = None  # CSV file with the header time,x or time,y or time,x,y (s, m)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.model_fields_set & {"pressure", "traction", "gravity", "base_motion"}:
            raise ValueError("one of pressure, traction, gravity or base_motion is required, got none")
        if self.eccentricity != 0 and self.pressure == 0:
            raise ValueError(f"eccentricity goes with a pressure only, got {self.eccentricity:g} without one")
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


class Scene(Section):
    """A scene as its file states it; `expand` resolves the sweep into single cases."""

    name: str = "scene"
    title: str = ""
    block: BlockSection
    contact: ContactSection
    load: LoadSection
    time: TimeSection
    fem: FemSection = FemSection()
    run: RunSection = RunSection()
    sweep: dict[str, Any] = Field(default_factory=dict)
    gate: tuple[GateSection, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        for field, values in self._swept().items():
            if not (isinstance(values, list) and values):
                raise ValueError(f"sweep: {field} must be a list of values that is not empty, got {values!r}")
            if field not in _sweepable():
                raise ValueError(f'sweep: unknown key, must be one of a table as in "time.step", got {field!r}')
        mode, lists = self.sweep.get("mode", "product"), self._swept()
        if mode not in ("product", "zip"):
            raise ValueError(f"sweep: mode must be 'product' or 'zip', got {mode!r}")
        if mode == "zip" and len({len(v) for v in lists.values()}) > 1:
            raise ValueError(f"sweep: lists of a zip must have one length, got {[*map(len, lists.values())]}")
        count = max(map(len, lists.values()), default=1) if mode == "zip" else math.prod(map(len, lists.values()))
        if count > MOST_CASES:
            raise ValueError(f"sweep: must make at most {MOST_CASES} cases, got {count}")
        if self.fem.patch_width is not None and self.fem.patch_width > self.block.base_length / 2:
            raise ValueError(
                f"fem: patch_width must be at most half the base length "
                f"{self.block.base_length / 2:g}, got {self.fem.patch_width:g}"
            )
        return self

    @model_validator(mode="after")
    def _check_pressed_part(self) -> Self:
        (x1, y1), (x2, y2) = self.block.edge(self.block.top)
        half = math.hypot(x2 - x1, y2 - y1) / 2
        if self.load.eccentricity and abs(self.load.eccentricity) >= half:
            raise ValueError(
                f"load: eccentricity must be below half the top edge {half:g}, got {self.load.eccentricity:g}"
            )
        return self

    def _swept(self) -> dict[str, list[Any]]:
        return {field: values for field, values in self.sweep.items() if field != "mode"}

    @property
    def beyond_two_blocks(self) -> str | None:
        """Why solvers that are written for one block under a centred pressure do not apply; None if they do."""
        if self.block.subdivide is not None:
            return "the block is cut into sub-blocks"
        return None if self.load.centred else "the solver is written for a centred pressure alone"

    def expand(self) -> tuple[Scene, ...]:
        """Return one scene per value of the sweep, named ``name[field=value,...]``.

        Raises
        ------
        SceneError
            A swept field or value is not allowed, or a case repeats.
        """
        lists = self._swept()
        if not lists:
            return (self,)
        rows = (
            zip(*lists.values(), strict=True) if self.sweep.get("mode") == "zip" else itertools.product(*lists.values())
        )
        return tuple(self._cases(lists, rows))

    def _cases(self, lists: dict[str, list[Any]], rows: Iterable[tuple[Any, ...]]) -> Iterator[Scene]:
        names = set()
        for row in rows:
            case = self.with_values(dict(zip(lists, row, strict=True)), label=True)
            if case.name in names:
                raise SceneError(f"{self.name}: sweep: must not repeat a case, got {case.name} twice")
            names.add(case.name)
            yield case

    def with_values(self, values: dict[str, Any], label: bool = False) -> Scene:
        """Return a copy with dotted keys replaced.

        A key that is set leaves the sweep, and so does a key that it excludes.

        Raises
        ------
        SceneError
            A key is no key of a scene, a value is not allowed, or two of the keys exclude each other.
        """
        data = self.definition()
        for field, value in values.items():
            if both := [other for other in _EXCLUSIVE.get(field, ()) if other in values]:
                raise SceneError(f"{self.name}: {field} and {both[0]} exclude each other, got both")
            _set_dotted(data, field, value, self.name)
        gone = {*values, *(other for field in values for other in _EXCLUSIVE.get(field, ()))}
        sweep = {f: v for f, v in self.sweep.items() if f not in gone}
        data["sweep"] = sweep if set(sweep) - {"mode"} else {}
        if label:
            inside = ",".join(f"{field}={_short(value)}" for field, value in values.items())
            data["name"] = f"{self.name}[{inside}]"
        return parse_scene(data, self.name)

    def definition(self) -> dict[str, Any]:
        """Return the scene as plain data (what a file would state)."""
        data: dict[str, Any] = json.loads(self.model_dump_json(exclude_unset=True))
        return data


def _short(value: object) -> str:
    """Return a value for a name; digits beyond six are kept, since names must tell cases apart."""
    if isinstance(value, list | tuple):
        return "x".join(map(_short, value))
    if not isinstance(value, float):
        return str(value)
    return f"{value:g}" if float(f"{value:g}") == value else repr(value)


def _set_dotted(data: dict[str, Any], field: str, value: object, where: str) -> None:
    """Set ``section.key`` in place; exclusive partners of the key are taken out."""
    section, _, key = field.partition(".")
    if not key:
        section, key = "", section
    if field in ("name", "sweep", "gate") or field.startswith(("sweep.", "gate.")):
        raise SceneError(f"{where}: {field}: must be a key as in time.step=0.001, got {field!r}")
    table = data.setdefault(section, {}) if section else data
    if not isinstance(table, dict):
        raise SceneError(f"{where}: {field}: must be section.key, got {field!r}")
    for partner in _EXCLUSIVE.get(field, ()):
        table.pop(partner.partition(".")[2], None)
    table[key] = value


def _sweepable() -> set[str]:
    """Return the dotted keys of the tables that a sweep may vary."""
    tables = {name: field.annotation for name, field in Scene.model_fields.items() if name != "run"}
    sections = {n: t for n, t in tables.items() if isinstance(t, type) and issubclass(t, Section)}
    return {f"{name}.{key}" for name, table in sections.items() for key in table.model_fields}


_FILES = ("fem.mesh", "load.base_motion")
_EXCLUSIVE = {
    "time.gg": ("time.gg_rate",),
    "time.gg_rate": ("time.gg",),
    "fem.elements": ("fem.mesh",),
    "fem.mesh": ("fem.elements",),
    "block.side": ("block.width", "block.height", "block.vertices", "block.base", "block.top"),
    "block.vertices": ("block.side", "block.width", "block.height"),
    "block.width": ("block.side", "block.vertices"),
    "block.height": ("block.side", "block.vertices"),
}


def parse_scene(data: dict[str, Any], source: str) -> Scene:
    """Check plain data and return the scene.

    Raises
    ------
    SceneError
        With one line: source, field, rule and value of the first defect.
    """
    try:
        return Scene.model_validate(data)
    except ValidationError as error:
        raise SceneError(_one_line(error, source)) from None
    except RecursionError:
        raise SceneError(f"{source}: scene: must not be nested so deeply, got too many levels") from None


def _one_line(error: ValidationError, source: str) -> str:
    """Return the first defect of a pydantic report as ``source: field: rule, got value``."""
    first = error.errors(include_url=False)[0]
    field = ".".join(str(part) for part in first["loc"])
    where = f"{source}: {field}" if field else source  # a rule on the whole scene begins with its field
    rule = first["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    if first["type"] == "extra_forbidden":
        rule = "unknown key"
    elif first["type"] == "missing":
        return f"{where}: is required, got nothing"
    elif rule == first["msg"].removeprefix("Input should be ") and "Input should be" in first["msg"]:
        rule = f"must be {rule}"
    elif first["type"].endswith(("too_short", "too_long")):
        rule = f"must{rule.partition('should')[2].partition(' after')[0]}"
    if ", got " not in rule:
        rule = f"{rule}, got {_clip(first['input'])}"
    more = error.error_count() - 1
    return f"{where}: {rule}" + (f" (and {more} more)" if more else "")


def _clip(value: object, width: int = 60) -> str:
    try:
        text = repr(value)
    except (RecursionError, ValueError):  # too many levels, or an integer of too many digits
        text = f"a {type(value).__name__} too large to print"
    return text if len(text) <= width else f"{text[: width - 3]}..."


def scene_names() -> list[str]:
    """Return the names of the built-in scenes."""
    return sorted(path.stem for path in SCENE_DIRECTORY.glob("*.toml"))


def load_scene(source: str | Path) -> Scene:
    """Return the scene of a TOML file or of a built-in name.

    Parameters
    ----------
    source
        Path of a scene file, or a name that `scene_names` lists.

    Raises
    ------
    SceneError
        The file cannot be read, is not TOML, or states something that is not allowed.
    """
    path = Path(source)
    if path.suffix != ".toml" and str(source) in scene_names():
        path = SCENE_DIRECTORY / f"{source}.toml"
    data = _read_toml(path)
    if "name" in data:
        raise SceneError(f"{path.name}: name: unknown key, got {_clip(data['name'])}")
    _beside(path.parent, data)
    return parse_scene({"name": path.stem} | data, path.name)


def _beside(directory: Path, data: dict[str, Any]) -> None:
    """Let the files that a scene names, in a table or in the sweep, stand beside the scene's own file."""

    def beside(value: object) -> object:
        return str(directory / value) if isinstance(value, str) else value

    for field in _FILES:
        section, _, key = field.partition(".")
        table, sweep = data.get(section), data.get("sweep")
        if isinstance(table, dict) and key in table:
            table[key] = beside(table[key])
        if isinstance(sweep, dict) and isinstance(sweep.get(field), list):
            sweep[field] = [beside(value) for value in sweep[field]]


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        if path.is_file() and path.stat().st_size > LARGEST_FILE:
            raise SceneError(f"{path}: must be at most {LARGEST_FILE} bytes, got {path.stat().st_size}")
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except FileNotFoundError:
        known = ", ".join(scene_names())
        raise SceneError(f"{path}: no such scene file; built-in scenes: {known}") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise SceneError(f"{path}: must be UTF-8 text, got bytes that are not") from None
    except (ValueError, RecursionError) as error:  # TOMLDecodeError is one, so is an integer too long
        raise SceneError(f"{path}: must be TOML: {' '.join(str(error).split())}") from None


def parse_assignment(text: str) -> tuple[str, Any]:
    """Split ``key=value`` of the command line; the value is TOML, or else a plain word.

    Raises
    ------
    SceneError
        There is no ``=`` or no key.
    """
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise SceneError(f"--set: must be key=value, got {text!r}")
    try:
        parsed = tomllib.loads(f"value = {value}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        parsed = value
    return key.strip(), parsed
