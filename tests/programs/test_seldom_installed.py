"""Programs of rigid boxes that are seldom there: one box each, and what its integrator and springs must give.

What they have in common with others is in `test_boxes.py`; Newton, whose kernels take a minute to compile, is here
alone.
"""

import importlib
import math
import sys

import numpy as np
import pytest
from oracles.box_scenes import box_scene, euler
from peers import dart, drake, exudyn, lmgc90, newton

from validation.models.plane.boxes import boxes_of

SINK = 9.81e-3  # m, of a box of 1000 kg on 1e6 N/m
PEAK = 9810.0 + math.sqrt(9810.0**2 + 2 * 9810.0 * 0.1 * 1e6)  # N, of its fall through 0.1 m on the same springs
CREEP = math.tan(math.radians(20.0)) / math.tan(math.radians(25.0))  # slip over the zone of proportional friction
SLIDE = 9.81 * (math.sin(math.radians(20.0)) - math.cos(math.radians(20.0)) * math.tan(math.radians(15.0))) / 2
SPRINGS = {"stiffness": 1e6, "steps": 400}
FALL = {"box": {"lift": 0.1}, "stiffness": 1e6, "step": 0.001, "steps": 300}
LEAN = {"slope": 20.0, "friction": 25.0, "steps": 500}


def landing(restitution):
    """Return a box that comes down at 1 m/s."""
    return {
        "box": {"lift": 0.05, "velocity": (0.0, -1.0)},
        "restitution": restitution,
        "gravity": 0.0,
        "steps": 20,
    }


def sink(columns, step):
    return 0.5 - columns["box_1.y"][-100:].mean()


def peak(columns, step):
    return columns["box_1-ground.normal"].max()


def slip(columns, step):
    return (columns["box_1.x"][-1] - columns["box_1.x"][-101]) / (100 * step)


def way(columns, step):
    return columns["box_1.x"][-1]


def rebound(columns, step):
    return (columns["box_1.y"][-1] - columns["box_1.y"][-2]) / step


ROWS = [  # package, solver, scene, what is measured, its value and how near
    ("compas_lmgc90", lmgc90.LMGC90, SPRINGS, sink, SINK, 0.02),
    ("pydrake", drake.AsItComes, SPRINGS, sink, SINK, 0.02),
    ("pydrake", drake.Drake, {"slope": 20.0, "friction": 15.0}, way, SLIDE, 0.01),
    ("exudyn", exudyn.Exudyn, LEAN, slip, (exudyn.Exudyn.friction_zone or 1e-3) * CREEP, 0.1),
    ("exudyn", exudyn.AsItComes, LEAN, slip, 1e-3 * CREEP, 0.1),
    ("exudyn", exudyn.Exudyn, FALL, peak, PEAK, 2e-3),
    ("newton", newton.SemiImplicit, SPRINGS, sink, SINK, 0.02),
    ("newton", newton.SemiImplicit, landing(1.0), rebound, 1.0, 0.02),
    ("newton", newton.XPBD, landing(1.0), rebound, 1.0, 0.02),
    ("newton", newton.XPBDAsItComes, landing(0.5), rebound, 0.5, 0.02),
]


@pytest.mark.long
@pytest.mark.parametrize(("package", "solver", "values", "measure", "expected", "within"), ROWS)
def test_a_box_does_what_its_equation_says(package, solver, values, measure, expected, within):
    pytest.importorskip(package, reason=f"NOT RUN: {package} is not installed")
    scene = box_scene(values.get("box", {}), **{name: value for name, value in values.items() if name != "box"})
    assert measure(solver().solve(scene), scene.time.step) == pytest.approx(expected, rel=within)


@pytest.mark.long
@pytest.mark.parametrize("solver", [newton.XPBD, newton.SemiImplicit])
def test_newtons_box_flies_as_semi_implicit_euler_does(solver):
    pytest.importorskip("newton", reason="NOT RUN: Newton is not installed")
    scene = box_scene({"lift": 5.0, "tilt": 30.0, "velocity": (3.0, 1.0), "spin": 9.0}, slope=20.0, steps=60)
    own = solver()
    columns = own.solve(scene)
    _, height, _ = boxes_of(scene).starts[0]
    rounding = round(scene.time.duration / own.step) * 8 * 2.0**-24  # of positions of up to 8 m, in single precision
    slope = math.radians(20.0)
    np.testing.assert_allclose(
        columns["box_1.x"], euler(scene, own.step, 3.0, 9.81 * math.sin(slope)), rtol=0, atol=rounding
    )
    fall = euler(scene, own.step, 1.0, -9.81 * math.cos(slope))
    np.testing.assert_allclose(columns["box_1.y"], height + fall, rtol=0, atol=rounding)


@pytest.mark.parametrize("package", ["newton", "warp"])
def test_newton_refuses_what_it_cannot_express_and_says_how_it_is_installed(package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(NotImplementedError, match="pip install"):
        newton.XPBD().solve(box_scene())
    with pytest.raises(NotImplementedError, match=r"plane\.contact\.stiffness"):
        newton.XPBD().solve(box_scene(stiffness=1e6))
    with pytest.raises(NotImplementedError, match=r"plane\.contact\.restitution"):
        newton.SemiImplicit().solve(box_scene(restitution=0.5))


@pytest.mark.parametrize(
    ("module", "step", "stated"),
    [
        ("dartpy", lambda program: program.simulation.World().getTimeStep(), dart.OWN_STEP),
        ("pydrake.all", lambda program: program.MultibodyPlantConfig().time_step, drake.OWN_STEP),
    ],
)
def test_default_steps_are_those_of_the_programs(module, step, stated):
    pytest.importorskip(module.partition(".")[0], reason=f"NOT RUN: {module} is not installed")
    assert step(importlib.import_module(module)) == stated
