"""The documentation site: it builds strictly, asks no network, a link that leads nowhere fails it."""

import importlib.util
import re
import subprocess
import sys
import tomllib

import pytest
from oracles.pages import ROOT

DOCS = ROOT / "docs"
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
REQUEST = re.compile(r"""<(?:script|link|img|iframe)[^>]*(?:src|href)=["']?(https?:)?//""")
MADE = ("changelog.md", "notebooks/choose-dt.md", "notebooks/judge-my-code.md")


def test_the_navigation_has_every_page_once():
    listed = re.findall(r"[ :](\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.M)
    assert sorted(listed) == sorted({path.name for path in DOCS.glob("*.md")} | set(MADE[1:]))


@pytest.fixture(scope="module")
def builder():
    """Return the module that builds the site."""
    pytest.importorskip("zensical", reason="the site is NOT RUN: needs the extra docs")
    spec = importlib.util.spec_from_file_location("site_pages", ROOT / ".ci/site_pages.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def site(builder, tmp_path_factory):
    """Return the built site."""
    out = tmp_path_factory.mktemp("site") / "site"
    done = subprocess.run([sys.executable, builder.__file__, "--out", out], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out


@pytest.mark.long
@pytest.mark.parametrize("link", ["no-page.md", "theory.md#no-place"])
def test_a_link_that_leads_nowhere_fails_the_build(builder, tmp_path, link):
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "theory.md").write_text("# Theory\n", encoding="utf-8")
    (docs / "index.md").write_text(f"# Start\n\n[There]({link})\n", encoding="utf-8")
    with pytest.raises(SystemExit):
        builder.build(tmp_path, {"site_name": "small"})
    (docs / "index.md").write_text("# Start\n\n[There](theory.md#theory)\n", encoding="utf-8")
    assert (builder.build(tmp_path, {"site_name": "small"}) / "index.html").is_file()


@pytest.mark.parametrize(("address", "run"), [("https://github.com/a/b/", True), ("https://b.invalid", False)])
def test_a_notebook_leads_to_a_running_one_once_there_is_a_public_address(builder, address, run):
    page = builder.notebook_page({"cells": [{"cell_type": "markdown", "source": ["# Top"]}]}, "n.ipynb", address)
    assert (f"/v2/gh/a/b/v{VERSION}?labpath=docs/notebooks/n.ipynb" in page) is run
    assert "[n.ipynb](n.ipynb)" in page and "dda-validation[notebooks]" in page


@pytest.mark.long
def test_the_site_has_every_page_and_asks_no_network(site):
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
def test_the_site_says_its_version_on_every_page(site):
    for name in ("theory", "notebooks/choose-dt", "reference/dda"):
        assert f" {VERSION}" in (site / f"{name}.html").read_text(encoding="utf-8")
