#!/usr/bin/env python3
"""The documentation site: pages that are made (reference, notebooks, versions) beside those of docs, set by Zensical.

    .ci/site_pages.py              into site/
    .ci/site_pages.py --out DIR    elsewhere

Equations stand in the pages as TeX between dollars and are set as MathML when the site is built, by an extension of
Markdown that is this module, so that no script and no font is asked for. A link that leads nowhere fails the build.
"""

from __future__ import annotations

import argparse
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import yaml
from latex2mathml.converter import convert
from markdown import Markdown
from markdown.extensions import Extension
from markdown.postprocessors import Postprocessor

from validation.scenes.plain import words

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("dda", "fem_reference", "validation")
LISTS = ("metrics", "keys", "solvers", "schemes", "scenes", "studies")  # of `dda-validate list`
NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
# Text of repositories, not of the site: the paper has a form of its own, folders of examples a README where they stand.
NO_PAGES = ("paper", "README.md")
EQUATION = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.S)


class MathmlPostprocessor(Postprocessor):
    """Equations that `pymdownx.arithmatex` has marked, as MathML."""

    def run(self, text: str) -> str:
        """Return the HTML of a page with its equations set."""

        def mathml(match: re.Match[str]) -> str:
            display = "block" if match[1] == "div" else "inline"
            return convert(html.unescape(match[2]).strip(), display=display)

        return EQUATION.sub(mathml, text)


class Mathml(Extension):
    """The extension of Markdown that mkdocs.yml names."""

    def extendMarkdown(self, md: Markdown) -> None:
        """Set equations last, when nothing else looks at the text any more."""
        md.postprocessors.register(MathmlPostprocessor(md), "mathml", priority=-1)


def makeExtension(**settings: Any) -> Extension:
    """Return the extension."""
    return Mathml(**settings)


def rooms(package: str) -> Iterator[str]:
    """Yield the dotted names of the rooms of a package."""
    yield from (f"{package}.{path.parent.name}" for path in sorted((ROOT / package).glob("*/__init__.py")))


def built_from() -> str:
    """Return the version that the pages describe and, in a checkout, its commit."""
    version = PROJECT["version"]
    command = ["git", "describe", "--always", "--dirty=+", "--abbrev=12"]
    try:
        commit = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):  # the source archive is no checkout
        return f"version {version}"
    return f"version {version}, commit {commit}"


def settings() -> dict[str, Any]:
    """Return mkdocs.yml with the made pages in its navigation, and what was built in the footer."""
    config: dict[str, Any] = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    reference: list[Any] = ["reference/index.md"]
    for package in PACKAGES:
        reference.append({package: [f"reference/{name}.md" for name in (package, *rooms(package))]})
    reference.append({"lists": [f"reference/{word}.md" for word in (*LISTS, "lines")]})
    config["nav"] += [{"Versions": "changelog.md"}, {"Reference": reference}]
    config["copyright"] = f"dda-validation {built_from()}"
    config["plugins"][-1]["mkdocstrings"]["handlers"]["python"]["paths"] = [str(ROOT)]
    return config


def write_pages(docs: Path) -> None:
    """Write all pages: those of docs, of the packages' names and rooms, lists of the command, notebooks, versions."""
    shutil.copytree(ROOT / "docs", docs, ignore=shutil.ignore_patterns(*NO_PAGES), dirs_exist_ok=True)
    for page in docs.glob("*.md"):
        text = page.read_text(encoding="utf-8")
        page.write_text(text + links_to_results(text), encoding="utf-8")
    for package in PACKAGES:
        for name in (package, *rooms(package)):
            whole = "true" if name != package else "false"
            text = f"# `{name}`\n\n::: {name}\n    options:\n      show_submodules: {whole}\n"
            (docs / f"reference/{name}.md").write_text(text, encoding="utf-8")
    for word in LISTS:
        command = [sys.executable, "-m", "validation", "list", word]
        printed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        text = f"# {word.capitalize()}\n\nAs `dda-validate list {word}` prints them.\n\n```text\n{printed}```\n"
        (docs / f"reference/{word}.md").write_text(text, encoding="utf-8")
    described = "".join(f"- `{name}`: {meaning}\n" for name, meaning in words())
    text = f"# Lines of a scene\n\nWhat a program reads, beside `time.*` and `columns`.\n\n{described}"
    (docs / "reference/lines.md").write_text(text, encoding="utf-8")
    for path in NOTEBOOKS:
        text = notebook_page(json.loads(path.read_text(encoding="utf-8")), path.name, PROJECT["urls"]["Repository"])
        (docs / f"notebooks/{path.stem}.md").write_text(text, encoding="utf-8")
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").replace("](docs/", "](")
    note = (
        f"These pages are those of {built_from()}. Those of another version are built from its tag, beside these: "
        "`git worktree add ../vX.Y.Z vX.Y.Z && make -C ../vX.Y.Z docs`.\n\n## "
    )
    (docs / "changelog.md").write_text(changelog.replace("## ", note, 1), encoding="utf-8")


def run_badge(name: str, repository: str) -> str:
    """Return what leads to a running notebook: Binder on this version, once the project has a public address."""
    address = urlsplit(repository)
    if address.hostname != "github.com":
        return ""
    place = f"https://mybinder.org/v2/gh{address.path.rstrip('/')}/v{PROJECT['version']}"
    return f"[Run it in the browser]({place}?labpath=docs/notebooks/{name}){{ .md-button }} "


def notebook_page(notebook: dict[str, Any], name: str, repository: str) -> str:
    """Return a notebook as Markdown: its text, its code, and what the committed run of the code put out."""
    parts: list[str] = []
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        parts.append(f"```python\n{source}\n```")
        for output in cell["outputs"]:
            if output["output_type"] == "stream":
                parts.append(f"```text\n{''.join(output['text']).rstrip()}\n```")
            elif "image/png" in output["data"]:
                image = output["data"]["image/png"].replace("\n", "")
                parts.append(f'<img alt="plot of the cell above" src="data:image/png;base64,{image}">')
    by_hand = f"[{name}]({name}), `pip install 'dda-validation[notebooks]'`, `jupyter lab {name}`."
    parts.insert(1, f"{run_badge(name, repository)}By hand: {by_hand}")
    return "\n\n".join(parts) + "\n"


def links_to_results(text: str) -> str:
    """Return links to the studies with results that a page calls so; `make docs` writes their pages."""
    if not (ROOT / "reports/results/verdicts.json").is_file():
        return ""
    called = re.findall(r"\bstud(?:y|ies)\s+((?:`[\w-]+`(?:,\s+|\s+and\s+)?)+)", text)
    studies = dict.fromkeys(name for names in called for name in re.findall(r"[\w-]+", names.replace(" and ", " ")))
    present = [study for study in studies if (ROOT / "reports/results/studies" / f"{study}.json").is_file()]
    links = [f'<a href="gallery/study-{study}.html">{study}</a>' for study in present]
    return f"\n<p>Results in the gallery: {', '.join(links)}.</p>\n" if links else ""


def build(place: Path, config: dict[str, Any]) -> Path:
    """Return the site of the pages in a directory.

    Raises
    ------
    SystemExit
        A link leads to no page or no heading, or the setting of a page failed; what Zensical says has been printed.
    """
    file = place / "mkdocs.yml"
    file.write_text(yaml.safe_dump(config, sort_keys=False, allow_unicode=True), encoding="utf-8")
    command = [sys.executable, "-m", "zensical", "build", "--strict", "--config-file", file]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parent)}
    done = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True)
    if done.returncode:
        sys.stderr.write(done.stdout + done.stderr)
        raise SystemExit(1)
    return place / "site"


def main() -> None:
    """Build the site; status 1 where a link leads nowhere."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "site", help="where the site is written")
    out = parser.parse_args().out.resolve()
    with tempfile.TemporaryDirectory() as temporary:
        write_pages(Path(temporary) / "docs")
        built = build(Path(temporary), settings())
        shutil.rmtree(out, ignore_errors=True)
        shutil.move(built, out)


if __name__ == "__main__":
    main()
