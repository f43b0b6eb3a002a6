"""Outlines of blocks, records and loads as a scene reads them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from validation.errors import InputError
from validation.scenes.outline import check_polygon, convex_quadrilateral
from validation.scenes.record import read_record
from validation.scenes.tables import BlockSection, LoadSection

PENTAGON = [[0.0, 0.0], [3.0, 0.0], [4.0, 2.0], [2.0, 3.0], [-1.0, 2.0]]


def block(**changes: object) -> BlockSection:
    return BlockSection(**({"density": 2700.0, "young": 1e9} | changes))  # type: ignore[arg-type]


def test_a_record_that_goes_back_is_named_by_its_instants(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("time,x\n0,0\n5,1\n3,2\n9,3\n")
    with pytest.raises(InputError, match="time must increase from row to row, got 3 after 5"):
        read_record(tmp_path / "r.csv")


@pytest.mark.parametrize(
    ("vertices", "words"),
    [
        (((0, 0), (2, 0), (2, 1), (2, 0.5), (0, 2)), "cross themselves, got edges 1 and 2"),
        (((0, 0), (1, 0), (1.5, 1), (2, 0)), "cross themselves, got edges 0 and 3"),  # back over the first one
        (((0, 0), (1, 0), (2, 0)), "cross themselves"),
        (((0, 0), (0, 2), (1, 2), (1, 0)), "must run counter-clockwise"),
        (((0, 0), (4, 0), (4, 2), (2, 0), (0, 2)), "cross themselves"),  # a corner touches the base
        (((0, 0), (2, 2), (2, 0), (0, 2)), "cross themselves"),
        (((0, 0), (2, 0), (1, 0), (1, 2)), "cross themselves"),  # an edge folded back on its neighbour
        (((0, 0), (0, 0), (2, 0), (2, 2)), "must not repeat"),
        (((0, 0), (2, 0)), "must be three or more"),
    ],
)
def test_outlines_that_are_none(vertices: tuple[tuple[float, float], ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        check_polygon(vertices, 0, 1)


@pytest.mark.parametrize(
    "vertices",
    [
        tuple(map(tuple, PENTAGON)),
        ((0, 0), (3, 0), (3, 3), (2, 1), (1, 1), (0, 3)),  # a notch whose floor is in line with no edge
        ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (2, 2), (2, 3), (0, 3)),  # upright edges in one line that do not meet
        ((0, 0), (1, 0), (2, 0), (2, 1), (0, 1)),  # a vertex within a straight edge
    ],
    ids=["pentagon", "notch", "C", "straight"],
)
def test_outlines_that_are_sound(vertices: tuple[tuple[float, float], ...]) -> None:
    check_polygon(vertices, 0, 2)


@pytest.mark.parametrize(
    ("vertices", "convex"),
    [
        (((0, 0), (2, 0), (1.5, 1), (0, 1)), True),
        (((0, 0), (1, 0), (2, 0), (1, 1)), False),  # a straight corner
        (((0, 0), (2, 0), (0.5, 0.5), (0, 2)), False),
        (((0, 1), (1, 1), (1, 0), (0, 0)), False),  # clockwise
        (((0, 0), (2, 0), (1, 2)), False),
        (tuple(map(tuple, PENTAGON)), False),
    ],
)
def test_what_can_be_cut_into_sub_blocks(vertices: tuple[tuple[float, float], ...], convex: bool) -> None:
    assert convex_quadrilateral(vertices) is convex


def test_outline_edges_and_base_of_a_block() -> None:
    wide = block(width=3.0, height=0.5)
    assert wide.outline == ((0, 0), (3, 0), (3, 0.5), (0, 0.5)) and wide.base_length == 3.0
    five = block(vertices=PENTAGON, base=4, top=1)
    assert five.edge(4) == ((-1.0, 2.0), (0.0, 0.0)) and five.edge(3) == ((2.0, 3.0), (-1.0, 2.0))
    assert five.base_length == pytest.approx(math.sqrt(5))


@pytest.mark.parametrize(
    "changes", [{"eccentricity": 0.1}, {"traction": 1.0}, {"gravity": 1.0}, {"base_motion": "r.csv"}], ids=str
)
def test_a_centred_pressure_is_all_there_is(changes: dict[str, object]) -> None:
    assert LoadSection(pressure=1.0).centred
    assert not LoadSection(pressure=1.0, **changes).centred  # type: ignore[arg-type]
