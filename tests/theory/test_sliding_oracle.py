"""The plain program with friction: what it shares with an established program, and with the closed forms."""

import math
from pathlib import Path

import numpy as np
import pytest
from oracles.sliding_dda import Slider, run

from validation import load_scene
from validation.theory import friction

MEASURED = Path(__file__).parents[2] / "docs" / "examples" / "ntdda" / "ntdda-phi22-slope20-dt2ms_meas.m"
LOAD, WEIGHT, SLOPE = 1e6, 10800 * 9.81, math.radians(20)
FORCE = (LOAD * math.sin(SLOPE), -LOAD * math.cos(SLOPE) - WEIGHT)  # the weight is not turned
BANDS = (1e-3, 1e-6)  # m, of ntdda in this model
LONG = pytest.mark.long
SOFT = 4e-3  # share of the displacement that the base of that program adds, by its first steps


def measured() -> np.ndarray:
    """Horizontal and vertical displacement of the file [m]."""
    rows = [line.split() for line in MEASURED.read_text().splitlines() if len(line.split()) == 9 and "%" not in line]
    table = np.array(rows, dtype=float)
    return np.cumsum(table[:, 6:8] * table[:, 2:3], axis=0)


def test_lagged_friction_is_what_the_program_does() -> None:
    """Step by step until a decision falls differently on its softer base; then on average."""
    theirs = measured()
    ours = run(Slider(phi=22, force=FORCE, dt=2e-3, steps=500, lagged=True, band=BANDS))
    apart = np.abs(np.column_stack([ours.u, ours.v]) - theirs)
    assert np.max(apart[:120]) < SOFT * np.max(np.abs(theirs[:120]))
    assert ours.u[-1] == pytest.approx(theirs[-1, 0], rel=0.03)
    sound = run(Slider(phi=22, force=FORCE, dt=2e-3, steps=500))
    assert sound.u[-1] < 0.1 * theirs[-1, 0]  # all states looked at: the block stops
    assert sound.inconsistent == 0


@pytest.mark.parametrize(
    ("step", "way"),
    [(1e-2, 1.0e-3), (2e-3, 2.2e-3), pytest.param(1e-3, 5.2e-3, marks=LONG), pytest.param(2e-4, 499e-3, marks=LONG)],
)
def test_a_stable_block_creeps_the_faster_the_finer_the_step(step: float, way: float) -> None:
    """Angle of friction 30 deg; printed digits, and what a base as soft as that program's makes of the decisions."""
    data = {"phi": 30, "force": FORCE, "dt": step, "steps": round(1 / step), "lagged": True, "band": BANDS}
    near = [run(Slider(**data, p=1e9 * (1 - soft), ps=4e8 * (1 - soft))).u[-1] for soft in (0, SOFT / 2, SOFT)]
    spread = max(near) - min(near)
    assert min(near) - spread - 5e-5 <= way <= max(near) + spread + 5e-5
    assert spread < 0.2 * way


@pytest.mark.long
def test_two_programs_that_agree_to_the_third_digit_creep_apart() -> None:
    """Where stick and slip alternate, their order decides; 0.3 % on the springs, half a millisecond."""
    data = {"phi": 22, "force": FORCE, "dt": 5e-4, "steps": 2000, "lagged": True}
    one, other = (run(Slider(**data, p=1e9 * (1 - soft), ps=4e8 * (1 - soft))).u[-1] for soft in (0.0, 3e-3))
    assert 1.5 < one / other < 2.5


def test_sliding_is_free_motion_along_the_base() -> None:
    """u_t + tan(phi) u_n of any scheme, through bounces; lagged friction is a step late, and is seen."""
    for scheme in ((0.5, 1.0, 0.98), (0.25, 0.5, 1.0), (0.3, 0.7, 0.9)):
        alpha, delta, gg = scheme
        case = load_scene("figures-3-4").with_values(
            {"contact.law": "unilateral", "contact.friction": 5.0, "load.pressure": 0.0, "load.gravity": 9.81}
            | {"load.slope": 40.0, "time.step": 0.002, "time.steps": 60, "time.alpha": alpha, "time.delta": delta}
            | {"time.gg": gg}
        )
        data = {"phi": 5, "gravity": 9.81, "slope": 40, "dt": 0.002, "steps": 60}
        data |= {"alpha": alpha, "delta": delta, "gg": gg}
        expected, _ = friction.free_motion(case, friction.sliding_acceleration(case))
        sound, late = run(Slider(**data)), run(Slider(**data, lagged=True))
        tan = friction.coefficient(case)
        off = [np.max(np.abs(m.u + tan * m.v - expected)) / expected[-1] for m in (sound, late)]
        assert (np.abs(sound.state) != 1).all()
        assert off[0] < 1e-12
        assert off[1] > 1e-6
