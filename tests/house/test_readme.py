"""README and the pages beside those of `test_docs`: code runs, tables of scenes load, commands and options exist."""

import functools
import re
import shlex
import tomllib
from pathlib import Path
from typing import Any

import pytest
import typer
from conftest import SCENE

from validation import solve
from validation.cli.entry import app
from validation.scenes.scene import parse_scene
from validation.solvers.names import check_names
from validation.solvers.registry import BUILT_IN
from validation.studies.catalogue import STUDIES

ROOT = Path(__file__).parents[2]
PAGES = ["README.md", *(f"docs/{path.name}" for path in sorted((ROOT / "docs").glob("*.md")))]


@functools.cache
def commands() -> dict[str, Any]:
    return typer.main.get_command(app).commands  # type: ignore[attr-defined]


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.parametrize("page", ["README.md", "docs/subblocks.md"])
def test_python_blocks_run(page: str) -> None:
    names: dict[str, object] = {}
    assert blocks(page, "python")
    for text in blocks(page, "python"):
        exec(compile(text, page, "exec"), names)


def test_the_numbers_that_the_example_speaks_of(capsys: pytest.CaptureFixture[str]) -> None:
    (text,) = blocks("README.md", "python")
    exec(compile(text, "README.md", "exec"), {})
    form, mesh, pressure = map(float, capsys.readouterr().out.split())
    assert 1e-4 < form < 1e-2 and mesh < 1e-3 * form and pressure == pytest.approx(5e6, rel=1e-3)


@pytest.mark.parametrize("page", ["docs/loads.md", "docs/subblocks.md"])
def test_tables_of_scenes_load(page: str, tmp_path: Path) -> None:
    (tmp_path / "record.csv").write_text("time,x\n0,0\n1,0.001\n")
    for text in blocks(page, "toml"):
        data = tomllib.loads(SCENE)
        for name, table in tomllib.loads(text.replace('"record.csv"', f"'{tmp_path}/record.csv'")).items():
            data[name] = {**data.get(name, {}), **table} if isinstance(table, dict) else table
        scene = parse_scene(data, page)
        check_names(scene, page)
        run = solve(scene.expand()[0], "dda")
        assert run.history is not None and set(scene.run.columns) == set(run.history.columns)


def first_cells(head: str) -> list[str]:
    """Return the names in the first column of the table of README.md under a head."""
    table = (ROOT / "README.md").read_text(encoding="utf-8").partition(f"| {head} |")[2].partition("\n\n")[0]
    return [name for row in re.findall(r"^\| (`.*?) \|", table, re.M) for name in re.findall(r"`([\w-]+)`", row)]


def test_the_table_of_solvers_is_the_registry() -> None:
    assert first_cells("solver") == list(BUILT_IN)


def test_the_table_of_studies_has_them_all() -> None:
    assert sorted(first_cells("study")) == sorted(STUDIES)


def test_every_command_stands_in_the_list_of_commands() -> None:
    listed = re.findall(r"dda-validate ([a-z-]+)", blocks("README.md", "sh")[2])
    assert set(commands()) - {"report"} <= set(listed) and "dda-validate report" in (ROOT / "README.md").read_text()


@pytest.mark.parametrize("page", PAGES)
def test_commands_and_options_of_a_page_exist(page: str) -> None:
    lines = [line for text in blocks(page, "(?:sh|text)") for line in text.splitlines() if "dda-validate" in line]
    for line in lines:
        for part in line.partition(" #")[0].split("&&"):
            words = shlex.split(part)
            if not words[0].endswith("dda-validate"):
                continue
            known = {option for parameter in commands()[words[1]].params for option in parameter.opts}
            assert {word for word in words if word.startswith("--")} <= known, line
