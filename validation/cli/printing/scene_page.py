"""The page of a scene: its model drawn in text, its steps, and the numbers that follow, before anything runs."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections import Counter
from collections.abc import Iterator, Sequence
from operator import itemgetter
from typing import Any

import numpy as np

from validation.advice.plain import Line, in_columns
from validation.cli.printing import numbers
from validation.scenes import features
from validation.scenes.keys import described, stated
from validation.scenes.plausibility import plausibility_warnings
from validation.scenes.rigid import BoxSection, RigidSection
from validation.scenes.scene import Scene
from validation.theory.stepping import Stepping

INSIDE = 15  # characters of a block's width in the drawing
NARROWEST = 5  # the same of a tall block
BESIDE = 7  # characters of a line of the drawing besides the block's width, before its text
SCHEMES = {
    (0.5, 1.0): "constant acceleration",
    (0.25, 0.5): "average acceleration",
    (1 / 6, 0.5): "linear acceleration",
    (0.0, 0.5): "central differences",
}
WRITTEN = {  # keys of `contact`, `damping` and `run` that have words of their own
    *("law", "stiffness", "shear_stiffness", "friction", "cohesion", "rule", "gap"),
    *("mass", "solvers", "columns"),
}
# keys of a column whose contacts open or slip
OF_CONTACTS = {"law", "stiffness", "gap", "strength", "friction", "gravity", "settled", "solve_limit"}
SWEPT_VALUES = 6  # of a key that are shown


def page(scene: Scene, source: str, width: int | None) -> Iterator[str]:
    """Yield the lines of the page; a scene with a sweep shows the range of each number over its cases."""
    cases = scene.expand()
    sampled_cases = numbers.cases(scene)
    derived = [numbers.numbers(case) for case in sampled_cases]
    yield from textwrap.wrap(f"{scene.name}: {scene.title or 'a scene'}", width or 1000, break_long_words=False)
    yield ""
    yield from drawing(cases[0], width)
    yield ""
    yield in_columns(list(_facts(cases[0], scene, len(cases))), width)
    yield ""
    if len(cases) > 1:
        of_all = f"{len(sampled_cases)} of {len(cases)}" if len(sampled_cases) < len(cases) else f"all {len(cases)}"
        yield f"over {of_all} cases of the sweep (the first one is above):"
    yield in_columns(_table(numbers.ranges(derived)), width)
    for text, count in _remarks(sampled_cases, derived).items():
        remark = f"{text} (in {count} of {len(sampled_cases)} cases)" if len(sampled_cases) > 1 else text
        yield from textwrap.wrap(remark, width or 1000, initial_indent="! ", subsequent_indent="  ")
    yield ""
    yield f"next: dda-validate run {source}"


def as_data(scene: Scene) -> dict[str, Any]:
    """Return the scene as a file states it, and each number's range, as plain data."""
    sampled_cases = numbers.cases(scene)
    derived = [numbers.numbers(case) for case in sampled_cases]
    return {
        "scene": scene.definition(),
        "cases": len(scene.expand()),
        "numbers": {
            name: {"low": low, "high": high, "unit": number.unit}
            for name, (low, high, number) in numbers.ranges(derived).items()
        },
        "remarks": dict(_remarks(sampled_cases, derived)),
        "warnings": plausibility_warnings(scene),
    }


def _remarks(cases: Sequence[Scene], derived: Sequence[Sequence[numbers.Number]]) -> Counter[str]:
    """Return how many cases lie beyond each limit."""
    remarks: Counter[str] = Counter()
    for case, case_numbers in zip(cases, derived, strict=True):
        remarks.update(numbers.remarks(case, case_numbers))
    return remarks


def _facts(first: Scene, scene: Scene, count: int) -> Iterator[Line]:
    """Yield the steps and the scheme of the first case, and what the scene varies and is run with."""
    if first.rigid is None:
        yield from _stepping(first)
    else:
        t = first.time
        halved = f", halved {first.rigid.refine} times" if first.rigid.refine else ""
        yield "rows", f"{t.steps}, one each {t.step:g} s; between them a program takes its own steps{halved}"
    if others := list(_other_keys(first)):
        yield "keys", ", ".join(others)
    if scene_features := features.of(first):
        yield "features", ", ".join(scene_features)
    for field, values in scene.sweep.items():
        if field != "mode":
            more = f", ... ({len(values)})" if len(values) > SWEPT_VALUES else ""
            yield "varied", f"{field} = {', '.join(map(_short, values[:SWEPT_VALUES]))}{more}"
    case_count = f"; {count} cases" if count > 1 else ""
    yield "solvers", f"{', '.join(scene.run.solvers)}{case_count}"
    if scene.gate:
        yield "gates", f"{len(scene.gate)} in the scene"


def _stepping(first: Scene) -> Iterator[Line]:
    """Yield the steps, the scheme and the damping of a scene that is stepped by it."""
    t = first.time
    scheme = Stepping.of(first).name
    if t.scheme == "newmark":
        scheme = f"{SCHEMES.get((t.alpha, t.delta), 'Newmark')}, alpha = {t.alpha:.4g}, delta = {t.delta:g}"
    start = "from zero acceleration" if t.start == "zero" else "from the acceleration of the load"
    yield "steps", f"{t.steps} of dt = {t.step:g} s, {start}"
    discount = f"gg_rate = {t.gg_rate:g} 1/s" if t.gg_rate is not None else f"gg = {t.discount:g}"
    yield "scheme", f"{scheme}, {discount}"
    if first.damping.present:
        yield "damping", f"C = a0 M + a1 K, a0 = {first.damping.mass:g} 1/s, a1 = {first.damping.stiffness:g} s"


def _other_keys(scene: Scene) -> Iterator[str]:
    """Yield the keys of a scene that are neither in the drawing nor in the lines above."""
    for place, table in scene.tables().items():
        if place in ("contact", "damping", "run"):
            for name, value, key in stated(table):
                if name not in WRITTEN:
                    yield described(name, value, key)


def _short(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _table(ranges: numbers.Ranges) -> list[Line]:
    rows: list[Line] = [("", "value", "", "what it is")]
    for name, (low, high, number) in ranges.items():
        least = f"{low:.4g}"
        most = f"{high:.4g}"
        rows.append((name, least if least == most else f"{least} .. {most}", number.unit, number.says))
    return rows


# ---- drawings -----------------------------------------------------------------------------------------------------


def drawing(scene: Scene, width: int | None) -> Iterator[str]:
    """Yield the model of a scene, drawn in text."""
    if scene.rigid is not None:
        return boxes(scene.rigid)
    return column(scene) if scene.column is not None else block(scene, width)


def block(scene: Scene, width: int | None) -> Iterator[str]:
    """Yield a block on its springs, to scale as far as characters go, with its parameters beside it."""
    b = scene.block
    wide, high = np.ptp(b.outline, axis=0)
    slenderness = wide / high
    across = INSIDE if slenderness >= 0.5 else max(NARROWEST, round(2 * INSIDE * slenderness))
    rows = _rows(across, slenderness)
    shape = "" if b.vertices is None else f", {len(b.vertices)} vertices"
    cut = "" if b.subdivide is None else f", cut into {b.subdivide[0]} x {b.subdivide[1]} {b.pattern}"
    start = {f"starts at {b.velocity:g} m/s": b.velocity, f"tilted by {b.tilt:g} deg": b.tilt}
    start |= {f"gap of {scene.contact.gap:g} m": scene.contact.gap}
    beside = [
        f"{wide:.3g} m wide, {high:.3g} m high{shape}{cut}",
        f"rho = {b.density:g} kg/m3, E = {b.young:g} Pa, mu = {b.poisson:g}, {b.hypothesis}",
        *filter(None, [", ".join(words for words, value in start.items() if value)]),
    ]
    *above, last = textwrap.wrap(_loads(scene), (width or 1000) - across - BESIDE, break_on_hyphens=False)
    yield from (" " * (across + BESIDE) + text for text in above)
    mark = ">" if scene.load.traction else ""
    if scene.load.pressure:
        mark = "v"
    arrows = " " + "   ".join([mark] * (across // 4 + 1)) if mark else ""
    yield f"  {arrows.ljust(across + 2)}   {last}"
    yield f"  +{'-' * across}+"
    for text in (*beside, *[""] * (rows - len(beside))):
        yield f"  |{' ' * across}|   {text}".rstrip()
    yield f"  +{'-' * across}+"
    c = scene.contact
    springs = "rigid" if math.isinf(c.stiffness) else f"p = {c.stiffness:g} N/m at each corner"
    if c.shear_stiffness is not None:
        springs += f", shear {c.shear_stiffness:g} N/m"
    holds = "locked" if c.law == "locked" else f"no tension, rule {c.rule}"
    if c.friction is not None:
        holds += f", friction {c.friction:g} deg" + (f", cohesion {c.cohesion:g} Pa" if c.cohesion else "")
    foot = "z" if c.law == "locked" else "x"
    yield f"  {foot}{' ' * across}{foot}   {springs}"
    yield f" {'=' * (across + 4)}  {holds}"


def _rows(across: int, slenderness: float) -> int:
    """Return the rows of a body's inside; a row is as high as two columns are wide."""
    return min(max(3, round(across / slenderness / 2)), INSIDE // 2)


def _loads(scene: Scene) -> str:
    load = scene.load
    names = {"pressure": "q"}
    loads = [described(names.get(name, name), value, key) for name, value, key in stated(load) if name != "base_motion"]
    if load.base_motion is not None:
        loads.append(f"base moved by {load.base_motion.rpartition('/')[2]}")
    return ", ".join(loads) or "no load"


def column(scene: Scene) -> Iterator[str]:
    """Yield the layers of a column from the top down, and what it stands on."""
    layered_column = scene.column
    if layered_column is None:
        return
    excitation = scene.stated_input
    if excitation is None:
        signal = ""
    elif excitation.shape is None:
        signal = f"record {(excitation.record or '').rpartition('/')[2]}"
    elif excitation.velocity is not None:
        signal = f"{excitation.shape}, {excitation.velocity:g} m/s"
    else:
        signal = f"{excitation.shape}, {excitation.pressure or 0:g} Pa"
    driven_end = None if excitation is None else excitation.at
    top = f"{signal} on the top, {layered_column.motion} waves" if driven_end == "top" else "free top"
    yield f"  +{'-' * INSIDE}+   {top}"
    for layer in reversed(layered_column.layer):
        cut = f"{layer.thickness:g} m in {layer.blocks}"[:INSIDE].center(INSIDE)
        velocity = f", v = {layer.velocity:g} m/s" if layer.velocity else ""
        material = "rigid" if math.isinf(layer.young) else f"E = {layer.young:g} Pa, mu = {layer.poisson:g}"
        yield f"  |{cut}|   rho = {layer.density:g} kg/m3, {material}{velocity}"
        yield f"  +{'-' * INSIDE}+"
    for joint in layered_column.joint:
        numbers = [described(name, value, key) for name, value, key in stated(joint) if name != "height"]
        yield f"{' ' * (INSIDE + 7)}joint at {joint.height:g} m, {', '.join(numbers)}"
    if layered_column.glue is not None:
        yield f"{' ' * (INSIDE + 7)}blocks glued by {layered_column.glue:g} Pa/m"
    # the keys of contacts that open or slip and have no joint of their own
    words = [described(name, value, key) for name, value, key in stated(layered_column) if name in OF_CONTACTS]
    if layered_column.law != "bonded" and words:
        yield f"{' ' * (INSIDE + 7)}contacts: {', '.join(words)}"
    base_motion = f", {signal}, {layered_column.motion} waves" if driven_end == "base" else ""
    yield f" {'=' * (INSIDE + 4)}  {layered_column.base} base{base_motion}"


def boxes(section: RigidSection) -> Iterator[str]:
    """Yield rigid boxes on each other from the top down, equal neighbours as one, and the ground."""
    left = min(box.x - box.width / 2 for box in section.box)
    right = max(box.x + box.width / 2 for box in section.box)
    characters_per_metre = INSIDE / (right - left)
    stack = [list(equal) for _, equal in itertools.groupby(enumerate(section.box, start=1), key=itemgetter(1))]
    for equal in reversed(stack):
        first, box = equal[0]
        last = equal[-1][0]
        across = max(NARROWEST, round(characters_per_metre * box.width))
        shift = min(INSIDE - across, round(characters_per_metre * (box.x - box.width / 2 - left)))
        beside = _box(box, last - first + 1)
        rows = max(len(beside), _rows(across, box.width / box.height) if len(section.box) == 1 else 1)
        margin = " " * (2 + shift)
        yield f"{margin}+{'-' * across}+"
        for row in range(rows):
            label = f"{first}" if first == last else f"{first}-{last}"
            inside = (label if row == rows // 2 else "").center(across)
            words = beside[row] if row < len(beside) else ""
            yield (f"{margin}|{inside}|".ljust(INSIDE + BESIDE) + words).rstrip()
        yield f"{margin}+{'-' * across}+"
    slope = "level ground"
    if section.slope:
        slope = f"slope of {abs(section.slope):g} deg, down to the {'right' if section.slope > 0 else 'left'}"
    contacts = "frictionless" if section.friction == 0 else f"friction {section.friction:g} deg"
    springs = "rigid or as a program has them"
    if section.stiffness is not None:
        springs = f"{section.stiffness:g} N/m below box 1"
    yield f" {'=' * (INSIDE + 4)}  contacts: {contacts}, restitution {section.restitution:g}, {springs}"
    margin = " " * (INSIDE + BESIDE)
    yield f"{margin}{slope}, g = {section.gravity:g} m/s2"
    if section.base_amplitude:
        motion = f"A = {section.base_amplitude:g} m, f = {section.base_frequency:g} Hz"
        yield f"{margin}ground moved by A (1 - cos 2 pi f t), {motion}"


def _box(box: BoxSection, count: int) -> list[str]:
    """Return size and start of a box, or of each of some equal boxes, a line each."""
    each = "each " if count > 1 else ""
    lines = [f"{each}{box.width:.3g} m wide, {box.height:.3g} m high, rho = {box.density:g} kg/m3"]
    start = [
        described(name, value, key) for name, value, key in stated(box) if name not in ("width", "height", "density")
    ]
    return [*lines, ", ".join(start)] if start else lines
