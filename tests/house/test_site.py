"""The documentation site: it builds strictly, asks no network, and its search finds a guide before the reference."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from oracles.pages import ROOT

DOCS = ROOT / "docs"
REQUEST = re.compile(r"""<(?:script|link|img|iframe)[^>]*(?:src|href)=["']?(https?:)?//""")
MADE = ("changelog.md", "notebooks/choose-dt.md", "notebooks/judge-my-code.md")  # by the hook


def test_every_entry_of_the_navigation_is_a_page() -> None:
    listed = re.findall(r"[ :](\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.M)
    assert len(listed) == len(set(listed)) > 15
    assert not [name for name in listed if not (DOCS / name).is_file() and name not in MADE]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the built site."""
    pytest.importorskip("mkdocs", reason="the site is NOT RUN: needs the extra docs")
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", out]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return out


@pytest.mark.long
def test_the_site_has_every_page_and_asks_no_network(site: Path) -> None:
    pages = {path.relative_to(site).with_suffix("").as_posix(): path for path in site.rglob("*.html")}
    assert {path.stem for path in DOCS.glob("*.md")} <= set(pages)
    made = {"changelog", "notebooks/choose-dt", "notebooks/judge-my-code"}
    assert made | {"reference/metrics", "reference/dda.scheme", "reference/validation.gates"} <= set(pages)
    for name, path in pages.items():
        text = path.read_text(encoding="utf-8")
        assert not REQUEST.search(text), name
        assert 'class="arithmatex"' not in text, f"{name}: an equation is not set"
    assert "<math" in pages["theory"].read_text(encoding="utf-8")


@pytest.mark.long
def test_the_site_says_its_version_and_finds_guides_first(site: Path) -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    for name, link in (("theory", "changelog.html"), ("notebooks/choose-dt", "../changelog.html")):
        text = (site / f"{name}.html").read_text(encoding="utf-8")
        assert f"dda-validation version {version}" in text and f'<a href="{link}">versions</a>' in text
    documents = json.loads((site / "search/search_index.json").read_text(encoding="utf-8"))["docs"]
    boosts = {document["location"].startswith("reference/"): document.get("boost", 1) for document in documents}
    assert boosts[True] < boosts[False]


def test_a_request_is_seen() -> None:
    for tag in ('<script src="https://a/b.js">', "<link rel=x href='//fonts/x'>", "<img src=http://a/b>"):
        assert REQUEST.search(tag)
    assert not REQUEST.search('<a href="https://example.org">') and not REQUEST.search('<img src="figure-3.png">')
