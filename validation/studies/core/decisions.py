"""What the first pages say in closed form: what a step damps, what springs add, what a discount does.

Rows of `figures-3-4`, under constant acceleration without a discount where nothing else is said:

    closed              p/E of the scene; w dt and the most that a step damps; the rate of a discount for 5 %
    p = {ratio}E        frequencies, and the step for each damping ratio
    stepped at {step}   the first frequency as stepped, against the bar's
    gg = {gg}           what a discount per step damps, under average acceleration
    held at {step}      the same of a discount that is held as a rate
"""

from __future__ import annotations

import cmath
import functools
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from validation.engine.finished import Derived, Finished
from validation.metrics.values import or_nan
from validation.runs.history import Array
from validation.runs.row import Metrics, Row
from validation.scenes.scene import Scene
from validation.studies.core import closed
from validation.suite.bands import cases
from validation.theory import spectra, statics

PAPER = "figures-3-4"
POINTS = 240  # of a curve
FIRST_POINTS = 200  # of that of the paper's own block
RATIOS = (1.0, 10.0, 100.0)  # p/E of the paper
TARGETS = (0.01, 0.02, 0.05, 0.1, 0.2)  # damping ratios that a step is named for
TARGET = 0.05  # the one of the rules
STEPPED = (2e-3, 5e-3)  # s, steps for which the first frequency is given as stepped
DISCOUNTS = (1.0, 0.98, 0.95, 0.9)  # of the paper's Figure 9
DISCOUNTED = {"2 ms": 2e-3, "1 ms": 1e-3, "0.1 ms": 1e-4}  # s, steps for which their damping is given
HELD = (1e-3, 2e-3, 1e-2, 2e-2)  # s, the same of a discount that is held as a rate
SCHEMES = {"(1/2, 1)": (0.5, 1.0), "(9/16, 1)": (0.5625, 1.0)}
SETTLED = 1e-3  # a pressure at rest within this of the load is the load
NOISE = 1e-9  # of the load; a smaller tension is rounding
DIGITS = 6  # of a curve


def paper() -> Scene:
    """Return the paper's block."""
    return next(iter(cases(PAPER)))


def at_rate() -> Scene:
    """Return the paper's block under a discount held as the rate of the rule."""
    base = closed.average(paper())
    return closed.timed(base, gg_rate=closed.rate_for(base, TARGET))


# ---- rows ----


def springs(case: Scene) -> Metrics:
    """Return what the springs of a case add at rest [m], and what the scheme makes of the contact."""
    return {
        "at rest": statics.static_displacement(case),
        "deflection": closed.penetration(case),
        "share": closed.spring_share(case),
        "damping": closed.first_damping(case),
        "radius": closed.contact_radius(case),
        "limit": closed.sign_change_step(case),
    }


def first_peak(case: Scene, dda: Row, bar: Row) -> Metrics:
    """Return how far DDA's first pressure peak is above the bar's, its tension [Pa], whether it rests right."""
    peak, exact = (or_nan(row.metrics.get("pressure.peak")) for row in (dda, bar))
    least, at_rest = (or_nan(dda.metrics.get(f"pressure.{name}")) for name in ("minimum", "static"))
    load = case.load.pressure
    off = abs(at_rest / load - 1)
    return {
        "excess": peak / exact - 1,
        "tension": "none" if least >= -NOISE * load else least,
        "off at rest": off,
        "at rest": "right" if off < SETTLED else "wrong",
    }


def derived() -> Iterator[Derived]:
    """Yield the rows in closed form."""
    rows = {"closed": _closed}
    rows |= {f"p = {ratio:g}E": functools.partial(_stiffness, ratio) for ratio in RATIOS}
    rows |= {f"stepped at {step:g}": functools.partial(_stepped, step) for step in STEPPED}
    rows |= {f"gg = {gg:g}": functools.partial(_discount, gg) for gg in DISCOUNTS}
    rows |= {f"held at {step:g}": functools.partial(_held, step) for step in HELD}
    for name, compute in rows.items():
        yield Derived(PAPER, name, (), compute)


def _closed(_: Finished) -> Metrics:
    scene = paper()
    base = closed.constant(scene)
    most_damped = closed.most_damped(base)
    most = closed.first_damping(closed.timed(base, step=most_damped / spectra.dda_frequency(base)))
    rate = closed.rate_for(scene, TARGET)
    return {
        "ratio": closed.ratio_of(scene),
        "turn": most_damped,
        "most": most,
        "transit": spectra.transit(scene),
        "rate": rate,
    }


def _stiffness(ratio: float, _: Finished) -> Metrics:
    scene = closed.stiffer(closed.constant(paper()), ratio)
    frequency = spectra.dda_frequency(scene)
    excess = frequency / spectra.bar_frequency(scene) - 1
    steps = {f"{100 * xi:g} %": step for xi, step in zip(TARGETS, closed.steps_for(scene, TARGETS), strict=True)}
    return {"frequency": frequency, "excess": excess, **steps}


def _stepped(step: float, _: Finished) -> Metrics:
    scene = paper()
    excess = stepped_frequency(closed.timed(scene, step=step)) / spectra.bar_frequency(scene) - 1
    return {"excess": abs(excess), "side": "above" if excess > 0 else "below"}


def stepped_frequency(scene: Scene) -> float:
    """Return the undamped frequency of DDA's first axial mode as stepped [rad/s]: |ln lambda| / dt."""
    return abs(cmath.log(spectra.roots(scene, spectra.dda_frequency(scene))[0])) / scene.time.step


def _discount(gg: float, _: Finished) -> Metrics:
    scene = closed.average(paper(), gg)
    ratios = {name: closed.first_damping(closed.timed(scene, step=step)) for name, step in DISCOUNTED.items()}
    rate = abs(np.log(gg)) / DISCOUNTED["1 ms"]
    return {**ratios, "overdamped": closed.overdamped_below(scene), "removed": 1 - gg, "rate": float(rate)}


def _held(step: float, _: Finished) -> Metrics:
    scene = closed.timed(at_rate(), step=step)
    return {"damping": closed.first_damping(scene), "turn": spectra.dda_frequency(scene) * step}


# ---- curves ----


def curves() -> Mapping[str, Any]:
    """Return the damping ratio over the time step, and what springs add and keep over p/E."""
    return {"over_steps": [*_over_steps()], "over_springs": [*_over_springs()]}


def _over_steps() -> Iterator[Mapping[str, Any]]:
    """Yield the curves of three charts: of the paper's block, its springs, discounts."""
    grid = np.geomspace(1e-5, 2e-2, POINTS)
    yield _curve("first", "DDA", np.geomspace(5e-5, 2e-2, FIRST_POINTS), paper())
    for ratio in RATIOS:
        yield _curve("step", f"p = {ratio:g}E", grid, closed.stiffer(closed.constant(paper()), ratio))
    for gg in DISCOUNTS[1:]:
        yield _curve("discount", f"gg = {gg:g}", grid, closed.average(paper(), gg))
    held = at_rate()
    yield {**_curve("discount", f"gg = exp(−{held.time.gg_rate:.3g} dt)", grid, held), "setting": "rate"}


def _curve(chart: str, name: str, steps: Array, scene: Scene) -> Mapping[str, Any]:
    damping = closed.over_steps(scene, steps)
    return {"chart": chart, "name": name, "setting": name, "x": _listed(steps), "y": _listed(damping)}


def _over_springs() -> Iterator[Mapping[str, Any]]:
    ratios = np.geomspace(0.1, 1e5, POINTS)
    base = closed.constant(paper(), step=2e-3)
    scenes = [closed.stiffer(base, float(ratio)) for ratio in ratios]
    shares = [closed.penetration(scene) / abs(statics.static_displacement(scene)) for scene in scenes]
    excesses = [spectra.dda_frequency(scene) / spectra.bar_frequency(scene) - 1 for scene in scenes]
    additions = {"share of v at rest": shares, "ω₁ above the bar's": excesses}
    radii = {}
    for name, (alpha, delta) in SCHEMES.items():
        radii[name] = [closed.contact_radius(closed.timed(scene, alpha=alpha, delta=delta)) for scene in scenes]
    for name, values in (additions | radii).items():
        yield {"name": name, "x": _listed(ratios), "y": _listed(values)}


def _listed(values: Any) -> list[float | None]:
    """Return numbers as a list, to the digits of a chart, None where there is none."""
    return [float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None for value in values]
