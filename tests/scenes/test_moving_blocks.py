"""Scenes of blocks that move: what is refused by field and value before anything runs, and what generators draw."""

import copy

import numpy as np
import pytest

from validation.errors import InputError
from validation.models.plane.geometry import overlap, separated, triangles_of
from validation.report.figures.curves import HistoryPanel, common_range
from validation.runs.columns import axis_of, unit_of
from validation.runs.history import History
from validation.scenes.outline import area
from validation.scenes.scene import parse_scene
from validation.solvers.registry import solve

FLOOR = {"name": "floor", "rectangle": [6.0, 1.0], "at": [0.0, -0.5], "fixed": True}
SQUARE = {"name": "square", "rectangle": [1.0, 1.0], "at": [0.0, 0.5]}
PLANE = {
    "young": "inf",
    "density": 2500.0,
    "gravity": [0.0, -9.81],
    "contact": {"stiffness": 1e9, "friction": 30.0},
    "block": [FLOOR, SQUARE],
}
UNIT_SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
L_SHAPE = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0))


def scene(changes=None, **run):
    """Return the scene of a block on a floor with other values in its table."""
    tables = {"plane": copy.deepcopy(PLANE) | (changes or {}), "time": {"step": 1e-3, "steps": 5}}
    return parse_scene(tables | ({"run": run} if run else {}), "plane")


def square(**changes):
    """Return the blocks with changes of the upper one."""
    return {"block": [FLOOR, SQUARE | changes]}


STATED = {"touch": [{"block": "square", "corner": corner, "on": "floor", "edge": 2} for corner in (0, 1)]}


@pytest.mark.parametrize(
    ("columns", "nothing", "changes"),
    [
        *(
            (["square.x", "square.0-floor.2.normal"], column, {})
            for column in ("sqare.x", "square.z", "x", "energy.heat")
        ),
        (["energy.kinetic", "square-floor.normal"], "square-floor.x", {}),
        (["momentum.angular"], "square.4-floor.2.normal", {}),
        (["momentum.x"], "square.0-square.2.normal", {}),
        (["block_2.x"], "block_1.x", square(name="")),
        (["square.0-floor.2.gap"], "square.2-floor.2.gap", STATED),
    ],
)
def test_a_column_of_nothing_is_refused(columns, nothing, changes):
    assert scene(changes, columns=columns).run.columns == tuple(columns)
    with pytest.raises(InputError) as caught:
        scene(changes, columns=[nothing])
    assert caught.value.field == "run"
    assert ("[[plane.touch]]" in caught.value.rule) == ("touch" in changes)


def test_every_column_has_its_unit_on_an_axis():
    own = scene().kind.columns
    units = {"square.x": "m", "square.angle": "rad", "square.0-floor.2.normal": "N", "energy.kinetic": "J"}
    assert {column: axis_of(column, own) for column in units} == {column: (column, units[column]) for column in units}
    assert unit_of("square.heat", own) == ""


def test_places_are_drawn_where_they_are_and_forces_from_zero():
    time = np.array([0.1, 0.2])
    drawn = {
        "square.x": np.array([4.0, 5.0]),
        "square.y": np.array([4.0, 4.001]),
        "energy.kinetic": np.array([4.0, 5.0]),
    }
    panel = HistoryPanel("", {"dda": History(time, drawn)}, {}, None, own=scene().kind.columns)
    assert common_range([panel], "square.x") == (4.0, 5.0)
    low, high = common_range([panel], "square.y")
    assert low == pytest.approx(4.0005 - 0.025 * 4.001) and high == pytest.approx(4.0005 + 0.025 * 4.001)
    assert common_range([panel], "energy.kinetic") == (0.0, 5.0)


def test_a_gap_that_nobody_looked_at_is_no_number():
    near = square(at=[0.0, 0.5 + 1e-10])  # touches
    far = scene({"gravity": [0.0, 0.0]} | near, columns=["square.2-floor.2.gap", "square.2-floor.2.normal"])
    history = solve(far, "dda").history
    assert np.all(np.isnan(history.columns["square.2-floor.2.gap"]))
    assert not np.any(history.columns["square.2-floor.2.normal"])


def test_triangles_tile_an_outline_from_any_corner():
    for start in range(len(L_SHAPE)):
        outline = (*L_SHAPE[start:], *L_SHAPE[:start])
        areas = [area([outline[corner] for corner in triangle]) for triangle in triangles_of(outline)]
        assert len(areas) == 4 and min(areas) > 0.1 and sum(areas) == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("shift", "depth", "lines"),  # and whose edges' lines part the two
    [
        (2.0, 0.0, "both"),
        (-1.3 + 0.4j, 0.0, "both"),
        (1.0 + 1.0j, 0.0, "none"),
        (2.5 - 3.0j, 0.0, "both"),
        (0.9 + 1.0j, 0.1, "none"),
        (0.0, 0.5, "none"),
        (-0.5 - 0.3j, 0.35, "none"),
        (1.6 + 0.2j, 0.4, "none"),
    ],
)
def test_outlines_that_are_not_convex_overlap_by_what_lies_inside(shift, depth, lines):
    first, second = (
        tuple((place.real, place.imag) for place in ((complex(*corner) + at) * np.exp(0.3j) + 7 for corner in outline))
        for outline, at in ((L_SHAPE, 0.0), (UNIT_SQUARE, shift))
    )
    assert overlap(first, second) == pytest.approx(depth, abs=1e-12) == overlap(second, first)
    assert {separated(first, second), separated(second, first)} == {lines == "both"}
