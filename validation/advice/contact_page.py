"""What `dda-validate advise contact` says of a block or a column: its runs side by side, and what would do better."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict
from typing import Any

from validation.advice import columns, contact, friction
from validation.advice.contact_alarms import contact_alarms
from validation.advice.overshoot import overshoot_alarms
from validation.advice.plain import Line, in_columns
from validation.errors import InputError
from validation.runs.beside import table_beside
from validation.runs.numbers import number_text, share_text
from validation.runs.row import Metrics, Row, RowsBySolver, Value
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


def scenes(scene: Scene) -> dict[str, Scene]:
    """Return the scene that each solver runs: the exact motions have no kinetic damping.

    Raises
    ------
    InputError
        The contact is locked, or the scene has a column.
    """
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
    free = plain.with_values({"time.gg": 1.0}) if scene.time.discount < 1 else plain
    return {own(): plain, exact(): free, of_role(Role.TRUTH): free}


def answer(
    scene: Scene,
    rows: RowsBySolver,
    penetration: float | None = None,
    probe: Callable[[float], float | None] | None = None,
) -> dict[str, Any]:
    """Return everything as plain data.

    Parameters
    ----------
    scene
        The scene.
    rows
        Its rows by solver, without the solvers that do not apply.
    penetration
        The requested penetration [m]; None where the user requests none: then `DEFAULT_PENETRATION`, but no advice on
        landings to a block that slides.
    probe
        How deep the exact block goes on springs p [m], None where there is no answer.
    """
    speed = landing_speed(scene, rows)
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
        "runs": {name: measured(row) for name, row in rows.items()},
        "sliding": None if slides is None else slides.as_dict(),
        "alarms": [alarm.record() for alarm in alarms],
    }


def measured(row: Row) -> dict[str, Value]:
    """Return what was measured of the contact."""
    prefixes = ("switches.", "contact.", "energy.", "horizon.", ALONG)
    return {name: value for name, value in row.metrics.items() if name.startswith(prefixes)}


def landing_speed(scene: Scene, rows: RowsBySolver) -> float:
    """Return the greatest speed at which the base lands [m/s]: the exact block's, else that of the scene's start."""
    for name in (exact(), own()):
        value = rows[name].metrics.get("contact.landing_speed") if name in rows else None
        if isinstance(value, float):
            return value
    fallen = 2 * scene.load.gravity * scene.contact.gap
    return math.sqrt(scene.block.velocity**2 + max(0.0, fallen))


def page(scene: Scene, data: Mapping[str, Any], absent: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of one page of text; `absent` says why a solver has no column."""
    springs = f"p = {scene.contact.stiffness:.4g} N/m"
    yield from _heading(scene, "contact that opens", springs, f": w_c dt = {data['omega']:.3g}")
    yield in_columns(table(scene, data["runs"]))
    yield from (f"{name}: {why}" for name, why in absent.items())
    yield ""
    if any(_number(run, MEAN_RATE) > 1 for run in data["runs"].values()):
        yield (
            "A gap may open faster than it closed without any gain of energy: strain, load and the other corner drive "
            "the base too; gains are the lines of energy."
        )
        yield ""
    slides = friction.sliding(scene)
    if slides is not None:
        yield from friction.lines(scene, slides)
        yield from _hops(slides, data["runs"])
        yield ""
    if data["needed"] is not None:
        yield from _needed(scene, data)
    for alarm in data["alarms"]:
        yield f"ALARM {alarm['kind']}: {alarm['sentence']}"


def _heading(scene: Scene, untitled: str, contact_words: str, remainder: str = "") -> Iterator[str]:
    """Yield the name of a scene and its numbers, with an empty line after them."""
    t = scene.time
    yield f"{scene.name}: {scene.title or untitled}"
    yield f"{contact_words}, dt = {t.step:g} s, {Stepping.of(scene).numbers}, gg = {t.discount:.6g}{remainder}"
    yield ""


def table(scene: Scene, runs: Mapping[str, Metrics]) -> list[Line]:
    """Return the runs side by side."""
    lines = [(f"over {scene.time.duration:.4g} s", *runs)]
    for words, opens in (("first opening", True), ("first landing", False)):
        lines.append((words, *(first(scene, run, opens) for run in runs.values())))
    with_friction = features.FRICTION in features.of(scene)
    kinds = ("block", "slips", "losses", "friction_loss") if with_friction else ("block", "losses")
    for kind in kinds:
        lines += measured_lines(kind, runs)
    lines.append(("solves per step, mean and most", *(_solves(run) for run in runs.values())))
    return [*lines, *measured_lines("repeatable", runs)]


def measured_lines(kind: str, runs: Mapping[str, Metrics]) -> list[Line]:
    """Return a line of each metric of a kind of `LINES`, with its number in every run."""
    lines = []
    for line in LINES[kind]:
        numbers = (
            number_text(run.get(line["metric"]), factor=line["factor"], unit=line["unit"]) for run in runs.values()
        )
        lines.append((line["words"], *numbers))
    return lines


def first(scene: Scene, run: Metrics, opens: bool) -> str:
    """Return when a run first opens or lands, in words; a block that touches may do either at once."""
    opening, closing = (run.get(f"switches.first_{name}") for name in ("opening", "closing"))
    value, other = (opening, closing) if opens else (closing, opening)
    before = isinstance(other, float) and not (isinstance(value, float) and value < other)
    touching = scene.contact.gap == 0 and (opens or scene.block.velocity < 0)
    if touching and before:
        return "at once"
    return f"{value:.7g} s" if isinstance(value, float) else "never"


def _solves(run: Metrics) -> str:
    mean, most = (run.get(f"contact.{name}_solves") for name in ("mean", "most"))
    return f"{mean:.4g}, {most:.0f}" if isinstance(mean, float) and isinstance(most, float) else "-"


def _number(run: Metrics, metric: str) -> float:
    """Return a number of a run, NaN where it has none."""
    value = run.get(metric)
    return value if isinstance(value, float) else math.nan


def _hops(slides: friction.Sliding, runs: Mapping[str, Metrics]) -> Iterator[str]:
    """Say where the exact block moves otherwise than a rigid one that stays on the slope."""
    run = runs.get(exact(), {})
    distance = abs(_number(run, ALONG))
    share = _number(run, "contact.open_share")
    if slides.stands or not share > 0 or not abs(distance - slides.run_out) > APART * slides.run_out:
        return
    yield (
        f"  hops        the exact block is open for {share_text(share)} of the time and moves {distance:.4g} m: the "
        "run-out above is that of a block that stays on the slope and never sticks"
    )


def _needed(scene: Scene, data: Mapping[str, Any]) -> Iterator[str]:
    need = data["needed"]
    depth = data["asked"]["penetration"]
    load = abs(opened.resultant_load(scene))
    why = "Asked for" if data["asked"]["stated"] else "For an accuracy that is usual (set --penetration)"
    landing_at = f"landing at {data['landing_speed']:.4g} m/s under {load:.4g} N"
    yield f"{why}: a penetration below {depth:g} m, {landing_at}."
    yield f"  springs     p >= {need['stiffness']:.4g} N/m (now {scene.contact.stiffness:.4g}){_depth(need, depth)}"
    ratio = need["stiffness"] / scene.block.young
    if ratio > MODERATE:
        yield (
            f"              that is {ratio:.4g} E, for the penetration of a landing, p ~ (V / x)^2; at rest springs of "
            f"{MODERATE:g} E give way by {load / (2 * MODERATE * scene.block.young):.2g} m"
        )
    stepped = data["restitution_now"]
    if data["landing_speed"] > 0 and stepped is not None:
        yield (
            f"  at present  an unloaded landing leaves the centre of mass {stepped['mean']:.3g} of its speed, "
            f"{stepped['low']:.3g} to {stepped['high']:.3g} by phase; the block's own is {stepped['own']:.3g}"
        )
    if scene.time.gg_rate is None and scene.time.discount < 1:
        loses = "the smaller dt, the more speed a landing loses"
        left = friction.left_of_a_distance(scene.time.discount, scene.time.step)
        yield f"  gg = {scene.time.discount:g} acts per step: {loses}; {left}"


def _depth(need: Mapping[str, Any], penetration: float) -> str:
    if need["depth"] is None:
        return ", for the load at rest and one unloaded landing"
    reservation = "" if need["depth"] <= penetration else ", and no stiffer ones were tried"
    return f": the exact block then penetrates {need['depth']:.3g} m{reservation}"


# ---- a column whose contacts open or slip ---------------------------------------------------------------------------


def column_scenes(scene: Scene) -> dict[str, Scene]:
    """Return the scene that each solver runs: the exact motion has no kinetic damping."""
    handled = {name for name in features.OF_MOVING_COLUMN if name in features.of(scene)}
    free = scene.with_values({"time.gg": 1.0}) if scene.time.discount < 1 else scene
    return {own(): scene} | {name: free for name in by_role(Role.LIMIT) if handled <= get_solver(name).handles}


def column_answer(scene: Scene, rows: RowsBySolver, bound: columns.ColumnLimits) -> dict[str, Any]:
    """Return everything as plain data."""
    return {
        "scene": scene.name,
        "limits": asdict(bound),
        "runs": {name: measured(row) for name, row in rows.items()},
        "alarms": [alarm.record() for alarm in columns.column_alarms(scene)],
    }


def column_page(
    scene: Scene, bound: columns.ColumnLimits, data: Mapping[str, Any], absent: Mapping[str, str]
) -> Iterator[str]:
    """Yield the lines of one page of text; a line of the table that no run has a number for is left out."""
    yield from _heading(scene, "a column whose contacts open or slip", f"{bound.contacts} contacts")
    lines = [*measured_lines("column", data["runs"]), *measured_lines("repeatable", data["runs"])]
    reported = [line for line in lines if {*line[1:]} != {NONE}]
    yield in_columns([(f"over {scene.time.duration:.4g} s", *data["runs"]), *reported])
    yield from (f"{name}: {why}" for name, why in absent.items())
    yield ""
    yield from columns.advised(scene, bound)
    yield from (f"ALARM {alarm['kind']}: {alarm['sentence']}" for alarm in data["alarms"])
