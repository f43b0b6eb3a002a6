"""The study `creep`: a statically stable block on an incline that moves all the same.

Undamped normal ringing unloads the friction once a period, so that the exact block creeps with a speed that scales with
g / w_n: at 20 degrees under 22 or 30 of friction between a half and twice that. A scheme that damps the ringing lets it
stop; friction that lags by a pass, and dead bands, let it go on, the faster the finer the step.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from validation.engine.finished import Derived, Finished, from_history
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.studies.bands import APART, LAGS, OTHER, about, cases, gate, order_row
from validation.studies.declaration import Study
from validation.theory import friction

EXACT = "creep-exact"
STEPS = "creep-steps"
LAGGED = "creep-lagged"
STIFFNESS = "creep-stiffness"
DAMPED = "creep-damped"
REFINED = {"slope-exact-constant": 1.0, "slope-exact-average": 2.0}
NEXT = 0.1  # of an order: what the next order adds over three halvings
EVENTS = "block-events"
DDA = "dda"
# Mean slip of the corners of the exact block at 0.1, 0.2, 0.3 and 0.4 s by an independent program [m], 30 degrees.
KNOWN = (1.790e-3, 3.732e-3, 5.532e-3, 7.394e-3)
RATES = {30.0: 18.7e-3, 22.0: 27.3e-3}  # its speed [m/s] over some tenths of a second
HALF = 5e-7  # m: half a unit of the last digit of KNOWN
# Way of the centroid in a second under lagged friction by an established program [m], by time step [s].
PROGRAM = {0.01: 1.0e-3, 0.002: 2.2e-3, 0.001: 5.2e-3, 0.0002: 499e-3}
DIGIT = 5e-5  # m: half a unit of its last digit
SHUFFLED = 0.2  # of the way: rounding, or 0.2 % on the springs, changes the order of stick and slip at the finest step
STOPS = {0.001: 0.26e-3, 0.0002: 1.13e-3}  # mean slip at which consistent friction stands under (1/2, 1) [m]
STOPPED = 5e-6  # m: half a unit of its last digit


def slid(columns: Mapping[str, Any]) -> np.ndarray:
    """Return the mean slide of the two corners [m]."""
    return np.asarray((columns["slide_m"] + columns["slide_n"]) / 2)


def derived() -> tuple[Derived, ...]:
    """Return the rows that are computed from finished cases."""
    exact = [from_history(case, EVENTS, "base", _base) for case in cases(EXACT, STIFFNESS)]
    steps = [from_history(case, DDA, "base", _base) for case in cases(STEPS, LAGGED, DAMPED)]
    return (
        *exact,
        *steps,
        *(_nearest(step) for step in PROGRAM),
        *(order_row(name, (DDA, EVENTS), "time.step", ("displacement", "horizontal")) for name in REFINED),
    )


def _base(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return the mean slide of the corners at quarters of the run, and its mean speed over the second half."""
    mean_slide = slid(history.columns)
    n = len(history.time)
    values: dict[str, Value] = {f"way.{k}": float(mean_slide[k * n // 4 - 1]) for k in (1, 2, 3, 4)}
    speed = (mean_slide[-1] - mean_slide[n // 2 - 1]) / (history.time[-1] - history.time[n // 2 - 1])
    mean_speed = mean_slide[-1] / history.time[-1]
    scale = friction.creep_scale(scene)
    return values | {"speed": float(speed), "mean_speed": float(mean_speed), "share": float(mean_speed / scale)}


def _nearest(step: float) -> Derived:
    """Return the row that lays the creep of three like springs beside the program's."""
    like_cases = tuple(case for case in cases(LAGGED) if case.time.step == step)
    needs = tuple((case.name, DDA) for case in like_cases)
    return Derived(LAGGED, f"at {1e3 * step:g} ms", needs, functools.partial(_beside, like_cases, PROGRAM[step]))


def _beside(like_cases: tuple[Scene, ...], program_slide: float, finished: Finished) -> Mapping[str, Value]:
    """Return how far the program's way is from those of the springs, over what their spread and its digits allow."""
    histories = [finished.needed_history(case.name, DDA) for case in like_cases]
    slides = [float(history.columns["horizontal_displacement"][-1]) for history in histories]
    middle = (min(slides) + max(slides)) / 2
    spread = max(slides) - min(slides)
    allowed = 1.5 * spread + DIGIT
    if program_slide > 0.1:
        allowed = max(allowed, SHUFFLED * program_slide)
    return {"distance": (program_slide - middle) / allowed, "way": middle, "spread": spread}


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (*exact_gates(), *step_gates(), *stiffness_gates(), *lagged_gates(), *order_gates())


def exact_gates() -> Iterator[Gate]:
    """Yield the gates on the exact creep."""
    digits_reason = "an independent program, by events; half a unit of its last digit"
    for case in cases(EXACT):
        phi = case.contact.friction or 0.0
        if phi == 30:
            for k, mean_slide in enumerate(KNOWN, start=1):
                yield gate(case, "base", f"way.{k}", about(mean_slide, HALF), digits_reason, OTHER, HALF)
        rate = RATES[phi]
        why = "an independent program, the speed over some tenths of a second; 5 % for where they begin and end"
        yield gate(case, "base", "speed", about(rate, 0.05 * rate), why, OTHER, 5e-5)
        order = "at 20 degrees under 22 or 30 the speed is between a half and twice g / w_n = g sqrt(m / (2 p))"
        yield gate(case, "base", "share", (0.5, 2.0), order)


def step_gates() -> Iterator[Gate]:
    """Yield the gates on consistent friction by steps."""
    for case in cases(STEPS):
        t = case.time
        if t.delta == 1 and t.discount == 1:
            stands = "constant acceleration damps the normal ringing: the block stands; band: rounding"
            yield gate(case, DDA, "contact.slip_rate", (0.0, 1e-9), stands)
            if t.step in STOPS:
                digits_reason = "an independent program: where it stands; half a unit of its last digit"
                yield gate(case, "base", "way.4", about(STOPS[t.step], STOPPED), digits_reason, OTHER, STOPPED)
        elif t.discount < 1:
            stands = "2 % a step damp the normal ringing: the block stands; band: rounding"
            yield gate(case, DDA, "contact.slip_rate", (0.0, 1e-9), stands)
        elif t.step <= 2e-4:
            goes = "average acceleration keeps the ringing from any start: the exact speed, between a half and twice"
            yield gate(case, "base", "mean_speed", (0.5 * RATES[30.0], 2 * RATES[30.0]), goes)


def stiffness_gates() -> Iterator[Gate]:
    """Yield the gates on springs of any stiffness: the creep of an undamped block, and where a damped one stands."""
    order = "on this slope the speed is between a half and twice g / w_n = g sqrt(m / (2 p)) on each of these springs"
    for case in cases(STIFFNESS):
        yield gate(case, "base", "share", (0.5, 2.0), order)
        for column in ("displacement", "horizontal"):
            yield gate(case, (DDA, EVENTS), f"{column}.l2", (APART, friction.lag(case)), LAGS)
    stands = "scheme or discount damp the normal ringing: the block stands; band: rounding"
    far = "more than one hop g / w_n^2, less than twice g / w_n until the damped ringing unloads the friction no more"
    for case in cases(DAMPED):
        yield gate(case, DDA, "contact.slip_rate", (0.0, 1e-9), stands)
        hop = friction.creep_scale(case) / friction.normal_frequency(case)
        yield gate(case, "base", "way.4", (hop, 2 * friction.damped_creep(case)), far)


def lagged_gates() -> Iterator[Gate]:
    """Yield the gates on lagged friction beside an established program."""
    for step, program_slide in PROGRAM.items():
        why = (
            f"an established program creeps {1e3 * program_slide:g} mm in a second; band: 1.5 times the spread of "
            "springs softer by 0, 0.2 and 0.4 %, as its base is, and half a unit of its last digit"
        )
        if program_slide > 0.1:
            why += "; 20 % at the finest step, where rounding decides the order of stick and slip"
        yield gate(LAGGED, f"at {1e3 * step:g} ms", "distance", (-1.0, 1.0), why, OTHER, 1e-3)


def order_gates() -> Iterator[Gate]:
    """Yield the gates on the order at which DDA tends to the exact motion through stick and slip."""
    for name, order in REFINED.items():
        why = f"order {order:g} of the scheme, kept through stick and slip; {NEXT:g} for the next order"
        for column in ("displacement", "horizontal"):
            yield gate(name, "order", column, about(order, NEXT), why)


STUDY = Study(
    name="creep",
    title="Stable blocks that creep",
    purpose="A block below its angle of friction should stand. The exact block on undamped springs creeps; does a code "
    "let it stand, creep as it does, or slide the faster the finer its step?",
    scenes=(EXACT, STEPS, STIFFNESS, DAMPED, LAGGED, *REFINED),
    gates=gates,
    derived=derived,
    pairs=((DDA, EVENTS),),
    long=True,
)
