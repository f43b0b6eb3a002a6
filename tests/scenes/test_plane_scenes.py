"""Scenes of glued blocks in the plane: what is refused by its field, and the modes both solvers share their rest in."""

import copy

import pytest

from validation.errors import InputError
from validation.scenes.scene import parse_scene
from validation.solvers.registry import get_solver

SQUARE = {"vertices": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]}
EDGE = [[2.0, 0.0], [2.0, 1.0]]
TABLES = {
    "plane": {
        "young": 1e9,
        "density": 2700.0,
        "width": 2.0,
        "height": 1.0,
        "subdivide": [4, 2],
        "clamp": [{"edge": [[0.0, 0.0], [0.0, 1.0]]}],
        "load": [{"edge": EDGE, "traction": [0.0, -1e5]}],
        "observe": {"edge": EDGE, "direction": [0.0, 1.0]},
    },
    "time": {"step": 1e-3, "steps": 5},
}


def scene(changes=None):
    """Return the scene with other values by dotted keys; None takes one away."""
    tables = copy.deepcopy(TABLES)
    for key, value in (changes or {}).items():
        *path, last = key.split(".")
        table = tables
        for name in path:
            table = table.setdefault(name, {})
        if value is None:
            del table[last]
        else:
            table[last] = value
    return parse_scene(tables, "plane")


@pytest.mark.parametrize("solver", ["dda", "fem"])
@pytest.mark.parametrize("place", ["plane.clamp", "plane.load"])
def test_a_place_beside_the_outline_is_refused(solver, place):
    off = [{"edge": [[0.5, 0.5], [0.5, 1.0]], "traction": [1.0, 0.0]}]
    with pytest.raises(InputError):
        get_solver(solver).solve(scene({place: off if place == "plane.load" else [{"edge": off[0]["edge"]}]}))


@pytest.mark.parametrize("solver", ["dda", "fem"])
def test_the_modes_share_the_rest(solver):
    modes = get_solver(solver).modes(scene())
    assert modes[0].share == max(mode.share for mode in modes)
    assert 0.9 < sum(mode.share for mode in modes) <= 1 + 1e-9  # of four modes that are reported
