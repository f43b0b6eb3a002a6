"""The exit status of a run: no 0 where nothing was measured, where a baseline is no baseline, where names collide."""

import json
import sys

import numpy as np
import pytest
from conftest import OVERFLOW, SCENE, refused, thinned, typed

from validation.report import book
from validation.report.blocks import Callout, FigureBlock
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver

RUN = "[run]\nsolvers = {}\n"
GATE = '[[gate]]\npair = {}\nmetric = "{}"\nband = {}\nreason = "a reason"\n'


def gated(band, pair='["dda", "bar"]', solvers='["dda", "bar"]'):
    metric = "displacement.l2" if "," in pair else "displacement.static"
    return SCENE + RUN.format(solvers) + GATE.format(pair, metric, band)


GOOD = "a good file"
WIDE, TIGHT = gated("[0.0, 1.0]"), gated("[0.0, 1e-3]")
# ---- nothing measured -----------------------------------------------------------------------------------------------


# ---- baselines ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("where", thinned(["link", "r", "r/verdicts.json"], 3))
def test_a_baseline_in_the_results_directory_is_read_before_it_is_overwritten(where, scene_file, tmp_path):
    scene_file.write_text(gated("[-1.0, 1.0]", '["dda"]'))
    (tmp_path / "link").symlink_to(tmp_path / "r")
    done = typed("run", scene_file, "--results", "r", "--json", cwd=tmp_path)
    assert done.returncode == json.loads(done.stdout)["status"] == 0
    scene_file.write_text(gated("[-1.0, -0.5]", '["dda"]'))
    done = typed("run", scene_file, "--results", "r", "--baseline", where, cwd=tmp_path)
    assert done.returncode == 1


BASELINES = {  # what is sound is a matter of the records
    "missing": lambda path: path.unlink(),
    "twice": lambda path: path.write_text(json.dumps(json.loads(path.read_text()) * 2)),
}


@pytest.mark.parametrize("name", BASELINES)
def test_a_baseline_that_is_none_is_refused_before_anything_runs(name, scene_file, tmp_path):
    scene_file.write_text(WIDE)
    assert typed("run", scene_file, "--results", tmp_path / "r").returncode == 0
    base = tmp_path / "r" / "verdicts.json"
    BASELINES[name](base)
    for command in (["run", scene_file, "--results", tmp_path / "n", "--baseline", base], ["diff", base, base]):
        assert str(base) in refused(*command)
    assert not (tmp_path / "n").exists()


# ---- files and streams ----------------------------------------------------------------------------------------------


def command(*arguments):
    return [sys.executable, "-m", "validation", *map(str, arguments)]


def test_fields_are_not_written_after_an_overflow(scene_file, tmp_path):
    out = tmp_path / "f.vtu"
    out.write_text(GOOD)
    done = typed("solve", scene_file, "--solver", "fem", "--fields", out, *OVERFLOW)
    assert done.returncode == 3 and "overflow" in done.stdout
    assert out.read_text() == GOOD
    assert sorted(path.name for path in tmp_path.iterdir()) == [out.name, scene_file.name]


def test_a_history_is_written_of_a_run_that_completes(scene_file, tmp_path):
    out = tmp_path / "h.csv"
    assert typed("solve", scene_file, "--csv", out).returncode == 0
    kept = get_solver("dda").solve(load_scene(scene_file)).history
    assert np.loadtxt(out, delimiter=",", skiprows=1)[:, :2] == pytest.approx(
        np.stack([kept.time, kept.columns["displacement"]], axis=1), rel=1e-9
    )


def test_a_solver_that_writes_no_fields_leaves_a_good_file_as_it_was(scene_file, tmp_path, monkeypatch):
    out = tmp_path / "f.vtu"
    out.write_text(GOOD)
    run = get_solver("dda").solve(load_scene(scene_file))
    monkeypatch.setattr("validation.engine.measure.completed", lambda *arguments: run)
    assert "--fields" in refused("solve", scene_file, "--solver", "fem", "--fields", out)
    assert out.read_text() == GOOD


def test_a_chapter_that_cannot_be_drawn_does_not_cost_the_report(scene_file, tmp_path, monkeypatch):
    for name in ("small", "other"):
        scene_file.with_name(f"{name}.toml").write_text(SCENE + RUN.format('["dda"]'))
        assert typed("run", scene_file.with_name(f"{name}.toml"), "--results", tmp_path / "r").returncode == 0
    picture = FigureBlock("picture.svg", "drawn elsewhere")
    monkeypatch.setattr(book, "chapter_of", lambda study: lambda *_: [][0] if study == "other" else [picture])
    blocks = book._all_blocks(Results(tmp_path / "r"), ["other", "small"], tmp_path)
    (said,) = [block.text for block in blocks if isinstance(block, Callout) and block.tone == "fail"]
    assert "other" in said and "IndexError" in said
    assert picture in blocks
    assert "IndexError" in refused("report", "other", "--results", tmp_path / "r", "--figures", tmp_path / "f")
