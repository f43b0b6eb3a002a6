"""The study `plates`: a plate with a hole and a disc, of glued triangles, beside closed forms and elements.

The error has three parts: the outline is a polygon under tractions that are uniform over an edge (quadratic elements on
it have that part alone), a triangle has one strain (linear elements on the same triangles have both), and glue of
finite stiffness gives way. With the closed form u, linear elements u_1 and quadratic ones u_2:

    outline u_2/u - 1,     strain u_1/u_2 - 1,     glue u_dda/u_1 - 1.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from itertools import starmap

import numpy as np

from validation.metrics.values import or_nan
from validation.models.plane.blocks import Vertices
from validation.models.plane.glued import Loads, PlateSection
from validation.models.plane.tables import PlaneSection
from validation.runs.row import Metrics, Row
from validation.scenes.outline import area
from validation.scenes.scene import Scene
from validation.studies.plates.closed import disc_centre, disc_widening, hole_displacement
from validation.studies.plates.elements import displacements, stress
from validation.suite.bands import Band, about, cases, near

FIRM = 1e9  # m, glue over Young's modulus
ROUNDING = 1e-9  # of a sparse solution: 1e4 eps times the condition of triangles and glue
STATIC = "displacement.static"
STRESS = ("stress.xx", "stress.yy")
SOFT_SCENE = "plates-glue"
Levels = Sequence[tuple[Scene, Row]]


# ---- what is exact ----


def exact(case: Scene) -> float:
    """Return by how much the points part in closed form [m]."""
    plane = case.table(PlaneSection)
    if disc := plane.disc:
        half_arc = math.radians(disc.half_arc)
        return 2 * disc.radius * disc_widening(disc.pressure, half_arc, plane.young, plane.poisson)
    plate = _plate(case)
    return 2 * hole_displacement(plate.hole, 0.0, plate.tension, plane.young, plane.poisson)


def exact_stress(case: Scene) -> tuple[float, float]:
    """Return s_xx and s_yy where they are looked at, in closed form [Pa]."""
    plane = case.table(PlaneSection)
    if disc := plane.disc:
        return disc_centre(disc.pressure, math.radians(disc.half_arc))
    s_xx, s_yy, _ = _plate(case).stresses(np.array([plane.observed.stress]))[0]
    return float(s_xx), float(s_yy)


def _plate(case: Scene) -> PlateSection:
    plate = case.table(PlaneSection).plate
    if plate is None:
        raise ValueError(f"must be a plate with a hole or a disc, got {case.name}")
    return plate


def linear(case: Scene, firm: bool = False) -> tuple[float, float]:
    """Return what linear elements on its triangles have, joined by springs if glued softly and not asked for firm glue.

    By how much the points part [m], and the mean s_xx of the triangles with a corner where it is looked at [Pa].
    """
    plane = case.table(PlaneSection)
    spring = math.inf if firm or plane.glue == FIRM else plane.glue * plane.young
    observe = plane.observed
    places = observe.place[0], observe.less[0][0], observe.stress
    return _linear(plane.polygons, plane.tractions, plane.young, plane.poisson, spring, places)


@functools.cache
def _linear(
    polygons: tuple[Vertices, ...], tractions: Loads, young: float, poisson: float, spring: float, observed: Vertices
) -> tuple[float, float]:
    *apart, stressed = observed
    triangles = [triangle for triangle in polygons if stressed in triangle]
    places = [*apart, *(corner for triangle in triangles for corner in triangle)]
    loads = []
    for (start, end), traction in tractions:
        length = math.dist(start, end)
        half = traction[0] * length / 2, traction[1] * length / 2
        loads.append((start, end, half, half))
    right, left, *corners = displacements(polygons, loads, young, poisson, places, spring)
    moved = np.reshape(corners, (-1, 3, 2))
    stresses = [stress(*pair, young, poisson)[0] for pair in zip(triangles, moved, strict=True)]
    return float(right[0] - left[0]), float(np.mean(stresses))


def cells_of(case: Scene) -> int:
    """Return the cells of a quarter."""
    body = case.table(PlaneSection).body
    return body.cells if body else 0


# ---- rows and bands ----


def parts(case: Scene, dda: Row, fem: Row | None = None) -> dict[str, float]:
    """Return what outline, strain and glue make wrong of a displacement, and all three."""
    blocks = or_nan(dda.metrics[STATIC])
    values = {
        "cells": float(cells_of(case)),
        "blocks": float(len(case.table(PlaneSection).polygons)),
        "whole": blocks / exact(case) - 1,
        "size": abs(blocks / exact(case) - 1),
        "glue": blocks / linear(case, firm=True)[0] - 1,
    }
    stress_xx, stress_yy = (or_nan(dda.metrics[name]) for name in STRESS)
    exact_xx, exact_yy = exact_stress(case)
    values["stress"] = stress_xx / exact_xx - 1
    values["stress size"] = abs(stress_xx / exact_xx - 1)
    if case.table(PlaneSection).disc:  # at the hole it is none
        values["stress along"] = stress_yy / exact_yy - 1
    if fem is not None:
        elements = or_nan(fem.metrics[STATIC])
        values |= {
            "outline": elements / exact(case) - 1,
            "outline size": abs(elements / exact(case) - 1),
            "strain": linear(case)[0] / elements - 1,
        }
    return values


def orders(levels: Levels) -> Metrics:
    """Return the order of the error by the two cases of most cells."""
    coarse, fine = starmap(parts, levels[-2:])
    values: dict[str, float] = {}
    for name in ("whole", "stress", "stress along"):
        if name in fine:
            errors = abs(coarse[name] / fine[name])
            values[name] = math.log(errors) / math.log(fine["cells"] / coarse["cells"])
    return values


def glue_order(levels: Levels) -> Metrics:
    """Return the order of glue's error in its stiffness."""
    softs = [or_nan(dda.metrics[STATIC]) / linear(case, firm=True)[0] - 1 for case, dda in levels[-2:]]
    glues = [case.table(PlaneSection).glue for case, _ in levels[-2:]]
    return {"order": math.log(abs(softs[0] / softs[1])) / math.log(glues[1] / glues[0])}


def second_program(case: Scene, fem: Row, fenicsx: Row) -> Metrics:
    """Return the displacement of the second program of elements over that of the first."""
    return {STATIC: or_nan(fenicsx.metrics[STATIC]) / or_nan(fem.metrics[STATIC])}


def glued(case: Scene) -> Band:
    """Return the displacement of the same triangles by an own program [m]; band: rounding of two sparse solutions.

    Linear elements have no joints: above those stands what firm glue adds, 3 l/2gh. A joint of length l gives way by
    l/2g of a strain, the block behind it by its height h; a triangle has three joints.
    """
    low, high = near(linear(case)[0], ROUNDING)
    return low, high * (1 + gives_way(case))


def glued_stress(case: Scene) -> Band:
    """Return s_xx of the same triangles there [Pa]; band: rounding, and what firm glue changes."""
    _, value = linear(case)
    return near(value, ROUNDING + gives_way(case))


def gives_way(case: Scene) -> float:
    """Return by how much firm glue gives way, of a strain; nothing of glue that the elements have too."""
    plane = case.table(PlaneSection)
    if plane.glue != FIRM:
        return 0.0
    slender = 0.0
    for polygon in plane.polygons:
        corners = np.array(polygon)
        lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
        slender = max(slender, float(np.max(lengths)) ** 2 / (2 * area(polygon)))
    return 3 * slender / (2 * plane.glue)


def sagitta(case: Scene) -> Band:
    """Return what a polygon in place of the circle changes: its sagitta over the radius, 1 - cos(pi/4n)."""
    half = 1 - math.cos(math.pi / (4 * cells_of(case)))
    return -half, half


def first_order_in_glue() -> Band:
    """Return 1 -/+ C/g, the next term, with the softer of both glues."""
    _, soft, _ = cases(SOFT_SCENE)
    return about(1.0, linear(soft)[0] / linear(soft, firm=True)[0] - 1)
