"""Workflows, hooks, pages and CONTRIBUTING.md name targets, files, commands and things that exist; versions agree."""

import functools
import json
import os
import re
import shlex
import subprocess
import tomllib
from fnmatch import fnmatch

import typer
import yaml
from oracles.pages import BLOCK, ROOT

from validation.cli.entry import app

WORKFLOWS = ROOT / ".github/workflows"
DOCS = [f"docs/{path.name}" for path in sorted((ROOT / "docs").glob("*.md"))]
PEERS = ROOT / "examples/peers"
PAGES = ["README.md", "CONTRIBUTING.md", "AGENTS.md", "SECURITY.md", *DOCS]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
GUIDE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")
WRITTEN = {  # by commands
    "reports/results",
    "reports/gallery",
    "reports/report.pdf",
    "reports/field.pdf",
    "before/verdicts.json",
}


@functools.cache
def commands():
    """Return the commands of `dda-validate` by name."""
    return typer.main.get_command(app).commands


def steps_of(workflow, job):
    """Return the steps of a job."""
    return yaml.safe_load((WORKFLOWS / workflow).read_text(encoding="utf-8"))["jobs"][job]["steps"]


# ---- workflows and hooks --------------------------------------------------------------------------------------------


def test_the_workflow_calls_the_script_of_continuous_integration_on_every_python():
    steps = steps_of("ci.yml", "suite")
    used = [step["uses"].partition("@")[0] for step in steps if "uses" in step]
    assert used == ["actions/checkout", "actions/setup-python"]
    script = next(step["run"] for step in reversed(steps) if "run" in step)
    assert script == ".ci/run" and os.access(ROOT / script, os.X_OK)
    job = yaml.safe_load((WORKFLOWS / "ci.yml").read_text(encoding="utf-8"))["jobs"]["suite"]
    assert steps[1]["with"]["python-version"] == "${{ matrix.python }}"
    assert f">={job['strategy']['matrix']['python'][0]}" == PROJECT["project"]["requires-python"]


def test_nothing_is_released_that_was_not_refused_as_unready_and_tested_before():
    runs = [step["run"] for step in steps_of("release.yml", "release") if "run" in step]
    order = [next(i for i, run in enumerate(runs) if word in run) for word in ("--release", ".ci/run", "gh release")]
    assert order == sorted(order)
    triggers = yaml.safe_load((WORKFLOWS / "release.yml").read_text(encoding="utf-8"))[True]  # `on` is a truth in YAML
    assert triggers == {"push": {"tags": ["v*"]}}


def test_the_action_s_last_step_asks_what_its_inputs_say(tmp_path):
    action = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
    step = action["runs"]["steps"][-1]
    inputs = {"solver": "mine:solve", "problems": "sliding impact", "study": "", "out": "site"}
    assert set(action["inputs"]) == set(inputs)
    values = {name: inputs[word.split(".")[1].split()[0]] for name, word in step["env"].items()}
    (tmp_path / "dda-validate").write_text('#!/bin/sh\necho "$@"\nexit 2\n', encoding="utf-8")
    (tmp_path / "dda-validate").chmod(0o755)
    done = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", step["run"]],
        env={**os.environ, **values, "PATH": os.pathsep.join([str(tmp_path), os.environ["PATH"]])},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout) == (2, "judge mine:solve sliding impact --out site\n")


# ---- what pages name ------------------------------------------------------------------------------------------------


def test_every_make_target_that_is_named_exists():
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M))
    pages = [*(ROOT / page for page in PAGES), ROOT / ".ci/run", *WORKFLOWS.iterdir()]
    named = {page: set(re.findall(r"(?:^|`|run: )make ([a-z-]+)", page.read_text("utf-8"), re.M)) for page in pages}
    assert not {page.name: names - targets for page, names in named.items() if names - targets}
    assert {"test", "lint", "portable", "docs", "bench", "gates", "dist"} <= named[ROOT / "CONTRIBUTING.md"]


def test_every_file_and_test_that_a_script_names_exists():
    for script in (ROOT / "Makefile", *(path for path in (ROOT / ".ci").iterdir() if path.is_file())):
        for name in re.findall(r"\btests/[\w/]+\.py(?:::\w+)?", script.read_text(encoding="utf-8")):
            path, _, test = name.partition("::")
            assert (ROOT / path).is_file() and f"def {test}" in (ROOT / path).read_text("utf-8"), (script.name, name)


def test_every_path_that_a_page_names_exists():
    rooms = r"(?:dda|fem_reference|validation|tests|docs|reports|\.ci|\.github)"
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        paths = {*re.findall(rf"`({rooms}/[\w./-]*)`", text), *re.findall(r"\b(?:tests|reports)/[\w/]+\.py", text)}
        assert not [path for path in paths - WRITTEN if not (ROOT / path).exists()], page
        links = re.findall(r"\]\((?!https?:)([^)#\s]+)\)", text)
        targets = [(ROOT / page).parent.joinpath(link).resolve() for link in links]
        assert not [target for target in targets if not target.exists() and not left_out(target)], page


def left_out(path):
    """Whether a path is of the adapters of other programs, and these are gone."""
    return path.is_relative_to(PEERS) and not PEERS.exists()


def test_commands_and_options_of_pages_exist():
    blocks = [block for page in PAGES for block in BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))]
    lines = [line for language, _, text in blocks if language in ("sh", "text", "yaml") for line in text.splitlines()]
    for line in lines:
        for part in line.removeprefix("      - run: ").partition(" #")[0].split("&&"):
            if "dda-validate" not in part:
                continue
            words = shlex.split(part)
            if words[0].endswith("dda-validate"):
                command = commands()[words[1]]
                if words[1] == "advise":
                    command = command.commands.get(words[2], command.commands["everything"])
                known = {option for parameter in command.params for option in parameter.opts}
                assert {word for word in words if word.startswith("--")} <= known, line


def test_readme_names_every_command():
    shell = [text for language, _, text in BLOCK.findall(README) if language == "sh"]
    shown = re.findall(r"^dda-validate ([a-z-]+)", shell[1], re.M)
    others = README.partition("The other commands: ")[2].partition("\n\n")[0]
    assert len(shown) == 8 and {*shown, *re.findall(r"`([a-z-]+)`", others)} == set(commands())


# ---- CONTRIBUTING.md and releases -----------------------------------------------------------------------------------


def test_every_row_of_where_a_change_goes_names_a_thing_in_its_file():
    rows = re.findall(r"^\| (an? [\w `]+|.*?) \| `(\S+)` \| `(\w+)` \|", GUIDE, re.M)
    assert len(rows) >= 14
    for change, path, name in rows:
        assert re.search(rf"\b{name}\b", (ROOT / path).read_text(encoding="utf-8")), f"{change}: {path}: {name}"


def test_the_map_has_every_room_in_the_order_of_its_contract():
    contracts = PROJECT["tool"]["importlinter"]["contracts"]
    layers = {contract["name"]: contract["layers"] for contract in contracts if contract["type"] == "layers"}
    rooms = [layer.removeprefix("validation.") for layer in layers["Rooms of validation, from the top floor down"][1:]]
    mapped = [name for name in re.findall(r"^\| `(\w+)` \|", GUIDE, re.M) if name not in ("dda", "fem_reference")]
    assert mapped == rooms
    for package in ("dda", "fem_reference"):
        row = next(line for line in GUIDE.splitlines() if line.startswith(f"| `{package}` |"))
        floors = [name for layer in layers[f"Rooms of {package}"] for name in layer.split(" | ")]
        assert [f"{package}.{name}" for name in re.findall(r"`(\w+)`", row)[1:]] == floors


def test_versions_of_projects_citation_and_changelog_agree():
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.findall(r"^## (?!Unreleased$)(.+)$", changelog, re.M)
    assert all(re.fullmatch(r"\d+\.\d+\.\d+ - \d{4}-\d{2}-\d{2}", heading) for heading in releases)
    number, _, date = releases[0].partition(" - ")
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    deposit = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    assert PROJECT["project"]["version"] == citation["version"] == deposit["version"] == number
    if PEERS.exists():
        peers = tomllib.loads((PEERS / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        assert peers["version"] == number
    assert str(citation["date-released"]) == date


def test_each_data_file_of_a_package_is_declared_and_so_part_of_a_wheel():
    declared = PROJECT["tool"]["setuptools"]["package-data"]
    count = 0
    for name in ("dda", "fem_reference", "validation"):
        for file in (path.relative_to(ROOT) for path in (ROOT / name).rglob("*") if path.is_file()):
            if file.suffix == ".py" or "__pycache__" in file.parts:
                continue
            packages = [folder for folder in file.parents if (ROOT / folder / "__init__.py").is_file()]
            patterns = [
                (package / pattern).as_posix()
                for package in packages
                for pattern in declared.get(".".join(package.parts), [])
            ]
            assert any(fnmatch(file.as_posix(), pattern) for pattern in patterns), file
            count += 1
    assert count > 100


def test_actions_of_others_are_pinned_by_commit_and_write_nothing_by_default():
    for path in (ROOT / ".github/workflows").glob("*.yml"):
        text = path.read_text(encoding="utf-8")
        pinned = re.findall(r"uses: \S+@(\S+)", text)
        assert all(re.fullmatch(r"[0-9a-f]{40}", commit) for commit in pinned), path.name
        assert yaml.safe_load(text)["permissions"] == {"contents": "read"}, path.name
