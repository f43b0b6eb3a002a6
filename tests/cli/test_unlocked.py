"""A scene with unilateral contact is run by the solvers that handle it and refused by everything else, in one line."""

from __future__ import annotations

import pytest

from validation import load_scene
from validation.errors import InputError
from validation.solvers.registry import get_solver, solver_names


def test_no_solver_prepares_a_scene_as_if_a_feature_were_absent() -> None:
    scene = load_scene("unlocked").expand()[1]
    for name in solver_names():
        solver = get_solver(name)
        if solver.unhandled(scene):
            with pytest.raises(InputError, match="does not handle unilateral contact"):
                solver.prepare(scene)
