"""The study `stability`: correct digits, outcomes and spectral radii over stiff and extreme data.

The matrix is stiffness x step x scheme x discount from the paper's start, and from the consistent one without
discount; beside it every other datum is driven to its extremes alone.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from validation.gates.gate import Gate
from validation.metrics.growth import Stability
from validation.scenes.scene import Scene, load_scene
from validation.suite.bands import gate
from validation.theory import spectra

SCHEMES = ((0.5, 1.0), (0.25, 0.5), (0.5625, 1.0), (0.3025, 0.6), (1 / 6, 0.5), (0.0, 0.5))
STIFFNESS = tuple(10.0**power for power in range(0, 25, 3))  # p [N/m] at E = 1e9 Pa: p/E = 1e-9 to 1e15
STEPS = (1e-9, 1e-6, 1e-3, 1.0, 1e3)  # s
DISCOUNTS = (1.0, 0.9, 0.0)
STARTS = {"zero": SCHEMES[:1], "consistent": SCHEMES[1:2]}  # of the one-factor extremes: each start with one scheme
FACTORS: dict[str, dict[str, Sequence[Any]]] = {
    "density": {"block.density": (1e-6, 1e-3, 1.0, 1e5, 1e8)},
    "young": {"block.young": (1.0, 1e3, 1e6, 1e12, 1e15)},
    "size": {"block.side": (1e-6, 1e-3, 1e3, 1e6)},
    "flat": {"block.width": (60.0, 2000.0), "block.height": (2.0, 2.0)},
    "tall": {"block.width": (2.0, 2.0), "block.height": (60.0, 2000.0)},
    "plane-stress": {"block.poisson": (-0.9, -0.5, 0.25, 0.49, 0.5)},
    "plane-strain": {"block.poisson": (-0.9, 0.25, 0.49, 0.4999, 0.4999999)},
    "pressure": {"load.pressure": (0.0, 1e-300, 1e300)},
}
LIMIT = {"zero": 1e-11, "consistent": 1e-9}  # what dda promises, over the maximum
# Orders of magnitude of the pressure error of the printed recursion over 300 steps of 1e-3 s, by an independent program
LOST = {(0.5, 1e21): 2e-5, (0.5, 1e24): 0.04, (0.25, 1e21): 9e-4, (0.25, 1e24): 1.3}


def conditional(alpha: float, delta: float) -> bool:
    """Whether a scheme has a limit: unconditionally stable is 2 alpha >= delta >= 1/2."""
    return not 2 * alpha >= delta >= 0.5


def scheme_scene(alpha: float, delta: float, start: str, sweep: Mapping[str, Any]) -> Scene:
    """Return the base scene under a scheme, swept."""
    limited = conditional(alpha, delta)
    values = {"time.alpha": alpha, "time.delta": delta, "time.start": start}
    base = load_scene("extremes")
    if limited:
        values["time.allow_unstable"] = True
    name = f"extremes-{alpha:.4g}-{delta:g}" + ("-consistent" if start == "consistent" else "")
    title = f"Stiffness and step, alpha = {alpha:.4g}, delta = {delta:g}, {start} start"
    return base.with_values(values).model_copy(update={"name": name, "title": title, "sweep": dict(sweep)})


def matrix() -> Iterator[Scene]:
    """Yield every scheme from the paper's start, and from the consistent one at gg = 1."""
    sweep = {"contact.stiffness": list(STIFFNESS), "time.step": list(STEPS)}
    for alpha, delta in SCHEMES:
        yield scheme_scene(alpha, delta, "zero", sweep | {"time.gg": list(DISCOUNTS)})
        yield scheme_scene(alpha, delta, "consistent", sweep)


def factors(names: Sequence[str]) -> Iterator[Scene]:
    """Yield the one-factor extremes of constant acceleration at rest and of average acceleration, consistent."""
    for name, start in itertools.product(names, STARTS):
        ((alpha, delta),) = STARTS[start]
        values = {"time.alpha": alpha, "time.delta": delta, "time.start": start}
        if name.startswith("plane"):
            values["block.hypothesis"] = name.replace("-", " ")
        scene = load_scene("extremes").with_values(values)
        sweep = {key: list(extremes) for key, extremes in FACTORS[name].items()} | {"mode": "zip"}
        update = {"name": f"extreme-{name}-{start}", "title": f"Extremes of {name}, {start} start", "sweep": sweep}
        yield scene.model_copy(update=update)


def gates_of(scenes: Sequence[Scene]) -> Iterator[Gate]:
    """Yield the gates of the cases of scenes."""
    for scene in scenes:
        for case in scene.expand():
            if case.load.pressure == 0:
                yield gate(case, "dda", "displacement.final", (0.0, 0.0), "no load moves nothing")
            elif bounded(case):
                yield from digits(case)
            else:
                yield from grown(case)


def bounded(case: Scene) -> bool:
    """Whether the exact solution of the block stays bounded: below the limit with a margin of a millionth."""
    t = case.time
    if not conditional(t.alpha, t.delta):
        return True
    return spectra.contact_frequency(case) * t.step < spectra.critical_omega(case) * (1 - 1e-6)


def digits(case: Scene) -> Iterator[Gate]:
    """Yield the gates on correct digits, both quantities, against sixty-digit arithmetic."""
    t = case.time
    name = case.name
    why = "contact-gap coordinates, mode by mode: eleven digits from A0 = 0, nine from the consistent start"
    yield gate(name, ("dda", "dda-60"), "worst.max", (0.0, LIMIT[t.start]), why)
    lost = LOST.get((t.alpha, case.contact.stiffness))
    if lost and t.start == "zero" and t.step == 1e-3 and t.discount == 1:
        why = "the printed recursion loses the pressure: independent program, within the scatter of rounding errors"
        yield gate(name, ("dda-textbook", "dda-60"), "pressure.max", (lost / 20, lost * 20), why)


def grown(case: Scene) -> Iterator[Gate]:
    """Yield the gate on the growth beyond the limit."""
    rate = spectra.spectral_radius(case, spectra.contact_frequency(case))
    if spectra.spectral_radius(case, spectra.dda_frequency(case)) > 0.9 * rate:
        return  # two modes grow alike: which one leads after 300 steps is no matter of the scheme
    why = "beyond the limit the history grows by the spectral radius of its stiffest mode, from trace and determinant"
    yield gate(case, "dda", "stability.growth", ((1 - 1e-6) * rate, (1 + 1e-6) * rate), why)


@functools.cache
def all_scenes() -> tuple[Scene, ...]:
    """Return the matrix, and the extremes of every other datum."""
    return (*matrix(), *factors(list(FACTORS)))


@functools.cache
def corners() -> tuple[Scene, ...]:
    """Return the corners of the matrix: each start with one scheme, an explicit one, and no load."""
    sweep = {"contact.stiffness": [1.0, 1e21, 1e24], "time.step": [1e-9, 1e-3, 1e3]}
    schemes = ((0.5, 1.0, "zero"), (0.25, 0.5, "consistent"), (0.0, 0.5, "zero"))
    return (*(scheme_scene(*corner, sweep) for corner in schemes), *factors(["pressure"]))


def gates() -> Iterator[Gate]:
    """Yield the gates of all cases."""
    return gates_of(all_scenes())


def gates_of_corners() -> Iterator[Gate]:
    """Yield the gates of the corners."""
    return gates_of(corners())


def data() -> Mapping[str, Any]:
    """Return what the ends of runs are, in words."""
    return {"kinds": [f"{kind}: {kind.sentence}" for kind in Stability]}
