"""Problems as plain data: nothing of a scene is lost, names carry the units, what is infinite has a name."""

from __future__ import annotations

import re

import pytest

from validation.errors import InputError
from validation.models.plane.boxes import boxes_of
from validation.problems.problem import problem
from validation.scenes.plain import scene_data, words
from validation.scenes.scene import load_scene

SI = r"_(m|kg|kg_m2|N|kg_per_m3|Pa|m_per_s2?|deg|rad|rad_per_s|N_per_m|Pa_per_m|Hz|s)$"
WORDS = {"poisson", "hypothesis", "law", "motion", "layers", "joints", "base", "contacts", "settled", "at", "shape"}
WORDS |= {"geometry", "restitution", "blocks", "contact", "fixed", "name", "pairs", "touches"}
WORDS |= {"block", "corner", "on", "edge"}  # of a stated contact


def test_blocks_are_stated_by_what_any_program_needs_to_place_them():
    scene = problem("tumbling").scene
    data = scene_data(scene)["plane"]
    ground, block = data["blocks"]
    (box,) = boxes_of(scene).boxes
    assert block["centroid_m"] == pytest.approx([box.x, box.y], abs=1e-12) and block["angle_rad"] == box.angle
    assert (block["mass_kg"], block["inertia_kg_m2"]) == pytest.approx((box.mass, box.inertia))
    assert min(y for _, y in block["vertices_m"]) == pytest.approx(1.0)
    assert ground["fixed"] and max(y for _, y in ground["vertices_m"]) == 0.0
    assert (data["gravity_m_per_s2"], data["contact"]["friction_deg"]) == ([0.0, -9.81], 0.0)
    assert (data["contact"]["stiffness_N_per_m"], data["contact"]["restitution"]) == ("inf", 1.0)


def test_a_block_that_is_driven_brings_its_record():
    ground, _ = scene_data(problem("shaken").scene)["plane"]["blocks"]
    assert (ground["motion"]["time_s"][135], ground["motion"]["x_m"][135]) == pytest.approx((0.25, 0.1))


def test_a_record_is_no_plain_data():
    with pytest.raises(InputError) as caught:
        scene_data(load_scene("waves-site"))
    assert caught.value.field == "input.shape"


def test_every_number_of_the_data_names_its_unit_and_has_its_words():
    meanings = {name.rpartition(".")[2]: text for name, text in words()}
    assert all(re.search(SI, name) or name in WORDS for name in meanings)
    for name in ("locked", "column", "joint", "impact"):
        for table in scene_data(problem(name).scene).values():
            for key in table if isinstance(table, dict) else ():
                assert re.search(SI, key) or key in WORDS, key


def test_columns_name_their_units():
    assert [problem("joint").named(column) for column in problem("joint").columns] == [
        *("velocity_1_m_per_s", "velocity_2_m_per_s", "force_3_Pa", "slip_3_m"),
    ]
    impact = problem("impact")
    assert (impact.named("box-ground.normal"), impact.named("creep")) == ("box-ground.normal_N", "creep")
