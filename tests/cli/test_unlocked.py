"""A scene with unilateral contact is run by the solvers that handle it and refused by everything else, in one line."""

from __future__ import annotations

import pytest
from conftest import refused

from validation import load_scene
from validation.errors import InputError
from validation.solvers.registry import get_solver, solver_names

ONE = ("--set", "contact.stiffness=1e9")


def test_what_is_written_for_linear_scenes_refuses_it() -> None:
    for words in (["advise", "damping", "unlocked"], ["solve", "unlocked", "--solver", "dda-textbook"]):
        assert "unilateral contact" in refused(*words, *ONE)


def test_no_solver_prepares_a_scene_as_if_a_feature_were_absent() -> None:
    scene = load_scene("unlocked").expand()[1]
    for name in solver_names():
        solver = get_solver(name)
        if solver.unhandled(scene):
            with pytest.raises(InputError, match="does not handle unilateral contact"):
                solver.prepare(scene)
