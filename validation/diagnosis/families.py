"""Causes that give the same rows: which ones, and which further scene would tell them apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from validation.diagnosis.causes import CAUSES, causes_of, values_of
from validation.diagnosis.fits.target import Target
from validation.diagnosis.readings import Slip
from validation.diagnosis.search import Explanation, Verdict
from validation.diagnosis.variant import Variant
from validation.runs.numbers import significant

ANY_SCENE = "a scene with less damping, over more periods"
BESIDE_GRAVITY = "load.pressure beside the gravity: a reversed sign turns both, gravity upwards its own part"
ONE_SCHEME = "nothing: it is one scheme by two names"
WIDER = "load.eccentricity, or a printed mass: the width of the block and of its base"


def relatives(target: Target, scene: Variant, verdict: Verdict, ids: Sequence[str], v: Variant) -> list[dict[str, Any]]:
    """Return what gives the same rows as the named causes.

    Most of it is found by running the other candidates. Three are in no candidate, since the rows depend on m/(k dt^2),
    E/p and load/p only (mass m, springs k): another step is another density, a wider block one on softer springs, and a
    base without mass stands in series with them.
    """
    values = values_of(target.column, ids, v)
    alike: list[dict[str, Any]] = []
    density = values.get("density-factor")
    if list(ids) == ["density-factor"] and density and not target.column.gravity:
        numbers = {"step-factor": significant(1 / math.sqrt(density), 6)}
        alike.append(_relative(["step-factor"], numbers, CAUSES["density-factor"].further_scene))
    if "base-compliance" in ids and v.base == 0:
        # a base without mass stands in series with the springs
        others = [name for name in ids if name != "base-compliance"]
        numbers = {name: values[name] for name in others if name in values}
        numbers["springs-factor"] = significant(math.exp(-v.softness), 6)
        further = CAUSES["base-compliance"].further_scene
        alike.append(_relative([*others, "springs-factor"], numbers, further))
    if list(ids) in (["springs-factor"], ["base-compliance"]) and target.column.poisson == 0:
        # per unit of width, pressure, mass and stiffness of the block stay; the two springs share a wider base
        wider = significant(math.exp(v.softness), 6)
        alike.append(_relative(["width-factor"], {"width-factor": wider}, WIDER))
    found = [_of_explanation(target, each, scene) for each in verdict.same_rows]
    return [*alike, *(one for one in found if not set(ids) < set(one["causes"]))]


def sign_or_gravity(target: Target, ids: Sequence[str], corrected: Sequence[Slip]) -> list[dict[str, Any]]:
    """Return the two causes of a history with all columns reversed, under gravity alone."""
    columns = 1 if target.pressure is None else 2
    c = target.column
    if list(ids) != ["sign"] or len(corrected) < columns or c.pressure or not c.gravity:
        return []
    upwards = _relative(["gravity-factor"], {"gravity-factor": -1.0}, BESIDE_GRAVITY)
    return [_relative(["sign"], {}, BESIDE_GRAVITY), upwards]


def as_good(target: Target, verdict: Verdict) -> list[dict[str, Any]]:
    """Return the explanations as good as the best one, or the other names of a time scheme."""
    scene = verdict.scene_fit.variant
    if verdict.alike:
        return [_of_explanation(target, explanation, scene) for explanation in (verdict.best, *verdict.alike)]
    if not verdict.explained or not any(CAUSES[name].family for name in verdict.best.ids):
        return []
    return [_of_explanation(target, each, scene) | {"further_scene": ONE_SCHEME} for each in verdict.aliases]


def _of_explanation(target: Target, explanation: Explanation, scene: Variant) -> dict[str, Any]:
    v = explanation.fit.variant
    ids = causes_of(target.column, explanation.ids, v, scene)
    further = next(filter(None, (CAUSES[name].further_scene for name in ids)), ANY_SCENE)
    return _relative(ids, values_of(target.column, ids, v), further)


def _relative(ids: list[str], values: dict[str, float], scene: str) -> dict[str, Any]:
    return {"causes": ids, "values": values, "further_scene": scene}
