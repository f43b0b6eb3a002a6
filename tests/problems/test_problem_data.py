"""Problems as plain data: nothing of a scene is lost, the names carry the units, the version moves with the data."""

from __future__ import annotations

import json
import re
from dataclasses import astuple
from typing import Any

import pytest
from pydantic import BaseModel

from validation.errors import InputError
from validation.problems.data import (
    BlockData,
    ColumnContactData,
    ColumnData,
    ContactData,
    InputData,
    JointData,
    LayerData,
    LoadData,
    block_data,
    column_data,
    contact_data,
    load_data,
    meaning,
    united,
)
from validation.problems.problem import PREFIX, PROBLEMS
from validation.scenes.column import ColumnSection
from validation.scenes.scene import Scene, load_scene, parse_scene

SI = ("_m", "_kg_per_m3", "_Pa", "_m_per_s", "_deg", "_N_per_m", "_m_per_s2", "_Pa_per_m", "_Pa_s_per_m", "_Hz", "_s")
# of the data of each version; where one differs the version must be another one, so that no submission to the
# earlier problem is judged by the new one


def plain(data: BaseModel, *without: str) -> dict[str, Any]:
    """Return what is stated in plain data, by names without their units; what is infinite is a number."""
    unit = re.compile(f"({'|'.join(SI)})$")
    stated = {unit.sub("", name): value for name, value in data if value is not None}
    numbers = {name: value for name, value in stated.items() if value and name not in without}
    return {name: float("inf") if value == "inf" else value for name, value in numbers.items()}


def of_column(column: ColumnData) -> dict[str, Any]:
    """Return the tables of a scene that the plain data describe; the impedance stands for density and speed."""
    base = plain(column.base)
    below = {"base_density": base["impedance"], "base_speed": 1.0} if "impedance" in base else {}
    below |= {"base_stiffness": base["stiffness"]} if "stiffness" in base else {}
    springs = column.joints if column.law == "bonded" else column.contacts
    return {
        "column": {
            **plain(column, "layers", "joints", "contacts", "input"),
            "base": base["kind"],
            "layer": [plain(layer) for layer in column.layers],
            "joint": [{"height": 0.0} | plain(spring) for spring in springs],
            **below,
        },
        **({"input": plain(column.input)} if column.input else {}),
    }


def rebuilt(scene: Scene) -> Scene:
    """Return the scene that the plain data of a scene describe."""
    column = column_data(scene)
    if column is None:
        contact = plain(contact_data(scene))
        contact["stiffness"] = contact.pop("normal_stiffness")
        tables = {
            "block": plain(block_data(scene), "thickness"),
            "contact": contact,
            "load": plain(load_data(scene)),
            "run": {"geometry": scene.run.geometry},
        }
    else:
        tables = of_column(column)
    return parse_scene({"name": scene.name, "time": {"step": 1.0, "steps": 1}} | tables, "plain data")


def seen(scene: Scene) -> dict[str, Any]:
    """Return what a scene's motion depends on."""
    if scene.column is not None:
        return seen_of_column(scene, scene.column)
    block = scene.block.model_dump(exclude={"side", "width", "height"}) | {"outline": scene.block.outline}
    # no problem has a dashpot, an impact law or passes of an augmented Lagrangian
    contact = scene.contact.model_dump(exclude={"damping_ratio", "restitution", "penetration"})
    contact["shear_stiffness"] = scene.contact.shear
    load = scene.load.model_dump(exclude={"ramp"})  # no exact motion is known under a ramp, and so no problem has one
    return block | contact | load | {"geometry": scene.run.geometry}


def seen_of_column(scene: Scene, column: ColumnSection) -> dict[str, Any]:
    """Return what the motion of a column depends on; a code of blocks has its own number of them in a bar."""
    plain = column.model_dump(include={"motion", "law", "layer", "glue", "settled", "heights"})
    for layer in plain["layer"]:
        del layer["blocks"]
    # springs below a column whose contacts open or slip are the lowest of these
    base = "rigid" if column.base == "springs" and column.contacts else column.base
    springs = [(joint.height, joint.stiffness) for joint in column.springs] if column.law == "bonded" else []
    drive = scene.stated_input.model_dump() if scene.stated_input is not None else None
    return plain | {
        "base": base,
        "springs": springs,
        "contacts": [astuple(contact) for contact in column.contacts],
        "gravity": column.gravity if column.law == "unilateral" else 0.0,
        "impedance": column.impedance,
        "input": drive,
    }


@pytest.mark.parametrize("name", PROBLEMS)
def test_nothing_of_a_problem_is_lost(name: str) -> None:
    scene = load_scene(PREFIX + name)
    assert seen(rebuilt(scene)) == seen(scene)


@pytest.mark.parametrize(
    "values",
    [
        {"load.eccentricity": 0.1, "load.traction": 3.0, "block.poisson": 0.2, "block.hypothesis": "plane strain"},
        {"contact.law": "unilateral", "contact.gap": 0.1, "contact.friction": 20.0, "contact.cohesion": 5.0},
        {"load.gravity": 3.0, "load.slope": 5.0, "contact.shear_stiffness": 7.0},
    ],
)
def test_nothing_of_another_scene_is_lost(values: dict[str, Any]) -> None:
    scene = load_scene(f"{PREFIX}locked").with_values(values)
    assert seen(rebuilt(scene)) == seen(scene) != seen(load_scene(f"{PREFIX}locked"))


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("columns-shaken", {}),
        ("columns-joint", {"input.shape": "cosine"}),
        ("columns-slips", {}),
        ("columns-spall-bars", {}),
        ("columns-mass-ratio", {"column.base": "springs", "column.base_stiffness": 3e9}),
        ("field-stack", {"column.settled": True}),
        ("field-cradle", {"column.stiffness": "inf"}),
        ("field-joint", {"column.joint": [{"height": 40.0, "stiffness": "inf"}]}),
    ],
)
def test_nothing_of_another_column_is_lost(name: str, values: dict[str, Any]) -> None:
    scene = load_scene(name).with_values(values)
    assert seen(rebuilt(scene)) == seen(scene)


def test_what_is_infinite_stands_in_json_as_inf() -> None:
    data = column_data(load_scene("field-stack"))
    assert data is not None
    assert {layer.young_Pa for layer in data.layers} == {"inf"}
    assert [contact.height_m for contact in data.contacts] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert [contact.gap_m for contact in data.contacts] == [0.005, 0.0005, 0.0005, 0.0005, 0.0005]
    assert ColumnData.model_validate_json(json.dumps(data.model_dump(mode="json"), allow_nan=False)) == data
    assert column_data(load_scene("field-joint")).contacts[0].strength_Pa == 1e5
    assert column_data(load_scene("field-cradle")).contacts[0].strength_Pa is None


def test_a_record_is_no_plain_data() -> None:
    with pytest.raises(InputError) as caught:
        column_data(load_scene("waves-site").with_values({}))
    assert caught.value.field == "input.shape"


def test_every_number_of_the_data_names_its_unit() -> None:
    for data in (BlockData, ContactData, LoadData, ColumnData, LayerData, JointData, ColumnContactData, InputData):
        for name in data.model_fields:
            plain = name in ("poisson", "hypothesis", "law", "motion", "layers", "joints", "base", "input")
            plain |= name in ("contacts", "settled", "at", "shape")
            assert plain or name.endswith(SI), name
    assert united("displacement_2") == "displacement_2_m" and united("stress_1") == "stress_1_Pa"
    assert united("rotation") == "rotation_rad" and united("contact_pressure") == "contact_pressure_Pa"
    assert united("velocity_1") == "velocity_1_m_per_s" and united("force_12") == "force_12_Pa"
    assert (united("gap_3"), united("slip_3")) == ("gap_3_m", "slip_3_m")
    for name in ("velocity_2", "force_2", "gap_2", "slip_2"):
        assert "the 2. of the heights" in meaning(name)
    assert meaning("displacement_2").startswith("displacement at the 2. of the heights")
