"""The study `methods`: time schemes and contact methods on the same scenes, at equal steps and at equal cost.

The block on its locked springs, from rest; the same block where the contact opens; a rigid block that lands on springs;
a rigid stop; blocks on each other; a block that slides. Each by all methods that apply, held to closed forms of the
schemes and to the numbers of an independent program (``study.toml``).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.metrics.values import or_nan
from validation.runs.case_name import scene_of
from validation.runs.history import Array, History
from validation.runs.numbers import significant
from validation.runs.row import Metrics, Value
from validation.scenes.scene import Scene, load_scene
from validation.studies.methods import facts
from validation.studies.methods.closed import exact_locked
from validation.studies.methods.methods import METHODS, SCHEMES, Method, method
from validation.suite.bands import Band, Bands, about, fitted_order
from validation.theory import friction, rebound, spectra
from validation.theory.stepping import Stepping

RATIOS = (1.0, 10.0, 100.0)  # p/E
STEPS = (0.01, 0.002, 0.001)  # s, of the locked block
LOCKED_TIME = 0.2  # s
HALVED = 0.0005  # s, half of the last step: average acceleration at the cost of a composite scheme
STABLE_EXPLICIT = 1.0, 0.001  # p/E and dt [s] of the locked block within the limit of the leapfrog
UNLOCKED = ((1.0, 1e-3), (1.0, 2e-4), (100.0, 1e-3), (100.0, 2e-4))  # p/E and dt [s]
UNLOCKED_TIME = 0.1  # s
ENERGY = 5e4  # W0 = q^2 a h / (2 E), the strain energy under the pressure at rest [J]
REFINED_TIME = 0.05  # s
COARSEST = 100  # steps
LEVELS = 6  # of the refinement, each with twice the steps of the one before
SLOW_LEVELS = {"constant": 8, "nine-sixteenths": 7, "implicit-euler": 7, "kane": 7}  # the same of first order
TARGET = 0.01  # relative error of the velocity
RIGID_COARSEST, RIGID_LEVELS = 800, 5  # steps over `REFINED_TIME` of a rigid stop
COLUMN_STEPS = (1e-3, 2e-4)  # s
COLUMN_TIME = 0.06  # s
SLIDING_STEP = 0.01  # s
SLIDING_TIME = 0.5  # s
IMPACT_OMEGAS = (0.3, 4.0, 1000.0)  # w_c dt
IMPACT_PHASES = (0.1, 0.5, 0.9)
IMPACT_STEPS = 240  # contact of 11 steps at w_c dt = 0.3, and a flight in which generalised alpha forgets its memory
RIGID_PHASES = 2000
ERROR = "displacement error"
RIGID_MAP = "rebound on a rigid contact"
COST = "methods-cost"
FAST = ("ch-0", "conserving")  # of second order, and none of whose switches gains energy
ENERGIES = tuple(f"energy.{name}" for name in ("kinetic", "strain", "springs", "load"))
BLOCK_EVENTS = ("methods-refined-exact", "block-events")
COLUMN_EVENTS = ("methods-column-exact", "column-events")
IMPLICIT = tuple(scheme for scheme in METHODS if scheme.group != "explicit")  # what a rigid block's own strain allows
FRICTIONAL = tuple(scheme for scheme in IMPLICIT if scheme.id != "conserving")  # conserving contact has no friction

# ---- scenes ----


def varied(
    scheme: Method, base: str, name: str, title: str, values: Mapping[str, Any], **lists: Sequence[float]
) -> Scene:
    """Return a built-in scene under a method, lists of values varied together; a key is ``time_step``."""
    scene = scheme.scene(load_scene(base), {"run.solvers": ["dda"], **values})
    sweep = {"mode": "zip"} | {key.replace("_", ".", 1): list(row) for key, row in lists.items()}
    return scene.model_copy(
        update={"name": f"methods-{name}-{scheme.id}", "title": f"{title}: {scheme.label}", "sweep": sweep}
    )


def over_springs(rows: Sequence[tuple[float, float]], duration: float) -> dict[str, list[float]]:
    """Return the lists of p/E and dt [s] on the paper's block."""
    young = load_scene("figures-3-4").block.young
    return {
        "contact_stiffness": [ratio * young for ratio, _ in rows],
        "time_step": [step for _, step in rows],
        "time_steps": [round(duration / step) for _, step in rows],
    }


def halved(coarsest: int, levels: int) -> dict[str, list[float]]:
    """Return lists of halved steps."""
    counts = [coarsest * 2**level for level in range(levels)]
    return {"time_step": [REFINED_TIME / count for count in counts], "time_steps": counts}


@functools.cache
def locked(scheme: Method) -> Scene:
    """Return the locked block from rest, over springs and step."""
    rows = [(ratio, step) for ratio in RATIOS for step in STEPS]
    if scheme.id == "leapfrog":
        rows = [STABLE_EXPLICIT]
    if scheme.id == "average":
        rows.append((1.0, HALVED))
    return varied(scheme, "figures-3-4", "locked", "The locked block from rest", {}, **over_springs(rows, LOCKED_TIME))


@functools.cache
def unlocked(scheme: Method) -> Scene:
    """Return the block whose contact opens, over springs and step."""
    values = {"time.allow_unstable": scheme.group == "explicit"}
    lists = over_springs(UNLOCKED, UNLOCKED_TIME)
    return varied(scheme, "unlocked-average", "unlocked", "Contact that opens", values, **lists)


@functools.cache
def refined(scheme: Method) -> Scene:
    """Return the block whose contact opens, at p = 1E, over halved steps."""
    lists = halved(COARSEST, SLOW_LEVELS.get(scheme.id, LEVELS))
    return varied(scheme, "unlocked-average", "refined", "Contact that opens, steps refined", {}, **lists)


@functools.cache
def impacts(scheme: Method) -> Scene:
    """Return the rigid block on springs, over w_c dt and the phase of the landing."""
    scene = load_scene("rebound-average")
    rows = [(omega, phase) for omega in IMPACT_OMEGAS for phase in IMPACT_PHASES]
    dt = scene.time.step
    stiffnesses = [(omega / dt) ** 2 * scene.block.mass / 2 for omega, _ in rows]
    gaps = [(3 - phase) * dt * -scene.block.velocity for _, phase in rows]
    lists = {"contact_stiffness": stiffnesses, "contact_gap": gaps}
    title = "A rigid block lands on springs"
    return varied(scheme, scene.name, "impact", title, {"time.steps": IMPACT_STEPS}, **lists)


@functools.cache
def column(scheme: Method) -> Scene:
    """Return five rigid blocks that are dropped on each other, over two steps."""
    lists = {"time_step": COLUMN_STEPS, "time_steps": [round(COLUMN_TIME / step) for step in COLUMN_STEPS]}
    values = {"run.columns": ["displacement"]}
    return varied(scheme, "columns-drop-average", "column", "Five rigid blocks dropped", values, **lists)


@functools.cache
def sliding(scheme: Method) -> Scene:
    """Return the block that slides down an incline."""
    steps = {"time.step": SLIDING_STEP, "time.steps": round(SLIDING_TIME / SLIDING_STEP)}
    values = {"contact.cohesion": 0.0, **steps}
    return varied(scheme, "slope-sliding", "sliding", "A block that slides", values, time_step=[SLIDING_STEP])


STOPS: Mapping[str, tuple[str, dict[str, Any]]] = {  # what turns a block back at a rigid stop: id -> words, values
    "displacements": ("a rigid stop in displacements under (1/2, 1)", {"time.alpha": 0.5, "time.delta": 1.0}),
    "impulses": (
        "Moreau and Jean, e = 0, theta = 1/2",
        {"contact.rule": "impact", "contact.restitution": 0.0, "time.alpha": 0.25, "time.delta": 0.5},
    ),
    "impulses-euler": (
        "Moreau and Jean, e = 0, theta = 1",
        {"contact.rule": "impact", "contact.restitution": 0.0, "time.alpha": 1.0, "time.delta": 1.5},
    ),
}


@functools.cache
def rigid(stop: str) -> Scene:
    """Return the block on a rigid stop, over halved steps."""
    words, values = STOPS[stop]
    rigid_stop = {"contact.stiffness": "inf", "contact.shear_stiffness": 0.0, "run.solvers": ["dda"]}
    base = load_scene("unlocked-average").model_copy(update={"sweep": {}})
    lists = halved(RIGID_COARSEST, RIGID_LEVELS)
    sweep = {"mode": "zip", "time.step": lists["time_step"], "time.steps": lists["time_steps"]}
    update = {"name": f"methods-rigid-{stop}", "title": f"A rigid stop: {words}", "sweep": sweep}
    return base.with_values({**rigid_stop, **values}).model_copy(update=update)


def exact(base: str, case: tuple[str, str], title: str, step: float, duration: float, **values: Any) -> Scene:
    """Return a built-in scene, exact in time."""
    name, solver = case
    steps = {"time.step": step, "time.steps": round(duration / step)}
    scene = method("average").scene(load_scene(base), {"run.solvers": [solver], **steps, **values})
    return scene.model_copy(update={"name": name, "title": f"{title}, exact in time"})


@functools.cache
def scenes() -> tuple[Scene, ...]:
    """Return all scenes of the study."""
    declared = [locked(scheme) for scheme in SCHEMES]
    declared += [unlocked(scheme) for scheme in METHODS]
    declared += [refined(scheme) for scheme in METHODS]
    declared += [impacts(scheme) for scheme in IMPLICIT]
    declared += [rigid(stop) for stop in STOPS]
    declared += [column(scheme) for scheme in SCHEMES]
    declared += [sliding(scheme) for scheme in FRICTIONAL]
    columns = {"run.columns": ["displacement"]}
    dropped = exact("columns-drop-average", COLUMN_EVENTS, "Five rigid blocks dropped", 1e-3, COLUMN_TIME, **columns)
    step = REFINED_TIME / COARSEST
    unlocked_exactly = exact("unlocked-average", BLOCK_EVENTS, "Contact that opens", step, REFINED_TIME)
    return (*declared, unlocked_exactly, dropped, load_scene(facts.AUGMENTED))


@functools.cache
def cases_by_scene() -> dict[str, tuple[Scene, ...]]:
    """Return the cases of every scene, by its name."""
    return {scene.name: scene.expand() for scene in scenes()}


def expanded(scene: Scene) -> tuple[Scene, ...]:
    """Return the cases of a scene of the study."""
    return cases_by_scene()[scene.name]


def opened() -> dict[str, Scene]:
    """Return the cases of contact that opens, at 0.2 ms, that are held to the exact motion, by scheme and p."""
    compared = {}
    for name, word, index in (
        ("leapfrog", "leapfrog, p = 1E", 1),
        ("leapfrog", "leapfrog, p = 100E", 3),
        ("average", "(1/4, 1/2), p = 1E", 1),
        ("average", "(1/4, 1/2), p = 100E", 3),
        ("constant", "(1/2, 1), p = 1E", 1),
    ):
        compared[word] = expanded(unlocked(method(name)))[index]
    return compared


def opened_exactly() -> dict[str, Scene]:
    """Return the exact cases of these, by p."""
    return {"1E": opened()["(1/4, 1/2), p = 1E"], "100E": opened()["(1/4, 1/2), p = 100E"]}


def exact_cases() -> tuple[tuple[str, str], ...]:
    """Return the cases whose exact motion is run beside their solvers."""
    return tuple((case.name, "block-events") for case in opened_exactly().values())


# ---- what is derived from the runs ----


def locked_error(case: Scene, history: History) -> Metrics:
    """Return the largest displacement error over the largest exact one."""
    expected = exact_locked(case, history.time)
    return {"largest": np.max(np.abs(history.displacement - expected)) / np.max(np.abs(expected))}


def final_energy(case: Scene, finished: Finished) -> Metrics:
    """Return the last energy over W0; that of the start is zero."""
    metrics = finished.rows[case.name, "dda"].metrics
    return {"share": sum(or_nan(metrics.get(name)) for name in ENERGIES) / ENERGY}


def relative_error(values: Array, expected: Array) -> float:
    """Return the relative L2 error."""
    return float(np.linalg.norm(values - expected) / np.linalg.norm(expected))


def error_of_steps(case: Scene, finished: Finished) -> float:
    """Return the relative L2 displacement error at the coarsest steps."""
    stride = case.time.steps // COARSEST
    displacement = finished.needed_history(case.name, "dda").displacement[stride - 1 :: stride]
    return relative_error(displacement, finished.needed_history(*BLOCK_EVENTS).displacement)


def refined_error(scheme: Method, case: Scene, finished: Finished) -> Metrics:
    """Return the error of a run, and its steps times the solves of one."""
    return {"error": error_of_steps(case, finished), "solves": case.time.steps * scheme.solves}


def order(scheme: Method, finished: Finished) -> Metrics:
    """Return the order of the last halving, and the steps times solves that reach the target."""
    errors = {case.time.steps: error_of_steps(case, finished) for case in expanded(refined(scheme))}
    *_, coarse, fine = errors.values()
    reached = [count for count, error in errors.items() if error <= TARGET]
    values: dict[str, Value] = {"last halving": math.log2(coarse / fine), "finest error": fine}
    values["solves to 1 %"] = float(min(reached) * scheme.solves) if reached else "undefined"
    return values | {f"error of {count} steps": error for count, error in errors.items()}


def slow_and_fast(finished: Finished) -> Metrics:
    """Return how many times as many solves DDA's own scheme needs for 1 % of the motion as schemes of second order."""
    slow = or_nan(order(method("constant"), finished)["solves to 1 %"])
    counts = {name: or_nan(order(method(name), finished)["solves to 1 %"]) for name in FAST}
    return {f"constant over {name}": slow / count for name, count in counts.items()}


# Displacement of the block that stops dead at a rigid stop, by an independent program [s], [m].
PLASTIC = {0.01: -0.00350963748, 0.02: -0.00744841152, 0.05: -0.00275254957}


def approach(stop: str, finished: Finished) -> Metrics:
    """Return the orders in the step of the distance from the plastic motion and of the peak pressure."""
    steps = []
    errors = []
    peaks = []
    for case in expanded(rigid(stop)):
        history = finished.needed_history(case.name, "dda")
        instants = [round(time / case.time.step) - 1 for time in PLASTIC]
        steps.append(case.time.step)
        errors.append(relative_error(history.displacement[instants], np.array([*PLASTIC.values()])))
        peaks.append(float(np.max(history.contact_pressure)))
    return {
        "order": fitted_order(steps, errors),
        "finest error": errors[-1],
        "order of the peak": fitted_order(steps, peaks),
        "finest peak": peaks[-1],
    }


def column_error(case: Scene, finished: Finished) -> Metrics:
    """Return the relative L2 error of the mean displacement at the coarser steps."""
    stride = round(COLUMN_STEPS[0] / case.time.step)
    displacement = finished.needed_history(case.name, "dda").displacement[stride - 1 :: stride]
    return {"l2": relative_error(displacement, finished.needed_history(*COLUMN_EVENTS).displacement)}


def slid_distance(case: Scene, history: History) -> Metrics:
    """Return the relative error of the distance slid, a t^2 / 2 with a = g (sin b - tan(phi) cos b)."""
    distance = float(history.columns["horizontal_displacement"][-1])
    return {"error": abs(distance) / friction.run_out(case, case.time.duration) - 1}


def compared_map(scheme: Method, finished: Finished) -> Metrics:
    """Return the largest difference of DDA's restitution from the map, and the greatest restitution."""
    restitutions = []
    omegas = []
    phases = []
    for case in expanded(impacts(scheme)):
        history = finished.needed_history(case.name, "dda").displacement
        restitutions.append(float(history[-1] - history[-2]) / case.time.step / -case.block.velocity)
        omegas.append(math.sqrt(2 * case.contact.stiffness / case.block.mass) * case.time.step)
        steps = case.contact.gap / (-case.block.velocity * case.time.step)
        phases.append(math.ceil(steps) - steps)
    mapped = rebound.rebounds(scheme.step_of_impact(np.array(omegas)), phases)
    return {"largest difference": np.max(np.abs(restitutions - mapped)), "greatest": max(restitutions)}


@functools.cache
def rigid_statistics(scheme: Method) -> rebound.ReboundStatistics:
    """Return the statistics of the restitution on a rigid contact over many phases."""
    return rebound.rebound_statistics(scheme.step_of_impact(math.inf), count=RIGID_PHASES)


def rigid_map(scheme: Method, finished: Finished) -> Metrics:
    """Return mean, least, greatest and mean square of the restitution on a rigid contact."""
    return dict(rigid_statistics(scheme)._asdict())


def cost_cases() -> dict[str, Scene]:
    """Return composite schemes at p = 1E and 1 ms, and average acceleration at half the step, by method."""
    compared = {scheme.id: expanded(locked(scheme))[2] for scheme in SCHEMES if scheme.group == "composite"}
    return compared | {"average": expanded(locked(method("average")))[-1]}


def equal_cost(finished: Finished) -> Metrics:
    """Return the errors of composite schemes over that of average acceleration at equal cost."""
    errors = {}
    for name, case in cost_cases().items():
        errors[name] = or_nan(locked_error(case, finished.needed_history(case.name, "dda"))["largest"])
    least = errors.pop("average")
    return {"average": least} | {name: error / least for name, error in errors.items()}


def row(
    owner: Scene | str, name: str, cases: Sequence[Scene], compute: Callable[..., Any], *first: Any, **options: Any
) -> Derived:
    """Return a row of a function of runs of DDA, whose first arguments are given."""
    needs = tuple((case.name, "dda") for case in cases) + options.pop("exact", ())
    scene = owner if isinstance(owner, str) else owner.name
    return Derived(scene, name, needs, functools.partial(compute, *first), **options)


@functools.cache
def derived() -> DerivedRows:
    """Return the rows that are computed from finished cases."""
    declared = [row(COST, ERROR, [*cost_cases().values()], equal_cost)]
    compared = [case for name in ("constant", *FAST) for case in expanded(refined(method(name)))]
    declared.append(row(COST, "order", compared, slow_and_fast, exact=(BLOCK_EVENTS,)))
    for scheme in METHODS:
        for case in expanded(unlocked(scheme)):
            declared.append(row(case, "energy at the end", [case], final_energy, case, reads=ENERGIES))
        declared.append(row(refined(scheme), "order", expanded(refined(scheme)), order, scheme, exact=(BLOCK_EVENTS,)))
        for case in expanded(refined(scheme)):
            declared.append(row(case, "refined", [case], refined_error, scheme, case, exact=(BLOCK_EVENTS,)))
    for scheme in IMPLICIT:
        declared.append(row(impacts(scheme), "rebound map", expanded(impacts(scheme)), compared_map, scheme))
        if scheme.id != "conserving":  # which returns all of the speed at any step, and has no rigid limit
            declared.append(row(impacts(scheme), RIGID_MAP, (), rigid_map, scheme))
    for stop in STOPS:
        declared.append(row(rigid(stop), "approach", expanded(rigid(stop)), approach, stop))
    for scheme in SCHEMES:
        for case in expanded(column(scheme)):
            declared.append(row(case, "column error", [case], column_error, case, exact=(COLUMN_EVENTS,)))
    return (*declared, *facts.derived(opened(), opened_exactly()))


CURVES = ("constant", "average", "ch-0.8", "ch-0.5", "ch-0", "hht-0.1", "bathe-half", "tr-bdf2", "leapfrog")
DAMPED_OMEGAS = np.geomspace(0.03, 100.0, 71)  # w dt of the curves of damping ratios
MAP_CURVES = ("constant", "ch-0", "ch-0.8", "hht-0.1", "bathe-half")
MAP_OMEGAS = np.geomspace(0.3, 300.0, 19)  # w_c dt of those of restitutions
MAP_PHASES = 40


@functools.cache
def data() -> Mapping[str, Any]:
    """Return curves for the figures: damping ratios over w dt, restitutions over w_c dt; and labels."""
    damping = []
    landings = []
    for scheme in map(method, CURVES):
        named: dict[str, Any] = {"method": scheme.id, "label": scheme.label}
        ratios = [scheme.stepping.damping_ratio(float(omega)) for omega in DAMPED_OMEGAS]
        damping.append(named | {"omega": [*map(_short, DAMPED_OMEGAS)], "damping": [*map(_short, ratios)]})
        if scheme.id in MAP_CURVES:
            step = scheme.step_of_impact(np.repeat(MAP_OMEGAS, MAP_PHASES))
            phases = np.tile(rebound.midpoints(MAP_PHASES), len(MAP_OMEGAS))
            e = rebound.rebounds(step, phases).reshape(-1, MAP_PHASES)
            parts = {"mean": np.mean(e, axis=1), "least": np.min(e, axis=1), "most": np.max(e, axis=1)}
            curves = {part: [*map(_short, values)] for part, values in parts.items()}
            landings.append(named | {"omega": [*map(_short, MAP_OMEGAS)]} | curves)
    return {"damping": damping, "impacts": landings, "labels": {scheme.id: scheme.label for scheme in METHODS}}


def _short(value: float) -> float | None:
    return significant(value, 5) if math.isfinite(value) else None


# ---- bands ----


def damping_ratios(case: Scene) -> Bands:
    """Return the damping ratios of both modes of the locked block, where roots swing."""
    stepping = Stepping.of(case)
    ratios = {}
    for mode, frequency in (("mode1", spectra.dda_frequency(case)), ("contact", spectra.contact_frequency(case))):
        if stepping.oscillates(frequency * case.time.step):
            value = stepping.damping_ratio(frequency * case.time.step)
            ratios[f"{mode}.damping"] = about(value, 1e-10 * abs(value) + 1e-12)
    return ratios


def column_cases() -> Iterator[Scene]:
    """Yield the cases of five dropped blocks."""
    for scheme in SCHEMES:
        yield from expanded(column(scheme))


def solves_of_a_step(case: Scene) -> Band:
    """Return the solves of a scheme's stages, and what the few steps with a switch add to their mean."""
    (scheme,) = (scheme for scheme in SCHEMES if column(scheme).name == scene_of(case.name))
    return float(scheme.solves), scheme.solves + 0.25


def settled(case: Scene) -> float:
    """Return 2 tan(phi) times the settlement under the weight, over the distance slid."""
    tangent = math.tan(math.radians(case.contact.friction or 0.0))
    return 2 * tangent * friction.settlement(case) / friction.run_out(case, case.time.duration)


def slid(case: Scene) -> Band | None:
    """Return the error of the distance slid by all methods but two."""
    others = [sliding(method(name)).name for name in ("average", "implicit-euler")]
    return None if case.name.startswith(tuple(others)) else about(0.0, settled(case))


def slid_by_the_average(case: Scene) -> Band | None:
    """Return that by average acceleration, which rings on."""
    return (-0.02, -2 * settled(case)) if case.name.startswith(sliding(method("average")).name) else None


def slid_by_implicit_euler(case: Scene) -> Band | None:
    """Return that by implicit Euler, which is a step ahead."""
    if not case.name.startswith(sliding(method("implicit-euler")).name):
        return None
    return about(case.time.step / case.time.duration, settled(case))
