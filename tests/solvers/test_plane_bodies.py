"""Bodies of elements and blocks: two codes, one model, the same steps; through scenes too."""

import numpy as np

from validation.scenes.scene import parse_scene
from validation.solvers.registry import solve


def landing(size, columns):
    """A body that lands and slides on another one, which stands on a fixed block; all that drives it times a size."""
    blocks = [
        {"name": "base", "rectangle": [6.0, 1.0], "at": [0.0, -0.5], "fixed": True},
        {"name": "a", "rectangle": [2.0, 1.0], "at": [0.0, 0.5]},
        {"name": "b", "rectangle": [1.0, 1.0], "at": [0.3, 1.5 + 1e-3 * size], "velocity": [0.5 * size, -0.5 * size]},
    ]
    touch = [{"block": up, "corner": i, "on": on, "edge": 2} for up, on in (("a", "base"), ("b", "a")) for i in (0, 1)]
    law = {"stiffness": 1e8, "friction": 30.0}
    made = {"young": 1e13, "density": 2500.0, "gravity": [0.0, -9.81 * size], "contact": law}
    data = {
        "plane": made | {"block": blocks, "touch": touch},
        "fem": {"foundation": "corner", "elements": 1, "degree": 1},
        "time": {"step": 1e-3, "steps": 12, "alpha": 0.5, "delta": 1.0, "start": "consistent"},
        "run": {"columns": list(columns), "solvers": ["dda", "fem"]},
    }
    return parse_scene(data, "landing")


PARTS = [f"{block}.{part}" for block in "ab" for part in ("x", "y", "angle", "vx", "vy", "spin")]
PARTS += [
    f"{pair}.{part}" for pair in ("a.0-base.2", "b.0-a.2", "b.1-a.2") for part in ("normal", "shear", "gap", "slip")
]
PARTS += [f"energy.{part}" for part in ("kinetic", "springs", "load", "friction", "algorithmic", "switching")]
PARTS += ["momentum.x", "momentum.y"]


def test_stiff_elements_on_corners_are_dda_but_for_its_finite_rotations():
    """Driven a tenth as hard they differ by a tenth: of first order in the rotation, in every column."""
    apart = []
    for size in (0.1, 0.01):
        scene = landing(size, [*PARTS, "base.x", "base.vy", "energy.balance", "a.gxy"])
        blocks, bodies = (solve(scene, name).history.columns for name in ("dda", "fem"))
        scales = {name: np.abs(blocks[name] - blocks[name][0]).max() for name in PARTS}
        apart.append([np.abs(bodies[name] - blocks[name]).max() / scales[name] for name in PARTS])
        assert np.abs(bodies["energy.balance"]).max() < 1e-9 * np.abs(bodies["energy.kinetic"]).max()
        assert not np.any([bodies["base.x"], bodies["base.vy"]])
    # 0.1 but for the second order, and for slips that begin a step earlier
    assert np.max(apart[1]) < 0.2 * np.max(apart[0]) < 0.01
