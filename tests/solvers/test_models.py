"""What kinds of scenes draw, measure and advise, against closed forms, row by row."""

import math

import numpy as np
import pytest
from oracles.made_cases import made_history
from oracles.stated_scenes import made

from validation import exact
from validation.advice.goals import Question
from validation.advice.hooks import AdviceHooks
from validation.advice.pages import PageHooks
from validation.models.block.advice import _moves_as_a_whole
from validation.models.column import pages as column_pages
from validation.models.plane import pages
from validation.models.plane.history import PlaneColumns
from validation.models.plane.limits import leaning_friction, recursion, seat_forces, stepped_dip
from validation.models.plane.measures import contact_time, peak
from validation.scenes.scene import load_scene
from validation.solvers.hooks import SolvingHooks
from validation.solvers.registry import get_solver
from validation.solvers.rigid.sliding import rigid_slide


def test_columns_of_what_moves_start_at_zero_but_poses():
    names = ("a.x", "a.angle", "a.vx", "momentum.x", "a.0-b.2.normal")
    assert [PlaneColumns()[name].from_zero for name in names] == [False, False, True, True, True]


GAPS = [  # at rows 0.5 s apart, and how long they are closed for the first time
    ([1.0, 0.5, -0.5, -1.5, 0.5, -1.0, 1.0], 2.25 * 0.5),
    ([-1.0, 1.0, -1.0, 1.0], None),
    ([1.0, -1.0, -1.0], None),
    ([1.0, 2.0], None),
]


def test_contact_lasts_from_where_the_gap_closes_to_where_it_opens():
    for gap, lasts in GAPS:
        found = contact_time(made_history(0.5, gap), np.array(gap))
        assert found == (lasts and pytest.approx(lasts)), gap


def test_the_peak_of_a_flat_top_is_its_height():
    """Of three values that differ by rounding alone no parabola has a curvature."""
    assert peak(np.array([0.5, np.nextafter(1.0, 0.0), 1.0, 1.0])) == 1.0
    assert peak(np.array([0.5, 2.9, 3.1, 1.7])) == pytest.approx(3.1 + 1.2**2 / (8 * 1.6))


def test_no_step_is_short_enough_for_a_rigid_stop(tmp_path):
    scene = made("turning", tmp_path).with_values({"contact.stiffness": math.inf})
    assert get_solver("dda").prepare(scene).highest_frequency() == math.inf


def test_piles_and_columns_stand_as_before():
    heights = [1.3, 2.9, 4.1]
    assert np.ravel(seat_forces(2, 3.1, 0.7)) == pytest.approx([10 / 13, 3 / 13, 18 / 11, 4 / 11])
    assert leaning_friction(0.9, 5.3) == pytest.approx(0.302435951)
    assert recursion(heights, 0.7, 0.3, 0.31, 0.62) == pytest.approx(0.594431200)
    assert stepped_dip(heights, 0.7, 0.3, 0.62) == pytest.approx(0.217121793)


def test_both_corners_of_a_block_land_when_it_has_fallen():
    block = {"width": 2.0, "height": 1.0, "density": 2500.0, "young": 1e9, "stiffness": 2e6}
    found = exact.unilateral_block([0.012], **block, gap=1e-2, velocity=-1.0)
    assert (found.closings, found.openings) == (pytest.approx((0.01, 0.01), rel=1e-9), ())


def test_a_rigid_mass_slides_by_what_friction_and_cohesion_leave():
    values = {"load": {"gravity": 9.81, "slope": 30.0}, "time.step": 0.1, "time.steps": 3}
    contact = {"law": "unilateral", "stiffness": 1e9, "shear_stiffness": 4e8, "friction": 20.0, "cohesion": 3e3}
    scene = load_scene("figures-3-4").expand()[0].with_values(values | {"contact": contact, "block.side": 2.0})
    loose = scene.with_values({"contact.friction": 0.0, "contact.cohesion": 0.0})
    assert rigid_slide(loose).slide[-1] == pytest.approx(9.81 * 0.5 * 0.3**2 / 2)
    held = 9.81 * math.tan(math.radians(20)) * math.cos(math.radians(30)) + 3e3 * 2.0 / scene.block.mass
    assert rigid_slide(scene).slide[-1] == pytest.approx((9.81 * 0.5 - held) * 0.3**2 / 2)


def test_a_scene_of_the_same_size_has_other_springs_or_another_mass(tmp_path):
    block = load_scene("figures-3-4").expand()[0]
    stops = {"law": "unilateral", "stiffness": math.inf, "shear_stiffness": 0.0}
    scenes = block, block.with_values({"contact": stops}), made("layers on springs", tmp_path)
    changes = [SolvingHooks.of(scene).scaled(scene, 1.7) for scene in scenes]
    assert changes[0] == {"contact.stiffness": block.contact.stiffness * 1.7}
    assert changes[1] == {"block.density": block.block.density * 1.7}
    assert [layer["density"] for layer in changes[2]["column.layer"]] == [3400.0, 3060.0]


def test_a_block_with_friction_moves_as_a_whole_on_a_slope():
    block = load_scene("figures-3-4").expand()[0]
    rough = {"contact": {"law": "unilateral", "stiffness": 1e9, "shear_stiffness": 4e8, "friction": 20.0}}
    scenes = [block, *(block.with_values(rough | {"load.gravity": 9.81, "load.slope": slope}) for slope in (0.0, 5.0))]
    assert [_moves_as_a_whole(scene) for scene in scenes] == [False, False, True]


def test_a_block_is_cut_into_rows_and_one_row_leaves_it_whole():
    block = load_scene("figures-3-4").expand()[0]
    cut = AdviceHooks.of(block).cut
    assert cut(block, [1]) is block
    assert [cut(scene, [3]).block.subdivide for scene in (block, cut(block, [2]))] == [(1, 3), (1, 3)]


def test_a_page_says_how_a_beam_and_a_column_are_cut(monkeypatch, tmp_path):
    monkeypatch.setattr(pages, "ELEMENTS", 2)
    monkeypatch.setattr(column_pages, "truth_of", lambda case: None)  # elements take less time
    beam = load_scene("patch-strip").expand()[0]
    column = made("layers on springs", tmp_path)  # whose input has no frequency of its own
    (of_beam,), (of_column,) = (
        PageHooks.of(scene).page(scene, Question(error=0.3))[0]["recommendations"] for scene in (beam, column)
    )
    assert of_beam["settings"] == {"plane.subdivide": [2, 1], "plane.pattern": "squares", "time.step": 10.0}
    assert (of_beam["displacement_error"], of_beam["uncertainty"]) == pytest.approx((0.125, 0.0), abs=1e-9)
    assert [layer["blocks"] for layer in of_column["settings"]["column.layer"]] == [1, 2]
    numbers = of_column["settings"]["time.step"], of_column["displacement_error"], of_column["duration"]
    assert numbers == pytest.approx((6.3934121e-3, 0.054649793, 1.27868242e-2), rel=1e-7)
