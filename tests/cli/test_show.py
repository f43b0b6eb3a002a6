"""`show SCENE`: the model drawn, its parameters, and derived numbers against formulas written here."""

import json
import math

import pytest
from conftest import thinned, typed

from validation import solve
from validation.errors import InputError
from validation.report.scene.numbers import numbers
from validation.scenes.scene import load_scene, scene_names


def shown(*arguments):
    done = typed("show", *arguments, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def single(found):
    """Return the numbers, each of which is the same in all cases."""
    assert all(each["low"] == each["high"] for each in found["numbers"].values())
    return {name: each["low"] for name, each in found["numbers"].items()}


@pytest.mark.parametrize(("young", "density", "p", "dt"), [(1e9, 2700.0, 1e9, 0.002), (4e9, 2000.0, 3e10, 0.0007)])
def test_numbers_of_a_block_are_those_of_the_formulas(young, density, p, dt, scene_file):
    sets = (f"block.young={young}", f"block.density={density}", f"contact.stiffness={p}", f"time.step={dt}")
    found = single(shown(scene_file, *(word for each in sets for word in ("--set", each))))
    c, h, q, m = math.sqrt(young / density), 2.0, 5e6, density * 4
    # two unknowns (v, ey): M = diag(m, m h^2/12), K = [[2 p, -p h], [-p h, E w h + p h^2 / 2]], w = h = 2 m
    a, b = 2 * p / m, (young * 4 + p * 2) / (m / 3)
    product = a * b - (2 * p) ** 2 / (m * m / 3)
    w1 = math.sqrt((a + b) / 2 - math.sqrt((a + b) ** 2 / 4 - product))
    wanted = {"m": m, "p/E": p / young, "c": c, "h/c": h / c, "c dt/h": c * dt / h, "F/2p": q * 2 / (2 * p), "w1": w1}
    wanted |= {"w1 dt": w1 * dt, "wc": math.sqrt(product) / w1, "wc dt": math.sqrt(product) / w1 * dt, "n dt": 50 * dt}
    assert {name: found[name] for name in wanted} == pytest.approx(wanted, rel=1e-9)
    assert "dt stable" not in found and "Omega" not in found


@pytest.mark.parametrize(
    ("name", "values"),
    [("waves-glue", {}), ("waves-joint", {}), ("figures-3-4", {"block.subdivide": [2, 2]})],
)
def test_the_largest_stable_step_is_that_of_the_solver(name, values):
    """Glue and joints count, and all modes of sub-blocks, not the lowest that are reported."""
    explicit = {"time.alpha": 0.0, "time.delta": 0.5, "time.steps": 2, "time.allow_unstable": True}
    case = load_scene(name).expand()[0].with_values(explicit | values)
    limit = next(number.value for number in numbers(case) if number.name == "dt stable")
    strict = case.with_values({"time.allow_unstable": False})
    assert solve(strict.with_values({"time.step": limit}), "dda").time.size == 2
    with pytest.raises(InputError, match="the stability limit"):
        solve(strict.with_values({"time.step": 1.0001 * limit}), "dda")


def test_contact_that_opens_shows_omega_and_the_step_that_hides_its_opening(scene_file):
    unlocked = ("--set", "contact.law=unilateral", "--set")
    numbers = single(shown(scene_file, *unlocked, "time.step=0.001"))
    c = math.sqrt(1e9 / 2700)
    first_release = 2.64272535338 * 2 / c  # of an unloaded landing at p = E, by an independent program
    assert numbers["Omega"] / 0.001 == pytest.approx(math.pi / first_release, rel=1e-10)
    assert numbers["e least"] <= numbers["e most"] < numbers["e own"] < 1
    assert numbers["dt seen"] == pytest.approx(2 / (c * math.sqrt(3)))  # h / (c sqrt(6 alpha))
    assert "w1" not in numbers
    words = {step: list(shown(scene_file, *unlocked, f"time.step={step}")["remarks"]) for step in (1e-4, 1e-3, 5e-3)}
    assert words[1e-4] == [] and "restitution" in words[1e-3][1] and len(words[1e-3]) == 2
    assert words[5e-3][1] == "dt is too large to show that the block leaves its springs at t = 0"
    assert "depends on where in the step the block lands" in words[5e-3][2]


@pytest.mark.parametrize("name", thinned(scene_names(), 13))
def test_every_built_in_scene_is_shown(name):
    found = shown(name)
    assert found["numbers"] and found["cases"] == len(load_scene(name).expand())
    assert typed("show", name).stdout.startswith(f"{name}: ")
