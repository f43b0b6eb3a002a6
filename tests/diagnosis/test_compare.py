"""`compare`: the model that fits, against the suite's own DDA and against a DDA program of another make."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import refused, typed
from faults import seams
from matplotlib.image import imread
from oracles.sliding_block import Plain, history, write_measured_point

from validation import load_scene, solve
from validation.diagnosis.fits.fit import fit, intervals, untold
from validation.diagnosis.fits.target import Target
from validation.diagnosis.judgement import compare
from validation.diagnosis.other_solvers import SolverSearch
from validation.diagnosis.reading import Foreign, Stepping, read
from validation.diagnosis.readings import Reading
from validation.diagnosis.sentences import span
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Variant, rectangle_of

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "ntdda"
YIELDS = {"opens": True, "updated": True, "base": (5.0, 2e12)}  # as a block of 50 GPa on points


def scene(**changes):
    base = {"time.step": 0.002, "time.steps": 60}
    return load_scene("figures-3-4").with_values(base | {k.replace("__", "."): v for k, v in changes.items()})


# ---- the stepping of many variants ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [
        {"time__alpha": 0.25, "time__delta": 0.5, "time__gg": 0.98, "time__start": "consistent"},
        {"block__poisson": 0.3, "time__step": 0.0007, "contact__stiffness": 3e9},
        {"block__poisson": 0.2, "block__hypothesis": "plane strain", "load__gravity": 9.81, "time__gg": 0.9},
        {"time__alpha": 0.0, "time__delta": 0.5, "time__step": 0.0005, "block__density": 1800.0},
    ],
)
def test_a_locked_variant_is_the_suites_own_dda(changes):
    s = scene(**changes)
    t, column = s.time, rectangle_of(s)
    own = Variant(t.alpha, t.delta, t.discount, t.start)
    found = histories(column, [replace(own, gg=0.5), own], np.full(t.steps, t.step))
    exact = solve(s, "dda")
    # two formulations of one recursion over 60 steps: some tens of roundings
    assert np.max(np.abs(found.displacement[:, 1] - exact.displacement)) < 1e-13 * np.max(np.abs(exact.displacement))
    assert np.max(np.abs(found.pressure[:, 1] - exact.contact_pressure)) < 1e-13 * np.max(
        np.abs(exact.contact_pressure)
    )
    assert column.static == pytest.approx(_static(s), rel=1e-12)


def _static(s):
    from validation.solvers.registry import get_solver

    return float(get_solver("dda").static(s)["displacement"])


@pytest.mark.parametrize(
    "changes", [{}, {"opens": True}, {"updated": True}, {"opens": True, "updated": True, "gg": 0.97}]
)
def test_every_variant_is_that_of_the_other_program(changes):
    program = Plain(**({"dt": 4e-4, "steps": 60, "g": 9.81} | changes))
    column = rectangle_of(scene())
    assert column is not None
    variant = Variant(0.5, 1.0, program.gg, weight=1.0, opens=program.opens, updated=program.updated)
    found, other = histories(column, [variant], np.full(60, program.dt)), history(program)
    assert np.max(np.abs(found.displacement[:, 0] - other.displacement)) < 2e-6 * np.max(np.abs(other.displacement))
    assert np.max(np.abs(found.pressure[:, 0] - other.pressure)) < 1e-5 * np.max(np.abs(other.pressure))
    np.testing.assert_array_equal(found.open[:, 0], other.open)
    assert other.open.any() == program.opens


# ---- fits ---------------------------------------------------------------------------------------------------------


def test_a_fit_finds_the_scheme_and_its_interval_holds_it():
    column = rectangle_of(scene())
    assert column is not None
    steps, rng = np.full(80, 0.001), np.random.default_rng(3)
    true = Variant(0.31, 0.7, 0.985, softness=0.02)
    clean = histories(column, [true], steps).displacement[:, 0]
    noisy = clean + 1e-5 * rng.standard_normal(80)
    free = ("alpha", "delta", "gg", "softness")
    (found,) = fit(Target(column, steps, np.arange(80), noisy[None]), [(Variant(0.25, 0.5, 1.0), free)], rounds=20)
    for name, interval in intervals(found).items():
        # the interval is a 95 % one; twice it fails once in ten thousand
        assert abs(interval.value - getattr(true, name)) < 2 * interval.half_width, name
        assert interval.half_width < 0.1, name
    assert untold(found) == []


def test_what_one_settled_row_cannot_tell_is_said():
    column = rectangle_of(scene())
    assert column is not None
    steps = np.full(140, 0.01)
    v = Variant(0.5, 1.0, 1.0)
    late = histories(column, [v], steps).displacement[100:, 0] * (1 + 1e-6 * np.sin(np.arange(40)))
    target = Target(column, steps, np.arange(100, 140), late[None])
    (found,) = fit(target, [(v, ("alpha", "delta", "gg", "softness"))])
    assert {name for direction in untold(found) for name in direction} >= {"alpha", "delta", "gg"}


@pytest.mark.long
@pytest.mark.parametrize(
    ("step", "gg", "opened"), [(5e-4, 0.99, (1, 6)), (4e-4, 0.99, (1, 7)), (4e-4, 1.0, (1, 47)), (1e-3, 0.99, (1, 2))]
)
def test_a_base_that_gives_way_is_no_fault_of_the_integrator(step, gg, opened, tmp_path):
    """A heavy base that adds 1 % to the static displacement, and swings at 1.4 krad/s.

    A dead band brings a base without mass nearer to these histories, and has no effect once the base has its mass.
    """
    program = Plain(dt=step, steps=60, gg=gg, **YIELDS | {"base": (5.0, 1.05e11)})
    made = history(program)
    s = scene(time__step=program.dt, time__gg=program.gg)
    answer = compare(s, read(write_measured_point(made, tmp_path / "m.m", program.dt)))
    assert answer.causes == ["contact-opened", "base-compliance", "geometry-updated"]
    assert answer.scheme == {"alpha": 0.5, "delta": 1.0, "gg": gg}
    assert answer.values["base-compliance"] == pytest.approx(0.01, abs=1e-3)
    assert answer.opened == opened == made.opened


def test_steps_are_written_as_runs():
    assert span([1, 2, 3, 7, 9, 10]) == "1-3, 7, 9-10"


# ---- answers --------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_the_example_of_ntdda():
    done = typed("compare", EXAMPLE / "scene.toml", EXAMPLE / "ntdda-p1E-dt2ms_meas.m", "--json")
    assert done.returncode == 1, done.stderr  # what surrounds the scheme is no fault, and not what the scene gives
    example = json.loads(done.stdout)
    silent = {
        "slips": [],
        "remedy": "",
        "unexplained": 0,
        "nearest": None,
        "alike": [],
        "departure": None,
        "opened": None,
    }
    assert {key: example[key] for key in silent} == silent
    assert example["causes"] == ["base-compliance", "own-weight", "geometry-updated"]
    assert set(example["values"]) == set(example["intervals"]) == {"base-compliance", "own-weight"}
    assert [stage["stage"] for stage in example["evidence"]] == [
        *("reading", "bounded", "displacement", "statics", "frequency", "damping")
    ]
    assert example["scheme"] == {"alpha": 0.5, "delta": 1.0, "gg": 1.0}
    assert str(example["sentence"]).startswith("Same model, same scheme: constant acceleration")
    # the number stands in the example's README
    assert example["values"]["base-compliance"] == pytest.approx(0.0015, abs=1e-4)
    assert example["model"] == ""


def example_target():
    foreign, s = read(EXAMPLE / "ntdda-p1E-dt2ms_meas.m"), load_scene(EXAMPLE / "scene.toml")
    column = rectangle_of(s)
    assert column is not None
    return Target(column, np.full(200, 0.002), np.arange(200), foreign.displacement[None])


def test_numbers_of_the_examples_readme():
    plain = Variant(0.5, 1.0, 1.0)
    moving = replace(plain, updated=True)
    found = fit(
        example_target(),
        [(plain, ()), (moving, ("softness",)), (moving, ("softness", "load")), (moving, ("softness", "weight"))],
    )
    assert [f"{f.misfit:.1e}" for f in found] == ["8.7e-03", "2.0e-03", "1.4e-05", "1.9e-06"]
    assert found[3].variant.weight == pytest.approx(0.970, abs=5e-4)


@pytest.mark.long
@pytest.mark.parametrize(
    ("program", "opened"),
    [
        (Plain(dt=4e-3, p=2e9, gg=0.95, rho=3000.0, steps=40, **YIELDS), None),
        (Plain(dt=1e-3, p=1e9, g=9.81, steps=60, **YIELDS), (1, 2)),
        (Plain(dt=5e-4, p=1e10, gg=0.98, g=9.81, rho=2300.0, steps=60, **YIELDS), None),
        (Plain(dt=2e-4, p=5e8, steps=100, g=9.81, **YIELDS), None),
    ],
)
def test_a_program_of_another_make(program, opened, tmp_path):
    """Base that yields, moving geometry, weight, opening: the scheme is named and the steps are found."""
    made = history(program)
    assert opened is None or made.opened == opened
    s = scene(time__step=program.dt, contact__stiffness=program.p, block__density=program.rho, time__gg=program.gg)
    answer = compare(s, read(write_measured_point(made, tmp_path / "m.m", program.dt)))
    assert answer.scheme == {"alpha": 0.5, "delta": 1.0, "gg": program.gg}
    assert answer.opened == made.opened
    assert ("contact-opened" in answer.causes) == (made.opened is not None)
    assert not set(answer.causes) & {"scheme", "gg", "gg-in-one-formula", "start", "time-shift", "springs-factor"}
    if made.opened:
        assert answer.departure is not None and answer.departure.step == made.opened[0]
        assert answer.sentence.startswith("Same scheme")
    else:
        assert answer.departure is None
        assert answer.sentence.startswith("Same model, same scheme")


@pytest.mark.long
def test_a_history_of_finite_elements_is_named_so():
    s = scene(time__steps=80)
    run_ = solve(s.with_values({"fem.elements": 16}), "fem")
    answer = compare(s, Foreign(run_.time, run_.displacement, run_.contact_pressure))
    assert answer.model == "bar"
    assert answer.sentence.startswith("Same model as bar")
    assert answer.departure is None and answer.causes == []


@pytest.mark.long
def test_a_polygon_is_compared_with_the_linear_models():
    corners = [[0.0, 0.0], [2.0, 0.0], [1.7, 1.5], [0.2, 1.5]]
    s = load_scene("figures-3-4").with_values(
        {"block.vertices": corners, "time.step": 0.002, "time.steps": 60, "fem.elements": 4}
    )
    theirs = solve(s.with_values({"time.alpha": 0.5625}), "dda")
    answer = compare(s.with_values({"time.alpha": 0.5625}), Foreign(theirs.time, theirs.displacement))
    assert answer.scheme == {"alpha": 0.5625, "delta": 1.0, "gg": 1.0}
    assert answer.departure is None
    noise = 1e-3 * float(np.max(np.abs(theirs.displacement))) * np.random.default_rng(1).standard_normal(60)
    noisy = Foreign(theirs.time, theirs.displacement + noise)
    assert compare(s.with_values({"time.alpha": 0.5625}), noisy).causes == []
    assert compare(s, noisy).causes == ["scheme"]


# ---- the command line -----------------------------------------------------------------------------------------------


def test_the_first_line_is_the_answer_and_the_report_one_page(tmp_path):
    exact = solve(scene(time__steps=30), "dda")
    table = np.column_stack([1e3 * exact.time, -1e3 * exact.displacement])
    path = tmp_path / "theirs.csv"
    path.write_text("t;uy\n" + "\n".join(f"{t:.7g};{u:.7g}" for t, u in table))
    arguments = ["compare", "figures-3-4", path, "--set", "time.step=0.002", "--columns", "time=t,displacement=uy"]
    written = ("--out", tmp_path / "a.pdf", "--figure", tmp_path / "f.png")
    done = typed(*arguments, "--scale", "time=1e-3,displacement=-1e-3", *written)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(
        "Same model, same scheme: constant acceleration (alpha = 0.5, delta = 1, gg = 1); the"
    )
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF-")
    assert imread(tmp_path / "f.png").shape[:2] == (1080, 1920)  # a slide
    assert "--figure: must end in .svg, .pdf, .png" in refused(*arguments, "--figure", "f.txt")
    slipped = typed(*arguments, "--json")
    assert slipped.returncode == 1  # it departs
    answer = json.loads(slipped.stdout)
    assert answer["causes"] == ["sign", "unit"]
    assert answer["departure"] == {"step": 1, "kind": "amplitude"}
    assert answer["remedy"] == "--scale time=0.001,displacement=-0.001"
    assert typed(*arguments, *answer["remedy"].split()).returncode == 0


def test_finite_elements_find_the_factor_that_they_were_given(monkeypatch):
    """What `compare` asks of a solver with a mesh, of one number of the scene and few factors."""
    s = scene(time__steps=20).with_values({"fem.elements": 2, "fem.degree": 1, "block.poisson": 0.25})
    run_ = solve(s.with_values({"block.young": 0.9e9}), "fem")
    seams.RIVAL_SLIPS.put(monkeypatch, {"young-factor"})
    steps = Stepping(np.full(20, s.time.step), np.arange(20))
    search = SolverSearch(s, Reading(steps, np.array([run_.displacement, run_.contact_pressure])), "fem")
    best = search.explanations()[0]
    assert (best.id, best.value) == ("young-factor", pytest.approx(0.9, rel=1e-6))
    assert best.left < 1e-9
