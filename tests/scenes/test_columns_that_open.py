"""Scenes of columns whose contacts open or slip: what goes together, what the contacts are, what drives them."""

import numpy as np
import pytest

from validation.scenes.drive import motion_at
from validation.scenes.scene import parse_scene

LAYERS = [
    {"thickness": 2.0, "density": 2000.0, "young": 1e9, "blocks": 2},
    {"thickness": 3.0, "density": 1000.0, "young": "inf", "blocks": 3, "velocity": -1.0},
]


def scene_with(column, **tables):
    whole = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "layer": LAYERS} | column
    data = {"column": {key: value for key, value in whole.items() if value is not None}}
    return parse_scene(
        data | {"time": {"step": 1e-3, "steps": 10}, "run": {"solvers": ["dda"]}} | tables, "column.toml"
    )


@pytest.mark.parametrize(
    "drive",
    [
        {"shape": "sine", "frequency": 3.0},
        {"shape": "cosine", "frequency": 3.0},
        {"shape": "triangle", "duration": 0.4},
        {"shape": "half-sine", "duration": 0.4},
    ],
    ids=lambda drive: drive["shape"],
)
def test_displacement_and_acceleration_belong_to_the_velocity_of_a_drive(drive):
    from scipy.integrate import quad

    scene = scene_with({}, input={"velocity": 2.0} | drive)
    times = np.array([0.07, 0.21, 0.39])
    motion = motion_at(scene, times)
    for time, displacement, acceleration in zip(times, motion.displacement, motion.acceleration, strict=True):
        integral, _ = quad(lambda t: float(motion_at(scene, np.array(t)).velocity), 0.0, time, epsabs=1e-13)
        assert displacement == pytest.approx(integral, abs=1e-10)
        around = motion_at(scene, np.array([time - 1e-6, time + 1e-6])).velocity
        assert acceleration == pytest.approx(np.diff(around)[0] / 2e-6, abs=1e-6)
