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
from validation.scenes.scene import Scene, load_scene
from validation.studies.columns import formulas as columns
from validation.studies.creep import formulas as creep
from validation.studies.slopes import formulas as sliding
from validation.studies.waves.rows import curves
from validation.suite.folders import get_study

GIVEN = {"mode": "zip"}  # values of a sweep that stand beside each other
STIFF = {"contact.stiffness": [1e11], "time.step": [1e-3], "time.steps": [60]}
SPRINGS = {"contact.stiffness": [4e9], "contact.shear_stiffness": [1.6e9]}
SUBBLOCKS: dict[str, dict[str, Any]] = {
    "subblocks-axial": {"block.pattern": ["squares", "triangles"], "block.subdivide": [[2, 2], [2, 2]]},
    "subblocks-best-glue": {"block.glue_ratio": [3.0], "block.subdivide": [[2, 2]], "load.pressure": [5e6],
                            "load.traction": [0.0]},
    "rocking": {"fem.patch_width": [1.0, 0.5]},
}  # fmt: skip
SWEEPS: dict[str, dict[str, dict[str, Any]]] = {  # study to its scenes with the values that are run
    "rebound": {
        "rebound-constant": {"contact.stiffness": [2.16e10], "contact.gap": [0.0025]},
        "contact-map-constant": STIFF,
        "contact-map-average": STIFF,
    },
    "slopes": {
        sliding.SLIDING: GIVEN | {"time.step": [0.01], "time.steps": [100]},
        sliding.DRAG: GIVEN | {"time.gg": [0.98], "time.step": [0.01], "time.steps": [100]},
        sliding.THRESHOLD: {"load.slope": [30.01]},
    },
    "creep": {
        creep.STEPS: GIVEN | {"time.step": [0.002], "time.steps": [500], "time.delta": [1.0], "time.alpha": [0.5],
                              "time.start": ["zero"], "time.gg": [1.0]},
        creep.LAGGED: {"time.step": [0.01]},
        creep.STIFFNESS: SPRINGS | {"time.step": [5e-5]},
        creep.DAMPED: SPRINGS | {"time.step": [5e-4]},
    },
    "subblocks": {name: GIVEN | sweep for name, sweep in SUBBLOCKS.items()},
}  # fmt: skip


def swept(study: str) -> list[Scene]:
    return [load_scene(name).model_copy(update={"sweep": sweep}) for name, sweep in SWEEPS[study].items()]


def short(scene: Scene) -> Scene:
    """Return a scene of a few steps on a coarse mesh."""
    time = scene.time.model_copy(update={"steps": 20})
    return scene.model_copy(update={"time": time, "fem": scene.fem.model_copy(update={"elements": 4, "degree": 1})})


def stack(name: str, *numbers: int) -> Scene:
    """Return a scene of columns with some of the cases of its sweep, by DDA."""
    scene = load_scene(name)
    sweep = {key: [values[n] for n in numbers] for key, values in scene.sweep.items() if key != "mode"}
    run = scene.run.model_copy(update={"solvers": ("dda",)})
    return scene.model_copy(update={"sweep": sweep | GIVEN, "run": run})


def with_own(study: Study, names: Sequence[str]) -> Study:
    """Return a study of some scenes with what belongs to them."""
    gates = tuple(gate for gate in study.gates() if gate.scene.startswith(tuple(names)))
    derived = tuple(row for row in study.derived() if row.scene.startswith(tuple(names)) and row.name != "order")
    scenes = [scene for scene in study.scenes if (scene if isinstance(scene, str) else scene.name) in names]
    return replace(study, scenes=scenes, extra=(), gates=lambda: gates, derived=lambda: derived)


def some_columns() -> Study:
    scenes = [stack("columns-solves-rest", 3), stack(columns.SPALL_BLOCKS, 1), stack(columns.SLIPS, 1),
              stack(columns.SETTLE, 1)]  # fmt: skip
    cases = {case.name for scene in scenes for case in scene.expand()}
    whole = get_study("columns")
    rows = [row for row in whole.derived() if all(name in cases and who == "dda" for name, who in row.needs)]
    return replace(whole, scenes=scenes, extra=(), gates=tuple, derived=lambda: rows)


def bare(study: Study, scenes: Sequence[Scene], **parts: Any) -> Study:
    return replace(study, scenes=scenes, gates=tuple, derived=tuple, **parts)


# study; headings below its title; files of figures; cells: number of the table, of the row and of the column, text
CHAPTERS: dict[str, tuple[Any, list[str], list[str], list[tuple[int, int, int, str]]]] = {
    "columns": (
        some_columns,
        ["What the open-close iteration takes", "Pieces of a spall", "Joints that slip, and stacks that rest"],
        ["columns-solves.svg", "columns-spall.svg"],
        [(0, 0, 0, "comes to rest"), (2, 1, 3, "−22.39"), (2, 1, 4, "2.107"), (3, 0, 3, "0.618")],  # mm, s
    ),
    "rebound": (
        lambda: bare(get_study("rebound"), swept("rebound"), extra=()),
        ["What a landing returns", "Energy, switches and solves"],
        ["rebound-restitution.svg", "rebound-maps.svg"],
        [(0, 0, 0, "constant"), (0, 0, 1, "100E"), (0, 1, 0, "average"), (0, 1, 2, "1")],
    ),
    "impacts": (
        lambda: bare(get_study("impacts"), [load_scene("bouncing-mass")]),
        ["A mass bounces on a spring: code_aster V5.01.108, modelling A"],
        [],
        [(0, 0, 1, "dda"), (0, 0, 2, "541.00")],
    ),
    "slopes": (
        lambda: bare(get_study("slopes"), swept("slopes"), solvers=("dda",)),
        ["Run-out", "Where sliding begins"],
        ["slopes-ways.svg"],
        [(0, 0, 6, "1.21989"), (0, 0, 8, "18.64"), (0, 1, 7, "0.689234"), (1, 0, 3, "0.0019770")],
    ),
    "creep": (
        lambda: bare(get_study("creep"), swept("creep"), solvers=("dda",)),
        [],
        ["creep.svg"],
        [(0, 0, 3, "1.01"), (0, 1, 1, "0.142"), (1, 0, 1, "11.4"), (1, 0, 3, "10.7"), (1, 0, 4, "0.142")],
    ),
    "toppling": (
        lambda: with_own(get_study("toppling"), ["toppling-growth"]),
        [],
        ["toppling.svg"],
        [(0, 0, 0, "growth")],
    ),
    "rocking": (
        lambda: with_own(get_study("rocking"), ["rocking-pulse"]),
        [],
        ["rocking.svg"],
        [(1, 0, 0, "0.900"), (1, 2, 0, "1.01"), (1, 0, 2, "–")],
    ),
    "subblocks": (
        lambda: Study("subblocks", "Sub-blocks", "Why.", [short(scene) for scene in swept("subblocks")]),
        ["Error against run time", "Glue", "Rocking"],
        ["subblocks-time-axial.svg"],
        [(0, 1, 0, "triangles"), (0, 1, 1, "2"), (1, 0, 0, "3"), (2, 0, 1, "226.5"), (2, 1, 0, "0.5")],
    ),
    "waves": (
        lambda: with_own(get_study("waves"), ["waves-discount", "waves-site-usual"]),
        ["A site under a record"],
        ["waves-site.svg"],
        [(0, 0, 5, "0.151"), (0, 0, 6, "0.01889")],
    ),
    "response": (
        lambda: get_study("response"),
        [],
        ["response.svg"],
        [(0, 5, 1, "52"), (0, 5, 2, "31.4419"), (0, 5, 4, "32.4739"), (0, 5, 7, "17.8527")],
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("name", CHAPTERS)
def test_a_chapter_says_and_draws_what_was_run(name: str, tmp_path: Path, drawn: dict[str, Figure]) -> None:
    study, headings, files, cells = CHAPTERS[name]
    results = Results(tmp_path / "results")
    run_study(study(), results)
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
    run_study(bare(get_study("response"), get_study("response").scenes[:1], solvers=("dda",), data=dict), results)
    run_study(bare(get_study("rocking"), []), results)
    blocks = chapter_of("response")(results, results.whole("response"), tmp_path)
    assert [type(block) for block in blocks] == [Heading, Paragraph]
    blocks = chapter_of("rocking")(results, results.manifest("rocking"), tmp_path)
    assert not [block for block in blocks if isinstance(block, FigureBlock)]


def test_closed_forms_of_the_page_of_waves_hold_the_rule_of_ten() -> None:
    drawn = {(c["scheme"], c["courant"]): c for c in curves()["curves"]}
    line = drawn["(1/2, 1)", 0.5]
    left = np.interp(np.log(10), np.log(line["blocks"]), line["left"])  # type: ignore[arg-type]
    assert left == pytest.approx(0.008969, rel=0.03)
    assert set(drawn["(1/4, 1/2)", 1.0]["left"]) == {1.0}  # type: ignore[call-overload]
