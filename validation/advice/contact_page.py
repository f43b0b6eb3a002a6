"""What `dda-validate advise contact` says of a block or a column: its runs side by side, and what would do better."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict
from typing import Any

from validation.advice import columns, contact, friction
from validation.advice.contact_alarms import contact_alarms
from validation.advice.hooks import ColumnLimits
from validation.advice.overshoot import overshoot_alarms
from validation.advice.plain import Line, in_columns
from validation.advice.words import say
from validation.errors import InputError
from validation.runs.beside import table_beside
from validation.runs.numbers import number_text
from validation.runs.row import Metrics, RowsBySolver
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, get_solver
from validation.theory import landing
from validation.theory.stepping import Stepping

DEFAULT_PENETRATION = 1e-4  # where none is requested [m]
ALONG = "horizontal.final"  # displacement along the base at the end [m]
MEAN_RATE = "contact.restitution_mean"
APART = 0.01  # of the run-out of a rigid block, from which on that of the exact block is said beside it
MODERATE = 10.0  # p/E beyond which the page says what asks for springs so stiff

TITLES = {"contact of a block": "contact that opens", "contacts of a column": "a column whose contacts open or slip"}
NONE = "-"  # in place of a number that a run has not

LINES: dict[str, list[dict[str, Any]]] = table_beside(__file__)
ALARMS = (contact_alarms, overshoot_alarms, friction.friction_alarms)


def of_role(role: Role) -> str:
    """Return the solver of a role that handles unilateral contact."""
    return next(name for name in by_role(role) if features.UNILATERAL in get_solver(name).handles)


def own() -> str:
    """Return the judged solver."""
    return of_role(Role.JUDGED)


def exact() -> str:
    """Return the solver that is exact in time for the judged solver's block."""
    return of_role(Role.LIMIT)


def elements() -> str:
    """Return the reference that takes most scenes: elements, where an exact bar takes a few."""
    return max(by_role(Role.REFERENCE), key=lambda name: len(get_solver(name).handles))


def scenes(scene: Scene, bound: ColumnLimits | None = None) -> dict[str, Scene]:
    """Return the scene that each solver runs: the exact motions have no kinetic damping.

    Raises
    ------
    InputError
        The contact is locked, or the scene has another column.
    """
    free = {"time.gg": 1.0} if scene.time.discount < 1 else {}
    if bound is not None:
        handled = {name for name in features.OF_MOVING_COLUMN if name in features.of(scene)}
        exact_ones = [name for name in by_role(Role.LIMIT) if handled <= get_solver(name).handles]
        return {own(): scene} | dict.fromkeys(exact_ones, scene.with_values(free))
    features.refuse_column(scene, "advise contact")
    if features.UNILATERAL not in features.of(scene):
        raise InputError(
            "must be unilateral for advise contact",
            source=scene.name,
            field="contact.law",
            value="locked, which neither opens nor lands",
            advice="unlock it with --set contact.law=unilateral",
        )
    along = ["horizontal_displacement"] if features.FRICTION in features.of(scene) else []
    plain = scene.with_values({"run.columns": ["displacement", "contact_pressure", *along]})
    return {own(): plain} | dict.fromkeys([exact(), of_role(Role.TRUTH)], plain.with_values(free))


def answer(
    scene: Scene,
    rows: RowsBySolver,
    penetration: float | None = None,
    probe: Callable[[float], float | None] | None = None,
    bound: ColumnLimits | None = None,
) -> dict[str, Any]:
    """Return everything as plain data.

    `rows` leave out the solvers that do not apply. Without a requested penetration [m] it is `DEFAULT_PENETRATION`, and
    a block that slides gets no advice on landings. `probe` returns how deep the exact block goes on springs p [m], None
    where there is no answer.
    """
    prefixes = ("switches.", "contact.", "energy.", "horizon.", ALONG)
    runs = {}
    for name, row in rows.items():
        runs[name] = {metric: value for metric, value in row.metrics.items() if metric.startswith(prefixes)}
    if bound is not None:
        alarms = columns.column_alarms(scene)
        return {"scene": scene.name, "limits": asdict(bound), "runs": runs, "alarms": [a.record() for a in alarms]}
    # The greatest speed at which the base lands: the exact block's, else that of the scene's start.
    speeds = [_number(runs.get(name, {}), "contact.landing_speed") for name in (exact(), own())]
    fallen = max(0.0, 2 * scene.load.gravity * scene.contact.gap)
    of_start = math.sqrt(scene.block.velocity**2 + fallen)
    speed = next((value for value in speeds if not math.isnan(value)), of_start)
    stepped_landing = contact.restitution(scene)
    slides = friction.sliding(scene)
    depth = DEFAULT_PENETRATION if penetration is None else penetration
    need = None
    has_springs = scene.contact.rule != "impact"  # an impact law is one of rigid contact
    if has_springs and (penetration is not None or slides is None):
        need = contact.needed(scene, speed, depth, probe)
    alarms = itertools.chain.from_iterable(alarms_of(scene, rows) for alarms_of in ALARMS)
    return {
        "scene": scene.name,
        "omega": contact.omega(scene),
        "contact_frequency": landing.contact_frequency(scene),
        "restitution_now": None if stepped_landing is None else asdict(stepped_landing),
        "landing_speed": speed,
        "asked": {"penetration": depth, "stated": penetration is not None},
        "needed": None if need is None else need._asdict(),
        "hidden_from": landing.hidden_from(scene),
        "runs": runs,
        "sliding": None if slides is None else slides.as_dict(),
        "alarms": [alarm.record() for alarm in alarms],
    }


def page(
    scene: Scene, data: Mapping[str, Any], absent: Mapping[str, str], bound: ColumnLimits | None = None
) -> Iterator[str]:
    """Yield the lines of one page of text; `absent` says why a solver has no column."""
    kind = "contact of a block" if bound is None else "contacts of a column"
    yield say(kind, scene, title=scene.title or TITLES[kind], stepping=Stepping.of(scene), **data)
    yield ""
    yield in_columns(table(scene, data["runs"], kind))
    yield from (f"{name}: {why}" for name, why in absent.items())
    yield ""
    yield from columns.advised(scene, bound) if bound is not None else _of_block(scene, data)
    yield from (f"ALARM {alarm['kind']}: {alarm['sentence']}" for alarm in data["alarms"])


def table(scene: Scene, runs: Mapping[str, Metrics], kind: str) -> list[Line]:
    """Return the runs side by side; a line of a column's contacts that no run has a number for is left out."""
    lines = [(f"over {scene.time.duration:.4g} s", *runs)]
    for line in LINES[kind]:
        cells = [_cell(scene, line, run) for run in runs.values()]
        of_friction = line.get("friction", False)
        is_empty = kind == "contacts of a column" and {*cells} == {NONE}
        if not is_empty and (not of_friction or features.FRICTION in features.of(scene)):
            lines.append((line["words"], *cells))
    return lines


def _cell(scene: Scene, line: Mapping[str, Any], run: Metrics) -> str:
    """Return the numbers of a run in a line, a dash where it has not all of them."""
    if "opens" in line:
        return first(scene, run, line["opens"])
    metrics = line["metric"].split(", ")
    numbers = [number_text(run.get(metric), factor=line["factor"], unit=line["unit"]) for metric in metrics]
    return NONE if NONE in numbers else ", ".join(numbers)


def first(scene: Scene, run: Metrics, opens: bool) -> str:
    """Return when a run first opens or lands, in words; a block that touches may do either at once."""
    opening, closing = (run.get(f"switches.first_{name}") for name in ("opening", "closing"))
    value, other = (opening, closing) if opens else (closing, opening)
    before = isinstance(other, float) and not (isinstance(value, float) and value < other)
    touching = scene.contact.gap == 0 and (opens or scene.block.velocity < 0)
    if touching and before:
        return "at once"
    return f"{value:.7g} s" if isinstance(value, float) else "never"


def _number(run: Metrics, metric: str) -> float:
    """Return a number of a run, NaN where it has none."""
    value = run.get(metric)
    return value if isinstance(value, float) else math.nan


def _of_block(scene: Scene, data: Mapping[str, Any]) -> Iterator[str]:
    """Yield what friction makes of a block, and which springs keep a penetration."""
    if any(_number(run, MEAN_RATE) > 1 for run in data["runs"].values()):
        yield say("rate above one")
        yield ""
    slides = friction.sliding(scene)
    if slides is not None:
        yield from friction.lines(scene, slides)
        # where the exact block moves otherwise than a rigid one that stays on the slope
        run = data["runs"].get(exact(), {})
        distance = abs(_number(run, ALONG))
        share = _number(run, "contact.open_share")
        is_apart = abs(distance - slides.run_out) > APART * slides.run_out
        if not slides.stands and share > 0 and is_apart:
            yield say("hops", share=share, distance=distance)
        yield ""
    need = data["needed"]
    if need is None:
        return
    depth = data["asked"]["penetration"]
    load = abs(opened.resultant_load(scene))
    yield say("penetration stated" if data["asked"]["stated"] else "penetration", depth=depth, load=load, **data)
    kept = "landing only"
    if need["depth"] is not None:
        kept = "goes deep" if need["depth"] <= depth else "goes too deep"
    yield say("springs needed", kept=say(kept, **need), contact=scene.contact, **need)
    ratio = need["stiffness"] / scene.block.young
    if ratio > MODERATE:
        yield say("stiff", ratio=ratio, moderate=MODERATE, rest=load / (2 * MODERATE * scene.block.young))
    if data["landing_speed"] > 0 and data["restitution_now"] is not None:
        yield say("landing now", **data["restitution_now"])
    t = scene.time
    if t.gg_rate is None and t.discount < 1:
        yield say("landing loses", t, left=friction.left_of_a_distance(t.discount, t.step))
