"""Judgement of another program by its history: same model, same scheme, or where and how it departs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from dda.one_block.variants import Column, Variant, histories
from validation.compare import causes, departure, sentences
from validation.compare.causes import CAUSES
from validation.compare.departure import Departure
from validation.compare.fit import NAMED, Fit, Interval, Target, fit, intervals, named, untold
from validation.compare.other_solvers import Goal, Rival, rivals
from validation.compare.reading import Foreign, Stepping, steppings
from validation.compare.rectangle import rectangle_of
from validation.errors import InputError
from validation.runs.history import Array
from validation.scenes import features
from validation.scenes.scene import Scene

UNIT_POWERS = (-6, -3, -2, 2, 3, 6)  # of ten, by which a unit may be off
UNEXPLAINED = 0.02  # relative L2: what is left beyond is a departure, cause known or not
CLEAR = 3e-3  # relative L2 below which DDA is the model, whatever the rivals' schemes
MUCH = 0.7  # of a misfit: what a less likely reading has to come below
PLAIN = 0.05  # relative L2 below which a reading is right
RIVAL = 0.5  # share of DDA's misfit below which another solver is the model
RIVALS = ("bar", "continuum")
MODEL_WORDS = {"dda": "one strain per block (DDA)", "bar": "the exact bar, which fine finite elements converge to"}


@dataclass(frozen=True, eq=False)
class Answer:
    """The answer to `compare`; `as_dict` is what ``--json`` prints."""

    scheme: dict[str, float | None]  # alpha, delta, gg
    ranking: list[dict[str, Any]]  # the best first
    departure: Departure | None
    causes: list[str]
    opened: tuple[int, int] | None  # first step and last
    sentence: str
    notes: tuple[str, ...] = ()
    told: dict[str, Interval] = field(default_factory=dict)  # alpha, delta, gg and what was free with them
    untold: list[dict[str, float]] = field(default_factory=list)
    misfit: float = 0.0  # of the best explanation, relative L2 [-]
    curves: dict[str, tuple[Array, Array]] = field(default_factory=dict)  # name to time [s] and displacement [m]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""
        gone = None if self.departure is None else {"step": self.departure.step, "kind": self.departure.kind}
        return {
            "scheme": self.scheme,
            "ranking": self.ranking,
            "departure": gone,
            "causes": self.causes,
            "opened": None if self.opened is None else list(self.opened),
            "sentence": self.sentence,
        }


@dataclass(frozen=True, eq=False)
class Reading:
    """A history as it is read: its steps, with errors of sign and unit corrected."""

    stepping: Stepping
    displacement: Array  # [m]
    pressure: Array | None  # [Pa]
    slips: tuple[str, ...]


def compare(scene: Scene, foreign: Foreign) -> Answer:
    """Judge a history against the scene.

    Raises
    ------
    InputError
        The scene has a sweep or is not linear, or the history is zero throughout or does not fit the scene.
    """
    features.refuse_column(scene, "compare")
    features.refuse_damping(scene, "compare")
    if not features.linear(scene):
        raise InputError(
            f"{scene.name}: compare takes linear scenes only, got one with {', '.join(features.of(scene))}"
        )
    if scene.sweep:
        raise InputError(f"{scene.name}: sweep: one value must be picked; use --set key=value")
    if not np.any(foreign.displacement):
        raise InputError(f"{scene.name}: displacement: must not be zero throughout, got zeros only")
    column = rectangle_of(scene)
    if column is None:
        return _without_rectangle(scene, foreign)
    own = Variant(scene.time.alpha, scene.time.delta, scene.time.discount, scene.time.start)
    reading, target, found = _best_reading(_readings(scene, column, own, foreign), column, own)
    clear = [(found.variant.alpha, found.variant.delta)] if found.misfit < CLEAR else NAMED.values()
    others = _others(scene, reading, RIVALS if scene.block.poisson == 0 else ("fem",), clear)
    if others and others[0].misfit < RIVAL * found.misfit:
        return _answer_of_rival(scene, foreign, reading, others)
    return _answer(scene, foreign, reading, target, found, own, others)


# ---- reading --------------------------------------------------------------------------------------------------------


def _readings(scene: Scene, column: Column, own: Variant, foreign: Foreign) -> list[Reading]:
    """Return the ways to read a history's steps, sign and units."""
    found = []
    for stepping in steppings(foreign, scene.time.step):
        expected = histories(column, [own], stepping.steps)
        reference = expected.displacement[stepping.rows, 0]
        found += _slips(foreign, stepping, reference, expected.pressure[stepping.rows, 0])
    return found


def _slips(foreign: Foreign, stepping: Stepping, reference: Array, contact: Array) -> list[Reading]:
    """Return the readings without slips of sign and unit, as sizes beside the scene's own history suggest."""
    time = ("unit",) if stepping.factor != 1 else ()
    readings = []
    for sign, factor in _factors(foreign.displacement, reference):
        pressure, slipped = foreign.pressure, tuple(time)
        if pressure is not None:
            turned, scale = _factors(pressure, contact)[0]
            pressure = pressure * turned / scale
            slipped += ("sign",) * (turned < 0) + ("unit",) * (scale != 1)
        slipped += ("sign",) * (sign < 0) + ("unit",) * (factor != 1)
        readings.append(Reading(stepping, foreign.displacement * sign / factor, pressure, tuple(sorted(set(slipped)))))
    return readings


def _best_reading(readings: Sequence[Reading], column: Column, own: Variant) -> tuple[Reading, Target, Fit]:
    """Return the likeliest reading with what explains it; a less likely one must explain much more."""
    best: tuple[Reading, Target, Fit] | None = None
    for reading in readings:
        target = _target(column, reading)
        found = causes.explain(target, own)
        if best is None or found.misfit < MUCH * best[2].misfit:
            best = reading, target, found
        if best[2].misfit < PLAIN:
            break
    if best is None:
        raise InputError("time: must be the ends of time steps, got times that fit no steps")
    return best


def _factors(values: Array, reference: Array) -> list[tuple[float, float]]:
    """Return the sign and the powers of ten by which values may be off, the likeliest first."""
    with np.errstate(all="ignore"):
        bounded = np.clip(np.nan_to_num(reference), -1e3 * abs(reference[0] or 1.0), 1e3 * abs(reference[0] or 1.0))
    sign = -1.0 if float(values @ bounded) < 0 else 1.0
    ratio = math.log10(float(np.max(np.abs(values))) / (float(np.max(np.abs(bounded))) or 1.0) or 1.0)
    near = [10.0**power for power in UNIT_POWERS if abs(ratio - power) < 0.5]
    return [(way * sign, factor) for way in (1.0, -1.0) for factor in (*near, 1.0)]


def _target(column: Column, reading: Reading) -> Target:
    return Target(column, reading.stepping.steps, reading.stepping.rows, reading.displacement, reading.pressure)


def _others(
    scene: Scene,
    reading: Reading,
    names: Sequence[str],
    schemes: Iterable[tuple[float, float]] = NAMED.values(),
) -> list[Rival]:
    """Return the other solvers' best answers; none where the steps are not equal, which they need."""
    steps = reading.stepping.steps
    if np.ptp(steps) > 0:
        return []
    if scene.time.discount != 1:  # the damped continuum takes minutes over long histories
        names = [name for name in names if name != "continuum"]
    same = scene.with_values(
        {
            "time.step": float(steps[0]),
            "time.steps": len(steps),
            "run.columns": ["displacement", "contact_pressure"],
            "run.solvers": ["dda"],
        }
    )
    goal = Goal(reading.stepping.rows, reading.displacement, reading.pressure)
    return rivals(same, names, goal, schemes)


# ---- answers --------------------------------------------------------------------------------------------------------


def _answer(
    scene: Scene,
    foreign: Foreign,
    reading: Reading,
    target: Target,
    found: Fit,
    own: Variant,
    others: Sequence[Rival],
) -> Answer:
    ids = [*reading.slips, *causes.causes_of(target, found, own)]
    v = found.variant
    gg = v.gg if "gg" in ids else own.gg
    steps = causes.opened(target, found)
    expected = departure.expected(target, found, own)
    gone = departure.departure(target, expected, found, ids, steps)
    if not gone and found.misfit > UNEXPLAINED:
        gone = departure.departure(target, expected, found, ["unknown"], [])
    told = _free_scheme(target, found)
    time = np.cumsum(target.steps)[target.rows]
    sentence = sentences.sentence(v, gg, own, ids, gone, steps, found.misfit, causes.compliance(target, v))
    return Answer(
        {"alpha": v.alpha, "delta": v.delta, "gg": gg},
        _ranking(target, found, gg, others),
        gone,
        ids,
        (steps[0], steps[-1]) if steps else None,
        sentence,
        _notes(foreign, reading),
        intervals(told),
        untold(told),
        found.misfit,
        {
            "the file": (time, reading.displacement),
            "dda": (time, expected[target.rows]),
            "best": (time, histories(target.column, [v], target.steps).displacement[target.rows, 0]),
        },
    )


def _free_scheme(target: Target, found: Fit) -> Fit:
    """Return the fit with alpha, delta and gg free as well."""
    free = tuple(dict.fromkeys(("alpha", "delta", "gg", *found.free)))
    return fit(target, [(found.variant, free)])[0]


def _ranking(target: Target, found: Fit, gg: float, others: Sequence[Rival]) -> list[dict[str, Any]]:
    """Return every named scheme with what was found besides, and the other solvers, by misfit."""
    pairs = dict.fromkeys([(found.variant.alpha, found.variant.delta), *NAMED.values()])
    free = tuple(name for name in found.free if name not in ("alpha", "delta", "gg"))
    starts = [(replace(found.variant, alpha=a, delta=d, gg=gg), free) for a, d in pairs]
    rows = [
        _row("dda", f.variant.alpha, f.variant.delta, gg, f.misfit, causes.compliance(target, f.variant))
        for f in fit(target, starts)
    ]
    rows += [
        _row(
            r.model,
            r.alpha,
            r.delta,
            r.gg,
            r.misfit,
            causes.compliance(target, replace(found.variant, softness=r.softness)),
        )
        for r in others
    ]
    return sorted(rows, key=lambda row: row["misfit"])


def _row(
    model: str, alpha: float | None, delta: float | None, gg: float | None, misfit: float, soft: float | None
) -> dict[str, Any]:
    """Return a line of the ranking; a scheme that grows has no finite misfit worth a number."""
    name = None if alpha is None or delta is None else named(alpha, delta)
    bounded = float(f"{min(misfit, 1e6):.6g}")
    slack = None if soft is None else float(f"{soft:.4g}")
    return {
        "model": model,
        "name": name,
        "alpha": alpha,
        "delta": delta,
        "gg": gg,
        "misfit": bounded,
        "compliance": slack,
    }


def _notes(foreign: Foreign, reading: Reading) -> tuple[str, ...]:
    said = (reading.stepping.note,) if reading.stepping.note else ()
    slips = tuple(CAUSES[name].words for name in reading.slips)
    return (*foreign.notes, *said, *slips)


def _answer_of_rival(scene: Scene, foreign: Foreign, reading: Reading, others: Sequence[Rival]) -> Answer:
    """Return the answer where another solver than DDA, or the linear DDA of any polygon, explains the history best."""
    best, t = others[0], scene.time
    ids = list(reading.slips)
    same_scheme = best.alpha is None or (best.alpha, best.delta) == (t.alpha, t.delta)
    if not same_scheme:
        ids.append("scheme")
    if abs(best.softness) > 1e-3:
        ids.append("base-compliance" if 0 < best.softness < 2 * causes.BENIGN_COMPLIANCE else "springs-factor")
    gone, off = None, "springs-factor" in ids
    if best.misfit > UNEXPLAINED or not same_scheme or reading.slips or off:
        rows, wanted = reading.stepping.rows, best.unsoftened if off else best.displacement
        gone = departure.measured(wanted[rows], reading.displacement, rows, 0.0)
    time = np.cumsum(reading.stepping.steps)[reading.stepping.rows]
    return Answer(
        {"alpha": best.alpha, "delta": best.delta, "gg": best.gg},
        [_row(r.model, r.alpha, r.delta, r.gg, r.misfit, None) for r in others],
        gone,
        ids,
        None,
        sentences.rival_sentence(best, same_scheme, ids, gone, MODEL_WORDS),
        _notes(foreign, reading),
        misfit=best.misfit,
        curves={"the file": (time, reading.displacement), best.model: (time, best.displacement[reading.stepping.rows])},
    )


def _without_rectangle(scene: Scene, foreign: Foreign) -> Answer:
    """Return the answer for a block that is no upright rectangle, or that turns: linear models alone are tried."""
    from validation.solvers.registry import get_solver

    every = []
    for stepping in steppings(foreign, scene.time.step):
        same = scene.with_values(
            {"time.step": float(stepping.steps[0]), "time.steps": len(stepping.steps), "run.solvers": ["dda"],
             "run.columns": ["displacement", "contact_pressure"]}
        )  # fmt: skip
        run = get_solver("dda").solve(same)
        rows = stepping.rows
        for reading in _slips(foreign, stepping, run.displacement[rows], run.contact_pressure[rows]):
            found = _others(scene, reading, ("dda", "fem"))
            every += [(reading, found)] if found else []
    if not every:
        raise InputError(f"{scene.name}: the times of the history are not uniform, which this scene needs")
    reading, others = min(every, key=lambda pair: pair[1][0].misfit)
    noted = replace(
        foreign,
        notes=(*foreign.notes, "the block is not an upright rectangle: opening and updated geometry are not tried"),
    )
    return _answer_of_rival(scene, noted, reading, others)
