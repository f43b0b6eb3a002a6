"""Speed against named rivals, as ratios in one run; writes `docs/speed.md`.

Both sides run on one BLAS thread, by turns, and each keeps the minimum of its repeats; set-up is counted. A rival's
answer is checked against ours before its time counts. FEniCSx runs where an interpreter has dolfinx, else NOT RUN.

    python reports/bench.py [--quick]
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402  (after the number of threads is set)

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
TABLE = HERE.parent / "docs" / "speed.md"
History = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Contest:
    """One line of the table."""

    name: str
    ours: Callable[[], History]
    rival: str
    theirs: Callable[[], History]
    target: float  # ratio that is asked for; 0 where none is
    agreement: float  # over the maximum
    repeats: int = 3


def timed(run: Callable[[], History]) -> tuple[float, History]:
    """Return seconds and answer of one run; of what takes less than 10 ms, the least of some runs in a row."""
    least, total = float("inf"), 0.0
    while total < 0.01:
        began = time.perf_counter()
        answer = run()
        spent = time.perf_counter() - began
        least, total = min(least, spent), total + spent
    return least, answer


def compete(contest: Contest) -> str:
    """Run both sides by turns; return a line of the table."""
    ours, theirs, off = [], [], 0.0
    for _ in range(contest.repeats):
        for seconds, run in ((ours, contest.ours), (theirs, contest.theirs)):
            spent, answer = timed(run)
            seconds.append(spent)
            if seconds is ours:
                expected = answer
        off = max(np.abs(a - b).max() / np.abs(b).max() for a, b in zip(answer, expected, strict=True))
        if not off <= contest.agreement:
            raise SystemExit(f"{contest.name}: {contest.rival} differs by {off:.2g} of the maximum")
    ratio = min(theirs) / min(ours)
    target = f"{contest.target:g}" if contest.target else "-"
    line = (
        f"| {contest.name} | {min(ours):.3g} | {contest.rival} | {min(theirs):.3g} | **{ratio:.0f}** | {target} | "
        f"{off:.0e} |"
    )
    print(line, flush=True)
    return line


# ---- ours -----------------------------------------------------------------------------------------------------------


def dda_history(steps: int) -> History:
    """Build the model of the square block and solve it."""
    import dda

    block = dda.Block.rectangle(2.0, 2.0, dda.Material(2700.0, 1e9, 0.0))
    model = dda.TwoBlockModel(block, dda.Contact(1e9), 5e6)
    columns = dda.solve(model, dda.Scheme(0.5, 1.0, 1.0, 1e-3), steps).columns
    return columns["displacement"], columns["contact_pressure"]


def built_history() -> Callable[[int], History]:
    """Return the history of a model that is there already."""
    import dda

    block = dda.Block.rectangle(2.0, 2.0, dda.Material(2700.0, 1e9, 0.0))
    model = dda.TwoBlockModel(block, dda.Contact(1e9), 5e6)
    model.gap_form.reduced()

    def history(steps: int) -> History:
        columns = dda.solve(model, dda.Scheme(0.5, 1.0, 1.0, 1e-3), steps).columns
        return columns["displacement"], columns["contact_pressure"]

    return history


def fem_history(steps: int, poisson: float, elements: int = 64) -> History:
    """Mesh the square block and solve it."""
    import fem_reference

    corners = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
    numbers = (2700.0, 1e9, poisson, "plane stress", 1e9, 1e9, 5e6)
    problem = fem_reference.Problem(corners, 0, 2, *numbers, elements=elements, degree=1)
    columns = fem_reference.solve(problem, fem_reference.Scheme(0.5, 1.0, 1.0, 1e-3), steps).columns
    return columns["displacement"], columns["contact_pressure"]


# ---- contests -------------------------------------------------------------------------------------------------------


def contests(quick: bool) -> list[Contest]:
    """Return the contests; `quick` leaves the long ones out."""
    from rivals import block_numpy, elements_skfem

    loop, skfem, built = "numpy loop", "scikit-fem, SuperLU loop", built_history()
    found = [
        Contest("dda, 10,000 steps", lambda: built(10**4), loop, lambda: block_numpy.history(10**4), 200, 1e-11, 9),
        Contest(
            "dda, 10,000 steps, model built too",
            lambda: dda_history(10**4),
            loop,
            lambda: block_numpy.history(10**4),
            0,
            1e-11,
            9,
        ),
    ]
    fem = [(1000, 0.25, 10, 3), (10_000, 0.25, 60, 1), (1000, 0.0, 80, 2)]
    if not quick:
        found.append(
            Contest("dda, 1,000,000 steps", lambda: built(10**6), loop, lambda: block_numpy.history(10**6), 500, 1e-9)
        )
    for steps, mu, target, repeats in fem:
        if quick and steps > 1000:
            continue
        found.append(
            Contest(
                f"fem, 64 x 64, mu = {mu:g}, {steps:,} steps",
                lambda steps=steps, mu=mu: fem_history(steps, mu),
                skfem,
                lambda steps=steps, mu=mu: elements_skfem.history(steps, poisson=mu),
                target,
                1e-10,
                repeats,
            )
        )
    return found


def fenicsx_line() -> str:
    """Return the line of FEniCSx, whose seconds are its own, without starting its interpreter."""
    from validation import load_scene, solve
    from validation.engine.measure import attempt
    from validation.runs.run import Outcome
    from validation.solvers.registry import get_solver

    values = {"block.poisson": 0.25, "fem.elements": 64, "fem.degree": 1, "time.steps": 1000, "time.step": 1e-3}
    scene = load_scene("figures-3-4").with_values(values)
    ours = min(timed(lambda: fem_history(1000, 0.25))[0] for _ in range(3))
    runs = [attempt(get_solver("fenicsx"), scene, False) for _ in range(2)]
    name = "| fem, 64 x 64, mu = 0.25, 1,000 steps"
    if runs[0].outcome is not Outcome.COMPLETED:
        return f"{name} | {ours:.3g} | FEniCSx, PETSc LU | NOT RUN: {'; '.join(runs[0].notes)} | | | |"
    theirs = min(sum(run.seconds.values()) for run in runs)
    own, other = solve(scene, "fem"), runs[0]
    pairs = ((own.displacement, other.displacement), (own.contact_pressure, other.contact_pressure))
    off = max(np.abs(a - b).max() / np.abs(b).max() for a, b in pairs)
    line = f"{name} | {ours:.3g} | FEniCSx, PETSc LU | {theirs:.3g} | **{theirs / ours:.0f}** | - | {off:.0e} |"
    print(line, flush=True)
    return line


# ---- growth ---------------------------------------------------------------------------------------------------------


def law(sizes: Sequence[float], seconds: Sequence[float]) -> float:
    """Return the exponent of the cost over the upper two thirds of the sizes."""
    part = slice(len(sizes) // 3, None)
    return float(np.polyfit(np.log(sizes[part]), np.log(seconds[part]), 1)[0])


def growth(quick: bool) -> list[str]:
    """Return the lines of the growth table."""
    built = built_history()
    steps = [10**3, 10**4, 10**5, 10**6]
    meshes = [4, 8, 16, 32, 64] if quick else [4, 8, 16, 32, 64, 128]
    rows = [
        ("dda, steps", "s", steps, [best(lambda n=n: built(n), 5) for n in steps]),
        ("fem, 16 x 16, mu = 0.25, steps", "s", steps, [best(lambda n=n: fem_history(n, 0.25, 16), 2) for n in steps]),
        (
            "fem, mu = 0.25, 1,000 steps, elements per side",
            "s",
            meshes,
            [best(lambda n=n: fem_history(1000, 0.25, n), 2) for n in meshes],
        ),
        ("engine, scenes (dda, 200 steps)", "s", [1, 10, 100], [sweep_seconds(count) for count in (1, 10, 100)]),
    ]
    return [
        f"| {name} | {', '.join(f'{n:,}' for n in sizes)} | {', '.join(f'{t:.2g}' for t in seconds)} | "
        f"{law(sizes, seconds):.2f} |"
        for name, _, sizes, seconds in rows
    ]


def best(run: Callable[[], History], repeats: int) -> float:
    """Return the least seconds of some runs."""
    return min(timed(run)[0] for _ in range(repeats))


def sweep_seconds(count: int) -> float:
    """Return the seconds of a study of some scenes in this process, results kept."""
    import tempfile

    from validation import load_scene
    from validation.engine.run import run_study
    from validation.engine.study import Study
    from validation.runs.results import Results

    steps = [1e-3 * (1 + i / count) for i in range(count)]
    scene = load_scene("figures-3-4").with_values({"time.step": steps[0]}).model_copy(update={"sweep": {}})
    study = Study("growth", "Growth", "Growth.", [scene], ("dda",), {"time.step": steps})
    with tempfile.TemporaryDirectory() as directory:
        began = time.perf_counter()
        run_study(study, Results(directory))
        return time.perf_counter() - began


def two_workers() -> str:
    """Return the line of a sweep on two worker processes over that on one."""
    import tempfile

    from validation import load_scene
    from validation.engine.run import run_study
    from validation.engine.study import Study
    from validation.runs.results import Results

    scene = load_scene("poisson").with_values({"fem.elements": 48, "fem.degree": 1}).model_copy(update={"sweep": {}})
    steps = [1e-3 * (1 + i / 16) for i in range(16)]
    study = Study("sweep", "Sweep", "Sweep.", [scene], ("fem",), {"time.step": steps}, measures=("history",))
    spent = []
    for jobs in (1, 2):
        with tempfile.TemporaryDirectory() as directory:
            began = time.perf_counter()
            run_study(study, Results(directory), jobs=jobs)
            spent.append(time.perf_counter() - began)
    return f"A sweep of 16 scenes by `fem` takes {spent[0]:.2g} s on one worker and {spent[1]:.2g} s on two."


def start_up() -> list[str]:
    """Return the lines of the start-up table: processor seconds of a fresh interpreter."""
    lines = []
    for name, arguments in (
        ("import dda", ["-c", "import dda"]),
        ("dda-validate --help", ["-m", "validation", "--help"]),
    ):
        spent = min(_processor_seconds(arguments) for _ in range(5))
        lines.append(f"| `{name}` | {spent:.2f} |")
    return lines


def _processor_seconds(arguments: list[str]) -> float:
    import resource

    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True, cwd=HERE.parent)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


PAGE = """# Speed

Written by `make bench` ({machine}, Python {python}, numpy {numpy}); one BLAS thread on both sides, run by turns,
least seconds of some repeats, set-up counted. Constant acceleration, p = E, dt = 1e-3 s. Ratios above one are ours;
the last column is the greatest difference of the two answers over the maximum. The rivals are
[`reports/rivals`](../reports/rivals) and, for FEniCSx, `fem_reference/fenicsx_worker.py`.

| what | ours [s] | rival | rival [s] | ratio | asked for | difference |
|---|---|---|---|---|---|---|
{contests}

## Growth

| what | sizes | seconds | exponent |
|---|---|---|---|
{growth}

A history of n steps keeps the time and the asked columns, 8 (1 + columns) n bytes, and while it is made one block more:
no state of any step is kept. The elements keep the vectors of the small space, 8 bytes times unknowns times
vectors (at most 400), beside the factor of one sparse matrix; the results directory 8 (1 + columns) n bytes a case.

{sweep}

## The estimate

{honesty}

## Start-up

| what | processor seconds |
|---|---|
{start}
"""


def main() -> None:
    """Run all and write the page."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--quick", action="store_true", help="leave the long contests out and print only")
    quick = options.parse_args().quick
    from rivals import estimates

    lines = [compete(contest) for contest in contests(quick)] + [fenicsx_line()]
    page = PAGE.format(
        machine=f"{os.cpu_count()} cores, {platform.machine()}",
        python=platform.python_version(),
        numpy=np.__version__,
        contests="\n".join(lines),
        growth="\n".join(growth(quick)),
        start="\n".join(start_up()),
        sweep=two_workers(),
        honesty=estimates.honesty(40 if quick else 200),
    )
    if quick:
        print(page)
    else:
        TABLE.write_text(page, encoding="utf-8")
        print(f"wrote {TABLE}")


if __name__ == "__main__":
    main()
