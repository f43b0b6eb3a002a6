"""A scene with unilateral contact is run by the solvers that handle it and refused by everything else, in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import refused

from validation import load_scene, solve
from validation.errors import InputError
from validation.solvers.registry import get_solver, solver_names

ONE = ("--set", "contact.stiffness=1e9")


def test_what_is_written_for_linear_scenes_refuses_it() -> None:
    for words in (["damping", "unlocked"], ["solve", "unlocked", "--solver", "dda-textbook"]):
        assert "unilateral contact" in refused(*words, *ONE)


def test_no_solver_prepares_a_scene_as_if_a_feature_were_absent() -> None:
    scene = load_scene("unlocked").expand()[1]
    for name in solver_names():
        solver = get_solver(name)
        if solver.unhandled(scene):
            with pytest.raises(InputError, match="does not handle unilateral contact"):
                solver.prepare(scene)


def test_an_impact_rebounds_from_the_bar_as_from_the_block(scene_file: Path) -> None:
    """At p/E = 1 the bar keeps 0.975858485361 and the block 0.930732420604 of the momentum of the impact."""
    values = {"contact.law": "unilateral", "load.pressure": 0.0, "block.velocity": -1.0, "time.steps": 400}
    scene = load_scene(scene_file).with_values(values | {"time.step": 5e-5})
    for solver, kept in (("bar-events", 0.975858485361), ("block-events", 0.930732420604)):
        v = solve(scene, solver).displacement
        speed = np.polyfit(scene.time.step * np.arange(200), v[-200:], 1)[0]  # over three passages of its waves
        assert speed == pytest.approx(kept, rel=0.05), solver


def test_both_ends_of_a_centred_block_switch_together() -> None:
    scene = load_scene("unlocked").expand()[1].with_values({"run.columns": ["gap_m", "gap_n", "normal_force_m"]})
    run = solve(scene, "block-events")
    gap, force = run.history.columns["gap_m"], run.history.columns["normal_force_m"]
    assert gap == pytest.approx(run.history.columns["gap_n"], rel=1e-12)
    assert np.all(force >= 0) and np.all((gap > 0) == (force == 0))
    assert force[force > 0] == pytest.approx(-1e9 * gap[force > 0], rel=1e-12)
