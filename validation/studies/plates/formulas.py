"""The study `plates`: a plate with a hole and a disc, of glued triangles, beside closed forms and elements.

What is wrong has four parts: the outline is a polygon and its tractions are uniform over an edge (quadratic elements on
the same outline have that part alone), a triangle has one strain (linear elements on the same triangles have both), and
glue of finite stiffness gives way. With the closed form u, linear elements u_1 and quadratic ones u_2:

    outline u_2/u - 1,     strain u_1/u_2 - 1,     glue u_dda/u_1 - 1.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from validation.engine.finished import Derived, Finished
from validation.metrics.values import or_nan
from validation.models.plane.tables import PlaneSection
from validation.runs.row import Value
from validation.scenes.outline import area
from validation.scenes.scene import Scene, parse_scene
from validation.studies.plates.closed import disc_centre, disc_widening, hole_displacement, hole_stress
from validation.studies.plates.elements import displacements, stress
from validation.studies.plates.shapes import Point, Triangle, disc, outline, ring
from validation.suite.bands import Band, about, near

YOUNG = 1e9
POISSON = 0.25
DENSITY = 2700.0
TENSION = 1e6  # Pa, along x
PRESSURE = 1e6  # Pa, on two arcs
HALF_ARC = math.pi / 8
INNER, OUTER = 1.0, 4.0  # radii of the plate [m]
FIRM = 1e9  # m, glue over Young's modulus
HOLES = (4, 8, 12)  # cells of a quarter
DISCS = (4, 8, 12)
GLUES = (10.0, 100.0, 1000.0)
ROUNDING = 1e-9  # of a sparse solution: 1e4 eps times the condition of triangles and glue
STATIC = "displacement.static"
STRESS = ("stress.xx", "stress.yy")
STRESSED = {"hole": (0.0, INNER), "disc": (0.0, 0.0)}  # where the stress is looked at: its peak, and the middle [m]
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)
Loads = list[tuple[tuple[Point, Point], tuple[float, float]]]


def hole(n: int, glue: float = FIRM) -> Scene:
    """Return a plate with a hole: on its outer edges the mean of the exact tractions there."""
    triangles = ring(INNER, OUTER, n)
    loads: Loads = []
    for start, end in outline(triangles, OUTER):
        (x0, y0), (x1, y1) = start, end
        middle = np.array([x0 + x1, y0 + y1]) / 2
        half = np.array([x1 - x0, y1 - y0]) / 2
        s_xx, s_yy, s_xy = WEIGHTS / 2 @ hole_stress(middle + POINTS[:, None] * half, INNER, TENSION)
        nx, ny = _normal(start, end)
        loads.append(((start, end), (float(s_xx * nx + s_xy * ny), float(s_xy * nx + s_yy * ny))))
    return _scene("hole", n, glue, triangles, loads)


def brazilian(n: int) -> Scene:
    """Return a disc under a pressure on two arcs, whose ends are nodes."""
    triangles = disc(1.0, n)
    loads: Loads = []
    for start, end in outline(triangles, 1.0):
        if math.atan2(abs(start[0] + end[0]), abs(start[1] + end[1])) < HALF_ARC:
            nx, ny = _normal(start, end)
            loads.append(((start, end), (-PRESSURE * nx, -PRESSURE * ny)))
    return _scene("disc", n, FIRM, triangles, loads)


def _normal(start: Point, end: Point) -> tuple[float, float]:
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    return (end[1] - start[1]) / length, (start[0] - end[0]) / length


def _scene(shape: str, n: int, glue: float, triangles: Sequence[Triangle], loads: Loads) -> Scene:
    """Return a scene that observes by how much the rim's points on the x axis part."""
    firm = glue == FIRM
    data: dict[str, Any] = {
        "name": f"plates-{shape}-{n}" if firm else f"plates-glue-{glue:g}",
        "title": {"hole": "Plate with a hole", "disc": "Disc between two arcs"}[shape],
        "plane": {
            "young": YOUNG,
            "density": DENSITY,
            "poisson": POISSON,
            "glue": glue,
            "block": [{"vertices": [list(point) for point in triangle]} for triangle in triangles],
            "load": [{"edge": [list(start), list(end)], "traction": list(value)} for (start, end), value in loads],
            "observe": {
                "point": [1.0, 0.0],
                "less": [[[-1.0, 0.0], [-1.0, 0.0]]],
                "direction": [1.0, 0.0],
                "stress": list(STRESSED[shape]),
            },
        },
        "time": {"step": 100.0, "steps": 1},  # of statics: implicit, far beyond the first period
        "run": {"solvers": ["dda", "fem"] if firm else ["dda"], "columns": ["displacement"]},
        "fem": {"elements": 1},  # along each side of a triangle
    }
    if firm and n == min(HOLES):
        data["run"]["solvers"].append("fenicsx")
    return parse_scene(data, data["name"])


@functools.cache
def by_shape() -> Mapping[str, tuple[Scene, ...]]:
    """Return the scenes of each shape, by the number of their cells, and those of softer glue."""
    return {
        "hole": tuple(hole(n) for n in HOLES),
        "disc": tuple(brazilian(n) for n in DISCS),
        "glue": tuple(hole(8, glue) for glue in GLUES),
    }


def scenes() -> tuple[Scene, ...]:
    """Return all scenes."""
    return tuple(scene for group in by_shape().values() for scene in group)


def firm() -> tuple[Scene, ...]:
    """Return those that are glued firmly."""
    return (*by_shape()["hole"], *by_shape()["disc"])


def with_fenicsx() -> list[Scene]:
    """Return those that a second program of elements runs."""
    return [scene for scene in firm() if "fenicsx" in scene.run.solvers]


# ---- what is exact --------------------------------------------------------------------------------------------------


def exact(case: Scene) -> float:
    """Return by how much the points part in closed form [m]."""
    if "disc" in case.name:
        return 2 * disc_widening(PRESSURE, HALF_ARC, YOUNG, POISSON)
    return 2 * hole_displacement(INNER, 0.0, TENSION, YOUNG, POISSON)


def exact_stress(case: Scene) -> tuple[float, float]:
    """Return s_xx and s_yy where the stress is looked at, in closed form [Pa]."""
    if "disc" in case.name:
        return disc_centre(PRESSURE, HALF_ARC)
    s_xx, s_yy, _ = hole_stress(np.array([STRESSED["hole"]]), INNER, TENSION)[0]
    return float(s_xx), float(s_yy)


@functools.cache
def linear(name: str) -> tuple[float, float]:
    """Return what linear elements on its triangles have, joined by springs if glued softly.

    By how much the points part [m], and the mean s_xx of the triangles with a corner where stress is looked at [Pa].
    """
    case = next(scene for scene in scenes() if scene.name == name)
    plane = case.table(PlaneSection)
    stressed = STRESSED["disc" if "disc" in name else "hole"]
    triangles = [triangle for triangle in plane.polygons if stressed in triangle]
    places = [(1.0, 0.0), (-1.0, 0.0), *(corner for triangle in triangles for corner in triangle)]
    loads = []
    for (start, end), traction in plane.tractions:
        length = math.dist(start, end)
        half = traction[0] * length / 2, traction[1] * length / 2
        loads.append((start, end, half, half))
    spring = math.inf if plane.glue == FIRM else plane.glue * plane.young
    right, left, *corners = displacements(plane.polygons, loads, YOUNG, POISSON, places, spring)
    moved = np.reshape(corners, (-1, 3, 2))
    stresses = [stress(*pair, YOUNG, POISSON)[0] for pair in zip(triangles, moved, strict=True)]
    return float(right[0] - left[0]), float(np.mean(stresses))


def firm_of(case: Scene) -> str:
    """Return the name of the scene that is glued firmly, of the same triangles."""
    return "plates-hole-8" if "glue" in case.name else case.name


def cells(case: Scene) -> int:
    """Return the cells of a quarter."""
    return 8 if "glue" in case.name else int(case.name.rpartition("-")[2])


# ---- rows and bands -------------------------------------------------------------------------------------------------


def parts(case: Scene, finished: Finished) -> Mapping[str, Value]:
    """Return what outline, strain and glue make wrong of a displacement, and all three."""
    blocks = or_nan(finished.rows[case.name, "dda"].metrics[STATIC])
    values: dict[str, Value] = {
        "cells": float(cells(case)),
        "blocks": float(len(case.table(PlaneSection).polygons)),
        "whole": blocks / exact(case) - 1,
        "size": abs(blocks / exact(case) - 1),
        "glue": blocks / linear(firm_of(case))[0] - 1,
    }
    stress_xx, stress_yy = (or_nan(finished.rows[case.name, "dda"].metrics[name]) for name in STRESS)
    exact_xx, exact_yy = exact_stress(case)
    values["stress"] = stress_xx / exact_xx - 1
    values["stress size"] = abs(stress_xx / exact_xx - 1)
    if "disc" in case.name:  # at the hole it is none
        values["stress along"] = stress_yy / exact_yy - 1
    if (case.name, "fem") in finished.rows:
        elements = or_nan(finished.rows[case.name, "fem"].metrics[STATIC])
        values |= {
            "outline": elements / exact(case) - 1,
            "outline size": abs(elements / exact(case) - 1),
            "strain": linear(case.name)[0] / elements - 1,
        }
    return values


def orders(shape: str, finished: Finished) -> Mapping[str, Value]:
    """Return the order of the error by the two scenes of most cells."""
    coarse, fine = (parts(case, finished) for case in by_shape()[shape][-2:])
    values: dict[str, Value] = {}
    for name in ("whole", "stress", "stress along"):
        if name in fine:
            errors = abs(float(str(coarse[name])) / float(str(fine[name])))
            values[name] = math.log(errors) / math.log(float(str(fine["cells"])) / float(str(coarse["cells"])))
    return values


def glue_order(finished: Finished) -> Mapping[str, Value]:
    """Return the order with which glue's error falls with its stiffness."""
    softs = []
    for case in by_shape()["glue"][-2:]:
        softs.append(or_nan(finished.rows[case.name, "dda"].metrics[STATIC]) / linear(firm_of(case))[0] - 1)
    return {"order": math.log(abs(softs[0] / softs[1])) / math.log(GLUES[-1] / GLUES[-2])}


def second_program(case: Scene, finished: Finished) -> Mapping[str, Value]:
    """Return the displacement of the second program of elements over that of the first."""
    first, second = (or_nan(finished.rows[case.name, solver].metrics[STATIC]) for solver in ("fem", "fenicsx"))
    return {STATIC: second / first}


def derived() -> tuple[Derived, ...]:
    """Return the rows of all scenes, and the orders."""
    rows = []
    for case in scenes():
        solvers = [solver for solver in case.run.solvers if solver != "fenicsx"]
        needs = tuple((case.name, solver) for solver in solvers)
        rows.append(Derived(case.name, "parts", needs, partial(parts, case), (STATIC, *STRESS)))
    for shape in ("hole", "disc"):
        needs = tuple((case.name, "dda") for case in by_shape()[shape])
        rows.append(Derived(f"plates-{shape}", "order", needs, partial(orders, shape), (STATIC, *STRESS)))
    needs = tuple((case.name, "dda") for case in by_shape()["glue"])
    rows.append(Derived("plates-glue", "order", needs, glue_order, (STATIC,)))
    for case in with_fenicsx():
        needs = ((case.name, "fem"), (case.name, "fenicsx"))
        rows.append(Derived(case.name, "fenicsx over fem", needs, partial(second_program, case), (STATIC,)))
    return tuple(rows)


def glued(case: Scene) -> Band:
    """Return the displacement of the same triangles by an own program [m]; band: rounding of two sparse solutions.

    Linear elements have no joints: above those stands what firm glue adds, 3 l/2gh. A joint of length l gives way by
    l/2g of a strain where the block behind it gives way by its height h; a triangle has three.
    """
    low, high = near(linear(case.name)[0], ROUNDING)
    return low, high * (1 + gives_way(case))


def glued_stress(case: Scene) -> Band:
    """Return s_xx of the same triangles where it is looked at [Pa]; band: rounding, and what firm glue changes."""
    _, value = linear(case.name)
    return near(value, ROUNDING + gives_way(case))


def gives_way(case: Scene) -> float:
    """Return by how much firm glue gives way, of a strain; of glue that the elements have too, nothing."""
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
    half = 1 - math.cos(math.pi / (4 * cells(case)))
    return -half, half


def first_order_in_glue() -> Band:
    """Return 1 -/+ C/g, the next term, with the softer of both glues."""
    _, soft, _ = by_shape()["glue"]
    return about(1.0, linear(soft.name)[0] / linear(firm_of(soft))[0] - 1)
