"""What is advised for other programs: there and back, scenes, and what cannot be had."""

import json
import math
from typing import Any

import pytest
from conftest import refused, typed
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from validation import InputError, advise_engine, translate
from validation.advice.engine_settings import PROGRAMS_ADVISED, EngineAdvice, Landing, Targets, advise_landing
from validation.scenes.scene import Scene, load_scene, parse_scene

GRAVITY = 9.81
RIGID = {
    "rigid": {"box": [{"width": 1.2, "height": 0.7, "density": 2500.0, "lift": 0.05}], "restitution": 0.3},
    "time": {"step": 0.01, "steps": 100},
}


def box_scene(**box: Any) -> Scene:
    """Return a scene of a rigid box."""
    data = {**RIGID, "rigid": {**RIGID["rigid"], "box": [{**RIGID["rigid"]["box"][0], **box}]}}
    return parse_scene(data, "box")


def back(advice: EngineAdvice, box: tuple[float, float] | None) -> Any:
    """Return the translation of what is advised."""
    parameters = dict(advice.settings)
    for name in ("restitution", "restitution_threshold", "gamma", "beta", "dt"):
        parameters.pop(name, None)
    if "solref" in parameters:
        parameters["timeconst"], parameters["dampratio"] = parameters.pop("solref")
    sides = box if advice.program == "box2d" else None
    common = {"mass": advice.mass, "points": advice.points, "box": sides, "static": True}
    return translate(advice.program, step=advice.step, **common, **parameters)


MASSES = st.floats(0.3, 3000.0)
STEPS = st.floats(1 / 2000, 1 / 60)
DEPTHS = st.floats(math.log(1e-5), math.log(1e-2)).map(math.exp)
SIDES = st.tuples(st.floats(0.1, 3.0), st.floats(0.1, 3.0))


@pytest.mark.parametrize("program", PROGRAMS_ADVISED)
@settings(deadline=None, max_examples=25)  # a translation steps 200 landings
@given(mass=MASSES, step=STEPS, penetration=DEPTHS, box=st.none() | SIDES)
def test_a_translation_of_what_is_advised_is_what_was_wanted(
    program: str, mass: float, step: float, penetration: float, box: tuple[float, float] | None
) -> None:
    landing = Landing(mass, mass * GRAVITY, 0.0, None, box)
    if program == "yade":
        step = min(step, math.sqrt(penetration / GRAVITY))
    try:
        advice = advise_landing(landing, program, Targets(penetration), step=step)
    except InputError as error:
        assert error.field == "--penetration"
        assume(False)
    translation = back(advice, box)
    assert translation.rest_penetration == pytest.approx(penetration, rel=1e-9)
    assert advice.penetration == pytest.approx(penetration, rel=1e-9)
    expected = (advice.stiffness, advice.damping, advice.damping_ratio)
    values = (translation.stiffness, translation.damping, translation.damping_ratio)
    assert values == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("program", ["mujoco", "pybullet", "yade"])
@pytest.mark.parametrize("e", [0.21, 0.54, 0.83])
def test_a_restitution_is_that_of_the_translation_where_the_weight_does_not_matter(program: str, e: float) -> None:
    landing = Landing(7.3, 7.3 * GRAVITY, 300.0)  # w V / g is 1e4 and above
    advice = advise_landing(landing, program, Targets(3.7e-4, e), step=1 / 1900)
    translation = back(advice, None)
    assert advice.rebound == pytest.approx(translation.rebound, abs=2e-3)
    assert translation.rebound["mean"] == pytest.approx(e, abs=5e-3)
    assert translation.numerical_ratio == pytest.approx(advice.hidden)


def test_a_box_of_a_scene_lands_as_it_falls() -> None:
    advice = advise_engine(box_scene(), "pybullet", penetration=1e-3, restitution=0.3)
    assert advice.mass == pytest.approx(2500 * 1.2 * 0.7)
    assert advice.step == 1 / 240  # of the program: the scene's is the interval of its rows
    stated = advise_engine(
        box_scene(lift=0.0), "pybullet", penetration=1e-3, restitution=0.3, speed=math.sqrt(2 * 9.81 * 0.05)
    )
    assert stated.settings == pytest.approx(advice.settings)


def test_a_block_of_a_scene_is_taken_with_its_load_and_its_stiffness() -> None:
    scene = load_scene("field-rebound").with_values({"load.pressure": 1e5})
    advice = advise_engine(scene, "opensees", penetration=1e-4)
    block = scene.block
    load = block.mass * scene.load.gravity + 1e5 * block.base_length
    assert advice.stiffness == pytest.approx(load / 1e-4)
    assert advice.stiffness_ratio == pytest.approx(advice.stiffness / block.young)  # a square
    assert advice.step == scene.time.step


def test_hidden_damping_shortens_the_step_of_pybullet_only() -> None:
    landing = Landing(10.0, 98.1)
    long = advise_landing(landing, "pybullet", Targets(1e-4, hidden=0.5))
    assert long.step == 1 / 240
    short = advise_landing(landing, "pybullet", Targets(1e-4, hidden=0.01))
    assert short.hidden == pytest.approx(0.01)
    assert short.omega_step == pytest.approx(0.02, rel=1e-3)  # W / 2
    for program in ("mujoco", "opensees"):
        assert advise_landing(landing, program, Targets(1e-4, hidden=0.01)).hidden == 0.0
    alpha = advise_landing(landing, "yade", Targets(1e-4, hidden=0.01)).settings["local_damping"]
    assert alpha == pytest.approx(0.01 * math.pi, rel=1e-3)


BALL = Landing(10.0, 98.1, 1.0)
REFUSED: list[tuple[str, Targets, dict[str, Any], str]] = [
    ("ode", Targets(1e-3), {}, "--for"),
    ("mujoco", Targets(), {}, "--penetration, --restitution, --hidden-damping"),
    ("mujoco", Targets(-1e-3), {}, "--penetration"),
    ("mujoco", Targets(float("nan")), {}, "--penetration"),
    ("mujoco", Targets(1e-3, 1.1), {}, "--restitution"),
    ("mujoco", Targets(1e-3), {"step": 0.0}, "--step"),
    ("mujoco", Targets(1e-3), {"points": 0}, "--points"),
    ("mujoco", Targets(1e-9), {"step": 0.01}, "--penetration"),
    ("mujoco", Targets(1e-7, 0.5), {"step": 0.01}, "--penetration, --restitution"),
    ("box2d", Targets(1e-7), {}, "--penetration"),
    ("box2d", Targets(1e-3, hidden=0.01), {}, "--hidden-damping"),
    ("pybullet", Targets(restitution=0.5), {}, "--penetration"),
    ("pybullet", Targets(1e-5), {}, "--penetration"),
    ("pybullet", Targets(1e-3, 1.0), {}, "--restitution"),
    ("pybullet", Targets(1e-4, hidden=0.01), {"step": 0.01}, "--hidden-damping"),
    ("yade", Targets(1e-3, 0.0), {}, "--restitution"),
    ("yade", Targets(1e-3, 0.5, 0.01), {}, "--hidden-damping"),
    ("yade", Targets(1e-3), {"step": 0.1}, "--step"),
    ("opensees", Targets(1e-3, 0.5), {}, "--restitution"),
    ("opensees", Targets(hidden=0.01), {}, "--penetration"),
]


@pytest.mark.parametrize(("program", "targets", "options", "field"), REFUSED)
def test_what_cannot_be_had(program: str, targets: Targets, options: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as error:
        advise_landing(BALL, program, targets, **options)
    assert error.value.field == field


@pytest.mark.long
def test_what_a_refusal_offers_can_be_had() -> None:
    for program, targets, options in (
        ("box2d", Targets(1e-7), {"step": 1 / 240}),
        ("pybullet", Targets(1e-3, 0.9), {"step": 1 / 60}),
        ("mujoco", Targets(1e-7, 0.5), {"step": 0.01}),
        ("yade", Targets(1e-4), {"step": 0.1}),
    ):
        with pytest.raises(InputError) as error:
            advise_landing(BALL, program, targets, **options)
        words = error.value.advice.split()
        step = float(words[words.index("s") - 1]) * (1 - 1e-3)  # of four digits
        assert advise_landing(BALL, program, targets, step=step).penetration == pytest.approx(targets.penetration)


@pytest.mark.parametrize(
    ("scene", "options", "field"),
    [
        (box_scene(lift=0.0), {"restitution": 0.5, "penetration": 1e-3}, "--speed"),
        (box_scene(tilt=5.0), {"penetration": 1e-3}, "box.tilt"),
        (load_scene("field-rebound").with_values({"load.gravity": 0.0}), {"penetration": 1e-3}, "load"),
        (load_scene("columns-weight"), {"penetration": 1e-3}, None),
    ],
)
def test_scenes_that_have_no_flat_landing(scene: Scene, options: dict[str, Any], field: str | None) -> None:
    with pytest.raises(InputError) as error:
        advise_engine(scene, "mujoco", **options)
    assert error.value.field == field


def test_the_command_is_the_function() -> None:
    words = ["advise", "field-rebound", "--for", "pybullet", "--penetration", 1e-3]
    expected = advise_engine(load_scene("field-rebound"), "pybullet", penetration=1e-3).as_dict()
    assert json.loads(typed(*words, "--json").stdout) == json.loads(json.dumps(expected))
    page = typed(*words).stdout
    assert "contactStiffness" in page and "as it comes" in page
    assert "--damping" in refused(*words, "--damping", 0.05)
    assert "--for" in refused("advise", "field-rebound", "--damping", 0.05, "--penetration", 1e-3)
