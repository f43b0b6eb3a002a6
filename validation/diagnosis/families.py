"""Causes that give the same rows: which ones, and which further scene would tell them apart."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from validation.diagnosis.causes import LISTED, causes_of, values_of
from validation.diagnosis.fits.target import Target
from validation.diagnosis.readings import Slip
from validation.diagnosis.search import Verdict
from validation.diagnosis.variant import Variant
from validation.runs.numbers import significant

SAME_FACTOR = 1e-5  # relative
SIDE = "load.gravity = 9.81: the weight is proportional to the area of the block"
BESIDE_GRAVITY = "load.pressure beside the gravity: a reversed sign turns both, gravity upwards its own part"
ONE_SCHEME = "nothing: it is one scheme by two names"
WIDER = "load.eccentricity, or a printed mass: the width of the block and of its base"


def relatives(
    target: Target, ids: Sequence[str], values: Mapping[str, float], variant: Variant
) -> list[dict[str, Any]]:
    """Return what gives the same rows as the named causes, by the equations alone.

    The rows depend on m/(k dt^2), E/p and load/p only (m the mass, k the springs), and the pressure on the load.
    """
    alike: list[dict[str, Any]] = []
    density = values.get("density-factor")
    if list(ids) == ["density-factor"] and density and not target.column.gravity:
        numbers = {"step-factor": significant(1 / math.sqrt(density), 6)}
        alike.append(_relative(["step-factor"], numbers, LISTED["density-factor"].further_scene))
    both = values.get("young-factor"), values.get("springs-factor")
    pair = sorted(ids) == ["springs-factor", "young-factor"]
    if pair and both[0] and both[1] and abs(both[0] / both[1] - 1) < SAME_FACTOR:
        less, more = significant(1 / both[0], 6), significant(both[0], 6)
        alike.append(_relative(["density-factor", "side-factor"], {"density-factor": more, "side-factor": less}, SIDE))
        if target.pressure is None:
            numbers = {"density-factor": less, "load-factor": less}
            alike.append(_relative(list(numbers), numbers, "the contact pressure: it shows the load"))
    if list(ids) == ["side-factor"] and target.pressure is None:
        side = values["side-factor"]
        numbers = {"density-factor": significant(side**2, 6), "load-factor": side}
        alike.append(_relative(list(numbers), numbers, LISTED["side-factor"].further_scene))
    if list(ids) == ["stiffness-damping"]:
        alike.append(_relative(["scheme"], {}, LISTED["stiffness-damping"].further_scene))
    if "base-compliance" in ids and variant.base == 0:
        alike.append(_springs_for_base(ids, values, variant))
    if list(ids) in (["springs-factor"], ["base-compliance"]) and target.column.poisson == 0:
        # per unit of width, pressure, mass and stiffness of the block stay; the two springs share a wider base
        wider = significant(math.exp(variant.softness), 6)
        alike.append(_relative(["width-factor"], {"width-factor": wider}, WIDER))
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
    numbers["springs-factor"] = significant(math.exp(-variant.softness), 6)
    return _relative([*others, "springs-factor"], numbers, LISTED["base-compliance"].further_scene)


def as_good(target: Target, verdict: Verdict) -> list[dict[str, Any]]:
    """Return the explanations that the file cannot tell from the best one."""
    equals = []
    for explanation in ([verdict.best] if verdict.alike else []) + list(verdict.alike):
        v = explanation.fit.variant
        ids = causes_of(target.column, explanation.ids, v, verdict.scene_fit.variant)
        further = (LISTED[name].further_scene for name in ids)
        scene = next(filter(None, further), "a scene with less damping, over more periods")
        equals.append(_relative(ids, values_of(target.column, ids, v), scene))
    return equals


def other_names(target: Target, verdict: Verdict) -> list[dict[str, Any]]:
    """Return the other causes that the best explanation, a time scheme, is called by."""
    if not verdict.explained or not any(LISTED[name].family for name in verdict.best.ids):
        return []
    names = []
    for explanation in verdict.aliases:
        ids = causes_of(target.column, explanation.ids, explanation.fit.variant, verdict.scene_fit.variant)
        names.append(_relative(ids, values_of(target.column, ids, explanation.fit.variant), ONE_SCHEME))
    return names


def _relative(ids: list[str], values: dict[str, float], scene: str) -> dict[str, Any]:
    return {"causes": ids, "values": values, "further_scene": scene}
