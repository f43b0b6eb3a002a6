"""The site: every page is in its navigation, it builds strictly and asks no network; the tutorial says what happens."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import beside
from oracles.pages import BLOCK, FEW, ROOT

DOCS = ROOT / "docs"
MKDOCS = Path(sys.executable).with_name("mkdocs")
REQUEST = re.compile(r"""<(?:script|link|img|iframe)[^>]*(?:src|href)=["']?(https?:)?//""")


def test_every_entry_of_the_navigation_is_a_page() -> None:
    listed = re.findall(r"[ :](\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.M)
    assert len(listed) == len(set(listed)) > 15
    assert not [name for name in listed if not (DOCS / name).is_file()]


@pytest.mark.long
def test_the_site_builds_strictly_and_asks_no_network(tmp_path: Path) -> None:
    if not MKDOCS.exists():
        pytest.skip("the extra docs is not installed")
    command = [MKDOCS, "build", "--quiet", "--site-dir", tmp_path / "site"]
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, env=os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    )
    assert done.returncode == 0, done.stderr
    pages = list((tmp_path / "site").rglob("*.html"))
    for path in pages:
        assert not REQUEST.search(path.read_text(encoding="utf-8")), path
    names = {path.stem for path in pages}
    assert {path.stem for path in DOCS.glob("*.md")} <= names
    assert {"index", "tutorial", "dda.scheme", "fem_reference.exact", "validation.gates"} <= names


def test_a_request_is_seen() -> None:
    for tag in ('<script src="https://a/b.js">', "<link rel=x href='//fonts/x'>", "<img src=http://a/b>"):
        assert REQUEST.search(tag)
    assert not REQUEST.search('<a href="https://example.org">') and not REQUEST.search('<img src="figure-3.png">')


def said(line: str, directory: Path, status: int = 0) -> str:
    """Return what a line of a shell prints as a user types it; of the gates, all where one is to fail, else a few."""
    words = line.split()
    module = {"dda-validate": "validation", "pytest": "pytest"}[words[0]]
    more = [] if module == "validation" else FEW if status == 0 else FEW[:3]
    done = subprocess.run(
        [sys.executable, "-m", module, *words[1:], *more],
        capture_output=True,
        text=True,
        timeout=200,
        cwd=directory,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    assert done.returncode == status, f"{line}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.mark.long
def test_the_tutorial_prints_what_it_says(tmp_path: Path, finished_cases: Path) -> None:
    (tmp_path / "reports").mkdir()
    beside(finished_cases, tmp_path / "reports/results")
    printed, checked = "", 0
    for language, file, text in BLOCK.findall((DOCS / "tutorial.md").read_text(encoding="utf-8")):
        if file:
            (tmp_path / file).write_text(text)
        elif language == "sh":
            printed = "".join(said(line, tmp_path) for line in text.splitlines())
        elif "statics" in text:  # the mistake that the page asks for
            mistake = tmp_path / "my_solver.py"
            mistake.write_text(mistake.read_text().replace("b.density * w * h", "2 * b.density * w * h"))
            printed = said("pytest --pyargs validation -m validation --dda-solver my_solver:solve", tmp_path, 1)
            assert_all(text, printed)
            mistake.write_text(mistake.read_text().replace("2 * b.density", "b.density"))
            checked += 1
        elif language == "text" and printed:
            assert_all(text, printed)
            checked += 1
    assert checked == 4


def assert_all(lines: str, printed: str) -> None:
    plain = [" ".join(line.split()) for line in printed.splitlines()]
    for line in lines.splitlines():
        assert any(" ".join(line.split()) in shown for shown in plain), f"{line!r} is not in\n{printed}"


def test_the_tutorials_solver_is_that_of_the_page_on_ones_own_code() -> None:
    solvers = [
        text
        for page in ("tutorial.md", "judge-your-code.md")
        for language, file, text in BLOCK.findall((DOCS / page).read_text(encoding="utf-8"))
        if file == "my_solver.py"
    ]
    assert len(solvers) == 2 and solvers[0] == solvers[1]
