"""Causes that give the same rows: which ones, and which further scene would tell them apart."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from validation.diagnosis.causes import causes_of, values_of
from validation.diagnosis.fits.target import Target
from validation.diagnosis.readings import Slip
from validation.diagnosis.search import Verdict
from validation.diagnosis.variant import Variant

SAME_FACTOR = 1e-5  # relative
SIDE = "load.gravity = 9.81: the weight is proportional to the area of the block"
BESIDE_GRAVITY = "load.pressure beside the gravity: a reversed sign turns both, gravity upwards its own part"
TELLS = {
    "gg": "another time step: gg acts per step, a drag per second",
    "scheme": "another time step",
    "start": "another time step",
    "springs-factor": "another contact stiffness, or the contact pressure if it is missing",
    "base-compliance": "another contact stiffness: a base adds as many metres, springs by a factor as large a share",
    "stiffness-damping": "another time step: the damping is per second, that of a scheme per step",
    "width-factor": "load.eccentricity, or a printed mass: the width of the block and of its base",
    "young-factor": "another contact stiffness: on stiff springs only the block deforms",
    "load-factor": "the contact pressure if it is missing; load.gravity = 9.81 without pressure",
    "density-factor": "load.gravity = 9.81 without pressure: density then acts on the static displacement",
    "side-factor": "the contact pressure if it is missing; load.gravity = 9.81",
    "reported-point": "stiff springs, on which the points of the block move most differently",
    "poisson": "another Poisson's ratio in both codes",
    "own-weight": "load.pressure = 0 with load.gravity = 9.81",
}


def relatives(
    target: Target, ids: Sequence[str], values: Mapping[str, float], variant: Variant
) -> list[dict[str, Any]]:
    """Return what gives the same rows as the named causes, by the equations alone.

    The rows depend on m/(k dt^2), E/p and load/p only (m the mass, k the springs), and the pressure on the load.
    """
    alike: list[dict[str, Any]] = []
    density = values.get("density-factor")
    if list(ids) == ["density-factor"] and density and not target.column.gravity:
        numbers = {"step-factor": float(f"{1 / math.sqrt(density):.6g}")}
        alike.append(_relative(["step-factor"], numbers, TELLS["density-factor"]))
    both = values.get("young-factor"), values.get("springs-factor")
    pair = sorted(ids) == ["springs-factor", "young-factor"]
    if pair and both[0] and both[1] and abs(both[0] / both[1] - 1) < SAME_FACTOR:
        less, more = float(f"{1 / both[0]:.6g}"), float(f"{both[0]:.6g}")
        alike.append(_relative(["density-factor", "side-factor"], {"density-factor": more, "side-factor": less}, SIDE))
        if target.pressure is None:
            numbers = {"density-factor": less, "load-factor": less}
            alike.append(_relative(list(numbers), numbers, "the contact pressure: it shows the load"))
    if list(ids) == ["side-factor"] and target.pressure is None:
        side = values["side-factor"]
        numbers = {"density-factor": float(f"{side**2:.6g}"), "load-factor": side}
        alike.append(_relative(list(numbers), numbers, TELLS["side-factor"]))
    if list(ids) == ["stiffness-damping"]:
        alike.append(_relative(["scheme"], {}, TELLS["stiffness-damping"]))
    if "base-compliance" in ids and variant.base == 0:
        alike.append(_springs_for_base(ids, values, variant))
    if list(ids) in (["springs-factor"], ["base-compliance"]) and target.column.poisson == 0:
        # per unit of width, pressure, mass and stiffness of the block stay; the two springs share a wider base
        wider = _six(math.exp(variant.softness))
        alike.append(_relative(["width-factor"], {"width-factor": wider}, TELLS["width-factor"]))
    return alike


def sign_or_gravity(target: Target, ids: Sequence[str], corrected: Sequence[Slip]) -> list[dict[str, Any]]:
    """Return the two causes of a history whose columns are all reversed, where gravity is the only load."""
    columns = 1 if target.pressure is None else 2
    c = target.column
    if list(ids) != ["sign"] or len(corrected) < columns or c.pressure or not c.gravity:
        return []
    upwards = _relative(["gravity-factor"], {"gravity-factor": -1.0}, BESIDE_GRAVITY)
    return [_relative(["sign"], {}, BESIDE_GRAVITY), upwards]


def _springs_for_base(ids: Sequence[str], values: Mapping[str, float], variant: Variant) -> dict[str, Any]:
    """Return the springs that give the rows of a base without mass: it stands in series with them."""
    others = [name for name in ids if name != "base-compliance"]
    numbers = {name: values[name] for name in others if name in values}
    factor = _six(math.exp(-variant.softness))
    return _relative([*others, "springs-factor"], numbers | {"springs-factor": factor}, TELLS["base-compliance"])


def _six(value: float) -> float:
    return float(f"{value:.6g}")


def as_good(target: Target, verdict: Verdict) -> list[dict[str, Any]]:
    """Return the explanations that the file cannot tell from the best one."""
    equals = []
    for explanation in ([verdict.best] if verdict.alike else []) + list(verdict.alike):
        v = explanation.fit.variant
        ids = causes_of(target.column, explanation.ids, v, verdict.own.variant)
        scene = next((TELLS[name] for name in ids if name in TELLS), "a scene with less damping, over more periods")
        equals.append(_relative(ids, values_of(target.column, ids, v), scene))
    return equals


def _relative(ids: list[str], values: dict[str, float], scene: str) -> dict[str, Any]:
    return {"causes": ids, "values": values, "further_scene": scene}
