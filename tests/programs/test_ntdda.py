"""ntdda as a solver: the rows of its files, for the scenes whose problems they are; of polygons the program itself."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from peers.ntdda import Histories

from validation.models.plane.blocks import centroid
from validation.models.plane.tables import PlaneSection
from validation.scenes.scene import load_scene, parse_scene

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples" / "ntdda"


def rows(name):
    """Return the numbers of a measured-point file: step, time, dt, x, y, way, vx, vy, v."""
    text = (EXAMPLES / name).read_text().partition("[")[2].partition("]")[0]
    return np.array(text.split(), float).reshape(-1, 9)


def test_a_block_on_a_slope_moves_sideways():
    found, told = Histories().solve(load_scene("field-creep")), rows("ntdda-phi22-slope20-dt2ms_meas.m")[:100]
    np.testing.assert_allclose(found["displacement"], told[:, 4] - 3, atol=2e-6)
    np.testing.assert_allclose(found["horizontal_displacement"], told[:, 3] - 5, atol=2e-6)


# ---- the program itself, of rigid polygons at rest -------------------------------------------------------------------

# It starts by the shell: the line that names an interpreter takes no path with a blank.
NTDDA = """#!/bin/sh
''':'
exec "{python}" "$0" "$@"
'''
import pathlib, re, sys
points = re.findall(r"<Point> (\\S+) (\\S+) </Point>", open(sys.argv[1]).read().partition("Measured")[2])
steps, step = (re.search(f'{{word}}="([^"]*)"', open(sys.argv[2]).read())[1] for word in ("timesteps", "maxtimestep"))
place = pathlib.Path(sys.argv[1]).parent / "output"
place.mkdir()
lines = []
for number, (x, y) in enumerate(points, 1):
    rows = [f"{{n}} {{n * float(step)}} 0 {{float(x) + 0.1 * n}} {{y}} 0 0 0 0" for n in range(1, int(steps) + 1)]
    lines += [f"measpoint{{number}}=[", *rows, "];"]
(place / "x_meas.m").write_text("\\n".join(lines))
"""


def slope(dip, friction):
    """Return a box of 2 m by 1 m on a plane that dips to the right."""
    a = math.radians(dip)

    def at(x, y):
        return [x * math.cos(a) + y * math.sin(a), y * math.cos(a) - x * math.sin(a)]

    outlines = {"ground": [(-3, -2), (12, -2), (12, 0), (-3, 0)], "box": [(0, 0), (2, 0), (2, 1), (0, 1)]}
    blocks = [
        {"name": name, "fixed": name == "ground", "vertices": [at(*corner) for corner in corners]}
        for name, corners in outlines.items()
    ]
    contact = {"stiffness": math.inf, "friction": friction}
    plane = {"young": math.inf, "density": 2700.0, "gravity": [0.0, -9.81], "contact": contact, "block": blocks}
    columns = ["box.x", "box.y", "box.angle"]
    return parse_scene(
        {"plane": plane, "time": {"step": 0.05, "steps": 10}, "run": {"columns": columns}}, f"slope-{dip}-{friction}"
    )


def on_path(tmp_path, monkeypatch):
    program = tmp_path / "ntdda"
    program.write_text(NTDDA.format(python=sys.executable))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))


def test_the_poses_are_those_of_two_measured_points(tmp_path, monkeypatch):
    on_path(tmp_path, monkeypatch)
    scene = slope(30.0, 20.0)
    columns = Histories().solve(scene)
    x, y = centroid(scene.table(PlaneSection).assembly.blocks[1].vertices)
    np.testing.assert_allclose(columns["box.x"], x + 0.1 * 25 * np.arange(1, 11), rtol=1e-9)
    np.testing.assert_allclose(columns["box.y"], y, rtol=1e-9)
    np.testing.assert_allclose(columns["box.angle"], 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "what"),
    [("stopping", "velocities"), ("pushing", "gravity"), ("truss", "touch"), ("spinning", "friction alone")],
)
def test_what_the_program_cannot_express_is_refused(name, what):
    with pytest.raises(NotImplementedError, match=what):
        Histories().solve(load_scene(f"rigid-{name}"))
