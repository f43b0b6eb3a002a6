"""Newmark's sliding block: closed forms, an independent integration, identities."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned
from scipy.integrate import solve_ivp

from fem_reference.exact.sliding_block import Segment, SlidingBlock, SlidingMotion, harmonic, moved, recorded, solve
from validation import load_scene
from validation.errors import InputError
from validation.solvers.rigid.sliding import harmonic_slide, rigid_slide

G = 9.81
LEVEL = SlidingBlock(0.0, math.degrees(math.atan(0.1)))
SLOPE = SlidingBlock(20.0, 30.0)


@pytest.mark.parametrize(("A", "length"), [(0.5, 0.3), (0.17, 1.1)])
def test_a_rectangular_pulse_moves_the_block_as_newmark_found(A: float, length: float) -> None:
    motion = solve(LEVEL, recorded([0, length, length], [A * G, A * G, 0]), 60.0)
    V, N = A * G * length, 0.1
    assert motion.slip == pytest.approx(V**2 / (2 * G * N) * (1 - N / A), rel=1e-13)
    assert motion.at([60.0])[0] == pytest.approx(-motion.slip)
    assert motion.switches == ((0.0, -1), (pytest.approx(V / (G * N)), 0))


def test_a_base_that_is_moved_away_is_a_throw_of_the_block() -> None:
    motion = solve(LEVEL, moved([0, 10], [0, 3]), 5.0)
    assert motion.slip == pytest.approx(0.3**2 / (2 * G * 0.1), rel=1e-13)
    back = solve(LEVEL, moved([0, 0.1, 0.2], [0, 0.02, 0.0]), 5.0)  # thrown, caught up with, thrown on, and left alone
    ways = [way for _, way in back.switches]
    assert ways[0] == -1
    assert ways[-1] == 0
    assert back.slip > abs(back.at([5.0])[0][0])


def test_a_slope_beyond_the_friction_angle_slides_from_the_start() -> None:
    b = math.radians(28.9)
    motion = solve(SlidingBlock(28.9, 15.0), moved([0.0], [0.0]), 1.0)
    fall = G * (math.sin(b) - math.tan(math.radians(15.0)) * math.cos(b))
    assert motion.at([0.5, 1.0])[0] == pytest.approx([fall / 8, fall / 2], rel=1e-13)
    held = solve(SlidingBlock(28.9, 15.0, cohesion=1.01 * fall), moved([0.0], [0.0]), 1.0)
    assert held.slip == 0.0
    least = G * math.sin(math.radians(10.0)) / math.cos(math.radians(30.0))
    assert SLOPE.resistance - SLOPE.driving == pytest.approx(least)


def test_the_yield_acceleration_parts_rest_from_sliding() -> None:
    limit, rate = SLOPE.resistance - SLOPE.driving, 7.0
    assert solve(SLOPE, harmonic(0.999999 * limit, rate, 2.0), 3.0).slip == 0.0
    assert solve(SLOPE, harmonic(1.01 * limit, rate, 2.0), 3.0).slip > 0.0


def integrated(block: SlidingBlock, base: tuple[Segment, ...], end: float) -> float:
    """The slide at the end by DOP853 with events, on the equation of motion alone."""
    slide = rate = 0.0
    for segment in base:
        t, last = segment.start, min(segment.end, end)
        rate -= segment.jump
        while t < last:
            slide, rate, t = swept(block, segment, (slide, rate), t, last)
    return slide


def swept(block: SlidingBlock, segment: Segment, start: tuple[float, float], t: float, last: float):
    def pushed(now: float) -> float:
        return float(segment.acceleration(now - segment.start))

    excess = block.driving - pushed(t + 1e-9)
    way = int(np.sign(start[1])) or (int(np.sign(excess)) if abs(excess) > block.resistance else 0)

    def motion(now, y):
        return [y[1], block.push(way) - pushed(now) if way else 0.0]

    def change(now, y):
        return way * y[1] + (now - t < 1e-9) if way else block.resistance - abs(block.driving - pushed(now))

    change.terminal, change.direction = True, -1
    options = {"rtol": 1e-12, "atol": 1e-14, "events": [change], "max_step": 0.01}
    done = solve_ivp(motion, (t, last), start, "DOP853", **options)
    rate = 0.0 if len(done.t_events[0]) else float(done.y[1, -1])
    return float(done.y[0, -1]), rate, float(done.t[-1])


def random_base(seed: int) -> tuple[Segment, ...]:
    rng = np.random.default_rng(seed)
    t = np.concatenate([[0], np.cumsum(rng.uniform(0.05, 0.3, 8))])
    if seed % 3 == 0:
        return harmonic(rng.uniform(3, 20), rng.uniform(3, 20), 1.5)
    return recorded(t, rng.uniform(-8, 8, 9)) if seed % 3 == 1 else moved(t, np.cumsum(rng.normal(0, 0.03, 9)))


@pytest.mark.parametrize("seed", thinned([0, 3, 1, 4, 2, 5], 2))
def test_an_independent_integration_agrees(seed: int) -> None:
    base = random_base(seed)
    motion = solve(SLOPE, base, 2.0)
    assert motion.slip > 0
    for end in (0.7, 1.3, 2.0):
        assert motion.at([end])[0] == pytest.approx(integrated(SLOPE, base, end), abs=1e-7)


@pytest.mark.parametrize("seed", [6, 7, 8])
def test_the_slide_is_smooth_and_its_rate_is_its_derivative(seed: int) -> None:
    motion = solve(SLOPE, random_base(seed), 2.0)
    t, h = np.linspace(0.01, 1.99, 500), 1e-6
    differences = (motion.at(t + h)[0] - motion.at(t - h)[0]) / (2 * h)
    near = np.array([np.abs(t - one.base.start).min() for one in motion.stretches])
    assert near.min() >= 0
    jumps = np.array([one.base.start for one in motion.stretches])
    apart = np.abs(t[:, None] - jumps).min(axis=1) > 2 * h
    assert np.abs(differences - motion.at(t)[1])[apart].max() < 1e-8
    assert motion.slip == pytest.approx(np.abs(np.diff(motion.at(np.linspace(0, 2, 40001))[0])).sum(), rel=1e-3)


def test_the_mirrored_slope_and_one_way() -> None:
    base = harmonic(14.0, 9.0, 2.0)
    other = tuple(replace(one, amplitude=-one.amplitude) for one in base)
    one, two = solve(SLOPE, base, 3.0), solve(replace(SLOPE, slope=-20.0), other, 3.0)
    assert one.at([1.0, 3.0])[0] == pytest.approx(-two.at([1.0, 3.0])[0], rel=1e-12)
    down = solve(replace(SLOPE, two_way=False), base, 3.0)
    assert 0 < down.slip == pytest.approx(down.at([3.0])[0][0])
    thrown = moved([0, 0.1, 0.2], [0, -0.02, 0.02])  # down the slope first, then up, where it is held
    ways = {
        held: {way for _, way in solve(replace(SLOPE, two_way=not held), thrown, 1.0).switches}
        for held in (False, True)
    }
    assert ways == {False: {1, -1, 0}, True: {1, 0}}
    assert -1 in {way for _, way in one.switches}
    assert -1 not in {way for _, way in down.switches}


SCENE = """
title = "rigid"
[block]
side = 2.0
density = 2700.0
young = 1.0e9
[contact]
law = "unilateral"
stiffness = 1.0e9
friction = 5.0
cohesion = 1000.0
[load]
gravity = 9.81
base_motion = "BASE"
[time]
step = 0.01
steps = 50
[run]
solvers = ["block-events"]
"""


def scene_of(tmp_path: Path, rows: str, text: str = SCENE):
    (tmp_path / "base.csv").write_text(rows)
    (tmp_path / "scene.toml").write_text(text.replace("BASE", str(tmp_path / "base.csv")))
    return load_scene(tmp_path / "scene.toml")


def test_the_mass_in_the_place_of_a_scenes_block(tmp_path: Path) -> None:
    found = rigid_slide(scene_of(tmp_path, "time,x\n0,0\n0.2,0.1\n0.4,0.1\n"))
    Y = G * math.tan(math.radians(5.0)) + 1000.0 / (2700.0 * 2.0)
    assert found.slide[9] == pytest.approx(-0.5 * 0.1 + Y * 0.1**2 / 2, rel=1e-12)
    assert found.slip >= abs(found.slide[-1])
    for change, message in (
        (("friction = 5.0\ncohesion = 1000.0", ""), "friction"),
        (("[load]", "[load]\npressure = 1e5"), "load"),
    ):
        with pytest.raises(InputError, match=message):
            rigid_slide(scene_of(tmp_path, "time,x\n0,0\n1,1\n", SCENE.replace(*change)))
    with pytest.raises(InputError, match="along x"):
        rigid_slide(scene_of(tmp_path, "time,y\n0,0\n1,1\n"))


def test_harmonic_slide_in_plain_numbers() -> None:
    t = np.linspace(0.1, 3.0, 30)
    found = harmonic_slide(20.0, 30.0, 6.0, 10.0, 3.0, t)
    motion: SlidingMotion = solve(SLOPE, harmonic(6.0, 10.0, 3.0), 3.0)
    assert np.array_equal(found.slide, motion.at(t)[0])
    assert found.slip == motion.slip > 0


def test_bad_input_is_refused_by_name() -> None:
    for field, value in [("slope", 90.0), ("friction", -1.0), ("gravity", -1.0), ("cohesion", math.nan)]:
        with pytest.raises(ValueError, match=field):
            replace(SLOPE, **{field: value})
    for make in (
        lambda: harmonic(1.0, 0.0, 1.0),
        lambda: recorded([0, 1], [1]),
        lambda: recorded([0.5, 1], [1, 1]),
        lambda: moved([0, 0], [1, 1]),
        lambda: solve(SLOPE, moved([0.0], [0.0]), 0.0),
        lambda: solve(SLOPE, moved([0.0], [0.0]), 1.0).at([2.0]),
    ):
        with pytest.raises(ValueError, match="must"):
            make()


def test_a_smooth_record_slides_as_the_motion_that_it_was_taken_from(tmp_path: Path) -> None:
    """Rows of 5 m/s2 sin(w t) twice integrated: the second differences err by (w dt)^2 / 12."""
    rate, t = 4 * math.pi, 0.002 * np.arange(501)
    x = 5.0 / rate * (t - np.sin(rate * t) / rate)
    rows = "".join(f"{q!r},{w!r}\n" for q, w in np.column_stack([t, x]).tolist())
    scene = scene_of(tmp_path, "time,x\n" + rows, SCENE.replace("cohesion = 1000.0", ""))
    found = rigid_slide(scene, smooth=True)
    exact = harmonic_slide(0.0, 5.0, 5.0, rate, 1.0, found.time)
    largest = float(np.max(np.abs(exact.slide)))
    assert largest > 1e-3
    assert np.max(np.abs(found.slide - exact.slide)) < 2 * (rate * 0.002) ** 2 * largest
