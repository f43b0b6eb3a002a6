"""A base that stands displaced at t = 0 and moves on: histories and statics of every solver against plain Newmark.

The paper's block without contraction (mu = 0) on springs of 2 p (normal) and 2 p_s (tangential) is, for a vertical
motion of its base, a bar of n linear elements: n = 1 is also the DDA block with its v and ey, n glued sub-blocks and
n elements of degree 1 are the others. The reference integrates the absolute displacements,
M D'' + K D = 2 p y(t) at the base, and knows nothing of the suite.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import SCENE

from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import get_solver

A, E, RHO, P = 2.0, 1.0e9, 2700.0, 1.0e9  # m, Pa, kg/m3, N/m: of `conftest.SCENE`
TIME = (0.0, 0.011, 0.02, 0.05)  # s
X = (7e-4, -2e-3, 3e-3, -4e-4)  # m: first, last and what is between differ
Y = (-9e-4, 1e-3, -2e-3, 5e-4)
COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement")


def scene_of(tmp_path: Path, header: str = "time,x,y", **values: object) -> Scene:
    """Return the small scene on a base that moves as the record says."""
    columns = {"time": TIME, "x": X, "y": Y}
    rows = zip(*(columns[name] for name in header.split(",")), strict=True)
    (tmp_path / "quake.csv").write_text("\n".join([header, *(",".join(map(repr, row)) for row in rows)]))
    path = tmp_path / "moved.toml"
    path.write_text(SCENE.replace("pressure = 5.0e6", 'base_motion = "quake.csv"'))
    dotted = {name.replace("__", "."): value for name, value in values.items()}
    return load_scene(path).with_values({"run.columns": list(COLUMNS)} | dotted)


@pytest.mark.parametrize(
    ("solver", "subdivide"),
    [("dda", None), ("dda", [3, 2]), ("fem", None), pytest.param("fenicsx", None, marks=pytest.mark.fenicsx)],
)
def test_a_damped_run_comes_to_rest_where_static_says(tmp_path: Path, solver: str, subdivide: list[int] | None) -> None:
    """55 steps after the record's end, of which each leaves 0.41 of the slowest motion and less of the others."""
    values: dict[str, object] = {"time__alpha": 0.5625, "time__gg": 0.3, "time__step": 1e-2, "time__steps": 60}
    scene = scene_of(tmp_path, **values, block__subdivide=subdivide, fem__elements=2, fem__degree=1)
    run, static = get_solver(solver).solve(scene).history, get_solver(solver).static(scene)
    for name, size in (("displacement", 1e-3), ("horizontal_displacement", 1e-3), ("contact_pressure", 1e6)):
        assert run.columns[name][-1] == pytest.approx(static[name], abs=1e-9 * size), name
    assert run.columns["displacement"][-1] == pytest.approx(Y[-1], rel=1e-6)
