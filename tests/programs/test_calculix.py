"""CalculiX as a solver: what it refuses, what it is told, its integrator by theory, its contact by exact motions."""

import shutil

import numpy as np
import pytest
from peers.calculix import CalculiX
from peers.calculix_block import block_deck
from peers.calculix_column import acceleration, column_deck, parts_of
from peers.calculix_deck import parsed

from validation.problems.problem import problem, problem_of
from validation.problems.truth import exact
from validation.scenes.scene import Scene

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="NOT RUN: CalculiX is not installed")


class Quick(CalculiX):
    """The chosen settings with fewer increments."""

    def increments(self, scene):
        return 8 if scene.column is None else 4


def scene_of(name, **values):
    return problem(name).scene.with_values({key.replace("__", "."): value for key, value in values.items()})


def column_scene(**column):
    scene = problem("column").scene
    return scene.with_values({f"column.{key}": value for key, value in column.items()})


def test_features_without_a_model_are_not_handled():
    absent = {"sub-blocks", "rigid contact", "dead bands", "lagged friction", "damping tables", "self-adaptive damping"}
    assert not absent & CalculiX.handles


@pytest.mark.parametrize(("name", "deck"), [("creep", block_deck), ("rocking", block_deck), ("column", column_deck)])
def test_every_number_fits_the_twenty_characters_that_ccx_reads(name, deck):
    for line in deck(problem(name).scene, 3).text(accurate=True).splitlines():
        assert line.startswith("*") or max(map(len, line.split(","))) <= 20, line


def test_rows_with_three_digits_of_an_exponent_are_read():
    text = " displacements (vx,vy,vz) for set OUT and time 0.1E-1\n\n         7  1.5-101 -2.500000E-03  0.000000E+00\n"
    times, found = parsed(text, 1)
    assert times.tolist() == [0.01] and found.tolist() == [[[1.5e-101, -2.5e-3, 0.0]]]


def test_a_column_is_cut_at_layers_joints_and_heights():
    column = column_scene(joint=[{"height": 6.0, "stiffness": 1e9}]).column
    parts = parts_of(column)
    assert [part.stretch.bottom for part in parts] == [0.0, 3.5, 6.0, 8.5]
    assert [part.stretch.spring for part in parts] == [None, None, 1e9, None]
    assert parts[1].levels[0] == parts[0].levels[-1] and parts[2].levels[0] == parts[1].levels[-1] + 1


@pytest.mark.parametrize("moved", [lambda t: 0.1 * t, lambda t: t**2])
def test_the_momentum_of_a_base_is_kept_though_it_start_with_a_jump(moved):
    t = np.linspace(0.0, 1.0, 101)
    reached = np.trapezoid(acceleration(t, moved(t)), t)
    assert abs(reached - (moved(1.0) - moved(0.98)) / 0.02) < 0.02 * abs(reached)


def differences(scene):
    known, found = exact(scene, problem_of(scene).truth).columns, Quick().solve(scene)
    return {name: float(np.linalg.norm(found[name][: len(v)] - v) / np.linalg.norm(v)) for name, v in known.items()}


RECORD = "time,x,y\n0,0,0\n0.01,0.001,0.0005\n0.03,-0.002,0.001\n"
BOTH = ["displacement", "horizontal_displacement"]


@needs_ccx
@pytest.mark.long
@pytest.mark.parametrize("hypothesis", ["plane stress", "plane strain"])
def test_locked_springs_under_all_loads_and_a_moving_base(tmp_path, hypothesis):
    record = tmp_path / "record.csv"
    record.write_text(RECORD)
    loads = {"load__eccentricity": 0.2, "load__traction": 5e5, "load__gravity": 9.81, "load__slope": 10.0}
    block = {"block__poisson": 0.3, "block__hypothesis": hypothesis, "contact__shear_stiffness": 4e8}
    scene = scene_of("locked", **loads, **block, load__base_motion=str(record), time__steps=20, run__columns=BOTH)
    assert max(differences(scene).values()) < 0.01


@pytest.mark.long
@needs_ccx
def test_corners_that_open_slip_and_stick_are_those_of_dda():
    scene = scene_of("creep", time__steps=30)
    assert max(differences(scene).values()) < 0.02


@pytest.mark.long
@needs_ccx
def test_a_block_that_rocks_turns_as_a_rigid_one():
    scene = scene_of("rocking", time__steps=30, block__tilt=-10.0)
    assert differences(scene)["rotation"] < 1e-3


@pytest.mark.long
@needs_ccx
@pytest.mark.parametrize(
    ("motion", "base"),
    [("shear", {"base": "rigid"}), ("pressure", {"base": "springs", "base_stiffness": 1e8})],
)
def test_waves_through_layers_on_a_moving_base(motion, base):
    layers = [{"thickness": 6.0, "density": 2000.0, "young": 5e8, "poisson": 0.3}]
    layers += [{"thickness": 4.0, "density": 1800.0, "young": 2e8, "poisson": 0.2}]
    joints = [{"height": 6.0, "stiffness": 5e8}]
    data = problem("column").scene.definition()
    data["column"] = {"motion": motion, "layer": layers, "joint": joints, "heights": [5.0], **base}
    data["input"] = {"at": "base", "shape": "ricker", "velocity": 0.1, "frequency": 25.0}
    data["time"] |= {"step": 2e-3, "steps": 60}
    data["run"]["columns"] = ["displacement", "contact_pressure", "displacement_1", "stress_1"]
    assert max(differences(Scene.model_validate(data)).values()) < 0.02
