"""Problems as plain data: nothing of a scene is lost, the names carry the units, the version moves with the data."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import pytest

from validation.problems.data import (
    PACK,
    BlockData,
    ColumnData,
    ContactData,
    LoadData,
    block_data,
    column_data,
    contact_data,
    load_data,
    meaning,
    united,
)
from validation.problems.problem import PREFIX, PROBLEMS
from validation.scenes.scene import Scene, load_scene, parse_scene

SI = ("_m", "_kg_per_m3", "_Pa", "_m_per_s", "_deg", "_N_per_m", "_m_per_s2", "_Pa_per_m", "_Pa_s_per_m", "_Hz", "_s")
# of the data of each version; where one differs the version must be another one, so that no submission to the
# earlier problem is judged by the new one
KNOWN = {"2.0": "8610b1ba23137e10"}


def of_block(block: BlockData, contact: ContactData, load: LoadData, geometry: str) -> dict[str, Any]:
    """Return the tables of a scene that the plain data describe."""
    own: dict[str, Any] = {
        "law": contact.law,
        "stiffness": contact.normal_stiffness_N_per_m,
        "shear_stiffness": contact.shear_stiffness_N_per_m,
    }
    own |= {"friction": contact.friction_deg} if contact.friction_deg is not None else {}
    own |= {"cohesion": contact.cohesion_Pa} if contact.cohesion_Pa else {}
    own |= {"gap": contact.gap_m} if contact.gap_m else {}
    return {
        "block": {
            "width": block.width_m,
            "height": block.height_m,
            "density": block.density_kg_per_m3,
            "young": block.young_Pa,
            "poisson": block.poisson,
            "hypothesis": block.hypothesis,
            "velocity": block.velocity_m_per_s,
            "tilt": block.tilt_deg,
        },
        "contact": own,
        "load": {
            "pressure": load.pressure_Pa,
            "eccentricity": load.eccentricity_m,
            "traction": load.traction_Pa,
            "gravity": load.gravity_m_per_s2,
            "slope": load.slope_deg,
        },
        "run": {"geometry": "updated" if geometry == "large rotation" else "small"},
    }


def of_column(column: ColumnData) -> dict[str, Any]:
    """Return the tables of a scene that the plain data describe; the impedance stands for density and speed."""
    base = column.base
    below = {"base_density": base.impedance_Pa_s_per_m, "base_speed": 1.0} if base.impedance_Pa_s_per_m else {}
    below |= {"base_stiffness": base.stiffness_Pa_per_m} if base.stiffness_Pa_per_m else {}
    layers = [
        {"thickness": one.thickness_m, "density": one.density_kg_per_m3, "young": one.young_Pa, "poisson": one.poisson}
        for one in column.layers
    ]
    joints = [{"height": one.height_m, "stiffness": one.stiffness_Pa_per_m} for one in column.joints]
    drive = column.input
    given = {
        "velocity": drive.velocity_m_per_s,
        "pressure": drive.pressure_Pa,
        "frequency": drive.frequency_Hz,
        "duration": drive.duration_s,
    }
    return {
        "column": {
            "motion": column.motion,
            "base": base.kind,
            "heights": list(column.heights_m),
            "layer": layers,
            "joint": joints,
            **below,
        },
        "input": {"at": drive.at, "shape": drive.shape} | {k: v for k, v in given.items() if v is not None},
    }


def rebuilt(scene: Scene) -> Scene:
    """Return the scene that the plain data of a scene describe."""
    column = column_data(scene)
    if column is None:
        geometry = "large rotation" if scene.run.geometry == "updated" else "small"
        tables = of_block(block_data(scene), contact_data(scene), load_data(scene), geometry)
    else:
        tables = of_column(column)
    return parse_scene({"name": scene.name, "time": {"step": 1.0, "steps": 1}} | tables, "plain data")


def seen(scene: Scene) -> dict[str, Any]:
    """Return what a scene's motion depends on."""
    if scene.column is not None:
        assert scene.column.law == "bonded"  # no problem's contacts open or slip yet
        contacts = {"law", "stiffness", "gap", "strength", "friction", "gravity", "settled", "solve_limit"}
        plain = scene.column.model_dump(exclude={"base_density", "base_speed", *contacts})
        for layer in plain["layer"]:
            del layer["blocks"], layer["velocity"]  # a code of blocks has its own
        for joint in plain["joint"]:
            del joint["gap"], joint["strength"], joint["friction"]
        return plain | {"impedance": scene.column.impedance, "input": scene.input.model_dump()}
    block = scene.block.model_dump(exclude={"side", "width", "height"}) | {"outline": scene.block.outline}
    contact = scene.contact.model_dump() | {"shear_stiffness": scene.contact.shear}
    load = scene.load.model_dump(exclude={"ramp"})  # no exact motion is known under a ramp, and so no problem has one
    return block | contact | load | {"geometry": scene.run.geometry}


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


def test_every_number_of_the_data_names_its_unit() -> None:
    for data in (BlockData, ContactData, LoadData, ColumnData):
        for name in data.model_fields:
            plain = name in ("poisson", "hypothesis", "law", "motion", "layers", "joints", "base", "input")
            assert plain or name.endswith(SI), name
    assert united("displacement_2") == "displacement_2_m" and united("stress_1") == "stress_1_Pa"
    assert united("rotation") == "rotation_rad" and united("contact_pressure") == "contact_pressure_Pa"
    assert meaning("displacement_2").startswith("displacement at the 2. of the heights")


def test_the_version_of_the_pack_is_that_of_its_data() -> None:
    data = []
    for name in PROBLEMS:
        scene = load_scene(PREFIX + name)
        data.append([name, seen(scene), scene.time.step, scene.time.steps, scene.run.columns])
    found = hashlib.sha256(json.dumps(data, sort_keys=True, default=str).encode()).hexdigest()[:16]
    assert KNOWN.get(PACK) == found, "the data of a problem differ: give the pack another version, PACK"
