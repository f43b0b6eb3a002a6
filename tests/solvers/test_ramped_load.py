"""A load that rises in a ramp: the closed form of each mode, exact flights, energies, and who refuses it."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import refused, typed

import dda
from validation.errors import InputError
from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import BUILT_IN, get_solver, solve

RAMP = 0.0137  # s, between two steps


def locked(**values: Any) -> Scene:
    """Return figure 3 at 2 ms with a ramp, and keys `table__key` in place of its own."""
    scene = load_scene("figures-3-4").expand()[1]
    return scene.with_values({"load.ramp": RAMP} | {key.replace("__", "."): value for key, value in values.items()})


def opening(**values: Any) -> Scene:
    return locked(contact__law="unilateral", **values)


def test_viscous_damping_goes_with_a_ramp() -> None:
    scene = locked(damping__mass=2.0, damping__stiffness=1e-4)
    reference = solve(scene, "bar").displacement
    assert solve(scene, "fem").displacement == pytest.approx(reference, abs=1e-8 * np.max(np.abs(reference)))


@pytest.mark.parametrize("start", ["zero", "consistent"])
def test_a_contact_that_stays_closed_is_the_locked_one_under_a_ramp(start: str) -> None:
    values: dict[str, Any] = {"time__gg": 0.99, "time__start": start, "time__alpha": 0.25, "time__delta": 0.5}
    values |= {"load__gravity": 9.81, "load__pressure": 0.0, "time__step": 1e-3}  # a pressure would lift it at first
    history = solve(opening(**values), "dda").displacement
    reference = solve(locked(**values), "dda").displacement
    assert history == pytest.approx(reference, abs=1e-9 * np.max(np.abs(reference)))


@pytest.mark.parametrize("name", BUILT_IN)
def test_who_does_not_take_a_ramp_refuses_it_by_name(name: str) -> None:
    solver = get_solver(name)
    assert ("ramped load" in solver.handles) == (name in ("dda", "fem", "bar"))
    if "ramped load" not in solver.handles:
        with pytest.raises(InputError, match=r"does not handle .*ramped load"):
            solver.prepare(locked())


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("dda", {"block__subdivide": [2, 2]}),
        ("dda", {"damping__kinetic": "adaptive"}),
        ("dda", {"contact__law": "unilateral", "run__geometry": "updated"}),
        ("fem", {"contact__law": "unilateral"}),
        ("bar", {"contact__law": "unilateral"}),
    ],
)
def test_what_does_not_go_with_a_ramp_is_refused_by_name(name: str, values: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="does not handle"):
        get_solver(name).prepare(locked(**values))


def test_the_packages_refuse_a_ramp_where_they_do_not_know_it() -> None:
    block = dda.Block([(0, 0), (2, 0), (2, 2), (0, 2)], dda.Material(2700.0, 1e9, 0.0))
    load = dda.Load(pressure=1e6, ramp=0.1)
    model = dda.TwoBlockModel(block, dda.Contact(1e9, 1e9), load)
    scheme = dda.Scheme(0.5, 1.0, 1.0, 1e-3)
    average = dda.Scheme(0.25, 0.5, 1.0, 1e-3)
    opens = dda.UnilateralModel(block, dda.Unilateral(1e9, 0.0), load)
    for unknown in (
        lambda: dda.subdivided(model, 2, 2, 1e15),
        lambda: dda.opening_subdivided(opens, 2, 2, 1e15),
        lambda: dda.solve_adaptive(model, scheme, 5),
        lambda: dda.solve_textbook(model, scheme, 5),
        lambda: dda.solve_unilateral(opens, average, 5, options=dda.UnilateralOptions("energy-conserving")),
    ):
        with pytest.raises(ValueError, match=r"ramp: does not go|at once"):
            unknown()
    for ramp in (-1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="ramp: must be finite and not negative"):
            dda.Load(ramp=ramp)


@pytest.mark.long
def test_compare_knows_the_ramp_of_a_scene_and_refuses_it_where_it_does_not(tmp_path: Path) -> None:
    values = ("--set", "time.step=0.002", "--set", f"load.ramp={RAMP}")
    history = tmp_path / "ramped.csv"
    assert typed("solve", "figures-3-4", *values, "--solver", "dda", "--csv", history).returncode == 0
    assert typed("compare", "figures-3-4", history, *values).returncode == 0  # the scene's own history
    assert typed("compare", "figures-3-4", history, *values[:2]).returncode == 1
    polygon = ("--set", "block.vertices=[[0.0, 0.0], [2.0, 0.0], [1.8, 2.0], [0.2, 2.0]]")
    assert "loads that act at once only" in refused("compare", "figures-3-4", history, *values, *polygon)
