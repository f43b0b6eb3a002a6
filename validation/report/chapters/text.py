"""Numbers and swept values as the report writes them."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from validation.runs.case_name import CaseName
from validation.runs.row import Value
from validation.runs.text import shown
from validation.scenes.keys import described, keys_of, stated
from validation.scenes.scene import Scene

DASH = "–"
AS_STATED = "as stated"  # label of a case without swept values
# edges of a polygon, of which only the number of vertices is written, and what the words of a column's faces say
IMPLIED = {"block.base", "block.top", "column.law", "column.stiffness"}
_FACES = {
    "bonded": "glued with",
    "unilateral": "on contacts without tension of",
    "frictional": "on contacts that slip, of",
}  # how the faces of a column's blocks touch, by the law of its springs
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MEANINGS = (
    ("undefined", "undef.", "undefined, the metric has no meaning for this run."),
    ("alias", "alias", "the frequency lies beyond π/Δt, and samples every Δt show another."),
    ("not reported", "n. r.", "not reported, the solver does not give what the metric needs."),
)
_WORDS = {word: short_word for word, short_word, _ in _MEANINGS}
_UNITS = str.maketrans("23", "²³")

PARAMETERS = {  # how the data of a block are written, in this order; those at their defaults are not
    "block.vertices": "polygon of {} vertices",
    "block.side": "a = {:g} m",
    "block.width": "{:g} m wide",
    "block.height": "{:g} m high",
    "block.density": "ρ = {:g} kg/m³",
    "block.young": "E = {:short2} Pa",
    "block.poisson": "μ = {:g}",
    "block.hypothesis": "{}",
    "block.subdivide": "{0[0]:g} by {0[1]:g} sub-blocks",
    "block.pattern": "{}",
    "block.glue_ratio": "glue = {:short2}E",
    "block.velocity": "{:g} m/s upwards at t = 0",
    "block.tilt": "tilted by {:.4g}°",
    "contact.stiffness": "p = {:short2} N/m",
    "contact.shear_stiffness": "in shear {:short2} N/m",
    "contact.law": "springs without tension",
    "contact.friction": "friction φ = {:.4g}°",
    "contact.rules": "{} friction",
    "contact.cohesion": "cohesion {:short2} Pa",
    "contact.rule": "{} contact",
    "contact.gap": "gap {:short4} m",
    "contact.band": "dead band −{0[0]:short4} to {0[1]:short4} m",
    "load.pressure": "q = {:short2} Pa",
    "load.eccentricity": "e = {:g} m",
    "load.traction": "τ = {:short2} Pa",
    "load.gravity": "g = {:g} m/s²",
    "load.slope": "slope β = {:.4g}°",
    "load.base_motion": "base moved by {}",
    "run.geometry": "updated geometry",
    "run.rotation": "{} rotation",
}
ALWAYS = {"block.poisson", "block.hypothesis", "load.pressure"}  # written at their defaults too
WRITTEN_WITH = {  # data that say something beside another one only
    "block.pattern": "block.subdivide",
    "block.glue_ratio": "block.subdivide",
    "contact.rules": "contact.friction",
    "run.rotation": "run.geometry",
}
SPECIAL = {("contact.stiffness", math.inf): "rigid stops", ("contact.shear_stiffness", 0.0): "frictionless"}


def raised(number: int) -> str:
    """Return a whole number in superscript digits."""
    return str(number).translate(_RAISED)


def power(value: float, digits: int = 2) -> str:
    """Return a number as mantissa times a power of ten, ``3.6×10⁻²``."""
    if value == 0 or not math.isfinite(value):
        return plain(value, digits)
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}×10{raised(int(exponent))}".replace("-", "−")


def plain(value: float, digits: int = 4) -> str:
    """Return a number with significant digits, as a power of ten outside 1e-3 to 1e6."""
    if math.isnan(value):
        return "not a number"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value and not 1e-3 <= abs(value) < 1e6:
        return power(value, digits)
    text = f"{value:#.{digits}g}" if value else "0"
    return (f"{value:.0f}" if "e" in text else text.removesuffix(".")).replace("-", "−")


def short(value: float, digits: int = 4) -> str:
    """Return a number as `plain` does, without zeros at the end of its decimals."""
    return re.sub(r"(\.\d*?)0+(?=×|$)", r"\1", plain(value, digits)).replace(".×", "×").removesuffix(".")


def bounded(value: float, text: str) -> str:
    """Return the text of a measured value; where it is rounding, say that it is below 1e-12."""
    return f"<10{raised(-12)}" if isinstance(value, float) and abs(value) <= 1e-12 else text


def capital(text: str) -> str:
    """Return a sentence with a capital letter."""
    return text[:1].upper() + text[1:]


def percent(value: float) -> str:
    """Return a fraction in per cent, or as a power of ten below 0.01 %."""
    return f"{short(100 * value, 3)}\u00a0%" if value == 0 or value >= 1e-4 else power(value)


def span(values: Sequence[float]) -> str:
    """Return the range of fractions, ``0.26 % to 9.0 %``; one value where they read alike."""
    low = percent(min(values))
    high = percent(max(values))
    return low if low == high else f"{low} to {high}"


def cell(value: Value, factor: float = 1.0, digits: int = 4) -> str:
    """Return a metric as a table cell: a number, or its word, or a dash where there is none."""
    if value is None:
        return DASH
    return _WORDS.get(value, value) if isinstance(value, str) else plain(value * factor, digits)


def word_notes(values: Iterable[Value]) -> tuple[str, ...]:
    """Return what the short words in a table's cells stand for."""
    words = set(values)
    return tuple(f"{short_word}: {meaning}" for word, short_word, meaning in _MEANINGS if word in words)


def case_labels(names: Sequence[str], scenes: Sequence[Scene]) -> list[str]:
    """Return a short label per case of one scene: the swept values in the symbols of the text."""
    full = list(map(case_label, names, scenes))
    short = [case_label(name, scene, {"time.steps"}) for name, scene in zip(names, scenes, strict=True)]
    return short if len(set(short)) == len(short) else full


def case_label(name: str, scene: Scene, without: Collection[str] = ()) -> str:
    """Return the swept values of a case in the symbols of the text, without those of some fields."""
    parts = []
    for field, value in CaseName.parse(name).values.items():
        if field in without:
            continue
        symbol, unit = _symbol(scene, field)
        if field == "contact.stiffness":
            unit = ""
            value = f"{scene.contact.stiffness / scene.block.young:.4g}E"
        elif field == "block.glue_ratio":
            unit = "E"
        elif unit == " Pa":
            value, unit = _pressure(value)
        parts.append((f"{symbol} = {value}{unit}" if symbol else value).replace("-", "−"))
    return ", ".join(parts) or AS_STATED


def _symbol(scene: Scene, field: str) -> tuple[str, str]:
    """Return the symbol of a key and its unit, as they stand beside a number."""
    place, _, name = field.partition(".")
    table = scene.tables().get(place)
    for key_name, _, key in keys_of(type(table)) if table is not None else ():
        if key_name == name:
            unit = "°" if key.unit == "deg" else f" {key.unit.translate(_UNITS)}".rstrip()
            return name.replace("_", " ") if key.symbol is None else key.symbol, unit
    return name.replace("_", " "), ""


def _pressure(text: str) -> tuple[str, str]:
    """Return a pressure in MPa where it is large, as number and unit; zero needs none."""
    value = float(text)
    if value == 0:
        return "0", ""
    return (f"{value / 1e6:g}", " MPa") if abs(value) >= 1e4 else (f"{value:g}", " Pa")


def parameters(scene: Scene, varied: set[str]) -> str:
    """Return the data of a scene in one line, without the fields that vary between its cases."""
    return f"{', '.join(parameter_items(scene, varied))}."


def parameter_items(scene: Scene, varied: set[str]) -> list[str]:
    """Return the data of a scene, without the fields that vary between its cases."""
    time = scene.time
    items = [
        *(_of_column(scene) if scene.column is not None else _of_block(scene)),
        ("time.step", f"dt = {time.step:g} s"),
        ("time.steps", f"{time.steps} steps"),
        ("time.alpha", f"α = {time.alpha:g}"),
        ("time.delta", f"δ = {time.delta:g}"),
        ("time.gg", f"gg = {time.discount:.6g}"),
        *_of_damping(scene),
        ("time.start", f"{time.start} initial acceleration"),
        ("fem.degree", f"elements of degree {scene.fem.degree}"),
        *_of_mesh(scene),
    ]
    items += _of_others(scene, {field for field, _ in items})
    return [text for field, text in items if field not in varied]


def _of_block(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield the data of a block, its contact, its load and its geometry, by their fields."""
    for field, template in PARAMETERS.items():
        if _is_written(scene, WRITTEN_WITH.get(field, field)):
            value = _value(scene, field)
            yield field, SPECIAL.get((field, value)) or template.format(_written(value))


def _value(scene: Scene, field: str) -> Any:
    table, key = field.split(".")
    return getattr(getattr(scene, table), key)


def _is_written(scene: Scene, field: str) -> bool:
    """Whether a datum is not the default of its key, or is written all the same."""
    table, key = field.split(".")
    fields = type(getattr(scene, table)).model_fields
    return field in ALWAYS or _value(scene, field) != fields[key].default


class _Number(float):
    """A number with a true minus sign; `short2` writes two digits without zeros at the end of its decimals."""

    def __format__(self, spec: str) -> str:
        if spec.startswith("short"):
            return short(float(self), int(spec.removeprefix("short")))
        return format(float(self), spec).replace("-", "−")


def _written(value: Any) -> Any:
    """Return a value for its template: numbers as they are written, of a file its name, of a polygon its vertices."""
    if isinstance(value, tuple):
        return len(value) if isinstance(value[0], tuple) else tuple(map(_Number, value))
    return shown(Path(value).name) if isinstance(value, str) else _Number(value)


def _of_damping(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield the viscous damping and the adaptive discount, where there are any."""
    damping = scene.damping
    if damping.present:
        yield "damping.mass", f"a₀ = {damping.mass:g} 1/s"
        yield "damping.stiffness", f"a₁ = {damping.stiffness:g} s"
    if damping.kinetic == "adaptive":
        yield "damping.kinetic", "adaptive gg"


def _of_others(scene: Scene, written: set[str]) -> Iterator[tuple[str, str]]:
    """Yield the data of a block that are not `written` yet, by their keys, where they are not the defaults."""
    for place, table in scene.tables().items():
        if place in ("block", "contact", "load", "damping", "column"):
            for name, value, key in stated(table):
                if f"{place}.{name}" not in written | IMPLIED:
                    yield f"{place}.{name}", described(name, value, key)


def _of_mesh(scene: Scene) -> list[tuple[str, str]]:
    """Return the data of the elements, by their fields."""
    if scene.column is not None:
        return [("fem.elements", f"{scene.fem.per_side} a block")]
    return [
        ("fem.elements", f"{scene.fem.per_side} a side" if not scene.fem.mesh else "mesh from a file"),
        ("fem.foundation", f"{scene.fem.foundation} foundation"),
    ]


def _of_column(scene: Scene) -> list[tuple[str, str]]:
    """Return the data of a column and its drive, by their fields."""
    column = scene.column
    if column is None:
        return []
    drive = scene.stated_input
    blocks = sum(layer.blocks for layer in column.layer)
    joints = f"{len(column.joint)} joint{'s' * (len(column.joint) > 1)}" if column.joint else "no joints"
    springs = column.glue if column.law == "bonded" else column.stiffness
    glue = "welded" if springs is None else f"{_FACES[column.law]} {short(springs, 2)} Pa/m"
    return [
        ("column.layer", f"{len(column.layer)} layer{'s' * (len(column.layer) > 1)} of {blocks} blocks in all"),
        ("column.height", f"{column.height:g} m high"),
        ("column.motion", f"{column.motion} waves"),
        ("column.glue", glue),
        ("column.joint", joints),
        ("column.base", f"{column.base} base"),
        *([("input.shape", f"{drive.shape or 'record'} at the {drive.at}")] if drive is not None else []),
    ]


def load_size(scene: Scene) -> float:
    """Return the size of the pressure on a block [Pa], beside which smaller ones are rounding; a column has none."""
    return abs(scene.load.pressure) if scene.column is None else math.inf
