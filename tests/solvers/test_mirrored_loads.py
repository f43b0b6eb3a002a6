"""Eccentric pressure and traction to the left: the mirror image of the right, with the sign that statics gives it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dda
from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import get_solver

COLUMNS = ["displacement", "contact_pressure", "horizontal_displacement", "rotation"]
EVEN = {"displacement": 1.0, "contact_pressure": 1.0, "horizontal_displacement": -1.0, "rotation": -1.0}
SUBDIVIDED = {"block.subdivide": [4, 3], "block.glue_ratio": 20.0}
MODELS = {  # all symmetric about the middle line; 0.31 ends the pressed part inside a sub-block and inside an element
    "dda": ("dda", {}, 0.31),
    "sub-blocks": ("dda", SUBDIVIDED, 0.31),
    "fem": ("fem", {"fem.elements": 4, "fem.degree": 1}, 0.31),
    "fem of degree 2": ("fem", {"fem.elements": 3, "fem.degree": 2}, 0.31),
    "fenicsx": ("fenicsx", {"fem.elements": 4}, 0.25),
}
IN_TURN = [  # short are each model with one load
    pytest.param(
        model,
        load,
        id=f"{load}-{name}",
        marks=[*[pytest.mark.fenicsx] * (name == "fenicsx"), *[pytest.mark.long] * (m % 2 != n)],
    )
    for m, (name, model) in enumerate(MODELS.items())
    for n, load in enumerate(("eccentricity", "traction"))
]


@pytest.mark.parametrize(("model", "load"), IN_TURN)
def test_left_is_the_mirror_image_of_right(
    scene_file: Path, model: tuple[str, dict[str, object], float], load: str
) -> None:
    """Even are v and the pressure, odd are u and the rotation; the heavier side goes down."""
    solver, values, shift = model
    columns = COLUMNS[:3] if solver == "fenicsx" else COLUMNS
    scene = load_scene(scene_file).with_values({"block.poisson": 0.2, "run.columns": columns, **values})

    def on(side: float) -> Scene:
        size = shift if load == "eccentricity" else 2e5
        return scene.with_values({"load": {"pressure": 5e6, load: side * size}})

    left, right = (get_solver(solver).solve(on(side)).history for side in (-1.0, 1.0))
    for name in columns:
        scale = np.abs(right.columns[name]).max()
        assert scale > 1e-7 * np.abs(right.displacement).max()
        # fifty steps of another order of operations
        np.testing.assert_allclose(left.columns[name], EVEN[name] * right.columns[name], rtol=0, atol=1e-10 * scale)
    static = get_solver(solver).static(on(-1.0))
    if "rotation" in columns:
        # pressed on the left it turns left (anticlockwise), pushed to the left as well
        assert static["rotation"] > 0
    if load == "traction":
        assert static["horizontal_displacement"] < 0


@pytest.mark.parametrize("pattern", ["squares", "triangles"])
@pytest.mark.parametrize(("e", "tau"), [(-0.31, 0.0), (0.31, 0.0), (0.0, -2e5), (0.4, 1e5)])
@pytest.mark.parametrize("columns", [1, 2, 5])
def test_a_rigid_block_of_sub_blocks_turns_on_its_springs(pattern: str, e: float, tau: float, columns: int) -> None:
    """Moment over the springs' rotary stiffness: r = -(q L e + tau a h) / sum(k x^2), u = tau a / 2 p_s - r h / 2.

    The base's springs stand at both ends of every sub-block's base edge of length a / n, p / n each.
    """
    a, h, p, ps, q = 2.0, 1.5, 1e9, 4e8, 5e6
    block = dda.Block.rectangle(a, h, dda.Material(2700.0, 1e16, 0.2))
    model = dda.TwoBlockModel(block, dda.Contact(p, ps), q, eccentricity=e, traction=tau)
    static = dda.static_system(dda.subdivided(model, columns, 2, 1e20, pattern))  # type: ignore[arg-type]
    ends = np.linspace(-a / 2, a / 2, columns + 1)
    rotary = p / columns * (np.sum(ends[:-1] ** 2) + np.sum(ends[1:] ** 2))
    pressed = a - 2 * abs(e)
    rotation = -(q * pressed * e + tau * a * h) / rotary
    # p / E = 1e-7 of elastic strain is left
    assert static["rotation"] == pytest.approx(rotation, rel=1e-5)
    assert static["horizontal_displacement"] == pytest.approx(tau * a / (2 * ps) - h / 2 * rotation, rel=1e-5)
    assert static["displacement"] == pytest.approx(-q * pressed / (2 * p), rel=1e-5)
    assert static["contact_pressure"] == pytest.approx(q * pressed / a, rel=1e-9)
