"""The chapter of sub-blocks, from a small run of its own scenes."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from validation.engine.run import run_study
from validation.engine.study import Study
from validation.report.blocks import FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.subblocks import chapter
from validation.runs.results import Results
from validation.scenes.scene import Scene, load_scene

pytestmark = pytest.mark.long  # runs small studies; numbers of rows made by hand are read in the short tests

SMALL = {
    "subblocks-column": {"block.subdivide": [[1, 1], [1, 4]], "fem.elements": [1, 4]},
    "subblocks-axial": {
        "block.pattern": ["squares", "squares", "triangles"],
        "block.subdivide": [[1, 1], [2, 2], [2, 2]],
    },
    "subblocks-rocking": {"block.pattern": ["squares", "triangles"], "block.subdivide": [[9, 9], [2, 2]]},
    "subblocks-locking": {"contact.stiffness": [1e9], "block.subdivide": [[12, 12]], "load.traction": [1e6]},
    "subblocks-best-glue": {
        "block.glue_ratio": [3.0, 3.0],
        "load.pressure": [5e6, 0.0],
        "load.traction": [0.0, 1e6],
        "block.subdivide": [[2, 2], [2, 2]],
    },
    "rocking": {"fem.patch_width": [1.0, 0.5]},
}


def small(name: str) -> Scene:
    scene = load_scene(name)
    time = scene.time.model_copy(update={"steps": 20})
    fem = scene.fem.model_copy(update={"elements": 4, "degree": 1})
    return scene.model_copy(update={"sweep": {"mode": "zip", **SMALL[name]}, "time": time, "fem": fem})


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    kept = Results(tmp_path_factory.mktemp("results"))
    run_study(Study("subblocks", "Sub-blocks", "What cutting buys.", [small(name) for name in SMALL]), kept)
    return kept


def test_the_chapter_tells_error_against_time_locking_glue_and_rocking(
    results: Results, tmp_path: Path, drawn: dict[str, Figure]
) -> None:
    blocks = chapter(results, results.manifest("subblocks"), tmp_path)
    headings = [block.text for block in blocks if isinstance(block, Heading)]
    assert headings[:4] == ["Sub-blocks", "Error against run time", "Glue", "Rocking"]
    figures = [block.file for block in blocks if isinstance(block, FigureBlock)]
    assert figures[:2] == ["subblocks-time-axial.svg", "subblocks-time-rocking.svg"]
    assert figures == [*drawn]
    said = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
    assert "cut the block into triangles" in said
    tables = {block.caption.partition(":")[0]: block for block in blocks if isinstance(block, Table) and block.caption}
    rocking = tables["First rocking mode on springs of equal total stiffness"].rows
    assert [row[0] for row in rocking] == ["1", "0.5"] and rocking[0][1] == "226.5"
    assert tables["8 × 8 squares at p = 1E, μ = 0"].rows[0][0] == "3"
    patterns = tables["Squares and triangles under pressure, against quadratic elements"].rows
    assert [row[:2] for row in patterns] == [("squares", "1"), ("squares", "2"), ("triangles", "2")]


def test_a_part_of_the_scenes_gives_a_part_of_the_chapter(results: Results, tmp_path: Path) -> None:
    manifest = results.manifest("subblocks")
    manifest["cases"] = [case for case in manifest["cases"] if case["scene"].startswith("rocking")]
    blocks = chapter(results, manifest, tmp_path)
    assert not [b for b in blocks if isinstance(b, FigureBlock) and b.file.startswith("subblocks-time")]
