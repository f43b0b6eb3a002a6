"""What `advise` says of blocks that move: the frequency of a contact, and springs and step that keep what they say."""

import math
from dataclasses import replace

import numpy as np
import pytest

from validation.errors import InputError
from validation.models.plane.assembly import OVERLAP
from validation.models.plane.corner_springs import fastest_contact, highest_frequency, lines, moving_advice
from validation.models.plane.tables import PlaneSection
from validation.scenes.scene import load_scene, parse_scene
from validation.solvers.registry import solve

P, DENSITY = 1e6, 2000.0


def falling(rectangle, young, velocity=-0.1):
    """Return a block whose lower right corner comes down on a fixed one."""
    width, height = rectangle
    floor = {"name": "floor", "rectangle": [4 * width, 1.0], "at": [0.0, -0.5], "fixed": True}
    block = {"name": "A", "rectangle": rectangle, "at": [0.0, height / 2], "velocity": [0.0, velocity]}
    plane = {"young": young, "density": DENSITY, "contact": {"stiffness": P, "friction": 0.0}, "block": [floor, block]}
    plane["touch"] = [{"block": "A", "corner": 1, "on": "floor", "edge": 2}]
    return parse_scene({"plane": plane, "time": {"step": 1e-3, "steps": 10}}, "falling")


def block_of(scene):
    return scene.table(PlaneSection).assembly.blocks[1]


@pytest.mark.long
@pytest.mark.parametrize(
    ("rectangle", "young", "over_mass"),
    [([10.0, 0.2], math.inf, 4.0), ([2.0, 2.0], 1.0, 7.0)],
    ids=["rigid rod", "soft square"],
)
def test_a_corner_is_in_contact_for_half_a_period_of_its_frequency(rectangle, young, over_mass):
    scene = falling(rectangle, young)
    frequency = highest_frequency(block_of(scene), P)
    mass = DENSITY * math.prod(rectangle)
    assert frequency == pytest.approx(math.sqrt(over_mass * P / mass), rel=1e-5), "the closed form"
    step = 2 * math.pi / frequency / 400
    values = {"time.step": step, "time.steps": 280, "time.alpha": 0.25, "time.delta": 0.5}
    history = solve(scene.with_values(values | {"run.columns": ["A.1-floor.2.normal"]}), "dda").history
    pressed = np.sum(history.columns["A.1-floor.2.normal"] > 0)
    assert pressed * step == pytest.approx(math.pi / frequency, rel=1e-2), "as dda has it"


def test_two_blocks_that_move_are_faster_than_one_and_strain_stiffens():
    block = block_of(falling([2.0, 2.0], 1e9))
    large = replace(block_of(falling([4.0, 4.0], 1e9)), name="large")
    small = replace(block, name="small", density=DENSITY / 2)
    squares = [highest_frequency(one, P) ** 2 for one in (small, block)]
    names, both = fastest_contact([large, block, small], P)
    assert names == ("small", "A") and both == pytest.approx(math.sqrt(sum(squares)))
    assert math.sqrt(squares[1]) > highest_frequency(replace(block, young=1.0), P)


@pytest.mark.parametrize(
    "scheme", [{}, pytest.param({"time.alpha": 0.25, "time.delta": 0.5}, marks=pytest.mark.long)], ids=str
)
def test_what_is_advised_keeps_thickness_and_rebound(scheme):
    scene = load_scene("rigid-impact").with_values(scheme)
    advice = moving_advice(scene, 0.05)
    taken = moving_advice(scene.with_values(advice.settings), 0.05)
    assert max(taken.sinking_share, taken.landing_share) == pytest.approx(OVERLAP, rel=0.05)
    assert max(1 - taken.rebound[0], taken.rebound[1] - 1) <= 0.05
    longer = moving_advice(scene.with_values(advice.settings | {"time.step": 2 * advice.settings["time.step"]}), 0.05)
    assert max(1 - longer.rebound[0], longer.rebound[1] - 1) > 0.05, "the longest such step"
    assert taken.omega_dt == pytest.approx(taken.frequency * advice.settings["time.step"])
    kept = moving_advice(scene, 0.05, keep_springs=True)
    assert {*kept.settings} == {"time.step"} and kept.stiffness == advice.stiffness
    assert sum(name in " ".join(lines(scene, "rigid-impact", advice)) for name in advice.settings) == 2


def test_where_nothing_touches_or_no_step_does_it_is_refused():
    free = falling([1.0, 1.0], math.inf).definition()
    del free["plane"]["contact"], free["plane"]["touch"]
    with pytest.raises(InputError) as nothing:
        moving_advice(parse_scene(free, "free"), 0.05)
    with pytest.raises(InputError) as no_step:
        moving_advice(load_scene("rigid-impact"), 1e-6)
    assert (nothing.value.field, no_step.value.field) == ("plane.contact", "--error")
