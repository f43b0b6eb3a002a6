"""A rigid contact, `stiffness = inf`: the limit of stiff springs where it is handled, and refused by name elsewhere."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import typed

from validation import load_scene, solve
from validation.scenes import features
from validation.scenes.scene import Scene, parse_scene

RIGID = {"contact.stiffness": math.inf, "contact.shear_stiffness": 0.0}


def scene(**values: Any) -> Scene:
    """Return an eccentric load on a block that also has a gap and a speed."""
    case = load_scene("unlocked-constant").expand()[0].with_values({"time.step": 5e-4, "time.steps": 60})
    return case.with_values({"load.eccentricity": 0.2, "contact.gap": 1e-3, "block.velocity": -0.5} | RIGID | values)


@pytest.mark.parametrize("delta", [1.0, 0.5])
def test_a_rigid_contact_is_the_limit_of_stiff_springs(delta: float) -> None:
    values = {"time.delta": delta, "time.alpha": delta / 2}
    rigid, stiff = (solve(scene(**values | {"contact.stiffness": p}), "dda") for p in (math.inf, 1e20))
    for name in ("displacement", "contact_pressure"):
        x, y = (getattr(run, name) for run in (rigid, stiff))
        until = slice(0, 14)  # before switches amplify the difference
        assert np.abs(x - y)[until].max() <= 1e-8 * np.abs(y)[until].max()
    assert np.all(rigid.contact_pressure >= 0) and rigid.contact_pressure.max() > 0


def test_a_scene_keeps_a_rigid_contact_through_plain_data() -> None:
    rigid = scene()
    data = json.loads(json.dumps(rigid.definition(), allow_nan=False))
    assert data["contact"]["stiffness"] == "inf"
    assert parse_scene(data, "again").contact.stiffness == math.inf
    assert features.RIGID in features.of(rigid) and features.RIGID not in features.of(rigid.with_values(SPRING))


SPRING = {"contact.stiffness": 1e9}


@pytest.mark.long
def test_the_page_on_contact_takes_it(tmp_path: Path) -> None:
    path = tmp_path / "rigid.toml"
    path.write_text(
        '[block]\nside = 2.0\ndensity = 2700.0\nyoung = 1e9\nvelocity = -1.0\n[contact]\nlaw = "unilateral"\n'
        "stiffness = inf\nshear_stiffness = 0.0\ngap = 0.01\n[load]\npressure = 0.0\n[time]\nstep = 1e-4\nsteps = 150\n"
    )
    done = typed("contact", path, "--json")
    found = json.loads(done.stdout)
    assert done.returncode == 0 and found["omega"] is None and found["runs"]["dda"]["contact.penetration"] == 0
    assert [set(alarm["values"]) for alarm in found["alarms"]] == [{"low", "mean", "high", "own"}]  # and no w_c dt
    # The strain gives back what a rigid quarter mass (0.5) would lose: 0.676 over 32 landings stepped by `dda`.
    assert found["restitution_now"]["mean"] == pytest.approx(0.676, abs=0.02)
