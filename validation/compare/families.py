"""Causes that give the same rows: which ones, and which further scene would tell them apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from validation.compare.causes import causes_of, values_of
from validation.compare.decision import Verdict
from validation.compare.fits.target import Target
from validation.compare.fitting import Found

SAME_FACTOR = 1e-5  # relative
SIDE = "load.gravity = 9.81: the weight is proportional to the area of the block"
TELLS = {
    "gg": "another time step: gg acts per step, a drag per second",
    "scheme": "another time step",
    "start": "another time step",
    "springs-factor": "another contact stiffness, or the contact pressure if it is missing",
    "young-factor": "another contact stiffness: on stiff springs only the block deforms",
    "load-factor": "the contact pressure if it is missing; load.gravity = 9.81 without pressure",
    "density-factor": "load.gravity = 9.81 without pressure: density then acts on the static displacement",
    "side-factor": "the contact pressure if it is missing; load.gravity = 9.81",
    "reported-point": "stiff springs, on which the points of the block move most differently",
    "poisson": "another Poisson's ratio in both codes",
    "own-weight": "load.pressure = 0 with load.gravity = 9.81",
}


def relatives(target: Target, ids: Sequence[str], values: dict[str, float]) -> list[dict[str, Any]]:
    """Return what gives the same rows as the named causes, by the equations alone.

    The rows depend on m/(k dt^2), E/p and load/p only (m the mass, k the springs), and the pressure on the load.
    """
    found: list[dict[str, Any]] = []
    density = values.get("density-factor")
    if list(ids) == ["density-factor"] and density and not target.column.gravity:
        said = {"step-factor": float(f"{1 / math.sqrt(density):.6g}")}
        found.append(_relative(["step-factor"], said, TELLS["density-factor"]))
    both = values.get("young-factor"), values.get("springs-factor")
    pair = sorted(ids) == ["springs-factor", "young-factor"]
    if pair and both[0] and both[1] and abs(both[0] / both[1] - 1) < SAME_FACTOR:
        less, more = float(f"{1 / both[0]:.6g}"), float(f"{both[0]:.6g}")
        found.append(_relative(["density-factor", "side-factor"], {"density-factor": more, "side-factor": less}, SIDE))
        if target.pressure is None:
            said = {"density-factor": less, "load-factor": less}
            found.append(_relative(list(said), said, "the contact pressure: it shows the load"))
    if list(ids) == ["side-factor"] and target.pressure is None:
        side = values["side-factor"]
        said = {"density-factor": float(f"{side**2:.6g}"), "load-factor": side}
        found.append(_relative(list(said), said, TELLS["side-factor"]))
    return found


def as_good(target: Target, verdict: Verdict) -> list[dict[str, Any]]:
    """Return the explanations that the file cannot tell from the best one."""
    return [_told(target, verdict, found) for found in ([verdict.best] if verdict.alike else []) + list(verdict.alike)]


def _told(target: Target, verdict: Verdict, found: Found) -> dict[str, Any]:
    v = found.fit.variant
    ids = causes_of(target, found.ids, v, verdict.own.variant)
    scene = next((TELLS[name] for name in ids if name in TELLS), "a scene with less damping, over more periods")
    return _relative(ids, values_of(target, ids, v), scene)


def _relative(ids: list[str], values: dict[str, float], scene: str) -> dict[str, Any]:
    return {"causes": ids, "values": values, "further_scene": scene}
