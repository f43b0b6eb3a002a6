"""The chapters of studies, each from a small run of its own scenes: headings, figures and a few cells of its tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from validation.engine.run import run_study
from validation.engine.study import Study
from validation.report.blocks import Blocks, FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.registry import chapter_of
from validation.runs.results import Results
from validation.solvers.registry import solver_names
from validation.studies.waves.rows import curves
from validation.suite.folders import get_study

# study: beginnings of the names of its cases, the solvers that run them; headings below its title; files of figures;
# cells: number of the table, of the row and of the column, text
CHAPTERS: dict[str, tuple[list[str], tuple[str, ...], list[str], list[str], list[tuple[int, int, int, str]]]] = {
    "columns": (
        ["columns-solves-rest[", "columns-spall-pieces[", "columns-slips-steps[",
         "columns-settle["],
        ("dda",),
        ["What the open-close iteration takes", "Pieces of a spall", "Joints that slip, and stacks that rest"],
        ["columns-solves.svg", "columns-spall.svg"],
        [(0, 0, 0, "comes to rest")],
    ),
    "rebound": (
        ["rebound-constant[contact.stiffness=2.16e+10,contact.gap=0.0025",
         "contact-map-constant[contact.stiffness=1e+11,time.step=0.001",
         "contact-map-average[contact.stiffness=1e+11,time.step=0.001"],
        ("dda",),
        ["What a landing returns", "Energy, switches and solves"],
        ["rebound-restitution.svg", "rebound-maps.svg"],
        [(0, 0, 0, "constant"), (0, 0, 1, "100E"), (0, 1, 0, "average"), (0, 1, 2, "1")],
    ),
    "impacts": (
        ["bouncing-mass"],
        ("dda",),
        ["A mass bounces on a spring: code_aster V5.01.108, modelling A"],
        [],
        [(0, 0, 1, "dda"), (0, 0, 2, "541.00")],
    ),
    "slopes": (
        ["slope-sliding", "slope-drag", "slope-threshold[load.slope=30.01"],
        ("dda",),
        ["Run-out", "Where sliding begins"],
        ["slopes-ways.svg"],
        [(0, 1, 6, "1.21989"), (0, 1, 8, "18.64"), (0, 2, 7, "0.689234"), (1, 0, 3, "0.0019770")],
    ),
    "creep": (
        ["creep-steps[time.step=0.002", "creep-lagged[time.step=0.01", "creep-stiffness[contact.stiffness=4e+09",
         "creep-damped[contact.stiffness=4e+09"],
        ("dda",),
        [],
        ["creep.svg"],
        [(0, 0, 1, "0.142"), (0, 1, 3, "1.01"), (1, 0, 1, "11.4"), (1, 0, 3, "10.7"), (1, 0, 4, "0.142")],
    ),
    "toppling": (["toppling-growth"], ("dda",), [], ["toppling.svg"], [(0, 0, 0, "growth")]),
    "rocking": (
        ["rocking-pulse"],
        ("dda",),
        [],
        ["rocking.svg"],
        [(0, 0, 0, "0.900"), (0, 2, 0, "1.01"), (0, 0, 2, "–")],
    ),
    "subblocks": (
        ["subblocks-axial[block.pattern=squares,block.subdivide=2x2", "subblocks-axial[block.pattern=triangles,"
         "block.subdivide=2x2", "rocking["],
        (),
        ["Error against run time", "Glue", "Rocking"],
        ["subblocks-time-axial.svg"],
        [(0, 1, 0, "triangles"), (0, 1, 1, "2"), (1, 0, 1, "226.5")],
    ),
    "waves": (
        ["waves-discount", "waves-site-usual"],
        ("dda", "layers"),
        ["A site under a record"],
        ["waves-travel.svg", "waves-site.svg"],
        [(0, 0, 5, "0.151"), (0, 0, 6, "0.01889")],
    ),
    "response": (
        ["response"],
        ("dda", "fem"),
        [],
        ["response.svg"],
        [(0, 5, 1, "52"), (0, 5, 2, "31.4419"), (0, 5, 4, "32.4739"), (0, 5, 7, "17.8527")],
    ),
}  # fmt: skip


def some(name: str, beginnings: Sequence[str], solvers: tuple[str, ...]) -> Study:
    """Return a study of some of its cases, by some of their solvers, with the rows that these are enough for."""
    study = get_study(name)
    cases = [case.scene for case in study.cases() if case.scene.name.startswith(tuple(beginnings))]
    scenes = []
    for scene in {scene.name: scene for scene in cases}.values():
        own = [solver for solver in scene.run.solvers if solver in solvers or not solvers]
        scenes.append(
            scene.model_copy(update={"run": scene.run.model_copy(update={"solvers": tuple(own)}), "sweep": {}})
        )
    known = {(scene.name, solver) for scene in scenes for solver in scene.run.solvers}
    subjects = {scene.name for scene in scenes}
    rows = [row for row in study.derived() if known.issuperset(row.needs) and (row.needs or row.scene in subjects)]
    rows += [row for row in study.derived() if not row.needs and "[" not in row.scene and row not in rows]
    gates = [
        gate for gate in study.gates() if gate.scene in subjects and not {*gate.pair} & {*solver_names()} - {*solvers}
    ]
    return replace(study, scenes=scenes, extra=(), gates=lambda: tuple(gates), derived=lambda: tuple(rows))


@pytest.mark.long
@pytest.mark.parametrize("name", CHAPTERS)
def test_a_chapter_says_and_draws_what_was_run(name: str, tmp_path: Path, drawn: dict[str, Figure]) -> None:
    beginnings, solvers, headings, files, cells = CHAPTERS[name]
    results = Results(tmp_path / "results")
    run_study(some(name, beginnings, solvers), results)
    blocks: Blocks = chapter_of(name)(results, results.whole(name, histories=True), tmp_path)
    assert [block.text for block in blocks if isinstance(block, Heading)][1:] == headings
    assert [block.file for block in blocks if isinstance(block, FigureBlock)] == files
    assert set(drawn) <= set(files)
    tables = [block for block in blocks if isinstance(block, Table)]
    for table, row, column, text in cells:
        assert tables[table].rows[row][column] == text, tables[table].rows


def test_a_chapter_without_rows_has_no_table_and_no_figure(tmp_path: Path) -> None:
    """Of a study without its data, and of one of which no case has finished."""
    results = Results(tmp_path / "results")
    bare: dict[str, Any] = {"gates": tuple, "derived": tuple}
    response = get_study("response")
    run_study(replace(response, scenes=response.scenes[:1], solvers=("dda",), data=dict, **bare), results)
    run_study(replace(get_study("rocking"), scenes=[], **bare), results)
    blocks = chapter_of("response")(results, results.whole("response"), tmp_path)
    assert [type(block) for block in blocks] == [Heading, Paragraph, Paragraph]  # what it asks, and its sources
    blocks = chapter_of("rocking")(results, results.manifest("rocking"), tmp_path)
    assert not [block for block in blocks if isinstance(block, FigureBlock)]


def test_closed_forms_of_the_page_of_waves_hold_the_rule_of_ten() -> None:
    drawn = {(c["scheme"], c["courant"]): c for c in curves()["curves"]}
    line = drawn["(1/2, 1)", 0.5]
    left = np.interp(np.log(10), np.log(line["blocks"]), line["left"])  # type: ignore[arg-type]
    assert left == pytest.approx(0.008969, rel=0.03)
    assert set(drawn["(1/4, 1/2)", 1.0]["left"]) == {1.0}  # type: ignore[call-overload]
