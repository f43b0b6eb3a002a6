"""Problems as plain data: nothing of a scene is lost, names carry the units, what is infinite has a name."""

from __future__ import annotations

import json
import re

import pytest

from validation.errors import InputError
from validation.models.plane.boxes import boxes_of
from validation.problems.problem import ASKS, PREFIX, problem
from validation.scenes.plain import scene_data, words
from validation.scenes.scene import load_scene, parse_scene

SI = r"_(m|kg|kg_m2|N|kg_per_m3|Pa|m_per_s2?|deg|rad|rad_per_s|N_per_m|Pa_per_m|Hz|s)$"
WORDS = {"poisson", "hypothesis", "law", "motion", "layers", "joints", "base", "contacts", "settled", "at", "shape"}
WORDS |= {"geometry", "restitution", "blocks", "contact", "fixed", "name", "pairs", "touches"}
WORDS |= {"block", "corner", "on", "edge"}  # of a stated contact


def plain(value):
    """Return plain data by names without their units, what is null left out; what is infinite is a number."""
    if isinstance(value, dict):
        return {re.sub(SI, "", name): plain(part) for name, part in value.items() if part is not None}
    if isinstance(value, list):
        return [plain(part) for part in value]
    return float("inf") if value == "inf" else value


def rebuilt(scene):
    """Return the scene that the plain data of a scene describe."""
    tables = plain(scene_data(scene))
    geometry = tables.pop("geometry", "small")
    tables["run"] = {"geometry": "updated" if geometry == "large rotation" else "small"}
    if "column" in tables:
        column = tables["column"]
        column["layer"] = column.pop("layers")
        springs = [
            {name: value for name, value in spring.items() if (name, value) != ("strength", float("inf"))}
            for spring in column.pop("contacts", column.pop("joints", []))
        ]
        column["joint"] = springs
    if tables.get("input", ...) is None:
        del tables["input"]
    return parse_scene({"name": scene.name, "time": {"step": 1.0, "steps": 1}} | tables, "plain data")


def motion_data(scene):
    """Return what the motion of a scene depends on, as its own tables have it."""
    if scene.column is not None:
        column = scene.column
        drive = scene.stated_input
        return {
            "contacts": column.contacts,
            "springs": [(spring.height, spring.stiffness) for spring in column.springs] if not column.contacts else [],
            "layers": [layer.model_dump(exclude={"blocks"}) for layer in column.layer],
            "rest": column.model_dump(include={"motion", "law", "settled", "heights", "glue"}),
            "impedance": column.impedance,
            "input": None if drive is None else drive.model_dump(),
        }
    contact = scene.contact.model_dump() | {"shear_stiffness": scene.contact.shear}
    block = scene.block.model_dump(exclude={"side", "width", "height"}) | {"outline": scene.block.outline}
    return block | contact | scene.load.model_dump() | {"geometry": scene.run.geometry}


VARIANTS = [
    *((PREFIX + name, {}) for name in ASKS),
    (
        "field-locked",
        {"load.eccentricity": 0.1, "load.traction": 3.0, "block.poisson": 0.2, "block.width": 3.0, "block.height": 2.5},
    ),
    ("field-locked", {"block.poisson": 0.2, "block.hypothesis": "plane strain", "contact.shear_stiffness": 7.0}),
    ("field-opening", {"contact.gap": 0.1, "contact.friction": 20.0, "contact.cohesion": 5.0}),
    ("field-locked", {"load.gravity": 3.0, "load.slope": 5.0}),
    ("columns-shaken", {}),
    ("columns-joint", {"input.shape": "cosine"}),
    ("columns-slips", {}),
    ("columns-mass-ratio", {"column.base": "springs", "column.base_stiffness": 3e9}),
    ("field-stack", {"column.settled": True}),
    ("field-cradle", {"column.stiffness": "inf"}),
    ("field-joint", {"column.joint": [{"height": 40.0, "stiffness": "inf"}]}),
]


@pytest.mark.parametrize(("name", "values"), VARIANTS)
def test_nothing_of_a_scene_is_lost(name, values):
    scene = load_scene(name).with_values(values)
    assert motion_data(rebuilt(scene)) == motion_data(scene)
    if values:
        assert scene_data(scene) != scene_data(load_scene(name))


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


def test_what_is_infinite_stands_in_json_as_inf():
    column = scene_data(load_scene("field-stack"))["column"]
    assert {layer["young_Pa"] for layer in column["layers"]} == {"inf"}
    assert [contact["height_m"] for contact in column["contacts"]] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert [contact["gap_m"] for contact in column["contacts"]] == [0.005, 0.0005, 0.0005, 0.0005, 0.0005]
    assert json.loads(json.dumps(column, allow_nan=False)) == column
    assert scene_data(load_scene("field-joint"))["column"]["contacts"][0]["strength_Pa"] == 1e5


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
