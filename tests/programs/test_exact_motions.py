"""How near the programs of blocks and columns come to exact motions, with the settings that were chosen: one table."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from oracles.absent import answer_of
from peers import calculix, mujoco, opensees, siconos, yade

from validation.problems.problem import problem_of
from validation.problems.truth import exact
from validation.scenes.scene import load_scene, parse_scene

TABLE = tomllib.loads(Path(__file__).with_name("exact_motions.toml").read_text(encoding="utf-8"))


class Quick(calculix.CalculiX):
    """CalculiX's chosen settings with fewer increments."""

    def increments(self, scene):
        return 8 if scene.column is None else 4


PROGRAMS = {
    "mujoco": mujoco.MuJoCo,
    "siconos": siconos.Siconos,
    "yade": yade.Yade,
    "calculix": Quick,
    "opensees": opensees.OpenSees,
}


def scene_of(problem, row, directory):
    """Return the scene of a problem with what a row states; a record of its base is written to a directory."""
    if problem == "layers":
        layers = TABLE["layers"]
        return parse_scene(layers | {"column": layers["column"] | row.get("column", {})}, "layers")
    values = dict(row.get("set", {}))
    if row.get("all"):
        values["run.columns"] = ["displacement", "contact_pressure", "horizontal_displacement", "rotation"]
    if row.get("record"):
        t = np.arange(0, 0.05, 0.005)
        path = directory / "base.csv"
        sines = np.column_stack([t, 0.3 + 0.02 * np.sin(60 * t), 0.002 * np.sin(80 * t)])
        motion = sines if row["record"] is True else row["record"]
        np.savetxt(path, motion, delimiter=",", header="time,x,y", comments="")
        values["load.base_motion"] = str(path)
    return load_scene(f"field-{problem}").with_values(values)


ROWS = [
    pytest.param(program, row, id=f"{program}-{row[0]}-{number}", marks=() if "short" in str(row) else pytest.mark.long)
    for program in PROGRAMS
    for number, row in enumerate(TABLE[program])
]


@pytest.mark.parametrize(("program", "row"), ROWS)
def test_a_program_comes_near_to_the_exact_motion(program, row, tmp_path):
    problem, within, *tables = row
    scene = scene_of(problem, dict(*tables), tmp_path)
    answer = answer_of(PROGRAMS[program](), scene)
    truth = exact(scene, problem_of(scene).truth).columns
    reported = [name for name in scene.run.columns if name in answer]
    assert reported
    for name in reported:
        expected = truth[name]
        difference = np.linalg.norm(answer[name][: len(expected)] - expected)
        assert difference < within * np.linalg.norm(expected), name
