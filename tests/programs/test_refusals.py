"""What the programs of blocks and columns cannot express is refused by name before any is asked; so is absence."""

import functools
import itertools
import re
import shutil
import sys
import tomllib
from pathlib import Path

import pytest
from peers import calculix, mujoco, ntdda, opensees, siconos, yade

from validation.scenes.scene import load_scene

REFUSALS = tomllib.loads(Path(__file__).with_name("refusals.toml").read_text(encoding="utf-8"))
PROGRAMS = {
    "siconos": siconos.Siconos,
    "siconos-default": siconos.AsItComes,
    "yade": yade.Yade,
    "mujoco": mujoco.MuJoCo,
    "mujoco-default": mujoco.AsItComes,
    "calculix": calculix.CalculiX,
    "opensees": opensees.OpenSees,
    "opensees-default": opensees.AsItComes,
}
REFUSING = PROGRAMS | {"ntdda": ntdda.Histories}
ROWS = [(name, *row) for name in REFUSING for row in REFUSALS.get(name, REFUSALS[name.removesuffix("-default")])]


@functools.cache
def field(problem):
    """Return a scene of the field of programs."""
    return load_scene(f"field-{problem}")


@pytest.fixture
def _nothing_is_there(monkeypatch):
    for module in ("mujoco", "openseespy", "openseespy.opensees"):
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(siconos, "PYTHON", "/nowhere/python3")


@pytest.mark.usefixtures("_nothing_is_there")
def test_what_a_program_cannot_express_is_refused_by_name():
    for name, problem, values, words in ROWS:
        with pytest.raises(NotImplementedError, match=re.escape(words)):
            REFUSING[name]().solve(field(problem).with_values(values))


@pytest.mark.usefixtures("_nothing_is_there")
def test_a_program_that_is_absent_is_named_with_its_recipe():
    columns = {"locked": {"run.columns": ["displacement"]}, "rocking": {"run.columns": ["rotation"]}, "column": {}}
    for name, problem in itertools.product(PROGRAMS, columns):
        with pytest.raises(NotImplementedError, match=r"(pip|apt-get) install"):
            PROGRAMS[name]().solve(field(problem).with_values(columns[problem]))


class Told:
    """A program that takes every command and does not converge."""

    def __getattr__(self, name):
        return lambda *given: {"analyze": -3, "getTime": 0.25}.get(name)


@pytest.mark.parametrize("solver", [opensees.OpenSees, opensees.AsItComes])
def test_newtons_iteration_that_ends_nowhere_has_a_name(monkeypatch, solver):
    monkeypatch.setattr(opensees, "program", Told)
    with pytest.raises(opensees.NotConverged, match=r"0\.25 s"):
        solver().solve(field("creep"))
