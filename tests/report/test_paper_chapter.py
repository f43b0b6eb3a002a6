"""The chapter of the paper and the pages' damping budgets: every figure drawn, from a results directory alone."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import beside
from matplotlib.figure import Figure

from validation.advice import budget
from validation.engine.run import run_study
from validation.report.appendix.alarms import alarm_table
from validation.report.blocks import FigureBlock, Table
from validation.report.chapters.paper import claims_table, conclusion
from validation.report.chapters.registry import chapter_of
from validation.report.front.groups import groups_of_studies
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies import Study
from validation.studies.catalogue import scene_study
from validation.studies.paper.study import PAPER

pytestmark = pytest.mark.xdist_group("paper-chapter")


UNDRAWN = ("poisson-statics", "open-close")  # scenes of claims alone


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """The study with shorter histories and without the slow solvers."""
    kept = Results(tmp_path_factory.mktemp("results"))
    scenes = [load_scene(s) if isinstance(s, str) else s for s in PAPER.scenes if s not in UNDRAWN]
    short = [s.with_values({"time.steps": min(s.time.steps, 120)}) for s in scenes]
    study = Study("paper", PAPER.title, PAPER.purpose, short, ("dda", "bar"), data=PAPER.data)
    run_study(study, kept)
    return kept


@pytest.mark.long
def test_a_part_of_the_scenes_gives_its_figures(results: Results, tmp_path: Path) -> None:
    manifest = results.manifest("paper")
    manifest["cases"] = [case for case in manifest["cases"] if case["scene"].startswith("figure-9")]
    blocks = chapter_of("paper")(results, manifest, tmp_path)
    files = [block.file for block in blocks if isinstance(block, FigureBlock)]
    assert files == ["figure-1.svg", "figure-9.svg"]
    assert all((tmp_path / file).stat().st_size > 2000 for file in files)


@pytest.mark.long
def test_every_figure_is_written_as_svg_and_png_and_no_solver_is_loaded(results: Results, tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from validation.report.book import figures; "
        "from validation.runs.results import Results; "
        f"figures('paper', Results({str(results.directory)!r}), Path({str(tmp_path)!r})); "
        "print([m for m in ('dda', 'fem_reference', 'skfem') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    written = {path.name for path in tmp_path.iterdir()}
    assert {f"figure-{n}.{kind}" for n in (1, 3, 4, 5, 6, 7, 8, 9) for kind in ("svg", "png")} <= written
    assert all((tmp_path / name).stat().st_size > 2000 for name in written)


def test_the_register_lists_every_claim() -> None:
    claims = json.loads(json.dumps(dict(PAPER.data())))["claims"]  # as a manifest holds them
    table = claims_table(claims, {"C1": {"verdict": 2.0, "left": 0.001}, "C6": {"verdict": 1.0}})
    rows = {row[0]: row for row in table.rows}
    assert {f"C{i}" for i in range(1, 23)} | {"S13", "S16", "S20", "S21", "S29", "S32"} == set(rows)
    assert rows["C1"][1] == "confirmed" and rows["C1"][4] == "left 0.001"
    assert rows["C6"][1] == "under a condition" and "Condition: mode by mode" in rows["C6"][3]
    assert rows["C2"][1] == "not tested"
    assert "1 is confirmed, 1 holds under a condition" in conclusion({"C1": {"verdict": 2.0}, "C6": {"verdict": 1.0}})


@pytest.mark.long
def test_the_page_of_a_scene_shows_its_budget_and_the_appendix_its_alarms(
    tmp_path: Path, finished_cases: Path, drawn: dict[str, Figure]
) -> None:
    scene = load_scene("figures-5-6")
    study = scene_study("figures-5-6")
    kept = beside(finished_cases, tmp_path / "results")
    run_study(Study(study.name, study.title, study.purpose, [scene], ("dda", "bar", "continuum")), kept)
    blocks = chapter_of("figures-5-6")(kept, kept.manifest("figures-5-6"), tmp_path)
    captions = [block.caption for block in blocks if isinstance(block, FigureBlock)]
    assert len(captions) == len(drawn) > 1
    assert any("Damping budget" in caption and "1.052 to 1.102 times" in caption for caption in captions)
    _, table = alarm_table(groups_of_studies(kept, ["figures-5-6"]))
    assert isinstance(table, Table)
    assert {row[0] for row in table.rows} == {"agreement by damping", "hidden tension", "contact ringing"}


def test_a_budget_holds_curves_and_limits() -> None:
    cases = load_scene("figures-3-4").expand()
    (found,) = budget.budgets(cases)
    assert found["steps"] == [0.001, 0.002, 0.01]
    assert found["limits"]["real roots"] * 344.5612 == pytest.approx(4.0, rel=2e-3)
    assert found["real roots at"] == pytest.approx(4.0, rel=2e-3)
    assert found["limits"]["wave transit"] == pytest.approx(3.29e-3, abs=5e-6)
    assert found["floor"] == pytest.approx(1.0515, abs=5e-5)
    dt, first = np.array(found["dt"]), found["modes"]["first axial"]
    i = int(np.argmin(np.abs(dt - 0.002)))
    assert first["total"][i] == pytest.approx(344.5612 * dt[i] / 4, rel=0.2)
    assert first["total"][-1] is None and first["kinetic"][0] == 0


def test_a_budget_s_viscous_part_is_what_the_tables_add() -> None:
    scene = load_scene("figures-3-4").expand()[1].with_values({"damping.mass": 20.0})
    (found,) = budget.budgets([scene])
    first = found["modes"]["first axial"]
    total, own, added = (first[part][0] for part in ("total", "algorithmic", "viscous"))
    assert added == pytest.approx(20.0 / (2 * 344.5612), rel=1e-3)  # a0 / (2 w) at small dt
    assert total == pytest.approx(own + added, rel=1e-3)


def test_a_budget_splits_damping_and_keeps_a_rate() -> None:
    light = load_scene("figure-9").expand()[1]
    (found,) = budget.budgets([light])
    assert found["limits"]["overdamped below"] == pytest.approx(2.93e-5, rel=2e-3)
    rate = light.with_values({"time.gg_rate": 20.0})
    (kept,) = budget.budgets([rate])
    first = kept["modes"]["first axial"]
    assert first["kinetic"][0] == pytest.approx(20.0 / (2 * 344.5612), rel=1e-3)  # c / (2 w) at small dt
    assert "overdamped below" not in kept["limits"]
    assert len(list(budget.budgets(load_scene("figure-9").expand()))) == 4
