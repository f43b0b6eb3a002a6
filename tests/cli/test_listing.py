"""`list WORD`: one line for each metric, study, scene and solver; the page of metrics is the catalogue."""

from pathlib import Path

import pytest
from conftest import typed

from validation.metrics.catalogue import CATALOGUE, KIND, METRICS, Metric
from validation.scenes.scene import load_scene, scene_names
from validation.solvers import registry
from validation.solvers.registry import get_solver, solver_names
from validation.studies.catalogue import STUDIES, get_study

PAGE = Path(__file__).parents[2] / "docs" / "metrics.md"


def listed(word: str) -> list[str]:
    done = typed("list", word)
    assert done.returncode == 0 and not done.stderr
    return done.stdout.splitlines()


def test_every_metric_has_a_line_with_unit_needs_and_meaning() -> None:
    heads, *lines = listed("metrics")
    assert heads.split() == ["metric", "unit", "needs", "meaning"]
    starts = [heads.index(word) for word in heads.split()]
    assert len(lines) == len(METRICS)
    for line, metric in zip(lines, CATALOGUE.values(), strict=True):
        cells = [line[a:b].strip() for a, b in zip(starts, [*starts[1:], None], strict=True)]
        assert cells == [metric.id, metric.unit, ", ".join(sorted(metric.needs)), metric.says]


def test_studies_scenes_and_solvers_have_a_line_each() -> None:
    studies, scenes, solvers = (listed(word)[1:] for word in ("studies", "scenes", "solvers"))
    assert [line.split()[0] for line in studies] == list(STUDIES)
    assert [line.split()[0] for line in scenes] == list(scene_names())
    assert [line.split()[0] for line in solvers] == solver_names()
    for line, name in zip(studies, STUDIES, strict=True):
        assert line.split()[1] == str(len(get_study(name).scenes)) and line.endswith(get_study(name).title)
    for line, name in zip(scenes, scene_names(), strict=True):
        scene = load_scene(name)
        assert line.split()[1] == str(len(scene.expand())) and line.endswith(scene.title)
        assert ", ".join(scene.run.solvers) in line
    for line, name in zip(solvers, solver_names(), strict=True):
        assert f" {get_solver(name).role} " in line and all(word in line for word in get_solver(name).handles)


def test_a_solver_of_another_package_is_listed_with_its_target(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "entry_points", lambda: {"theirs": "their_package.adapter:solve"})
    last = listed("solvers")[-1].split()
    assert (last[0], last[1], last[-1]) == ("theirs", "other", "their_package.adapter:solve")


def test_the_plain_list_names_all_four() -> None:
    done = typed("list")
    words = done.stdout.replace(",", "").split()
    for name in (*STUDIES, *scene_names(), *solver_names(), *METRICS):
        assert name in words


def test_another_word_is_bad_input() -> None:
    done = typed("list", "gates")
    assert done.returncode == 2
    assert done.stderr == "error: list: must be one of metrics, scenes, solvers, studies, got 'gates'\n"


def row(metric: Metric) -> str:
    return f"| `{metric.id}` | {metric.unit} | {', '.join(sorted(metric.needs))} | {metric.says} |"


def test_the_page_of_metrics_is_the_catalogue() -> None:
    table = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    expected = [row(metric) for metric in (*CATALOGUE.values(), KIND)]
    assert table == expected, "write these lines into docs/metrics.md:\n" + "\n".join(expected)
