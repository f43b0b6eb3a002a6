"""Known causes of a departure, and the search for the fewest of them that explain a history.

The search begins with every named scheme, with and without opening and moving geometry, each with one free
compliance. The best few take on one more cause at a time as long as it earns its place; then every cause whose
absence costs nothing is removed again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dda.one_block.variants import GRAVITY, Variant, histories
from validation.compare.fit import NAMED, Fit, Interval, Target, better, changed, fit, intervals
from validation.runs.history import Array

Start = tuple[Variant, tuple[str, ...]]
FLOOR = 5e-5  # relative L2 below which two histories are the same: seven digits, and what geometry does to them
BENIGN_COMPLIANCE = 0.05  # share of the static displacement that a base may add before the springs are in question
KEPT = 4  # variants that take on a further cause
PATIENCE = 2  # rounds without gain: two causes may show together only
DEPTH = 6  # causes at most
SOFTNESSES = tuple(math.log(f) for f in (0.01, 0.1, 0.25, 0.5, 2.0, 4.0, 10.0, 100.0))
FAULT = 3e-3  # relative L2 that a fault must put into a history to be named: a base that swings puts in 1e-3
FACTOR = 3.0  # by which a scheme without a name must fit better than any with one
CLOSE = 1e-4  # relative L2 up to which the fitted variant's own contact state is taken
FREE_FLIGHT = 2e-3  # share of the static pressure that counts as none
APART = 0.02  # of alpha or delta: a scheme closer to a named one is that one
BASES = ((5.0, 1.0), (5.0, 1.25), (20.0, 1.0))  # mass of a base to begin with over the block's, change of softness
SAME_NUMBER = 2e-3  # relative: a discount or a load closer than this is not another one


@dataclass(frozen=True)
class Cause:
    """A cause: its id, its description, and whether integrator and contact law are as they should be."""

    id: str
    words: str
    benign: bool = False


CAUSES = {
    cause.id: cause
    for cause in (
        Cause("sign", "a sign error: upwards is positive here"),
        Cause("unit", "a unit error"),
        Cause("scheme", "a different scheme"),
        Cause("gg", "a different velocity discount gg"),
        Cause("gg-in-one-formula", "gg is applied in only one of the formulas (6) and (7)"),
        Cause("start", "the other initial acceleration (zero or consistent)"),
        Cause("time-shift", "the rows are shifted by one step"),
        Cause("springs-factor", "contact stiffness wrong by a factor"),
        Cause("load-factor", "load or displacement wrong by a factor"),
        Cause("contact-opened", "the contact opened"),
        Cause("base-compliance", "a slightly compliant base", benign=True),
        Cause("own-weight", "the block's own weight", benign=True),
        Cause("geometry-updated", "geometry updated at every step", benign=True),
    )
}


# ---- what a variant has that the scene has not ----------------------------------------------------------------------


def compliance(target: Target, variant: Variant) -> float:
    """Return the static displacement that softer springs add, over the scene's own static displacement [-]."""
    c = target.column
    return -c.force / c.normal * math.expm1(variant.softness) / c.static


def benign_springs(target: Target, variant: Variant) -> bool:
    """Whether the springs are the scene's, on a slightly compliant base or one that is seen to swing."""
    soft = compliance(target, variant)
    return -BENIGN_COMPLIANCE / 5 <= soft <= BENIGN_COMPLIANCE * (1 if variant.base == 0 else 4)


def causes_of(target: Target, found: Fit, scene: Variant) -> list[str]:
    """Return the ids of the causes by which a fitted variant differs from the scene's."""
    v, told = found.variant, intervals(found)
    soft = compliance(target, v)
    noise = max(FLOOR, 2 * found.misfit / math.sqrt(found.independent), abs(_width(told, "softness")))
    ids = {
        "scheme": (v.alpha, v.delta) != (scene.alpha, scene.delta),
        "gg": abs(v.gg - scene.gg) > max(SAME_NUMBER, _width(told, "gg")),
        "gg-in-one-formula": v.discounted != "both",
        "start": v.start != scene.start,
        "time-shift": v.shift != 0,
        "springs-factor": not benign_springs(target, v) and abs(soft) > noise,
        "load-factor": v.load != 1,
        "contact-opened": v.opens,
        "base-compliance": benign_springs(target, v) and soft > max(5e-4, noise),
        "own-weight": v.weight != 0,
        "geometry-updated": v.updated,
    }
    return [name for name, present in ids.items() if present]


def _width(told: Mapping[str, Interval], name: str) -> float:
    width = told[name].half_width if name in told else 0.0
    return width if math.isfinite(width) else 0.0


# ---- the search -----------------------------------------------------------------------------------------------------


def explain(target: Target, scene: Variant) -> Fit:
    """Return the simplest variant that explains a history as well as any tried.

    Parameters
    ----------
    target
        The history.
    scene
        The scene's own scheme, nothing added.
    """
    free = ((), ("weight",), ("gg",), ("gg", "weight"))
    found = fit(target, _family([(scene.alpha, scene.delta)], scene, free))
    if min(f.misfit for f in found) > FLOOR:
        found += fit(target, _openings(scene))
    best = min(found, key=_order)
    waited = 0
    for _ in range(DEPTH):
        if best.misfit <= FLOOR or waited == PATIENCE:
            break
        bases = _bases(found, scene)
        found = bases + fit(target, [start for base in bases for start in _further(base)])
        challenger = min(found, key=_order)
        if better(challenger, best, 1, FLOOR):
            best, waited = challenger, 0
        else:
            waited += 1
    return _pruned(target, _own_scheme(target, best, scene), scene)


def _own_scheme(target: Target, found: Fit, scene: Variant) -> Fit:
    """Return the fit with its scheme free, if no named scheme explains nearly as much; else with a named one."""
    free, v = found, found.variant
    if "alpha" not in found.free:
        if found.misfit <= FLOOR:
            return found
        (free,) = fit(target, [(v, tuple(dict.fromkeys(("alpha", "delta", *found.free))))])
        return free if _unnamed(free, found) else found
    plain = tuple(name for name in found.free if name not in ("alpha", "delta"))
    still = tuple(name for name in plain if name != "gg")
    pairs = NAMED.values()
    near = [(replace(v, alpha=a, delta=d), plain) for a, d in pairs]
    near += [(replace(v, alpha=a, delta=d, gg=scene.gg), still) for a, d in pairs]
    close = min(fit(target, near), key=_order)
    return found if _unnamed(found, close) else close


def _unnamed(free: Fit, close: Fit) -> bool:
    """Whether a scheme without a name is sufficiently supported by the data."""
    apart = max(abs(free.variant.alpha - close.variant.alpha), abs(free.variant.delta - close.variant.delta))
    return apart > APART and close.misfit > FACTOR * free.misfit and better(free, close, 2, FLOOR, FAULT)


def _bases(found: Sequence[Fit], scene: Variant) -> list[Fit]:
    """Return the best fit of each of the best few schemes, and of the scene's own."""
    first: dict[tuple[float, float, bool], Fit] = {}
    for f in sorted(found, key=_order):
        first.setdefault((f.variant.alpha, f.variant.delta, f.variant.opens), f)
    own = [f for key, f in first.items() if key[:2] == (scene.alpha, scene.delta)]
    return list(first.values())[:KEPT] + [f for f in own if f not in list(first.values())[:KEPT]]


def _order(found: Fit) -> tuple[float, int]:
    """Sort by misfit; variants as good as equal, by what they add."""
    v = found.variant
    added = [v.updated, v.opens, v.discounted != "both", v.shift != 0, v.weight != 0, v.load != 1]
    return round(math.log(max(found.misfit, FLOOR / 10)), 2), sum(added) + len(found.free)


def _family(pairs: Sequence[tuple[float, float]], scene: Variant, more: Sequence[tuple[str, ...]]) -> list[Start]:
    """Return schemes with and without opening and moving geometry, and what is free in each besides the springs."""
    flags = [(False, False), (True, False), (False, True), (True, True)]
    plain = [
        replace(scene, alpha=alpha, delta=delta, opens=opens, updated=updated)
        for alpha, delta in pairs
        for opens, updated in flags
    ]
    return [(v, ("softness", *names)) for v in plain for names in more]


def _openings(scene: Variant) -> list[Start]:
    """Return the named schemes, springs of quite another stiffness, and a scheme with no name."""
    own = (scene.alpha, scene.delta)
    softer = [replace(scene, softness=value) for value in SOFTNESSES]
    free = [(replace(scene, opens=opens), ("alpha", "delta", "softness")) for opens in (False, True)]
    starts: list[Start] = [(v, ("softness",)) for v in softer]
    others = [pair for pair in NAMED.values() if pair != own]
    return _family(others, scene, ((), ("gg",))) + starts + free


def _further(base: Fit) -> list[Start]:
    """Return a variant with one more cause each."""
    v, free = base.variant, base.free
    moves: list[dict[str, object]] = [
        {"start": "zero" if v.start == "consistent" else "consistent"},
        {"shift": 1},
        {"shift": -1},
        {"opens": not v.opens},
        {"updated": not v.updated},
    ]
    if v.gg < 1:
        moves += [{"discounted": name} for name in ("both", "velocity", "displacement") if name != v.discounted]
    starts: list[Start] = [(changed(v, move), free) for move in moves]
    if not (v.opens or v.updated) and free == ("softness",):
        starts += [(replace(v, softness=value), free) for value in SOFTNESSES]
    starts += [(replace(v, alpha=a, delta=d), free) for a, d in NAMED.values() if (a, d) != (v.alpha, v.delta)]
    if v.softness > 0 and "base" not in free:
        starts += [(replace(v, base=mass, softness=v.softness * soft), (*free, "base")) for mass, soft in BASES]
    return starts + [(v, (*free, name)) for name in ("gg", "weight", "load") if name not in free]


# fields of a variant that make up a cause, and whether the smallest trace of it counts
_FIELDS = {
    ("alpha", "delta"): False,
    ("start",): False,
    ("shift",): False,
    ("opens",): True,  # the contact force is its own witness
    ("discounted",): False,
    ("gg",): False,
    ("load",): False,
    ("base",): True,
    ("weight",): True,
    ("updated",): True,
}


def _pruned(target: Target, found: Fit, scene: Variant) -> Fit:
    """Return the fit without the causes whose absence costs nothing, or less than a fault is worth naming."""
    full, dropped = _with_weight(target, found), 0
    found = full
    while groups := _added(found, scene):
        dropped += 1
        reverted = fit(target, [_without(found, group, scene) for group in groups])
        simpler = [
            f
            for group, f in zip(groups, reverted, strict=True)
            if not better(full, f, dropped, FLOOR, least=0.0 if _FIELDS[group] else FAULT)
        ]
        if not simpler:
            break
        found = min(simpler, key=lambda f: f.misfit)
    return found


def _added(found: Fit, scene: Variant) -> list[tuple[str, ...]]:
    """Return the groups of fields in which a fitted variant differs from the scene's."""
    v = found.variant
    return [
        group
        for group in _FIELDS
        if any(getattr(v, name) != getattr(scene, name) or name in found.free for name in group)
    ]


def _without(found: Fit, group: tuple[str, ...], scene: Variant) -> Start:
    """Return a fitted variant with one group of fields as the scene has it."""
    back = changed(found.variant, {name: getattr(scene, name) for name in group})
    return back, tuple(name for name in found.free if name not in group)


def _with_weight(target: Target, found: Fit) -> Fit:
    """Return the fit with the block's weight in place of a load factor, if that explains as much."""
    if "load" not in found.free or "weight" in found.free:
        return found
    free = tuple("weight" if name == "load" else name for name in found.free)
    (heavy,) = fit(target, [(replace(found.variant, load=1.0), free)])
    return heavy if heavy.misfit <= max(1.1 * found.misfit, FLOOR) else found


# ---- where the contact is open --------------------------------------------------------------------------------------


def open_steps(target: Target, found: Fit) -> list[int]:
    """Return the steps, counted from 1, at whose end the fitted variant's contact is open."""
    history = histories(target.column, [found.variant], target.steps)
    return [int(i) + 1 for i in np.flatnonzero(history.open[:, 0])] if found.variant.opens else []


def opened(target: Target, found: Fit) -> list[int]:
    """Return the open steps: the fitted variant's where it fits closely, else those without a contact force."""
    steps = open_steps(target, found)
    force = contact_force(target, found.variant) if steps and found.misfit > CLOSE else None
    if force is None:
        return steps
    model = histories(target.column, [found.variant], target.steps).pressure[:, 0]
    size = abs(target.column.force) / target.column.width or 1.0
    if np.median(np.abs(force - model)) > 2 * FREE_FLIGHT * size:  # too rough to tell
        return steps
    bias = float(np.median(force[np.array(steps) - 1]))  # of the weight, constant in free flight
    return [int(i) + 1 for i in np.flatnonzero(np.abs(force - bias) < FREE_FLIGHT / 2 * size)]


def contact_force(target: Target, variant: Variant) -> Array | None:
    """Return the contact pressure that follows from the displacements alone [Pa], without a contact model.

    With the scheme known, (6) gives the acceleration of each step from the displacements, and the block's momentum
    balance the mean pressure P = q + rho h (A + g): zero in free flight, whatever the springs are. None where rows
    are missing, or where rounding would grow (alpha < 1/4).
    """
    if len(target.rows) != len(target.steps) or variant.alpha < 1 / 4 or variant.shift:
        return None
    D, V, A, inertial = 0.0, 0.0, 0.0, []
    v, c = variant, target.column
    first, again = (1.0 if v.discounted == name else v.gg for name in ("velocity", "displacement"))
    load, weight = v.load * c.pressure, c.gravity + v.weight * GRAVITY
    if v.start == "consistent":
        A = -load / (c.density * c.height) - weight
    for dt, D1 in zip(target.steps.tolist(), target.displacement.tolist(), strict=True):
        A1 = (D1 - D - first * dt * V - dt * dt * (0.5 - v.alpha) * A) / (v.alpha * dt * dt)
        D, V, A = D1, again * V + dt * ((1 - v.delta) * A + v.delta * A1), A1
        inertial.append(c.density * c.height * (A1 + weight))
    area = histories(c, [v], target.steps).area[:, 0]
    return np.asarray(load + area * np.array(inertial))
