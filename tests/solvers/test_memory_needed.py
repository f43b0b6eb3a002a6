"""Memory that a case needs: by columns, steps, unknowns and sub-blocks."""

import pytest
from conftest import scene_of

from validation.solvers import memory
from validation.solvers.registry import get_solver


def bytes_of(solver="fem", **changes):
    return memory.needed(scene_of(**changes), get_solver(solver))[0]


def test_a_mesh_needs_memory_by_its_file_and_none_that_cannot_be_read(tmp_path):
    """That it cannot be read is said where it is read."""
    (tmp_path / "seven.msh").write_text("7" * 7)
    for name, size in (("none.msh", 0), ("seven.msh", 7)):
        meshed = scene_of().with_values({"fem": {"mesh": str(tmp_path / name)}})
        assert memory.needed(meshed, get_solver("fem"))[0] == 8 * 50 * (4 * 3 + 6) + 200 * size


@pytest.mark.parametrize(
    ("solver", "changes", "column"),
    [
        ("fem", {}, True),
        ("fem", {"load__traction": 1.0}, False),
        ("fem", {"load__eccentricity": 0.1}, False),
        ("fem", {"load__base_motion": "quake.csv"}, False),
        ("fem", {"fem__foundation": "corner"}, False),
        ("fem", {"fem__cells": "triangles"}, False),
        ("fem", {"block__poisson": 0.1}, False),
        ("fenicsx", {}, False),
        ("fenicsx:4", {}, False),
    ],
    ids=str,
)
def test_memory_of_one_column_is_asked_only_where_one_column_will_do(solver, changes, column):
    size = bytes_of(solver, **({"fem__elements": 300, "fem__degree": 1, "time__steps": 1} | changes))
    assert size < 1e7 if column else size > 2 * 301**2 * 1000
