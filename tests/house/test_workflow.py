"""The workflow, the hooks and CONTRIBUTING.md name files, targets and things that exist; versions agree."""

import os
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
WORKFLOW, HOOKS = ROOT / ".github/workflows/ci.yml", ROOT / ".pre-commit-config.yaml"
GUIDE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PAGES = ["README.md", "CONTRIBUTING.md", *(f"docs/{path.name}" for path in sorted((ROOT / "docs").glob("*.md")))]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
# Blocks of ``key: value`` and ``- item`` by indentation, and lists in brackets: the part of YAML that our files use.
LINE = re.compile(r"(?P<indent> *)(?P<item>- )?(?:(?P<key>[\w-]+):(?: (?P<value>\S.*))?|(?P<scalar>\S.*))")


def lines_of(text: str) -> Iterator[tuple[int, str | None, str | None]]:
    """Yield indentation, key (``-`` for an item) and value of each line; an item's first key is a line of its own."""
    for line in filter(lambda line: line.strip() and not line.lstrip().startswith("#"), text.splitlines()):
        found = LINE.fullmatch(line)
        assert found, f"not in the part of YAML that is used here: {line!r}"
        indent = len(found["indent"])
        if found["item"]:
            yield indent, "-", found["scalar"]
            indent += 2
        assert found["item"] or found["key"], f"neither a key nor an item: {line!r}"
        if found["key"]:
            yield indent, found["key"], found["value"]


def parsed(text: str) -> Any:
    """Return mappings, lists and strings; a list in brackets is a list of strings."""
    lines = list(lines_of(text))

    def block(start: int, end: int) -> Any:
        indent = lines[start][0]
        heads = [i for i in range(start, end) if lines[i][0] == indent]
        assert min(line[0] for line in lines[start:end]) == indent, "a line stands to the left of its block"
        found = []
        for head, after in zip(heads, [*heads[1:], end], strict=True):
            key, value = lines[head][1:]
            assert value is None or after == head + 1, f"{key}: has a value and a block"
            found.append((key, scalar(value) if value is not None else block(head + 1, after)))
        keys = [key for key, _ in found]
        if keys[0] == "-":
            assert set(keys) == {"-"}
            return [value for _, value in found]
        assert len(set(keys)) == len(keys), f"a key twice: {keys}"
        return dict(found)

    return block(0, len(lines))


def scalar(text: str) -> Any:
    if text.startswith("["):
        assert text.endswith("]")
        return [part.strip().strip('"') for part in text[1:-1].split(",")]
    return text.strip('"')


def targets() -> set[str]:
    return set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M))


def test_the_workflow_calls_the_script_of_continuous_integration_on_every_python() -> None:
    job = parsed(WORKFLOW.read_text(encoding="utf-8"))["jobs"]["suite"]
    used = [step["uses"].partition("@")[0] for step in job["steps"] if "uses" in step]
    assert used == ["actions/checkout", "actions/setup-python"]
    commands = [step["run"] for step in job["steps"] if "run" in step]
    assert commands[-1] == ".ci/run" and os.access(ROOT / commands[-1], os.X_OK)
    assert job["steps"][1]["with"]["python-version"] == "${{ matrix.python }}"
    assert f">={job['strategy']['matrix']['python'][0]}" == PROJECT["requires-python"]


def test_hooks_are_local_and_run_the_tools_of_the_environment() -> None:
    (repository,) = parsed(HOOKS.read_text(encoding="utf-8"))["repos"]
    assert repository["repo"] == "local"
    assert [hook["entry"] for hook in repository["hooks"]] == [
        f".venv/bin/{tool}" for tool in ("ruff check", "ruff format", "lint-imports", "mypy")
    ]
    assert {hook["language"] for hook in repository["hooks"]} == {"system"}


@pytest.mark.parametrize("text", ["a: 1\n b: 2", "a:\n  b: 1\n c: 2", "a: 1\na: 2", "- a\nb: 1", "a:b", "a: [1"])
def test_what_is_not_indented_as_yaml_is_refused(text: str) -> None:
    with pytest.raises(AssertionError):
        parsed(text)


@pytest.mark.parametrize("page", [*PAGES, ".ci/run", ".github/workflows/ci.yml", ".pre-commit-config.yaml"])
def test_every_make_target_that_is_named_exists(page: str) -> None:
    named = re.findall(r"(?:^|`)make ([a-z-]+)", (ROOT / page).read_text(encoding="utf-8"), re.M)
    assert set(named) <= targets()
    if page == "CONTRIBUTING.md":
        assert {"test", "lint", "portable", "docs", "api", "bench", "gates"} <= set(named)


@pytest.mark.parametrize("page", PAGES)
def test_every_path_that_a_page_names_exists(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    made = {
        "reports/results",
        "reports/gallery",
        "reports/report.pdf",
        "reports/field.pdf",
        "before/verdicts.json",
    }  # by commands
    rooms = r"(?:dda|fem_reference|validation|tests|docs|reports|\.ci|\.github)"
    paths = set(re.findall(rf"`({rooms}/[\w./-]*)`", text)) | set(re.findall(r"\b(?:tests|reports)/[\w/]+\.py", text))
    assert not [path for path in paths - made if not (ROOT / path).exists()]
    links = re.findall(r"\]\((?!https?:)([^)#\s]+)\)", text)
    assert not [link for link in links if not (ROOT / page).parent.joinpath(link).exists()]


def test_every_row_of_where_a_change_goes_names_a_thing_in_its_file() -> None:
    rows = re.findall(r"^\| (an? [\w `]+|.*?) \| `(\S+)` \| `(\w+)` \|", GUIDE, re.M)
    assert len(rows) >= 14
    for change, path, name in rows:
        assert re.search(rf"\b{name}\b", (ROOT / path).read_text(encoding="utf-8")), f"{change}: {path}: {name}"


def test_the_map_has_every_room_in_the_order_of_its_contract() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    layers = {contract["name"]: contract["layers"] for contract in contracts if contract["type"] == "layers"}
    rooms = [layer.removeprefix("validation.") for layer in layers["Rooms of validation, from the top floor down"][1:]]
    assert [
        name for name in re.findall(r"^\| `(\w+)` \|", GUIDE, re.M) if name not in ("dda", "fem_reference")
    ] == rooms
    for package in ("dda", "fem_reference"):
        row = next(line for line in GUIDE.splitlines() if line.startswith(f"| `{package}` |"))
        wanted = [name for layer in layers[f"Rooms of {package}"] for name in layer.split(" | ")]
        assert [f"{package}.{name}" for name in re.findall(r"`(\w+)`", row)[1:]] == wanted


def test_versions_of_projects_citation_and_changelog_agree() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.findall(r"^## (?!Unreleased$)(.+)$", changelog, re.M)
    assert all(re.fullmatch(r"\d+\.\d+\.\d+ - \d{4}-\d{2}-\d{2}", heading) for heading in releases)
    number, _, date = releases[0].partition(" - ")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    peers = tomllib.loads((ROOT / "examples/peers/pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert PROJECT["version"] == peers["version"] == number
    assert re.findall(r"^(?:version|date-released): (.+)$", citation, re.M) == [number, date]
