"""Newton's adapters: that they state a scene of boxes rightly, by what each solver's integrator and contact must give.

Warp compiles a solver's kernels when it is used first, for a minute or two, and keeps them in a folder of the user.
"""

import math
import sys
from importlib.util import find_spec

import numpy as np
import pytest
from oracles.box_scenes import box_scene, euler
from peers.newton import XPBD, SemiImplicit, SemiImplicitAsItComes, XPBDAsItComes

from validation.models.plane.boxes import boxes_of

# To look for it costs nothing; to import it takes seconds in every process that collects these tests.
is_absent = pytest.mark.skipif(not find_spec("newton"), reason="NOT RUN: Newton is not installed")


def installed(test):
    """Mark a test that runs the program as long; what it has in common with other programs has short tests there."""
    return pytest.mark.long(is_absent(test))


ALL = [XPBD(), XPBDAsItComes(), SemiImplicit(), SemiImplicitAsItComes()]
every = pytest.mark.parametrize("solver", ALL, ids=lambda solver: type(solver).__name__)
SLOPE = math.radians(20.0)
SINGLE = 2.0**-24  # what rounding takes of a number in single precision


@pytest.mark.parametrize(
    ("solver", "rigid", "field"),
    [(XPBD(), {"stiffness": 1e6}, "stiffness"), (SemiImplicit(), {"restitution": 0.5}, "restitution")],
)
def test_refuses_what_a_solver_cannot_express(solver, rigid, field):
    with pytest.raises(NotImplementedError, match=rf"plane\.contact\.{field}"):
        solver.solve(box_scene(**rigid))


@pytest.mark.parametrize("package", ["newton", "warp"])
def test_a_program_that_is_absent_is_named(package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(NotImplementedError, match="pip install"):
        XPBD().solve(box_scene())


@installed
@every
def test_a_box_falls_and_spins_as_semi_implicit_euler_does(solver):
    scene = box_scene({"lift": 5.0, "tilt": 30.0, "velocity": (3.0, 1.0), "spin": 9.0}, slope=20.0, steps=60)
    _, height, angle = boxes_of(scene).starts[0]
    columns = solver.solve(scene)
    count = round(scene.time.step * scene.time.steps / solver.step)
    rounding = count * 8 * SINGLE  # each step rounds positions of up to 8 m
    expected = euler(scene, solver.step, 3.0, 9.81 * math.sin(SLOPE))
    np.testing.assert_allclose(columns["box_1.x"], expected, atol=rounding)
    fall = euler(scene, solver.step, 1.0, -9.81 * math.cos(SLOPE))
    np.testing.assert_allclose(columns["box_1.y"], height + fall, atol=rounding)
    # SemiImplicit takes 0.05 of the spin away in a second as it comes; Newton adds half the quaternion's rate.
    turned = columns["box_1.angle"] - angle
    np.testing.assert_allclose(turned, 9.0 * scene.time.step * np.arange(1, scene.time.steps + 1), rtol=0.04)


@installed
@every
def test_a_box_slides_without_friction_as_semi_implicit_euler_does_whatever_its_mass(solver):
    scenes = [box_scene({"density": density}, slope=20.0, steps=50) for density in (10.0, 40.0)]
    expected = euler(scenes[0], solver.step, 0.0, 9.81 * math.sin(SLOPE))
    for scene in scenes:
        np.testing.assert_allclose(solver.solve(scene)["box_1.x"], expected, rtol=2e-3, atol=1e-4)


@installed
@pytest.mark.parametrize(
    ("solver", "restitution"), [(XPBD(), 1.0), (SemiImplicit(), 1.0), (XPBD(), 0.5), (XPBDAsItComes(), 0.5)]
)
def test_a_box_comes_back_at_the_asked_share_of_its_speed(solver, restitution):
    scene = box_scene({"lift": 0.05, "velocity": (0.0, -1.0)}, restitution=restitution, gravity=0.0, steps=20)
    height = solver.solve(scene)["box_1.y"]
    assert (height[-1] - height[-2]) / scene.time.step == pytest.approx(restitution, rel=2e-2)


@installed
@pytest.mark.parametrize("solver", [SemiImplicit(), SemiImplicitAsItComes()], ids=lambda solver: type(solver).__name__)
def test_a_given_stiffness_is_that_of_a_box_on_the_ground(solver):
    scene = box_scene({"density": 100.0}, stiffness=4e4, steps=400)
    settled = 0.5 - solver.solve(scene)["box_1.y"][-20:].mean()
    assert settled == pytest.approx(9.81 * 100.0 / 4e4, rel=1e-2)
