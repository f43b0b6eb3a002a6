"""A base that stands displaced at t = 0 and moves on: histories and statics of every solver against plain Newmark.

The paper's block without contraction (mu = 0) on springs of 2 p (normal) and 2 p_s (tangential) is, for a vertical
motion of its base, a bar of n linear elements: n = 1 is also the DDA block with its v and ey, n glued sub-blocks and
n elements of degree 1 are the others. The reference integrates the absolute displacements,
M D'' + K D = 2 p y(t) at the base, and knows nothing of the suite.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import SCENE, thinned
from oracles.plain_newmark import stepped, upright

import dda
import fem_reference
from validation.runs.history import Array
from validation.scenes.record import base_record
from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import get_solver

A, E, RHO, P = 2.0, 1.0e9, 2700.0, 1.0e9  # m, Pa, kg/m3, N/m: of `conftest.SCENE`
M = RHO * A * A  # kg
TIME = (0.0, 0.011, 0.02, 0.05)  # s
X = (7e-4, -2e-3, 3e-3, -4e-4)  # m: first, last and what is between differ
Y = (-9e-4, 1e-3, -2e-3, 5e-4)
COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement")
SOLVERS = ["dda", "fem", pytest.param("fenicsx", marks=pytest.mark.fenicsx)]
GLUE = 1e12  # over E: what it adds to a column's compliance is below 1e-11
SCHEMES = {  # constant acceleration never uses the first acceleration, these do
    "average": (0.25, 0.5, 1.0, 5e-4),
    "discounted": (0.3025, 0.6, 0.97, 1e-3),
    "central differences": (0.0, 0.5, 1.0, 1e-4),
}
# stiff glue has no stable explicit step: there the block is whole
CASES = [(1, "central differences"), *((n, name) for n in (1, 4) for name in ("average", "discounted"))]


def scene_of(tmp_path: Path, header: str = "time,x,y", **values: object) -> Scene:
    """Return the small scene on a base that moves as the record says."""
    columns = {"time": TIME, "x": X, "y": Y}
    rows = zip(*(columns[name] for name in header.split(",")), strict=True)
    (tmp_path / "quake.csv").write_text("\n".join([header, *(",".join(map(repr, row)) for row in rows)]))
    path = tmp_path / "moved.toml"
    path.write_text(SCENE.replace("pressure = 5.0e6", 'base_motion = "quake.csv"'))
    dotted = {name.replace("__", "."): value for name, value in values.items()}
    return load_scene(path).with_values({"run.columns": list(COLUMNS)} | dotted)


def elements_on_a_spring(n: int, scheme: dda.Scheme, steps: int) -> tuple[Array, Array]:
    """Return v of the middle and the contact pressure of n linear elements, the base following Y, step by step."""
    y = np.interp(scheme.step * np.arange(steps + 1), TIME, Y)
    D = stepped(*upright(n), np.outer(y, 2 * P * np.eye(n + 1)[0]), scheme)
    middle = [np.interp(A / 2, np.linspace(0, A, n + 1), row) for row in D]
    return np.array(middle), -2 * P * (D[:, 0] - y[1:]) / A


@pytest.mark.parametrize("solver", thinned(SOLVERS, 4))
@pytest.mark.parametrize(("blocks", "scheme"), thinned(CASES, 2))
@pytest.mark.parametrize("start", ["zero", "consistent"])
def test_a_displaced_base_starts_every_solver_as_plain_newmark(
    tmp_path: Path, solver: str, blocks: int, scheme: str, start: str
) -> None:
    numbers = dict(zip(("alpha", "delta", "gg", "step"), SCHEMES[scheme], strict=True))
    values: dict[str, object] = {f"time__{name}": value for name, value in numbers.items()}
    values |= {"time__start": start, "time__steps": 40, "fem__elements": blocks, "fem__degree": 1}
    values |= {"block__subdivide": [1, blocks], "block__glue_ratio": GLUE} if solver == "dda" and blocks > 1 else {}
    run = get_solver(solver).solve(scene_of(tmp_path, "time,y", **values))
    middle, pressure = elements_on_a_spring(blocks, dda.Scheme(**numbers, start=start), 40)
    # 40 steps of two orders of operations at a conditioning of some hundred, and the glue's compliance
    np.testing.assert_allclose(run.displacement, middle, rtol=0, atol=2e-10 * np.abs(middle).max())
    np.testing.assert_allclose(run.contact_pressure, pressure, rtol=0, atol=2e-10 * np.abs(pressure).max())
    assert np.abs(run.history.columns["horizontal_displacement"]).max() <= 1e-12 * np.abs(middle).max()


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


@pytest.mark.parametrize("header", ["time,x", "time,y", "time,x,y", "time,y,x"])
def test_a_record_is_read_by_its_header(tmp_path: Path, header: str) -> None:
    scene, still = scene_of(tmp_path, header), [0.0] * len(TIME)
    record = base_record(scene)
    assert [list(record.time), list(record.x), list(record.y)] == [
        list(TIME),
        list(X) if "x" in header else still,
        list(Y) if "y" in header else still,
    ]
    between = 0.5 * (TIME[1] + TIME[2])
    for motion in (dda.BaseMotion(record.time, np.column_stack([record.x, record.y])).at, own_motion(record)):
        expected = [[part[0], (part[1] + part[2]) / 2, part[-1]] for part in (record.x, record.y)]
        np.testing.assert_allclose(motion(np.array([-1.0, between, 9.0])).T, expected, rtol=1e-14)


def own_motion(record):  # type: ignore[no-untyped-def]
    """Return the finite-element code's record."""
    return fem_reference.Motion(tuple(record.time), tuple(record.x), tuple(record.y))
