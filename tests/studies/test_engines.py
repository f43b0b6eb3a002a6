"""The study `engines`: its table, programs that users bring, what a curve shows, and what is not installed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from validation.engine import run_study
from validation.gates.gate import Status
from validation.problems.boxes import box_problems
from validation.results import Results
from validation.solvers import registry
from validation.studies.engines import cells, predictions, study
from validation.studies.engines.cells import Point, finding, from_where
from validation.studies.engines.table import EngineTable, read
from validation.studies.field import programs
from validation.studies.field.table import FAIL, NOT_APPLICABLE, NOT_RUN, PARTIAL, PASS

TOY = """
import math
import numpy as np

class Toy:
    handles = frozenset({"rigid boxes"})
    about = {"program": "Toy", "version": "1", "settings": "symplectic Euler"}
    e = None

    def solve(self, scene):
        rigid = scene.rigid
        box = rigid.box[0]
        if rigid.stiffness is not None:
            raise NotImplementedError("no stiffness")
        if self.e is None and rigid.restitution == 0:
            raise ArithmeticError("it ends")
        e = rigid.restitution if self.e is None else self.e
        parts = 2 ** (3 + rigid.refine)
        step = scene.time.step / parts
        y, v, rows = rigid.starts[0][1], box.velocity[1], []
        for n in range(scene.time.steps * parts):
            v += rigid.pull[1] * step
            if y + v * step < box.reach and v < 0:
                v = -e * v
            y += v * step
            if n % parts == parts - 1:
                rows.append(y)
        zero = np.zeros(len(rows))
        return {"x_1": zero, "y_1": rows, "angle_1": zero, "program_steps": scene.time.steps * parts}

class Soft(Toy):
    e = 0.3

class Absent(Toy):
    def solve(self, scene):
        raise NotImplementedError("Absent is not installed: pip install absent")

class Diverges(Toy):
    def solve(self, scene):
        return {name: np.full(scene.time.steps, np.nan) for name in ("x_1", "y_1", "angle_1")}
"""


@pytest.fixture
def brought(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Install toy programs, two of them under the names of programs that the field knows."""
    (tmp_path / "toys.py").write_text(TOY)
    monkeypatch.syspath_prepend(tmp_path)
    found = {"box2d": "toys:Toy", "box2d-default": "toys:Soft", "pymunk": "toys:Absent", "mine": "toys:Diverges"}
    for room in (registry, programs):
        monkeypatch.setattr(room, "entry_points", lambda: found)


def run(
    names: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> tuple[dict[str, Status], EngineTable]:
    """Run the study over some problems, and return the gates by what they are of, and the table."""
    some = {name: box_problems()[name] for name in names}
    for room in (cells, study):
        monkeypatch.setattr(room, "box_problems", lambda: some)
    cells.case_scenes.cache_clear()
    cells.curve_scenes.cache_clear()
    results = Results(tmp_path / "results")
    whole = study.study()
    verdicts = run_study(whole, results)
    table = read(results)
    assert table is not None
    cells.curve_scenes.cache_clear()
    return {f"{one.gate.scene} {one.gate.pair[0]}": one.status for one in verdicts}, table


@pytest.mark.long
def test_the_table_of_two_problems(brought: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gates, table = run(("restitution", "impact"), tmp_path, monkeypatch)
    assert gates["rigid-restitution judged rigid-exact"] is gates["rigid-impact judged rigid-exact"] is Status.PASS
    assert gates["engines box2d"] is gates["engines box2d-default"] is Status.PASS
    assert gates["engines pymunk"] is gates["engines drake"] is Status.NOT_RUN
    bounces = {one.program: one for one in table.row("restitution")}
    assert bounces["rigid-exact"].verdict == PASS
    # of the cases with e = 0 it has no answer: what it has passes
    assert bounces["box2d"].verdict == PARTIAL
    assert "it ends" in bounces["box2d"].reason and "e = 0, 5 m/s" in bounces["box2d"].reason
    assert len(bounces["box2d"].quantities) == 6
    assert [point.refine for point in bounces["box2d"].points] == [0, 1, 2, 3, 4]
    steps = [point.steps for point in bounces["box2d"].points]
    assert steps == [60 * 8 * 2**n for n in range(5)]
    assert bounces["box2d"].points[0].step == pytest.approx(1 / 480, rel=1e-5)
    assert bounces["box2d"].finding == "the error is below a twentieth of its band at every step"
    soft = bounces["box2d-default"]
    assert soft.verdict == FAIL
    assert soft.error == pytest.approx(70, rel=1e-3)
    assert soft.says.startswith("restitution 0.3 (exact 1), e = 1")
    assert soft.finding == "the error does not shrink with the step: 20 of its band at first, 20 after 4 halvings"
    assert soft.seconds is not None and soft.seconds > 0
    assert all(point.seconds for point in soft.points)
    assert bounces["pymunk"].verdict == bounces["drake"].verdict == NOT_RUN
    assert bounces["mine"].verdict == FAIL and bounces["mine"].says == "not a number"
    assert bounces["mine"].error is None
    impacts = {one.program: one for one in table.row("impact")}
    assert impacts["box2d"].verdict == NOT_APPLICABLE and "no stiffness" in impacts["box2d"].reason
    assert impacts["dda"].finding.startswith("the error falls at each of 4 halvings of the step, order 1.")
    about = {one.name: one for one in table.programs}
    assert about["box2d"].about["settings"] == "symplectic Euler"
    assert (about["mine"].kind, about["box2d-default"].kind, about["box2d"].family) == ("user", "default", "games")


def test_without_the_study_there_is_no_table(tmp_path: Path) -> None:
    assert read(Results(tmp_path)) is None


@pytest.mark.parametrize(
    ("flags", "value"),
    [
        ({1.0: False, 2.0: False, 4.0: True, 5.0: True}, 3.0),
        ({1.0: True, 2.0: False, 4.0: True}, 3.0),
        ({1.0: True, 2.0: True}, 1.0),
        ({1.0: False, 2.0: False}, 2.0),
        ({1.0: True, 2.0: False}, 2.0),
    ],
)
def test_from_where_on_all_flags_are_up(flags: dict[float, bool], value: float) -> None:
    assert from_where(flags) == value


def points(*errors: float | None, steps: int = 100) -> list[Point]:
    return [Point(n, 0.1 / 2**n, steps * 2**n, error, "completed") for n, error in enumerate(errors)]


@pytest.mark.parametrize(
    ("errors", "sentence"),
    [
        ((8.0, 4.0, 2.0, 1.0), "falls at each of 3 halvings of the step, order 1.0"),
        ((16.0, 4.0, 1.0, 0.25), "falls at each of 3 halvings of the step, order 2.0"),
        ((1.0, 2.0, 4.0, 8.0), "grows at each of 3 halvings of the step, order -1.0"),
        ((0.4, 0.1, 0.025, 0.006), "falls at each of 3 halvings of the step, order 2.0"),
        ((3.0, 3.1, 2.9, 3.0), "does not shrink with the step: 3 of its band at first, 3 after 3 halvings"),
        ((3.0, 5.0, 0.5, 0.6), "falls unevenly, from 3 to 0.6"),
        ((0.01, 0.04, 0.0, 0.011), "below a twentieth of its band at every step"),
    ],
)
def test_what_a_curve_shows(errors: tuple[float, ...], sentence: str) -> None:
    assert sentence in finding(points(*errors))


def test_a_curve_that_is_short_or_whose_steps_were_not_halved_shows_nothing() -> None:
    assert finding(points(4.0, 2.0, 1.0)) == ""
    assert finding(points(8.0, None, 2.0, 1.0, 0.5)) == ""
    assert finding(points(8.0, 4.0, math.inf, 1.0)) == ""
    same_steps = [replace(point, steps=100) for point in points(8.0, 4.0, 2.0, 1.0)]
    assert finding(same_steps) == ""


@pytest.mark.long
def test_a_program_that_falls_otherwise_than_its_integrator_is_seen(
    brought: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both toys are symplectic Euler, and neither is Box2D, which makes four parts of a step."""
    falls = {"box2d": (1.0, "why"), "box2d-default": (0.25, "why"), "mujoco": (1.0, "why")}
    monkeypatch.setattr(predictions, "FALLS", falls)
    gates, table = run(("bouncing",), tmp_path, monkeypatch)
    assert gates["rigid-bouncing box2d falls"] is Status.PASS
    assert gates["rigid-bouncing box2d-default falls"] is Status.FAIL
    assert gates["rigid-bouncing mujoco falls"] is Status.NOT_RUN
    soft = table.cell("bouncing", "box2d-default")
    assert soft.verdict == FAIL and soft.says.startswith("energy in the end over that at the start")
