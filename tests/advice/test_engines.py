"""The translator of engines' soft constraints: there and back, and what it refuses."""

import json
from typing import Any

import pytest
from conftest import refused, typed
from oracles.pages import ROOT, page_with

from validation import InputError, translate
from validation.advice.engine_table import PARAMETERS, PROGRAMS

STEP = 1 / 240


@pytest.mark.parametrize(
    ("engine", "parameters"),
    [
        ("box2d", {"hertz": 41.0, "damping_ratio": 0.7}),
        ("bullet", {"erp": 0.2, "cfm": 3e-7}),
        ("mujoco", {"timeconst": 0.03, "dampratio": 1.3}),
    ],
)
def test_there_and_back(engine: str, parameters: dict[str, float]) -> None:
    first = translate(engine, mass=350.0, step=STEP, **parameters)
    spring = {"stiffness": first.stiffness, "damping": first.damping}
    again = translate("spring", mass=350.0, step=STEP, **spring)
    assert {name: again.forms[engine][name] for name in parameters} == pytest.approx(parameters, rel=1e-12)
    for other, form in first.forms.items():
        own = {name: form[name] for name in PARAMETERS[other] if name in form}
        same = translate(other, mass=350.0, step=STEP / 100, **own) if other == "mujoco" else None
        same = same or translate(other, mass=350.0, step=STEP, **own)
        assert (same.stiffness, same.damping) == pytest.approx(tuple(spring.values()), rel=1e-12)


def test_the_way_back_from_a_restitution() -> None:
    for e in (1.0, 0.9, 0.5, 0.1, 0.01):
        assert translate("spring", mass=2.0, stiffness=1e6, restitution=e).restitution == pytest.approx(e, rel=1e-10)
    unclipped = translate("spring", mass=2.0, stiffness=1e6, restitution=0.4509754529)
    assert unclipped.damping_ratio == pytest.approx(0.3, abs=1e-9)


def test_a_block_has_a_quarter_of_its_mass_at_the_contact() -> None:
    block = translate("box2d", block_mass=10800.0, hertz=30, damping_ratio=0.2)
    body = translate("box2d", mass=2700.0, hertz=30, damping_ratio=0.2)
    assert block.mass == 2700.0 and block.stiffness == body.stiffness
    assert block.weight == 4 * body.weight and block.rest_penetration == 4 * body.rest_penetration
    assert block.scene["contact.stiffness"] == block.stiffness / 2
    assert block.scene["contact.damping_ratio"] == pytest.approx(0.1) and body.scene["contact.damping_ratio"] == 0.2


def test_an_impedance_over_the_penetration() -> None:
    constant = translate("mujoco", mass=1.0, timeconst=0.02, dampratio=1.0)
    assert constant.load_share == pytest.approx(0.05)
    curve = translate("mujoco", mass=1.0, timeconst=0.02, dampratio=1.0, solimp=(0.9, 0.95, 0.001, 0.5, 2))
    assert 0.05 < curve.load_share < 0.1 and curve.rest_penetration > constant.rest_penetration


REFUSED: list[tuple[str, dict[str, Any], str]] = [
    ("bulet", {"mass": 1.0}, "engine"),
    ("box2d", {"mass": 1.0, "hertz": 30.0}, "damping_ratio"),
    ("box2d", {"hertz": 30.0, "damping_ratio": 1.0}, "mass, block_mass"),
    ("box2d", {"hertz": 30.0, "damping_ratio": 1.0, "mass": 1.0, "block_mass": 1.0}, "mass, block_mass"),
    ("box2d", {"hertz": -1.0, "damping_ratio": 1.0, "mass": 1.0}, "hertz"),
    ("box2d", {"hertz": float("nan"), "damping_ratio": 1.0, "mass": 1.0}, "hertz"),
    ("box2d", {"hertz": 1.0, "damping_ratio": 1.0, "mass": 0.0}, "mass"),
    ("box2d", {"hertz": 1.0, "damping_ratio": 1.0, "mass": 1.0, "erp": 0.2}, "erp"),
    ("box2d", {"hertz": 1.0, "damping_ratio": 1.0, "mass": 1.0, "step": 0.0}, "step"),
    ("bullet", {"erp": 0.2, "cfm": 1e-5, "mass": 1.0}, "step"),
    ("bullet", {"erp": 0.2, "cfm": 0.0, "mass": 1.0, "step": 0.01}, "cfm"),
    ("bullet", {"erp": 1.2, "cfm": 1e-5, "mass": 1.0, "step": 0.01}, "erp"),
    ("mujoco", {"timeconst": 0.01, "dampratio": 1.0, "mass": 1.0, "step": 0.006}, "timeconst"),
    ("mujoco", {"timeconst": -100.0, "dampratio": 1.0, "mass": 1.0}, "timeconst"),
    ("mujoco", {"timeconst": 0.02, "dampratio": 1.0, "mass": 1.0, "dmax": 1.0}, "dmax"),
    ("mujoco", {"timeconst": 0.02, "dampratio": 1.0, "mass": 1.0, "solimp": (0.9, 0.95)}, "solimp"),
    ("spring", {"stiffness": 1e6, "damping": 1.0, "restitution": 0.5, "mass": 1.0}, "damping, restitution"),
    ("spring", {"stiffness": 1e6, "restitution": 0.0, "mass": 1.0}, "restitution"),
]


@pytest.mark.parametrize(("engine", "parameters", "field"), REFUSED)
def test_what_is_refused(engine: str, parameters: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as error:
        translate(engine, **parameters)
    assert error.value.field == field


def test_the_command_is_the_function() -> None:
    words = ["translate", "box2d", "--hertz", 30, "--damping-ratio", 10, "--step", STEP, "--mass", 2700]
    done = typed(*words, "--json")
    expected = translate("box2d", hertz=30.0, damping_ratio=10.0, step=STEP, mass=2700.0).as_dict()
    assert json.loads(done.stdout) == json.loads(json.dumps(expected))
    page = typed(*words).stdout
    assert "0.2761 mm" in page and "determinant 0.05772068" in page
    assert "solimp" in refused(
        "translate", "mujoco", "--timeconst", 0.02, "--dampratio", 1, "--mass", 1, "--solimp", "a,b"
    )


def test_the_page_has_the_table_of_the_programs() -> None:
    page = (ROOT / "docs/engines.md").read_text(encoding="utf-8")
    rows = ["| program | number | | is | as it comes |", "|---|---|---|---|---|"]
    for program in PROGRAMS.values():
        for one in program.parameters:
            default = " ".join(f"{number:g}" for number in one.default)
            rows.append(f"| {program.title} | `{one.meaning}` | {one.unit} | {one.formula} | {default} |")
    rows += ["", "Checked with, and after:", ""]
    rows += [f"- {one.title} {one.version}: {one.source}." for one in PROGRAMS.values()]
    table = "\n" + "\n".join(rows) + "\n"
    assert page == page_with(table, page, "<!-- programs -->", "<!-- /programs -->")
