"""Every code block of the documentation is run, in the order in which a reader meets it."""

import doctest
import importlib
import os
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from conftest import beside, typed
from oracles.pages import BLOCK, FEW, ROOT
from oracles.submissions import right_answer

PAGES = ("theory.md", "extending.md", "columns.md")
# Pages that take seconds each.
LONG = (
    "stacks.md",
    "friction.md",
    "contact.md",
    "rotation.md",
    "waves.md",
    "judge-your-code.md",
    "ci.md",
    "fenicsx.md",
)


def run_line(line: str, directory: Path) -> None:
    """Run a line of a shell as a user in a directory does."""
    program, *words = shlex.split(line, comments=True)
    if program == "dda-validate":
        done = typed(*words, cwd=directory)
    else:
        assert program == "pytest"
        done = subprocess.run(
            [sys.executable, "-m", program, *words, *FEW],
            capture_output=True,
            text=True,
            timeout=200,
            cwd=directory,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
    assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"


@pytest.mark.parametrize("page", [*PAGES, *(pytest.param(page, marks=pytest.mark.long) for page in LONG)])
def test_code_blocks_run(page: str, tmp_path: Path, finished_cases: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("before", "after"):  # what the page compares, with the cases that other tests have finished
        beside(finished_cases, tmp_path / name)
    if page == "judge-your-code.md":
        right_answer(tmp_path / "my-answer")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    names: dict[str, object] = {}
    blocks = BLOCK.findall((ROOT / "docs" / page).read_text(encoding="utf-8"))
    assert blocks
    for language, file, text in blocks:
        if file:
            (tmp_path / file).write_text(text)
        if language == "sh":
            for line in text.splitlines():
                run_line(line, tmp_path)
        elif language == "python" and not file:
            exec(compile(text, page, "exec"), names)
        elif language == "toml":
            tomllib.loads(text)


def test_the_workflow_calls_commands_and_options_that_exist() -> None:
    text = (ROOT / "docs/ci.md").read_text(encoding="utf-8")
    for option in ("--baseline", "--summary"):
        assert option in text and option in (ROOT / "validation/cli/app.py").read_text(encoding="utf-8")
    assert "--dda-solver" in text
    assert "--dda-solver" in (ROOT / "validation/entry/plugin.py").read_text(encoding="utf-8")


def test_every_public_name_has_a_docstring() -> None:
    import dda
    import fem_reference
    import validation

    for package in (dda, fem_reference, validation):
        for name in package.__all__:
            value = getattr(package, name)
            if isinstance(value, type) or hasattr(value, "__code__"):
                assert (value.__doc__ or "").strip(), f"{package.__name__}.{name}"


EXAMPLES = [
    path
    for package in ("dda", "fem_reference", "validation")
    for path in sorted((ROOT / package).rglob("*.py"))
    if ">>>" in path.read_text()
]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_of_docstrings_print_what_they_say(path: Path) -> None:
    module = importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
    found = doctest.testmod(module)
    assert found.attempted > 0 and found.failed == 0
