"""The chapter of waves, from a run of the whole study and from parts of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from validation.engine.run import run_study
from validation.engine.study import Study
from validation.report.blocks import Block, FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.registry import chapter_of
from validation.runs.results import Results
from validation.studies.waves.rows import curves
from validation.studies.waves.study import study


def told(some: Study, directory: Path) -> list[Block]:
    """Run a study and return its chapter."""
    results = Results(directory / "results")
    run_study(some, results)
    return chapter_of("waves")(results, results.whole(some.name), directory)


def part(*names: str) -> Study:
    """Return the study with some of its scenes and what belongs to them."""
    whole = study()
    scenes = [s for s in whole.scenes if (s if isinstance(s, str) else s.name) in names]
    known = {case.scene.name for case in replace(whole, scenes=scenes, extra=()).cases()}
    return replace(
        whole,
        scenes=scenes,
        extra=(),
        gates=lambda: tuple(g for g in whole.gates() if g.scene in known and g.pair != ("order",)),
        derived=lambda: tuple(d for d in whole.derived() if d.scene in known and d.name != "order"),
    )


@pytest.mark.long
def test_the_whole_chapter(tmp_path: Path) -> None:
    blocks = told(study(), tmp_path)
    texts = [block.text for block in blocks if isinstance(block, Paragraph)]
    assert texts[0].startswith(
        "Ten blocks a wavelength are a rule for the speed only: at c dt/h = 1/2 the wave is 1.67"
    )
    assert "0.897\u00a0% of its amplitude is left" in texts[0]
    assert "gates pass" in texts[1]
    assert [block.file for block in blocks if isinstance(block, FigureBlock)] == ["waves-travel.svg", "waves-site.svg"]
    others, joints, base = (block for block in blocks if isinstance(block, Table))
    assert [row[5:] for row in others.rows][:4] == [
        ("−28.691", "0.001071"), ("−3.070", "0.007117"), ("1.168", "0.008762"), ("1.667", "0.008967")
    ]  # fmt: skip
    assert others.rows[4][5:] == ("0.151", "0.01889")
    assert [row[3] for row in joints.rows] == [
        "0.895981", "0.894800", "0.894519", "0.894433", "0.871194", "0.888266", "0.893212"
    ]  # fmt: skip
    assert {row[5] for row in joints.rows[:4]} == {"1.000000"}
    assert len(base.rows) == 6
    assert "DDA is 14.5\u00a0% off at the surface" in texts[3]


@pytest.mark.long
def test_parts_of_the_study_make_parts_of_the_chapter(tmp_path: Path) -> None:
    blocks = told(part("waves-discount"), tmp_path)
    assert [type(block) for block in blocks] == [Heading, Paragraph, Paragraph, Table]
    page = chapter_of("")(Results(tmp_path / "results"), Results(tmp_path / "results").whole("waves"), tmp_path)
    assert not [block for block in page if isinstance(block, Table)]  # a column has no first axial mode to tell
    assert told(part("waves-site-usual"), tmp_path / "site")[-1].file == "waves-site.svg"  # type: ignore[union-attr]


def test_closed_forms_of_the_page_hold_the_rule_of_ten() -> None:
    drawn = {(c["scheme"], c["courant"]): c for c in curves()["curves"]}
    line = drawn["(1/2, 1)", 0.5]
    left = np.interp(np.log(10), np.log(line["blocks"]), line["left"])  # type: ignore[arg-type]
    assert left == pytest.approx(0.008969, rel=0.03)
    assert set(drawn["(1/4, 1/2)", 1.0]["left"]) == {1.0}  # type: ignore[call-overload]
