"""The chapter of columns whose contacts open and slip, from small runs of its own scenes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from validation.engine.finished import Derived
from validation.engine.run import run_study
from validation.report.blocks import FigureBlock, Heading, Table
from validation.report.chapters import columns as chapter
from validation.runs.results import Results
from validation.scenes.scene import Scene, load_scene
from validation.studies.columns import study

pytestmark = pytest.mark.long  # runs small studies; numbers of rows made by hand are read in the short tests

CASES = {  # scene to the cases of its sweep that are run
    "columns-drop-constant": (0,),
    "columns-solves-rest": (3, 19),
    "columns-solves-shaken": (3,),
    study.SPALL_BLOCKS: (0, 1, 4),
    study.SLIPS: (1,),
    study.SETTLE: (1, 2),
}


def scenes() -> Iterator[Scene]:
    for name, numbers in CASES.items():
        scene = load_scene(name)
        sweep = {key: [values[n] for n in numbers] for key, values in scene.sweep.items() if key != "mode"}
        few = scene.model_copy(update={"sweep": sweep | {"mode": "zip"}})
        yield few.model_copy(update={"run": few.run.model_copy(update={"solvers": ("dda",)})})


def derived() -> tuple[Derived, ...]:
    names = {case.name for scene in scenes() for case in scene.expand()}
    return tuple(row for row in study.derived() if all(need in names and who == "dda" for need, who in row.needs))


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Results:
    kept = Results(tmp_path_factory.mktemp("columns") / "kept")
    small = replace(study.study(), scenes=tuple(scenes()), extra=(), gates=lambda: (), derived=derived)
    run_study(small, kept)
    return kept


def test_the_chapter_lays_stacks_spalls_and_slips_beside_what_is_known(
    kept: Results, tmp_path: Path, drawn: dict[str, Figure]
) -> None:
    blocks = chapter.chapter(kept, kept.manifest("columns"), tmp_path)
    assert [block.text for block in blocks if isinstance(block, Heading)][1:] == [
        "What the open-close iteration takes",
        "Pieces of a spall",
        "Joints that slip, and stacks that rest",
    ]
    assert [block.file for block in blocks if isinstance(block, FigureBlock)] == [*drawn]
    assert [*drawn] == ["columns-drop.svg", "columns-solves.svg", "columns-spall.svg"]
    solves, _, slips, rests = [block for block in blocks if isinstance(block, Table)]
    assert [row[:2] for row in solves.rows] == [("comes to rest", "0.5"), ("comes to rest", "1"), ("shaken on", "0.5")]
    assert slips.rows[1][:3] == ("(1/2, 1)", "1", "5")
    assert slips.rows[1][3:] == ("−22.39", "2.107")  # as an independent program printed them
    assert [row[3] for row in rests.rows] == ["0.618", "0.155"]
    assert [float(row[4]) for row in rests.rows] == pytest.approx([0.650, 0.260], rel=0.02)


def test_pieces_of_a_spall_are_drawn_by_the_blocks_in_each(
    kept: Results, tmp_path: Path, drawn: dict[str, Figure]
) -> None:
    chapter.chapter(kept, kept.manifest("columns"), tmp_path)
    left, right = drawn["columns-spall.svg"].axes[:2]
    names = [text.get_text() for text in (left.get_legend() or left).findobj() if hasattr(text, "get_text")]
    assert "1 block a piece" in names and "4 blocks a piece" in names
    assert len([line for line in right.lines if len(line.get_xdata()) == 6]) == 1
