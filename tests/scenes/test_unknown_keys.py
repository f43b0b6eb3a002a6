"""Unknown keys of a scene: all of them first, in one error, each with the key that was probably meant."""

from __future__ import annotations

from typing import Any

import pytest

from validation.errors import InputError
from validation.scenes.scene import load_scene, parse_scene

BLOCK = {"block": {"side": 2.0, "density": 2700.0, "young": 1e9}, "contact": {"stiffness": 1e9}}
SCENE = BLOCK | {"load": {"pressure": 5e6}, "time": {"step": 0.002, "steps": 100}}
MEANT = {  # a key of a scene, as people write it, to the key that is meant
    "block.dt": "time.step",
    "time.dt": "time.step",
    "dt": "time.step",
    "time.stepp": "time.step",
    "time.n_steps": "time.steps",
    "time.gamma": "time.delta",
    "time.beta": "time.alpha",
    "time.Delta": "time.delta",
    "time.gg-rate": "time.gg_rate",
    "time.unstable": "time.allow_unstable",
    "time.integrator": "time.scheme",
    "block.scheme": "time.scheme",
    "time.rhoinf": "time.rho_inf",
    "time.rho_infinity": "time.rho_inf",
    "contact.zeta": "contact.damping_ratio",
    "contact.cor": "contact.restitution",
    "contact.tolerance": "contact.penetration",
    "block.E": "block.young",
    "block.youngs_modulus": "block.young",
    "block.rho": "block.density",
    "time.rho": "block.density",
    "block.nu": "block.poisson",
    "block.heigth": "block.height",
    "block.Width": "block.width",
    "block.friction": "contact.friction",
    "contact.p": "contact.stiffness",
    "contact.penalty": "contact.stiffness",
    "contact.stifness": "contact.stiffness",
    "contact.phi": "contact.friction",
    "contact.friction_angle": "contact.friction",
    "load.presure": "load.pressure",
    "load.g": "load.gravity",
    "gravity": "load.gravity",
    "load.angle": "load.slope",
    "load.base-motion": "load.base_motion",
    "fem.element": "fem.elements",
    "fem.order": "fem.degree",
    "damping.a0": "damping.mass",
    "run.solver": "run.solvers",
    "solver": "run.solvers",
    "blocks.side": "block",
    "material.young": "block",
    "sweep.time.stepp": "time.step",
    "sweep.dt": "time.step",
    "name": "title",
}


def with_key(field: str) -> dict[str, Any]:
    """Return a scene's data with a key of the value 1 added."""
    data: dict[str, Any] = {table: dict(keys) for table, keys in SCENE.items()}
    place, _, key = field.rpartition(".")
    if field.startswith("sweep."):
        place, _, key = field.partition(".")
    (data.setdefault(place, {}) if place else data)[key] = 1
    return data


@pytest.mark.parametrize(("field", "meant"), [pair for pair in MEANT.items() if pair[0] != "name"])
def test_the_key_that_was_meant_is_named(field: str, meant: str) -> None:
    with pytest.raises(InputError) as refused:
        parse_scene(with_key(field), "x.toml")
    assert refused.value.rule == "unknown key" and refused.value.source == "x.toml"
    assert refused.value.field == field or field.startswith(f"{refused.value.field}.")  # of a table, the table
    assert refused.value.advice == f"did you mean {meant}?"


def test_all_of_them_come_in_one_error_before_any_other(tmp_path: Any) -> None:
    path = tmp_path / "x.toml"
    path.write_text(
        'name = "x"\n[block]\nside = -2.0\ndt = 0.1\n[time]\nstepp = -1\n[sweep]\n"time.gama" = [1]\n'
        "[[gate]]\npear = 1\n[nonsense]\nkey = 1\n"
    )
    with pytest.raises(InputError) as refused:
        load_scene(path)
    assert refused.value.rule == "unknown keys"
    assert refused.value.field == "name, block.dt, time.stepp, sweep.time.gama, gate.0.pear, nonsense"
    assert refused.value.advice == (
        "did you mean title for name, time.step for block.dt, time.step for time.stepp, "
        "time.delta for sweep.time.gama, gate.pair for gate.0.pear? dda-validate list keys names all"
    )


def test_keys_of_a_column_are_looked_for_in_the_tables_of_a_column() -> None:
    data = {"column": {"motion": "pressure", "layer": [{"thickness": 1.0, "E": 1e9, "nu": 0.2}], "young": 1e9}}
    with pytest.raises(InputError) as refused:
        parse_scene(data, "x.toml")
    assert refused.value.field == "column.layer.0.E, column.layer.0.nu, column.young"
    assert str(refused.value).count("column.layer.young for") == 2
    assert "column.layer.poisson for column.layer.0.nu" in str(refused.value)


def test_very_many_are_counted() -> None:
    data = SCENE | {f"unknown_{number}": number for number in range(40)}
    with pytest.raises(InputError) as refused:
        parse_scene(data, "x.toml")
    assert str(refused.value.field).endswith(" and 10 more")


OF_BOXES = {  # the same in a scene of rigid boxes
    "rigid.mu": "rigid.friction",
    "rigid.friction_coefficient": "rigid.friction",
    "rigid.e": "rigid.restitution",
    "rigid.bounce": "rigid.restitution",
    "rigid.g": "rigid.gravity",
    "rigid.angle": "rigid.slope",
    "rigid.kn": "rigid.stiffness",
    "rigid.box.mass": "rigid.box.density",
    "rigid.box.omega": "rigid.box.spin",
    "rigid.box.angle": "rigid.box.tilt",
    "rigid.box.w": "rigid.box.width",
    "rigid.step": "time.step",
}


@pytest.mark.parametrize(("field", "meant"), OF_BOXES.items())
def test_the_key_of_rigid_boxes_that_was_meant_is_named(field: str, meant: str) -> None:
    box: dict[str, Any] = {"width": 1.0, "height": 1.0, "density": 2500.0}
    data: dict[str, Any] = {"rigid": {"box": [box]}, "time": {"step": 0.01, "steps": 10}}
    place, _, key = field.rpartition(".")
    {"rigid": data["rigid"], "rigid.box": box}[place][key] = 1.0
    with pytest.raises(InputError) as refused:
        parse_scene(data, "boxes")
    assert refused.value.advice == f"did you mean {meant}?"
