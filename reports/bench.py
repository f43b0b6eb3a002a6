"""Speed against named rivals, as ratios in one run; writes `docs/speed.md`.

Both sides run on one BLAS thread, by turns, and each keeps the minimum of its repeats; set-up is counted. A rival's
answer is checked against ours before its time counts. FEniCSx runs where an interpreter has dolfinx, else NOT RUN.

    python reports/bench.py [--quick]
"""

from __future__ import annotations

import argparse
import contextlib
import math
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402  (after the number of threads is set)
from rivals import block_modes, block_numpy, column_numpy, elements_skfem, engines, plane_numpy  # noqa: E402

import dda  # noqa: E402
import fem_reference  # noqa: E402
from dda.bodies.column import Column, Layer, Spring  # noqa: E402
from dda.bodies.column_history import ColumnResult, solve_column  # noqa: E402
from dda.bodies.column_march import Drive  # noqa: E402
from dda.march import compiled  # noqa: E402
from validation import load_scene, solve  # noqa: E402
from validation.engine.measure import completed  # noqa: E402
from validation.engine.run import run_study  # noqa: E402
from validation.engine.study import Study  # noqa: E402
from validation.runs.results import Results  # noqa: E402
from validation.runs.run import Outcome  # noqa: E402
from validation.runs.threads import VARIABLES  # noqa: E402
from validation.scenes.record import base_record  # noqa: E402
from validation.scenes.scene import Scene  # noqa: E402
from validation.solvers.registry import get_solver  # noqa: E402
from validation.solvers.rigid.rocking import quarter_period, rocking  # noqa: E402

TYPED = "stiff-contact"  # the study that is run as typed
AS_TYPED = 1.5  # largest ratio of its seconds over those on one BLAS thread
TABLE = HERE.parent / "docs" / "speed.md"
SQUARE = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
PAPER = (0.5, 1.0, 1.0, 1e-3)  # alpha, delta, gg, dt [s]
MODES = 40  # lowest ones of the elements, of the rival that leaves the others out
MODAL = 2e-3  # of the maximum: what they leave out
History = tuple[np.ndarray, ...]  # displacement [m], contact pressure [Pa]


@dataclass(frozen=True)
class Contest:
    """One line of the table."""

    name: str
    ours: Callable[[], History]
    rival: str
    theirs: Callable[[], History]
    target: float  # ratio that is asked for; 0 where none is
    agreement: float  # greatest difference over the maximum
    repeats: int = 3


def timed(run: Callable[[], History], clock: Callable[[], float] = time.process_time) -> tuple[float, History]:
    """Return seconds and answer of one run; of what takes less than 10 ms, the least of some runs in a row.

    By the processor: on a machine that others use the clock favours what is over before it is interrupted.
    """
    least, total = float("inf"), 0.0
    while total < 0.01:
        began = clock()
        answer = run()
        spent = clock() - began
        least, total = min(least, spent), total + spent
    return least, answer


def difference(found: History, expected: History) -> float:
    """Return the greatest difference of two answers over the maximum."""
    return max(np.abs(a - b).max() / np.abs(b).max() for a, b in zip(found, expected, strict=True))


def line(name: str, ours: float, rival: str, theirs: float, target: float, off: float) -> str:
    """Return a line of the table, and print it."""
    asked = f"{target:g}" if target else "-"
    ratio = theirs / ours
    digits = 0 if ratio >= 10 else 1
    text = f"| {name} | {ours:.3g} | {rival} | {theirs:.3g} | **{ratio:.{digits}f}** | {asked} | {off:.0e} |"
    print(text, flush=True)
    return text


def compete(contest: Contest) -> str:
    """Run both sides by turns; return a line of the table."""
    ours, theirs = [], []
    for _ in range(contest.repeats):
        spent, expected = timed(contest.ours)
        ours.append(spent)
        spent, answer = timed(contest.theirs)
        theirs.append(spent)
        off = difference(answer, expected)
        if not off <= contest.agreement:
            raise SystemExit(f"{contest.name}: {contest.rival} differs by {off:.2g} of the maximum")
    return line(contest.name, min(ours), contest.rival, min(theirs), contest.target, off)


# ---- ours -----------------------------------------------------------------------------------------------------------


def dda_model() -> dda.TwoBlockModel:
    """Return the model of the square block."""
    block = dda.Block(SQUARE, dda.Material(2700.0, 1e9, 0.0))
    model = dda.TwoBlockModel(block, dda.Contact(1e9), 5e6)
    model.gap_form.reduced()
    return model


def dda_history(steps: int, model: dda.TwoBlockModel | None = None) -> History:
    """Solve the square block, and build its model where it is not there already."""
    return tuple(dda.solve(model or dda_model(), dda.Scheme(*PAPER), steps).columns.values())


def fem_history(steps: int, poisson: float, elements: int = 64) -> History:
    """Mesh the square block and solve it."""
    numbers = (2700.0, 1e9, poisson, "plane stress", 1e9, 1e9, 5e6)
    problem = fem_reference.Problem(SQUARE, 0, 2, *numbers, elements=elements, degree=1)
    return tuple(fem_reference.solve(problem, fem_reference.Scheme(*PAPER), steps).columns.values())


# ---- contests -------------------------------------------------------------------------------------------------------


def dda_contest(steps: int, model: dda.TwoBlockModel, target: float, agreement: float, repeats: int) -> Contest:
    """Return a contest of the block."""
    name = f"dda, {steps:,} steps"
    theirs = lambda: block_numpy.history(steps)  # noqa: E731
    return Contest(name, lambda: dda_history(steps, model), "numpy loop", theirs, target, agreement, repeats)


def dda_modes_contest(steps: int, model: dda.TwoBlockModel, repeats: int) -> Contest:
    """Return a contest of the block against the strongest rival that a user has: twenty lines of SciPy."""
    theirs = lambda: block_modes.history(steps)  # noqa: E731
    ours = lambda: dda_history(steps, model)  # noqa: E731
    return Contest(f"dda, {steps:,} steps", ours, "two modes, lfilter", theirs, 0, 1e-11, repeats)


def opening_model(p: float = 1e9) -> dda.UnilateralModel:
    """Return the square block on corners that open."""
    return dda.UnilateralModel(dda.Block(SQUARE, dda.Material(2700.0, 1e9, 0.0)), dda.Unilateral(p), 5e6)


def opening_history(
    steps: int, dt: float, model: dda.UnilateralModel | None = None, singly: bool = False
) -> dda.ContactResult:
    """Solve the square block on corners that open; step by step in all six unknowns if `singly`."""
    options = dda.UnilateralOptions(full=singly)
    return dda.solve_unilateral(model or opening_model(), dda.Scheme(0.5, 1.0, 1.0, dt), steps, options=options)


def opening_elements(n: int, dt: float, shear: float = 0.0) -> tuple[fem_reference.Problem, fem_reference.Scheme]:
    """Return the square block under a load off its centre, in bilinear elements."""
    numbers = (2700.0, 1e9, 0.25, "plane stress", 1e9, shear, 5e6)
    problem = fem_reference.Problem(SQUARE, 0, 2, *numbers, elements=n, degree=1, eccentricity=0.25)
    return problem, fem_reference.Scheme(0.5, 1.0, 1.0, dt)


def fem_contest(steps: int, mu: float, target: float, repeats: int) -> Contest:
    """Return a contest of the elements."""
    name = f"fem, 64 x 64, mu = {mu:g}, {steps:,} steps"
    theirs = lambda: elements_skfem.history(steps, poisson=mu)  # noqa: E731
    ours = lambda: fem_history(steps, mu)  # noqa: E731
    return Contest(name, ours, "scikit-fem, SuperLU loop", theirs, target, 1e-10, repeats)


def fem_modes_contest(steps: int, mu: float, repeats: int) -> Contest:
    """Return a contest of the elements against their lowest modes about the static answer."""
    name = f"fem, 64 x 64, mu = {mu:g}, {steps:,} steps"
    theirs = lambda: elements_skfem.modal(steps, MODES, poisson=mu)  # noqa: E731
    ours = lambda: fem_history(steps, mu)  # noqa: E731
    return Contest(name, ours, f"{MODES} modes, eigsh and lfilter", theirs, 0, MODAL, repeats)


def contests(quick: bool) -> list[Contest]:
    """Return the contests; `quick` leaves the long ones out."""
    model = dda_model()
    lines = [dda_modes_contest(10**4, model, 9)]
    lines += [dda_contest(10**4, model, 200, 1e-11, 9)]
    if not quick:
        lines += [dda_modes_contest(10**6, model, 5), dda_contest(10**6, model, 500, 1e-9, 3)]
        lines += [fem_modes_contest(10**4, 0.25, 2), fem_contest(10**4, 0.25, 60, 1)]
    lines += [fem_contest(1000, 0.25, 10, 3)]
    return [*lines, fem_modes_contest(1000, 0.0, 2), fem_contest(1000, 0.0, 80, 2)]


def fenicsx_line(n: int = 64, steps: int = 1000) -> str:
    """Return the line of FEniCSx, whose seconds are its own, without starting its interpreter."""
    values = {"block.poisson": 0.25, "fem.elements": n, "fem.degree": 1, "time.steps": steps, "time.step": 1e-3}
    scene = load_scene("figures-3-4").with_values(values)
    ours = min(timed(lambda: fem_history(steps, 0.25, n), time.perf_counter)[0] for _ in range(3))
    runs = [completed(get_solver("fenicsx"), scene) for _ in range(2)]
    name, rival = f"fem, {n} x {n}, mu = 0.25, {steps:,} steps", "FEniCSx, PETSc LU"
    if runs[0].outcome is not Outcome.COMPLETED:
        return f"| {name} | {ours:.3g} | {rival} | NOT RUN: {'; '.join(runs[0].notes)} | | | |"
    own, other = ((run.displacement, run.contact_pressure) for run in (solve(scene, "fem"), runs[0]))
    return line(name, ours, rival, min(sum(run.seconds.values()) for run in runs), 0, difference(own, other))


# ---- microseconds a step --------------------------------------------------------------------------------------------


def step_line(
    name: str,
    steps: int,
    switches: int,
    seconds: float,
    budget: float,
    engine_seconds: Sequence[float | str],
    compared: str,
) -> str:
    """Return a line of the table of steps, and print it.

    Parameters
    ----------
    name
        What is stepped.
    steps, switches
        Number of steps, and of them how many change a contact state.
    seconds
        Seconds of all steps, set-up counted.
    budget
        Greatest number of microseconds a step that is asked for.
    engine_seconds
        Seconds of the same number of steps of each of `engines.ENGINES`, or why there are none.
    compared
        How far the answers are apart, in words.
    """
    ours = 1e6 * seconds / steps
    others = [each if isinstance(each, str) else f"{1e6 * each / steps:.1f}" for each in engine_seconds]
    text = f"| {name} | {steps:,} | {switches:,} | {ours:.3g} | {budget:g} | {' | '.join(others)} | {compared} |"
    print(text, flush=True)
    return text


def engine_runs(
    dt: float, gravity: np.ndarray, **box: float | tuple[float, float]
) -> dict[str, tuple[float, np.ndarray]]:
    """Return seconds and rows of each engine that is there."""
    found = {}
    for engine in engines.ENGINES:
        if not engines.absent(engine):
            found[engine] = least(lambda: engines.box(engine, dt, gravity, **box), 1)  # noqa: B023
    return found


def engine_seconds(runs: dict[str, tuple[float, np.ndarray]]) -> list[float | str]:
    """Return the seconds of each engine, or why it has none."""
    return [runs[engine][0] if engine in runs else engines.absent(engine) for engine in engines.ENGINES]


def opening_steps(steps: int = 10**5, dt: float = 1e-5, p: float = 1.5e9) -> str:
    """Return the line of a block on corners that open; the engines drop the same box by a millimetre."""
    model = opening_model(p)
    opening_history(4 * steps, dt, model)  # long enough to be compiled, which is kept
    seconds, answer = least(lambda: opening_history(steps, dt, model), 5)
    switches = np.count_nonzero(np.diff(answer.closed[0]))
    off = difference(tuple(answer.columns.values()), block_numpy.opening(steps, dt=dt, p=p))
    runs = engine_runs(dt, np.tile([0.0, -9.81], (steps, 1)), gap=1e-3)
    compared = f"numpy loop, all states' inverses: {off:.0e}"
    return step_line("dda, contact that opens", steps, switches, seconds, 0.1, engine_seconds(runs), compared)


def slope_scene(steps: int) -> Scene:
    """Return the block on an incline under a record, in as many steps."""
    scene = load_scene("slope-quake").model_copy(update={"sweep": {}})
    step = scene.time.step * scene.time.steps / steps
    return scene.with_values({"time.step": step, "time.steps": steps, "contact.stiffness": 1e11})


def slipping_steps(steps: int = 10**5) -> str:
    """Return the line of a block that slips on an incline under a record."""
    scene = slope_scene(steps)
    seconds, run = least(lambda: solve(scene, "dda"), 3)
    slide = run.history.columns["slide_m"]
    speed = np.abs(np.diff(slide))
    switches = np.count_nonzero(np.diff(speed > 1e-3 * speed.max()))  # below that it is held by its springs
    record, dt, turn = base_record(scene), scene.time.step, np.radians(scene.load.slope)
    place = np.interp(dt * np.arange(-1, steps + 1), record.time, record.x)
    gravity = np.tile(scene.load.gravity * np.array([np.sin(turn), -np.cos(turn)]), (steps, 1))
    gravity[:, 0] -= np.diff(place, 2) / dt**2
    runs = engine_runs(dt, gravity, friction=float(np.tan(np.radians(scene.contact.friction))))
    far = [f"{engine} {abs(rows[-1, 0] / slide[-1] - 1):.1%}" for engine, (_, rows) in runs.items()]
    compared = f"slide of {slide[-1]:.3g} m: {', '.join(far) or 'none'}"
    return step_line("dda, slope under a record", steps, switches, seconds, 1.0, engine_seconds(runs), compared)


def rocking_box(scene: Scene) -> dict[str, float | tuple[float, float]]:
    """Return the box of `field-rocking` for the engines."""
    tangent = float(np.tan(np.radians(scene.contact.friction)))
    return {
        "size": (scene.block.width, scene.block.height),
        "tilt": float(np.radians(scene.block.tilt)),
        "friction": tangent,
    }


def turning_steps(steps: int = 30_000, dt: float = 1e-4) -> str:
    """Return the line of a block that rocks on its corners with impacts; the fall is compared, which has no impact."""
    scene = load_scene("field-rocking").with_values({"time.step": dt, "time.steps": steps})
    box = rocking_box(scene)
    seconds, run = least(lambda: solve(scene, "dda"), 2)
    rotation = box["tilt"] + run.history.columns["rotation"]
    impacts = np.count_nonzero(np.diff(np.sign(rotation)))
    runs = engine_runs(dt, np.tile([0.0, -9.81], (steps, 1)), **box)
    far = [f"dda {fall_error(rotation, dt, box):.0e}"]
    far += [f"{engine} {fall_error(rows[:, 2], dt, box):.0e}" for engine, (_, rows) in runs.items()]
    compared = f"exact fall: {', '.join(far)}"
    return step_line("dda, rocking with impacts", steps, impacts, seconds, 3.0, engine_seconds(runs), compared)


def fall_error(rotation: np.ndarray, dt: float, box: dict[str, float | tuple[float, float]]) -> float:
    """Return the greatest error of a rotation over the tilt, until the block comes down for the first time."""
    (width, height), tilt = box["size"], box["tilt"]
    count = min(len(rotation), int(quarter_period(width, height, tilt) / dt))
    exact = rocking(width, height, tilt, dt * np.arange(1, count + 1)).rotation
    return float(np.abs(rotation[:count] - exact).max() / tilt)


def shaken_column(steps: int, blocks: int = 80) -> ColumnResult:
    """Return the history of rigid blocks with gaps between them on a shaken base, as `column_numpy` has it."""
    dt, amplitude, w = 4e-4, 1.86e-3, 125.66
    time = dt * np.arange(steps + 1)
    column = Column(
        [Layer(float(blocks), 2500.0, np.inf, blocks=blocks, velocity=amplitude * w)],
        law="unilateral",
        joints=[Spring(float(height), 1e9, 1e-3) for height in range(blocks)],
        gravity=9.81,
    )
    motion = amplitude * np.sin(w * time), amplitude * w * np.cos(w * time), -amplitude * w * w * np.sin(w * time)
    return solve_column(column, dda.Scheme(0.25, 0.5, 1.0, dt), Drive(*motion, 0 * time))


def column_steps(steps: int = 10**5, checked: int = 300) -> str:
    """Return the line of a column of blocks whose contacts open, its first steps against a numpy loop."""
    seconds, answer = least(lambda: shaken_column(steps), 3)
    rival, theirs = least(lambda: column_numpy.history(checked), 1)
    off = difference(tuple(values[:checked] for values in answer.columns.values()), theirs)
    switches = int(answer.step_switches.sum())
    compared = f"numpy loop, {1e6 * rival / checked:.0f} us: {off:.0e} over {checked} steps"
    return step_line("dda, column of 80 rigid blocks", steps, switches, seconds, 20.0, ["-", "-"], compared)


def fem_steps(steps: int = 10**5, checked: int = 2000) -> str:
    """Return the line of bonded elements on a base that opens, its first steps against those of the mesh itself."""
    problem, scheme = opening_elements(16, 1e-4, 1e9)
    contact, columns = fem_reference.Unilateral(shear="glued"), ("displacement", "contact_pressure", "open_share")
    solved = lambda count, full: fem_reference.solve_unilateral(  # noqa: E731
        problem, scheme, count, contact, full=full, columns=columns
    )
    solved(steps, False)
    seconds, answer = least(lambda: solved(steps, False), 2)
    mesh = solved(checked, True)
    off = max(
        np.abs(answer.columns[name][:checked] - mesh.columns[name]).max() / np.abs(mesh.columns[name]).max()
        for name in columns[:2]
    )
    spent = f"{1e6 * mesh.stepping_seconds / checked:.0f} us"
    switches = np.count_nonzero(np.diff(answer.columns["open_share"]))
    compared = f"steps of the mesh, {spent}: {off:.0e}; {answer.notes[-1]}"
    return step_line("fem, 16 x 16, bonded, opens", steps, switches, seconds, 20.0, ["-", "-"], compared)


PLANE = (1e8, 4e7, 0.5)  # stiffness and shear stiffness of a corner [N/m], tan(phi)


def rectangle(x: float, y: float, width: float, height: float, turned: float = 0.0) -> np.ndarray:
    """Return the corners of an upright rectangle from its lower left one, turned about the origin [deg]."""
    cos, sin = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    corners = np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])
    return corners @ np.array([[cos, sin], [-sin, cos]])


def sliding_blocks() -> list[dda.PlaneBlock]:
    """Return two squares, one behind the other on a slope steeper than their friction."""
    ground = dda.PlaneBlock(rectangle(-30, -1, 40, 1, 40.0), 2500.0, fixed=True)
    return [ground, *(dda.PlaneBlock(rectangle(x, 0, 1, 1, 40.0), 2500.0) for x in (0.0, -2.0))]


def wall(rows: int = 10, bricks: int = 10) -> list[dda.PlaneBlock]:
    """Return a wall whose rows overlap by a quarter, on a floor, whose joints have no gap."""
    blocks = [dda.PlaneBlock(rectangle(-1, -1, bricks + 3, 1), 2500.0, fixed=True)]
    for row in range(rows):
        blocks += [dda.PlaneBlock(rectangle(k + 0.25 * (row % 2), 0.5 * row, 1, 0.5), 2500.0) for k in range(bricks)]
    return blocks


def pile(count: int = 200) -> list[dda.PlaneBlock]:
    """Return random polygons above the floor of a box."""
    random = np.random.default_rng(3)
    across = math.ceil(math.sqrt(count))
    wide, high = 1.3 * across, 3.0 * across
    sides = [(-1.0, -1.0, wide + 2, 1.0), (-1.0, 0.0, 1.0, high), (wide, 0.0, 1.0, high)]
    blocks = [dda.PlaneBlock(rectangle(*side), 2500.0, fixed=True) for side in sides]
    for number in range(count):
        n = random.integers(3, 8)
        angles = 2 * np.pi / n * (np.arange(n) + np.sort(random.uniform(0, 0.8, n)))
        place = np.array([0.65 + 1.3 * (number % across), 0.52 + 1.05 * (number // across)])
        ring = 0.5 * np.column_stack([np.cos(angles), np.sin(angles)]) + place
        velocity = tuple(random.normal(0, 0.5, 2))
        blocks.append(dda.PlaneBlock(ring, 2500.0, velocity=velocity, spin=random.normal()))
    return blocks


def plane_history(blocks: list[dda.PlaneBlock], steps: int, gg: float = 1.0) -> dda.PlaneResult:
    """Return a history of blocks whose contacts are found, compiled."""
    stiffness, shear, friction = PLANE
    model = dda.PlaneModel(blocks, gravity=(0.0, -9.81), found=dda.ContactSprings(stiffness, shear, friction))
    scheme = dda.Scheme(0.5, 1.0, gg, 1e-3, "consistent")
    return dda.solve_plane(model, scheme, steps, every=steps, compiled=True)


def plane_steps(
    name: str, blocks: list[dda.PlaneBlock], steps: int, checked: int, budget: float, apart: float, gg: float = 1.0
) -> str:
    """Return the line of blocks in the plane, their first steps against a numpy loop.

    Its rule of contact is a simpler one: how far the answers may be apart, over the greatest displacement, is said.
    """
    seconds, result = least(lambda: plane_history(blocks, steps, gg), 2)
    velocity = np.array([(*block.velocity, block.spin) for block in blocks])
    outlines = [np.array(block.vertices) for block in blocks]
    held = [block.held for block in blocks]
    theirs, answer = least(lambda: plane_numpy.history(outlines, held, checked, 1e-3, *PLANE, velocity, gg), 1)
    ours = plane_history(blocks, checked, gg).displacement[-1]
    off = difference((answer,), (ours,))
    if result.outcome != "completed" or off > apart:
        raise SystemExit(f"{name}: {result.outcome}; the numpy loop differs by {off:.2g} of the maximum")
    compared = f"numpy loop, {1e6 * theirs / checked:.0f} us: {off:.0e} over {checked} steps"
    return step_line(f"dda, {name}", steps, int(np.sum(result.solves)), seconds, budget, ["-", "-"], compared)


def plane_lines() -> list[str]:
    """Return the lines of blocks in the plane.

    The budgets: twenty microseconds for two blocks, ten times those of a special body that slides for each; two thirds
    of what a first version in plain numpy and numba took for the others.
    """
    return [
        plane_steps("two blocks on a slope", sliding_blocks(), 2000, 500, 20.0, 1e-3),
        plane_steps("wall of 100 bricks at rest", wall(), 1000, 20, 1700.0, 0.1, gg=0.9),
        plane_steps("pile of 200 polygons", pile(), 600, 200, 2000.0, 0.02),
    ]


def least(run: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Return the least processor seconds of some runs, and the answer; what is compiled at the first is not counted."""
    answer = run()
    seconds = []
    for _ in range(repeats):
        began = time.process_time()
        answer = run()
        seconds.append(time.process_time() - began)
    return min(seconds), answer


@contextlib.contextmanager
def held_to(how: str) -> Iterator[None]:
    """Let all histories run in plain Python, or all compiled, whatever their length."""
    names = ("SHORT", "LONG")
    before = [getattr(compiled, name) for name in names]
    for name in names:
        setattr(compiled, name, math.inf if how == compiled.PLAIN else 0.0)
    try:
        yield
    finally:
        for name, value in zip(names, before, strict=True):
            setattr(compiled, name, value)


def accuracy_lines(steps: Sequence[float] = (5e-3, 1e-3, 2e-4)) -> list[str]:
    """Return the lines of error against time for the fall of the tilted block of `field-rocking`."""
    scene = load_scene("field-rocking")
    box, lines = rocking_box(scene), []
    end = quarter_period(*box["size"], box["tilt"])
    for dt in steps:
        count = int(end / dt)
        fall = scene.with_values({"time.step": dt, "time.steps": count})
        cells = []
        for how in (compiled.PLAIN, compiled.COMPILED):
            with held_to(how):
                seconds, run = least(lambda: solve(fall, "dda"), 2)  # noqa: B023
            rotation = box["tilt"] + run.history.columns["rotation"]
            cells.append(f"{fall_error(rotation, dt, box):.0e}, {seconds:.2g}")
        for engine in engines.ENGINES:
            for fine in (False, True):
                if engines.absent(engine):
                    cells.append(engines.absent(engine))
                    continue
                gravity = np.tile([0.0, -9.81], (count, 1))
                seconds, rows = least(lambda: engines.box(engine, dt, gravity, fine=fine, **box), 2)  # noqa: B023
                cells.append(f"{fall_error(rows[:, 2], dt, box):.0e}, {seconds:.2g}")
        lines.append(f"| {dt:g} | {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    return lines


# ---- growth ---------------------------------------------------------------------------------------------------------


def least_seconds(run: Callable[[], History], repeats: int) -> float:
    """Return the least seconds of some runs."""
    return min(timed(run)[0] for _ in range(repeats))


def grown(name: str, sizes: Sequence[int], seconds: Callable[[int], float]) -> str:
    """Return seconds at the greatest size, and the exponent of their growth over the upper two thirds of the sizes."""
    spent = [seconds(n) for n in sizes]
    part = slice(len(sizes) // 3, None)
    exponent = np.polyfit(np.log(sizes[part]), np.log(spent[part]), 1)[0]
    return f"- {name}: {spent[-1]:.2g} s at {sizes[-1]:,}, as n^{exponent:.2f}"


def growth(quick: bool) -> list[str]:
    """Return a line for each growth."""
    model, steps, meshes = dda_model(), [10**3, 10**4, 10**5, 10**6], [4, 8, 16, 32, 64, 128]
    meshes = meshes[:-1] if quick else meshes
    return [
        grown("dda, steps", steps, lambda n: least_seconds(lambda: dda_history(n, model), 5)),
        grown("fem, 16 x 16, mu = 0.25, steps", steps, lambda n: least_seconds(lambda: fem_history(n, 0.25, 16), 2)),
        grown(
            "fem, mu = 0.25, 1,000 steps, elements per side",
            meshes,
            lambda n: least_seconds(lambda: fem_history(1000, 0.25, n), 2),
        ),
        grown("dda, pile of n polygons, 800 steps", [50, 100, 200, 400], pile_seconds),
        grown("dda, wall of n bricks that settles, 200 steps", [49, 100, 196, 400], wall_seconds),
        grown("engine, scenes (dda, 200 steps)", [1, 10, 100], lambda n: sweep_seconds("figures-3-4", {}, "dda", n)),
    ]


def pile_seconds(count: int) -> float:
    """Return the seconds of 800 steps of so many polygons in a box."""
    return least(lambda: plane_history(pile(count), 800), 1)[0]


def wall_seconds(count: int) -> float:
    """Return the seconds of 200 steps in which a square wall of so many bricks comes to rest."""
    side = math.isqrt(count)
    return least(lambda: plane_history(wall(side, side), 200), 2)[0]


def sweep_seconds(name: str, values: dict[str, float], solver: str, count: int, jobs: int = 1) -> float:
    """Return the seconds of a study of some time steps of a scene, results kept."""
    steps = [1e-3 * (1 + i / count) for i in range(count)]
    scene = load_scene(name).with_values(values).model_copy(update={"sweep": {"time.step": steps}})
    study = Study("sweep", "Sweep", "Sweep.", [scene], (solver,), measures=("history",))
    with tempfile.TemporaryDirectory() as directory:
        began = time.perf_counter()
        run_study(study, Results(directory), jobs=jobs)
        return time.perf_counter() - began


def two_workers(count: int = 16, n: int = 48) -> str:
    """Return the line of a sweep on two worker processes over that on one."""
    values = {"fem.elements": n, "fem.degree": 1}
    one, two = (sweep_seconds("poisson", values, "fem", count, jobs) for jobs in (1, 2))
    return f"A sweep of {count} scenes by `fem` takes {one:.2g} s on one worker and {two:.2g} s on two."


def typed_seconds(variables: dict[str, str]) -> float:
    """Return the seconds of a study as the command line runs it in an environment with these variables of BLAS."""
    plain = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    with tempfile.TemporaryDirectory() as directory:
        command = [sys.executable, "-m", "validation", "run", TYPED, "--quiet", "--results", directory]
        began = time.perf_counter()
        subprocess.run(command, env=plain | variables, cwd=HERE.parent, check=True)
        return time.perf_counter() - began


def threads_line(repeats: int = 2) -> str:
    """Return the line of a study as typed over the same on one BLAS thread, by turns, the least seconds of each."""
    typed, single = [], []
    for _ in range(repeats):
        typed.append(typed_seconds({}))
        single.append(typed_seconds({"OMP_NUM_THREADS": "1"}))
    ratio = min(typed) / min(single)
    if ratio > AS_TYPED:
        raise SystemExit(f"run {TYPED}: as typed {ratio:.2f} times as long as on one BLAS thread, above {AS_TYPED}")
    return (
        f"`run {TYPED}` takes {min(typed):.2g} s as typed, **{ratio:.2f}** of that on one thread (at most {AS_TYPED})."
    )


PAGE = """# Speed

Written by `make bench` ({machine}, Python {python}, numpy {numpy}); one BLAS thread on both sides, by turns, least
processor seconds, set-up counted. Constant acceleration, p = E, dt = 1e-3 s. The ratio is how many times as long the
rival (`reports/rivals`) takes, the last column the greatest difference of the answers over the maximum. The strongest
rivals sum modes by `scipy.signal.lfilter`: of the block both, of the elements the {modes} lowest about the static
answer; a loop over steps is what one writes for whatever is not linear.

| what | ours [s] | rival | rival [s] | ratio | asked for | difference |
|---|---|---|---|---|---|---|
{contests}

## Steps that switch

Microseconds of processor time a step with set-up; the budget is what a step may take. What numba compiles is not
counted: once an install, for the first long history of each kind, 4 to 16 s of a block, of one that turns and of a
column, 30 s of the elements (from 50,000 steps on), 11 to 20 s of blocks in the plane, whose switches are solves. 1e5
steps of a block that opens take two seconds in plain Python, 0.02 s from then on. MuJoCo and pymunk step the same box
as a rigid one on a plane, each step in a Python loop.

| what | steps | switches | ours [us] | budget [us] | MuJoCo [us] | pymunk [us] | answers apart |
|---|---|---|---|---|---|---|---|
{steps}

Error of the rotation over the tilt until the block of `field-rocking` comes down, and seconds; "fine" are the
settings of `examples/peers` (MuJoCo) and fifty iterations without slop (pymunk).

| dt [s] | dda, plain Python | dda, compiled | MuJoCo | MuJoCo, fine | pymunk | pymunk, fine |
|---|---|---|---|---|---|---|
{accuracy}

## Growth

{growth}

A history keeps 8 (1 + columns) bytes a step, and while it is made a block of steps more. The elements keep 8 bytes
times unknowns times vectors of the small space (at most 400), beside the factor of one sparse matrix. {sweep}

## Threads

Every process takes one BLAS thread, unless the environment says otherwise.
{threads}
"""


def main() -> None:
    """Run all and write the page."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--quick", action="store_true", help="leave the long contests out and print only")
    quick = options.parse_args().quick
    page = PAGE.format(
        machine=f"{os.cpu_count()} cores, {platform.machine()}",
        python=platform.python_version(),
        numpy=np.__version__,
        modes=MODES,
        contests="\n".join([*map(compete, contests(quick)), fenicsx_line()]),
        steps="\n".join(
            [opening_steps(), slipping_steps(), turning_steps(), column_steps(), fem_steps(), *plane_lines()]
        ),
        accuracy="\n".join(accuracy_lines()),
        growth="\n".join(growth(quick)),
        sweep=two_workers(),
        threads=threads_line(1 if quick else 2),
    )
    if quick:
        print(page)
    else:
        TABLE.write_text(page, encoding="utf-8")
        print(f"wrote {TABLE}")


if __name__ == "__main__":
    main()
