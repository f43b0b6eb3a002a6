"""The study `methods`: time schemes and contact methods on the same scenes, at equal steps and at equal cost.

The block on its locked springs, from rest; the same block where the contact opens; a rigid block that lands on springs;
a rigid stop; blocks on each other; a block that slides. Each by all methods that apply, held to closed forms of the
schemes and to the numbers of an independent program (`known.toml`).
"""

from __future__ import annotations

import functools
import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate
from validation.metrics.values import or_nan
from validation.runs.history import Array
from validation.runs.row import Value
from validation.scenes.scene import Scene, load_scene
from validation.studies.bands import OTHER, OWN, about, fitted_order, gate, near
from validation.studies.declaration import Study
from validation.studies.methods.methods import METHODS, SCHEMES, Method, method
from validation.theory import friction, rebound, spectra, statics
from validation.theory.stepping import Stepping

RATIOS = (1.0, 10.0, 100.0)  # p/E
STEPS = (0.01, 0.002, 0.001)  # s, of the locked block
LOCKED_TIME = 0.2  # s
HALVED = 0.0005  # s, half of the last step: average acceleration at the cost of a composite scheme
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
ORDER = "order"
ERROR = "displacement error"
FINAL = "energy at the end"
MAP = "rebound map"
RIGID_MAP = "rebound on a rigid contact"
SLIDING = "distance"
STOP = "approach"
COLUMN = "column error"
COST = "methods-cost"
SOFT = 1e-7  # of the restitution: the block's own strain, eight times p/E, and rounding over the impact
PHASE_DRIFT = 0.15  # of an order: where in their steps the landings fall changes the error's constant by a tenth
SPACING = 4 / RIGID_PHASES  # of extremes of the rigid map between two phases: its lines are at most as steep as 8
ENERGIES = tuple(f"energy.{name}" for name in ("kinetic", "strain", "springs", "load"))
UNSTABLE = "unstable"
STABLE_EXPLICIT = 1.0, 0.001  # p/E and dt [s] of the locked block within the limit of the leapfrog


@functools.cache
def known() -> Mapping[str, Any]:
    """Return the printed numbers, as text."""
    return tomllib.loads((Path(__file__).parent / "known.toml").read_text())


_EXPANDED: dict[str, tuple[Scene, ...]] = {}  # a scene has no hash


def expanded(scene: Scene) -> tuple[Scene, ...]:
    """Return the cases of a scene of the study, which are made once."""
    if scene.name not in _EXPANDED:
        _EXPANDED[scene.name] = scene.expand()
    return _EXPANDED[scene.name]


def half_unit(text: str) -> float:
    """Return half a unit of the last digit of a printed decimal number."""
    return 0.5 * 10.0 ** -len(text.partition(".")[2])


def named(scene: Scene, part: str, one: Method, title: str, sweep: Mapping[str, Sequence[float]]) -> Scene:
    """Return a scene of the study, whose lists of values are varied together."""
    lists = {field: list(values) for field, values in sweep.items()}
    update = {"name": f"methods-{part}-{one.id}", "title": f"{title}: {one.label}", "sweep": {"mode": "zip", **lists}}
    return scene.model_copy(update=update)


# ---- scenes ---------------------------------------------------------------------------------------------------------


@functools.cache
def locked(one: Method) -> Scene:
    """Return the locked block from rest, over springs and step."""
    rows = [(ratio, step) for ratio in RATIOS for step in STEPS]
    if one.id == "leapfrog":
        rows = [STABLE_EXPLICIT]
    if one.id == "average":
        rows.append((1.0, HALVED))
    scene = one.scene(load_scene("figures-3-4"), {"run.solvers": ["dda"]})
    sweep: dict[str, list[float]] = {
        "contact.stiffness": [ratio * scene.block.young for ratio, _ in rows],
        "time.step": [step for _, step in rows],
        "time.steps": [round(LOCKED_TIME / step) for _, step in rows],
    }
    return named(scene, "locked", one, "The locked block from rest", sweep)


@functools.cache
def unlocked(one: Method) -> Scene:
    """Return the block whose contact opens, over springs and step."""
    values: dict[str, Any] = {"run.solvers": ["dda"], "time.allow_unstable": one.group == "explicit"}
    scene = one.scene(load_scene("unlocked-average"), values)
    sweep: dict[str, list[float]] = {
        "contact.stiffness": [ratio * scene.block.young for ratio, _ in UNLOCKED],
        "time.step": [step for _, step in UNLOCKED],
        "time.steps": [round(UNLOCKED_TIME / step) for _, step in UNLOCKED],
    }
    return named(scene, "unlocked", one, "Contact that opens", sweep)


@functools.cache
def refined(one: Method) -> Scene:
    """Return the block whose contact opens, at p = 1E, over halved steps."""
    scene = one.scene(load_scene("unlocked-average"), {"run.solvers": ["dda"]})
    counts = [COARSEST * 2**level for level in range(SLOW_LEVELS.get(one.id, LEVELS))]
    sweep = {"time.step": [REFINED_TIME / count for count in counts], "time.steps": counts}
    return named(scene, "refined", one, "Contact that opens, steps refined", sweep)


@functools.cache
def truth() -> Scene:
    """Return the block whose contact opens, exact in time."""
    values = {"run.solvers": ["block-events"], "time.step": REFINED_TIME / COARSEST, "time.steps": COARSEST}
    scene = method("average").scene(load_scene("unlocked-average"), values)
    return scene.model_copy(update={"name": "methods-refined-exact", "title": "Contact that opens, exact in time"})


@functools.cache
def impacts(one: Method) -> Scene:
    """Return the rigid block that lands on springs, over w_c dt and the phase of the landing."""
    scene = one.scene(load_scene("rebound-average"), {"run.solvers": ["dda"], "time.steps": IMPACT_STEPS})
    rows = [(omega, phase) for omega in IMPACT_OMEGAS for phase in IMPACT_PHASES]
    mass = scene.block.mass
    dt = scene.time.step
    sweep = {
        "contact.stiffness": [(omega / dt) ** 2 * mass / 2 for omega, _ in rows],
        "contact.gap": [(3 - phase) * dt * -scene.block.velocity for _, phase in rows],
    }
    return named(scene, "impact", one, "A rigid block lands on springs", sweep)


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
    rigid_stop: dict[str, Any] = {"contact.stiffness": "inf", "contact.shear_stiffness": 0.0, "run.solvers": ["dda"]}
    base = load_scene("unlocked-average").model_copy(update={"sweep": {}})
    counts = [RIGID_COARSEST * 2**level for level in range(RIGID_LEVELS)]
    steps = [REFINED_TIME / count for count in counts]
    sweep: dict[str, Any] = {"mode": "zip", "time.step": steps, "time.steps": counts}
    update = {"name": f"methods-rigid-{stop}", "title": f"A rigid stop: {words}", "sweep": sweep}
    return base.with_values({**rigid_stop, **values}).model_copy(update=update)


@functools.cache
def column(one: Method) -> Scene:
    """Return five rigid blocks that are dropped on each other, over two steps."""
    values = {"run.solvers": ["dda"], "run.columns": ["displacement"]}
    scene = one.scene(load_scene("columns-drop-average"), values)
    sweep = {"time.step": COLUMN_STEPS, "time.steps": [round(COLUMN_TIME / step) for step in COLUMN_STEPS]}
    return named(scene, "column", one, "Five rigid blocks dropped", sweep)


@functools.cache
def column_truth() -> Scene:
    """Return the five blocks, exact in time."""
    steps = {"time.step": COLUMN_STEPS[0], "time.steps": round(COLUMN_TIME / COLUMN_STEPS[0])}
    values = {"run.solvers": ["column-events"], "run.columns": ["displacement"], **steps}
    scene = method("average").scene(load_scene("columns-drop-average"), values)
    return scene.model_copy(
        update={"name": "methods-column-exact", "title": "Five rigid blocks dropped, exact in time"}
    )


@functools.cache
def sliding(one: Method) -> Scene:
    """Return the block that slides down an incline."""
    steps = {"time.step": SLIDING_STEP, "time.steps": round(SLIDING_TIME / SLIDING_STEP)}
    scene = one.scene(load_scene("slope-sliding"), {"run.solvers": ["dda"], "contact.cohesion": 0.0, **steps})
    return named(scene, "sliding", one, "A block that slides", {"time.step": [SLIDING_STEP]})


IMPLICIT = tuple(one for one in METHODS if one.group != "explicit")  # what a rigid block's own strain allows
FRICTIONAL = tuple(one for one in IMPLICIT if one.id != "conserving")  # conserving contact has no friction


@functools.cache
def scenes() -> tuple[Scene, ...]:
    """Return all scenes of the study."""
    declared = [locked(one) for one in SCHEMES]
    declared += [unlocked(one) for one in METHODS]
    declared += [refined(one) for one in METHODS]
    declared += [impacts(one) for one in IMPLICIT]
    declared += [rigid(stop) for stop in STOPS]
    declared += [column(one) for one in SCHEMES]
    declared += [sliding(one) for one in FRICTIONAL]
    return (*declared, truth(), column_truth())


# ---- what is derived from the runs ----------------------------------------------------------------------------------


def exact_locked(scene: Scene) -> Array:
    """Return the displacement of the block of one strain on locked springs, exact in time, from rest [m].

    sum of x_i (x_i . F) / w_i^2 (1 - cos w_i t) over both modes of M = diag(m, m h^2/12) and
    K = [[2p, -p h], [-p h, E w h + p h^2/2]] in (v, ey), F = -q w (1, h/2).
    """
    E, _ = statics.moduli(scene)
    w, h = statics.size(scene)
    p = scene.contact.stiffness
    m = scene.block.mass
    roots = np.array([m, m * h * h / 12]) ** -0.5
    K = np.array([[2 * p, -p * h], [-p * h, E * w * h + p * h * h / 2]])
    squares, vectors = np.linalg.eigh(K * np.outer(roots, roots))
    modes = roots[:, None] * vectors
    load = -scene.load.pressure * w * np.array([1.0, h / 2])
    t = scene.time.step * np.arange(1.0, scene.time.steps + 1)
    shares = modes[0] * (load @ modes) / squares
    return np.asarray((1 - np.cos(np.outer(t, np.sqrt(squares)))) @ shares)


def locked_error(case: Scene, finished: Finished) -> Mapping[str, Value]:
    """Return the largest displacement error over the largest exact displacement."""
    exact = exact_locked(case)
    history = finished.needed_history(case.name, "dda").displacement
    return {"largest": float(np.max(np.abs(history - exact)) / np.max(np.abs(exact)))}


def final_energy(case: Scene, finished: Finished) -> Mapping[str, Value]:
    """Return the energy at the last step over W0, that of the start being zero."""
    metrics = finished.rows[case.name, "dda"].metrics
    return {"share": sum(or_nan(metrics.get(name)) for name in ENERGIES) / ENERGY}


def errors_of(one: Method, finished: Finished) -> dict[int, float]:
    """Return the relative L2 error of the displacement's rate by the number of steps, at the coarsest instants."""
    exact = _velocity(finished, truth(), "block-events")
    errors = {}
    for case in expanded(refined(one)):
        velocity = _velocity(finished, case, "dda")
        errors[case.time.steps] = float(np.linalg.norm(velocity - exact) / np.linalg.norm(exact))
    return errors


def _velocity(finished: Finished, case: Scene, solver: str) -> Array:
    """Return the displacement v at the coarsest instants [m]."""
    stride = case.time.steps // COARSEST
    return np.asarray(finished.needed_history(case.name, solver).displacement[stride - 1 :: stride])


def order(one: Method, finished: Finished) -> Mapping[str, Value]:
    """Return the order of the last halving, and the steps times solves that reach the target."""
    errors = errors_of(one, finished)
    *_, coarse, fine = errors.values()
    reached = [count for count, error in errors.items() if error <= TARGET]
    values: dict[str, Value] = {"last halving": math.log2(coarse / fine), "finest error": fine}
    values["solves to 1 %"] = float(min(reached) * one.solves) if reached else "undefined"
    return values | {f"error of {count} steps": error for count, error in errors.items()}


def slow_and_fast(finished: Finished) -> Mapping[str, Value]:
    """Return how many times as many steps DDA's own scheme needs for 1 % of the motion as CH 0."""
    counts = [order(method(name), finished)["solves to 1 %"] for name in ("constant", "ch-0")]
    return {"constant over ch-0": or_nan(counts[0]) / or_nan(counts[1])}


# Displacement of the block that stops dead at a rigid stop, by an independent program [s], [m].
PLASTIC = {0.01: -0.00350963748, 0.02: -0.00744841152, 0.05: -0.00275254957}


def approach(stop: str, finished: Finished) -> Mapping[str, Value]:
    """Return the orders in the step of the distance from the plastic motion and of the peak pressure."""
    exact = np.array([*PLASTIC.values()])
    steps = []
    errors = []
    peaks = []
    for case in expanded(rigid(stop)):
        history = finished.needed_history(case.name, "dda")
        instants = [round(time / case.time.step) - 1 for time in PLASTIC]
        steps.append(case.time.step)
        errors.append(float(np.linalg.norm(history.displacement[instants] - exact) / np.linalg.norm(exact)))
        peaks.append(float(np.max(history.contact_pressure)))
    return {
        "order": fitted_order(steps, errors),
        "finest error": errors[-1],
        "order of the peak": fitted_order(steps, peaks),
        "finest peak": peaks[-1],
    }


def column_error(case: Scene, finished: Finished) -> Mapping[str, Value]:
    """Return the relative L2 error of the mean displacement at the coarser steps."""
    exact = finished.needed_history(column_truth().name, "column-events").displacement
    stride = round(COLUMN_STEPS[0] / case.time.step)
    displacement = finished.needed_history(case.name, "dda").displacement[stride - 1 :: stride]
    return {"l2": float(np.linalg.norm(displacement - exact) / np.linalg.norm(exact))}


def slid_distance(case: Scene, finished: Finished) -> Mapping[str, Value]:
    """Return the relative error of the distance slid, a t^2 / 2 with a = g (sin b - tan(phi) cos b)."""
    exact = friction.sliding_acceleration(case) * case.time.duration**2 / 2
    distance = float(finished.needed_history(case.name, "dda").columns["horizontal_displacement"][-1])
    return {"error": abs(distance) / abs(exact) - 1}


def restitutions(one: Method, finished: Finished) -> Iterator[tuple[Scene, float, float]]:
    """Yield the cases of a rigid block that lands, with the restitution of DDA and of the map."""
    for case in expanded(impacts(one)):
        history = finished.needed_history(case.name, "dda").displacement
        after = float(history[-1] - history[-2]) / case.time.step
        omega = math.sqrt(2 * case.contact.stiffness / case.block.mass) * case.time.step
        steps = case.contact.gap / (-case.block.velocity * case.time.step)
        phase = math.ceil(steps) - steps
        expected = float(rebound.rebounds(one.step_of_impact(omega), [phase])[0])
        yield case, after / -case.block.velocity, expected


def compared_map(one: Method, finished: Finished) -> Mapping[str, Value]:
    """Return the largest difference of DDA's restitution from the map, and the greatest restitution."""
    rows = list(restitutions(one, finished))
    return {
        "largest difference": max(abs(measured - expected) for _, measured, expected in rows),
        "greatest": max(measured for _, measured, _ in rows),
    }


@functools.cache
def rigid_statistics(one: Method) -> rebound.ReboundStatistics:
    """Return the statistics of the restitution on a rigid contact over many phases."""
    return rebound.rebound_statistics(one.step_of_impact(math.inf), count=RIGID_PHASES)


def rigid_map(one: Method, finished: Finished) -> Mapping[str, Value]:
    """Return mean, least, greatest and mean square of the restitution on a rigid contact."""
    return dict(rigid_statistics(one)._asdict())


def equal_cost(finished: Finished) -> Mapping[str, Value]:
    """Return the errors of composite schemes at p = 1E and 1 ms over that of average acceleration at half the step."""
    average = case_of(locked(method("average")), 1.0, HALVED)
    least = or_nan(locked_error(average, finished)["largest"])
    values: dict[str, Value] = {"average": least}
    for one in SCHEMES:
        if one.group == "composite":
            error = or_nan(locked_error(case_of(locked(one), 1.0, 2 * HALVED), finished)["largest"])
            values[one.id] = error / least
    return values


def case_of(scene: Scene, ratio: float, step: float) -> Scene:
    """Return the case of a stiffness p/E and a step [s]."""
    for case in expanded(scene):
        if math.isclose(case.contact.stiffness, ratio * case.block.young) and math.isclose(case.time.step, step):
            return case
    raise LookupError(f"{scene.name}: no case of p = {ratio:g}E and dt = {step:g} s")


@functools.cache
def derived() -> tuple[Derived, ...]:
    """Return the rows that are computed from finished cases."""
    rows = []
    for one in SCHEMES:
        for case in expanded(locked(one)):
            rows.append(Derived(case.name, ERROR, ((case.name, "dda"),), functools.partial(locked_error, case)))
    composites = [locked(one) for one in SCHEMES if one.group == "composite"]
    cost_cases = [case_of(scene, 1.0, 2 * HALVED) for scene in composites]
    cost_cases.append(case_of(locked(method("average")), 1.0, HALVED))
    rows.append(Derived(COST, ERROR, tuple((case.name, "dda") for case in cost_cases), equal_cost))
    compared_levels = [(case.name, "dda") for name in ("constant", "ch-0") for case in expanded(refined(method(name)))]
    rows.append(Derived(COST, ORDER, (*compared_levels, (truth().name, "block-events")), slow_and_fast))
    for one in METHODS:
        for case in expanded(unlocked(one)):
            needs = ((case.name, "dda"),)
            rows.append(Derived(case.name, FINAL, needs, functools.partial(final_energy, case), ENERGIES))
        levels = [(case.name, "dda") for case in expanded(refined(one))]
        needs_truth = (*levels, (truth().name, "block-events"))
        rows.append(Derived(refined(one).name, ORDER, needs_truth, functools.partial(order, one)))
    for one in IMPLICIT:
        landings = tuple((case.name, "dda") for case in expanded(impacts(one)))
        rows.append(Derived(impacts(one).name, MAP, landings, functools.partial(compared_map, one)))
        if one.id != "conserving":  # which returns all of the speed at any step, and has no rigid limit
            rows.append(Derived(impacts(one).name, RIGID_MAP, (), functools.partial(rigid_map, one)))
    for stop in STOPS:
        levels = [(case.name, "dda") for case in expanded(rigid(stop))]
        rows.append(Derived(rigid(stop).name, STOP, tuple(levels), functools.partial(approach, stop)))
    for one in SCHEMES:
        for case in expanded(column(one)):
            needs_column = ((case.name, "dda"), (column_truth().name, "column-events"))
            rows.append(Derived(case.name, COLUMN, needs_column, functools.partial(column_error, case)))
    for one in FRICTIONAL:
        for case in expanded(sliding(one)):
            rows.append(Derived(case.name, SLIDING, ((case.name, "dda"),), functools.partial(slid_distance, case)))
    return tuple(rows)


CURVES = ("constant", "average", "ch-0.8", "ch-0.5", "ch-0", "hht-0.1", "bathe-half", "tr-bdf2", "leapfrog")
DAMPED_OMEGAS = np.geomspace(0.03, 100.0, 71)  # w dt of the curves of damping ratios
MAP_CURVES = ("constant", "ch-0", "ch-0.8", "hht-0.1", "bathe-half")
MAP_OMEGAS = np.geomspace(0.3, 300.0, 19)  # w_c dt of those of restitutions
MAP_PHASES = 40


@functools.cache
def data() -> Mapping[str, Any]:
    """Return curves of the theory for the figures: damping ratios over w dt, restitutions over w_c dt."""
    curves: dict[str, dict[str, list[float | None]]] = {}
    for name in CURVES:
        one = method(name)
        ratios = [one.stepping.damping_ratio(float(omega)) for omega in DAMPED_OMEGAS]
        curves[name] = {"damping": [_short(ratio) for ratio in ratios]}
        if name not in MAP_CURVES:
            continue
        rows = [rebound.rebound_statistics(one.step_of_impact(float(w)), count=MAP_PHASES) for w in MAP_OMEGAS]
        for part in ("mean", "least", "most"):
            curves[name][part] = [_short(getattr(row, part)) for row in rows]
    omegas = {"damping": [_short(x) for x in DAMPED_OMEGAS], "impact": [_short(x) for x in MAP_OMEGAS]}
    return {"omega": omegas, "methods": curves, "labels": {one.id: one.label for one in METHODS}}


def _short(value: float) -> float | None:
    return float(f"{value:.5g}") if math.isfinite(value) else None


# ---- gates ----------------------------------------------------------------------------------------------------------

PRINTED = "an independent program: half a unit of its last digit"
# Method and case of `UNLOCKED` whose motion is chaotic: it gains energy landing by landing, and a change of the load in
# its sixteenth digit changes the numbers of 0.1 s by parts of a percent to multiples. They are not gated.
CHAOTIC = {
    ("average", 2),
    *((name, 3) for name in ("average", "ch-0.8", "hht-0.1", "bathe-0.5", "leapfrog")),
}
CLOSED: Mapping[str, tuple[float, ...]] = {  # mean, least, greatest and mean square of e on a rigid contact
    "constant": (1 / 2, 0.0, 1.0, 1 / 3),
    "kane": (1 / 2, 0.0, 1.0, 1 / 3),
    "average": (5 / 3, 1 / 3, 3.0, 91 / 27),
    "nine-sixteenths": (19 / 45, 1 / 15, 7 / 9, 0.2204),
    "implicit-euler": (0.0, 0.0, 0.0, 0.0),
    "ch-0": (2 / 3, 1 / 3, 1.0, 13 / 27),
    "wbz-0.5": (7 / 6, 1 / 3, 2.0, 43 / 27),
}
PARTS = ("mean", "least", "most", "mean_square")


def printed(case: Scene | str, name: str, metric: str, text: str, scale: float = 1.0, why: str = PRINTED) -> Gate:
    """Return the gate on a number as it was printed, times a scale."""
    half = half_unit(text) * scale
    return gate(case, name, metric, about(float(text) * scale, half * 1.001), why, OTHER, half)


@functools.cache
def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (
        *locked_gates(),
        *cost_gates(),
        *unlocked_gates(),
        *order_gates(),
        *impact_gates(),
        *rigid_gates(),
        *stop_gates(),
        *column_gates(),
        *sliding_gates(),
    )


def locked_gates() -> Iterator[Gate]:
    """Yield the gates on damping ratios and errors of the locked block."""
    why = "roots of one step of the scheme at the closed-form frequency, written apart from the solver; band: rounding"
    errors = f"{PRINTED}; phase errors saturate near 0.5 (damped to rest) and 1 (out of phase)"
    for one in SCHEMES:
        cases = expanded(locked(one))
        texts = known()["locked"][one.id]
        if one.id == "leapfrog":
            texts = [text for text in texts if text != UNSTABLE]
        for n, case in enumerate(cases):
            stepping = Stepping.of(case)
            modes = {"mode1": spectra.dda_frequency(case), "contact": spectra.contact_frequency(case)}
            for mode, frequency in modes.items():
                if stepping.oscillates(frequency * case.time.step):
                    value = stepping.damping_ratio(frequency * case.time.step)
                    yield gate(case, "dda", f"{mode}.damping", about(value, 1e-10 * abs(value) + 1e-12), why)
            if n < len(texts):
                yield printed(case, ERROR, "largest", texts[n], why=errors)


def cost_gates() -> Iterator[Gate]:
    """Yield the gates on errors at equal cost."""
    halved = "0.090204"
    yield printed(COST, ERROR, "average", halved)
    why = (
        "error of a composite scheme over that of average acceleration for the same solves, from an independent "
        "program's errors of both; above 1: two solves do not pay"
    )
    for one in SCHEMES:
        if one.group == "composite":
            text = known()["locked"][one.id][2]
            value = float(text) / float(halved)
            yield gate(COST, ERROR, one.id, about(value, 1.001 * value * half_unit(halved) / float(halved)), why, OTHER)
    why = "DDA's own scheme is of first order: an independent program's counts, 12800 and 800, a whole number"
    yield gate(COST, ORDER, "constant over ch-0", (16.0, 16.0), why, OTHER)


def unlocked_gates() -> Iterator[Gate]:
    """Yield the gates on peak pressure and energy where the contact opens."""
    why = f"{PRINTED}; with the leapfrog beyond its limit the block is thrown, and all numbers stay finite"
    for one in METHODS:
        rows = known()["unlocked"].get(one.id, ())
        for n, (case, row) in enumerate(zip(expanded(unlocked(one)), rows, strict=False)):
            if (one.id, n) in CHAOTIC:
                continue
            peak, energy = row
            yield printed(case, "dda", "contact.peak_force", peak, 1e6 * case.block.base_length, why)
            if one.id != "implicit-euler":  # as Newmark (1, 3/2) it has another velocity, and another kinetic energy
                yield printed(case, FINAL, "share", energy, why=why)


def order_gates() -> Iterator[Gate]:
    """Yield the gates on the order through openings and landings, and on the solves for 1 % of the motion."""
    counts = known()["solves"]
    for one in METHODS:
        value = one.order
        why = f"order {value} of the scheme, kept through switches; band: where the landings fall in their steps"
        yield gate(refined(one), ORDER, "last halving", about(value, PHASE_DRIFT), why)
        if one.id in counts:
            why = "an independent program: steps times solves, in powers of two, a whole number"
            count = float(counts[one.id])
            yield gate(refined(one), ORDER, "solves to 1 %", (count, count), why, OTHER)


def impact_gates() -> Iterator[Gate]:
    """Yield the gates on the impacts of the rigid block."""
    why = "the map of the scheme's stages, computed without DDA; band: the block's strain, 8 p/E, and rounding"
    for one in IMPLICIT:
        yield gate(impacts(one), MAP, "largest difference", (0.0, SOFT), why, OTHER)


def rigid_gates() -> Iterator[Gate]:
    """Yield the gates on the rebound of a rigid contact, the limit of every stiff one."""
    closed = "closed form; band: extremes between two of the phases"
    gains = "damping of the closed contact does not tame its impacts: the greatest rebound, by an independent program"
    for one in IMPLICIT:
        name = impacts(one)
        for part, value in zip(PARTS, CLOSED.get(one.id, ()), strict=False):
            yield gate(name, RIGID_MAP, part, about(value, SPACING), closed)
        for part, text in zip(PARTS, known()["stiff"].get(one.id, ()), strict=False):
            if text != "-":
                yield printed(name, RIGID_MAP, part, text, why=gains if part == "most" else PRINTED)


def stop_gates() -> Iterator[Gate]:
    """Yield the gates on rigid stops: whether they converge to the motion of a plastic impact."""
    name = rigid("displacements")
    why = (
        "a rigid stop in displacements turns each landing back by where in the step it falls, at every step: no "
        "convergence, |order| < 1/2, where a method that converges has 1"
    )
    yield gate(name, STOP, "order", (-0.5, 0.5), why)
    why = (
        "the distance from the plastic motion that is left at the finest step: an independent program, 1 to 4 %, twice"
    )
    yield gate(name, STOP, "finest error", (0.005, 0.08), why, OTHER)
    why = "theta = 1/2 leaves a penetration of up to V dt at a landing, by its phase: order 1, which scatters"
    yield gate(rigid("impulses"), STOP, "order", about(0.85, 0.35), why)
    why = "theta = 1 is implicit Euler between the impacts: order 1; band: the next order at the coarsest step"
    yield gate(rigid("impulses-euler"), STOP, "order", about(1.0, 0.15), why)
    why = "the pressure of a rigid stop is an impulse over dt: order -1; band: the load's part of it"
    for stop in ("impulses", "impulses-euler"):
        yield gate(rigid(stop), STOP, "order of the peak", about(-1.0, 0.05), why)


# Relative L2 error of the mean displacement of five blocks at the finer step; this suite's own.
COLUMN_ERRORS: Mapping[str, float] = {
    "constant": 0.2702,
    "average": 0.004545,
    "nine-sixteenths": 0.2681,
    "implicit-euler": 0.4425,
    "ch-0.8": 0.004901,
    "ch-0.5": 0.007143,
    "ch-0": 0.01111,
    "hht-0.1": 0.005857,
    "wbz-0.5": 0.009092,
    "bathe-half": 0.002043,
    "tr-bdf2": 0.001817,
    "bathe-0.5": 0.001405,
    "leapfrog": 0.005209,
}


def column_gates() -> Iterator[Gate]:
    """Yield the gates on five blocks that are dropped on each other."""
    solves = "solves of the stages, and one more where a contact opens or closes, which few steps do"
    errors = "error against the exact motion, this suite's own last value; band: where the landings fall in their steps"
    for one in SCHEMES:
        for case in expanded(column(one)):
            yield gate(case, "dda", "contact.mean_solves", (float(one.solves), one.solves + 0.25), solves)
        *_, fine = expanded(column(one))
        yield gate(fine, COLUMN, "l2", near(COLUMN_ERRORS[one.id], 0.05), errors, OWN)


def sliding_gates() -> Iterator[Gate]:
    """Yield the gates on the distance slid."""
    for one in FRICTIONAL:
        (case,) = expanded(sliding(one))
        distance = friction.sliding_acceleration(case) * case.time.duration**2 / 2
        settled = 2 * math.tan(math.radians(case.contact.friction or 0.0)) * friction.settlement(case) / distance
        late = case.time.step / case.time.duration if one.id == "implicit-euler" else 0.0
        why = (
            "a t^2 / 2; the settlement under the weight, as the friction's part of it, comes late by up to twice itself"
        )
        if late:
            why += "; implicit Euler is ahead by dt / T"
        if one.id == "average":  # which rings on: the block sticks in each unloading
            why = "undamped ringing lets the block stick in each period: the distance is short, by at most two percent"
            yield gate(case, SLIDING, "error", (-0.02, -2 * settled), why, "own last value")
            continue
        yield gate(case, SLIDING, "error", about(late, settled), why)


def study() -> Study:
    """Return the study, whose many scenes are made when it is asked for."""
    return Study(
        name="methods",
        title="Methods that are proposed as cures",
        purpose="Generalised-alpha, composite and explicit time schemes and other contact methods on the same scenes: "
        "which scheme where contact is locked, which where it opens, and what never to use?",
        scenes=scenes(),
        gates=gates,
        derived=derived,
        data=data,
        pairs=(),
    )
