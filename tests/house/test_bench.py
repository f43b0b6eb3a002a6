"""The rivals of `make bench` give our answers, and the committed table holds what was asked for."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import dda
import fem_reference

ROOT = Path(__file__).resolve().parents[2]
SQUARE = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))


@pytest.fixture
def rivals(monkeypatch):
    monkeypatch.setattr(sys, "path", [str(ROOT / "reports"), *sys.path])
    from rivals import block_modes, block_numpy, elements_skfem

    return block_numpy, elements_skfem, block_modes


def apart(ours, theirs):
    """Return the greatest difference of two answers over the maximum."""
    return max(np.abs(a - b).max() / np.abs(b).max() for a, b in zip(ours, theirs, strict=True))


@pytest.mark.parametrize(("alpha", "delta"), [(0.5, 1.0), (0.3025, 0.6)])
def test_rivals_give_our_answers(rivals, alpha, delta):
    block, elements, modes = rivals
    model = dda.TwoBlockModel(dda.Block.rectangle(2.0, 2.0, dda.Material(2700.0, 1e9, 0.0)), dda.Contact(3e9), 5e6)
    ours = list(dda.solve(model, dda.Scheme(alpha, delta, 1.0, 7e-4), 150).columns.values())
    theirs = block.history(150, p=3e9, dt=7e-4, alpha=alpha, delta=delta)
    problem = fem_reference.Problem(
        SQUARE, 0, 2, 2700.0, 1e9, 0.25, "plane stress", 3e9, 3e9, 5e6, elements=8, degree=1
    )
    found = list(fem_reference.solve(problem, fem_reference.Scheme(alpha, delta, 1.0, 7e-4), 150).columns.values())
    square = {"n": 8, "p": 3e9, "dt": 7e-4, "alpha": alpha, "delta": delta}
    pairs = [(ours, theirs), (ours, modes.history(150, p=3e9, dt=7e-4, alpha=alpha, delta=delta))]
    pairs.append((found, elements.history(150, **square)))
    assert all(apart(*pair) <= 1e-10 for pair in pairs)  # what `make bench` asks before a time counts
    # modes that are left out are all that parts a sum of modes from our answer
    assert (
        apart(found, elements.modal(150, 160, **square)) < 1e-6 < apart(found, elements.modal(150, 40, **square)) < 0.05
    )


def test_the_rival_of_elements_on_a_base_that_opens_gives_our_answers(rivals):
    problem = fem_reference.Problem(
        SQUARE, 0, 2, 2700.0, 1e9, 0.25, "plane stress", 3e9, 0.0, 5e6, elements=8, degree=1, eccentricity=0.25
    )
    ours = fem_reference.solve_unilateral(problem, fem_reference.Scheme(0.5, 1.0, 1.0, 2e-4), 120).columns
    theirs = rivals[1].opening(120, n=8, p=3e9, dt=2e-4)
    assert 0 < ours["open_share"].mean() < 1
    for name, values in zip(("displacement", "contact_pressure"), theirs, strict=True):
        assert np.abs(ours[name] - values).max() <= 1e-9 * np.abs(values).max()


def test_the_rival_of_columns_gives_our_answers(rivals):
    import bench
    from rivals import column_numpy

    ours = bench.shaken_column(400, blocks=12)
    assert ours.step_switches.sum() > 20
    for name, values in zip(("displacement", "contact_pressure"), column_numpy.history(400, blocks=12), strict=True):
        assert np.abs(ours.columns[name] - values).max() <= 1e-9 * np.abs(values).max()


def test_the_rival_of_the_plane_gives_our_answers(rivals):
    """To what its simpler rule of contact leaves: nothing of blocks that slide, what corners coincide of a wall."""
    import bench
    from rivals import plane_numpy

    stiffness, shear, friction = bench.PLANE
    springs = dda.ContactSprings(stiffness, shear, friction)
    for blocks, steps, most in (
        (bench.sliding_blocks(), 200, 1e-4),
        (bench.wall(3, 2), 60, 0.1),
        (bench.pile(5), 150, 0.01),
    ):
        model = dda.PlaneModel(blocks, gravity=(0.0, -9.81), found=springs)
        ours = dda.solve_plane(model, dda.Scheme(0.5, 1.0, 1.0, 1e-3, "consistent"), steps, compiled=False)
        velocity = np.array([(*block.velocity, block.spin) for block in blocks])
        outlines = [np.array(block.vertices) for block in blocks]
        held = [block.held for block in blocks]
        theirs = plane_numpy.history(outlines, held, steps, 1e-3, *bench.PLANE, velocity)
        assert bench.difference((theirs,), (ours.displacement[-1],)) < most


def test_the_committed_table_holds_what_was_asked_for():
    lines = re.findall(r"\*\*(\d+)\*\* \| (\d+) \|", (ROOT / "docs" / "speed.md").read_text())
    assert len(lines) >= 5
    assert all(int(ratio) >= int(asked) for ratio, asked in lines)


def test_a_command_as_typed_takes_about_as_long_as_on_one_thread():
    table = (ROOT / "docs" / "speed.md").read_text().split("## Threads")[1]
    lines = re.findall(r"\*\*([\d.]+)\*\* of that on one thread \(at most ([\d.]+)\)", table)
    assert lines
    assert all(float(ratio) <= float(most) <= 1.5 for ratio, most in lines)


@pytest.mark.long
def test_each_part_of_the_bench_runs():
    code = (
        "import bench; print(bench.fenicsx_line(4, 20)); print(bench.two_workers(2, 4)); "
        "print(bench.grown('n', [1, 2, 4], lambda n: n**2)); "
        "print(bench.compete(bench.dda_contest(50, bench.dda_model(), 0, 1e-9, 1))); "
        "bench.opening_steps(200); bench.slipping_steps(200); bench.turning_steps(100); bench.fem_steps(300, 200); "
        "bench.accuracy_lines([0.02])"
    )
    told = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT / "reports", capture_output=True, text=True, timeout=300
    )
    assert told.returncode == 0, told.stderr
    lines = told.stdout.splitlines()
    assert lines[0].startswith("| fem, 4 x 4, mu = 0.25, 20 steps |")
    assert "A sweep of 2 scenes by `fem` takes" in told.stdout
    assert "- n: 16 s at 4, as n^2.00" in lines
    assert "| numpy loop |" in told.stdout
    for name, steps in (("contact that opens", 200), ("slope under a record", 200), ("rocking with impacts", 100)):
        assert f"| dda, {name} | {steps} |" in told.stdout
    assert "| fem, 16 x 16, bonded, opens | 300 |" in told.stdout and "| 0.02 | " in told.stdout


def test_the_engines_fall_and_slide_as_a_rigid_box_does(rivals, monkeypatch):
    from rivals import engines

    there = [engine for engine in engines.ENGINES if not engines.absent(engine)]
    monkeypatch.setattr(engines.importlib.util, "find_spec", lambda name: None)
    assert [engines.absent(engine) for engine in engines.ENGINES] == [
        "NOT RUN: mujoco is not installed",
        "NOT RUN: pymunk is not installed",
    ]
    for engine in there:
        free = engines.box(engine, 1e-3, np.tile([0.0, -9.81], (100, 1)), gap=1.0)
        assert free[-1, 1] == pytest.approx(2.0 - 9.81 * 0.1**2 / 2, rel=1e-2)
        slides = engines.box(engine, 1e-3, np.tile([5.0, -9.81], (500, 1)), friction=0.2)
        assert slides[-1, 0] == pytest.approx((5.0 - 0.2 * 9.81) * 0.5**2 / 2, rel=3e-2)
