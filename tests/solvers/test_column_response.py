"""A pressure on the top of a column: its response at rest is the pressure."""

import pytest

from validation import load_scene, response


def test_a_pressure_on_the_top_has_the_scenes_size():
    scene = load_scene("waves-base").expand()[0]
    drive = {"at": "top", "shape": "half-sine", "pressure": 3e5, "duration": 0.01}
    pressed = scene.with_values({"input": drive})
    for solver in ("dda", "fem", "layers"):
        found = response(pressed, [1e-3], solver)
        assert not found.base
        assert abs(found.contact_pressure[0]) == pytest.approx(3e5, rel=1e-3)
