"""Hook of MkDocs: pages that are made (reference, notebooks, versions), equations as MathML, which version was built.

Equations stand in the pages as TeX between dollars and are set as MathML when the site is built, so that no script and
no font is asked for. Pages that the navigation does not name come last, under More.
"""

import html
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

from validation.scenes.plain import words

ROOT = Path(__file__).parents[1]
PACKAGES = ("dda", "fem_reference", "validation")
LISTS = ("metrics", "keys", "solvers", "schemes", "scenes", "studies")  # of `dda-validate list`
NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))
REFERENCE_BOOST = 0.2  # of the weight of a guide in the search
EQUATION = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.S)


def rooms(package: str) -> Iterator[str]:
    """Yield the dotted names of the rooms of a package."""
    yield from (f"{package}.{path.parent.name}" for path in sorted((ROOT / package).glob("*/__init__.py")))


def built_from() -> str:
    """Return the version that the pages describe and, in a checkout, its commit."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    command = ["git", "describe", "--always", "--dirty=+", "--abbrev=12"]
    try:
        commit = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):  # the source archive is no checkout
        return f"version {version}"
    return f"version {version}, commit {commit}"


def on_config(config: Any) -> None:
    """Append versions and the reference to the navigation; say in the footer what was built."""
    config.copyright = f'dda-validation {built_from()}; <a href="{{changelog}}">versions</a>'
    config.nav.append({"Versions": "changelog.md"})
    pages: list[Any] = ["reference/index.md"]
    for package in PACKAGES:
        pages.append({package: [f"reference/{name}.md" for name in (package, *rooms(package))]})
    pages.append({"lists": [f"reference/{word}.md" for word in (*LISTS, "lines")]})
    config.nav.append({"Reference": pages})


def on_files(files: Files, config: Any) -> None:
    """Add the pages: what packages export and hold, lists of the command, notebooks, the changelog."""
    for package in PACKAGES:
        for name in (package, *rooms(package)):
            whole = "true" if name != package else "false"
            text = f"# `{name}`\n\n::: {name}\n    options:\n      show_submodules: {whole}\n"
            files.append(File.generated(config, f"reference/{name}.md", content=text))
    for word in LISTS:
        command = [sys.executable, "-m", "validation", "list", word]
        printed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        text = f"# {word.capitalize()}\n\nAs `dda-validate list {word}` prints them.\n\n```text\n{printed}```\n"
        files.append(File.generated(config, f"reference/{word}.md", content=text))
    described = "".join(f"- `{name}`: {meaning}\n" for name, meaning in words())
    text = f"# Lines of a scene\n\nWhat a program reads, beside `time.*` and `columns`.\n\n{described}"
    files.append(File.generated(config, "reference/lines.md", content=text))
    for path in NOTEBOOKS:
        text = notebook_page(json.loads(path.read_text(encoding="utf-8")), path.name)
        files.append(File.generated(config, f"notebooks/{path.stem}.md", content=text))
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").replace("](docs/", "](")
    note = (
        f"These pages are those of {built_from()}. Those of another version are built from its tag, beside these: "
        "`git worktree add ../vX.Y.Z vX.Y.Z && make -C ../vX.Y.Z docs`.\n\n## "
    )
    changelog = changelog.replace("## ", note, 1)
    files.append(File.generated(config, "changelog.md", content=changelog))


def notebook_page(notebook: dict[str, Any], name: str) -> str:
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
    parts.insert(1, f"The notebook: [{name}]({name}).")
    return "\n\n".join(parts) + "\n"


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> None:
    """Let the search find a guide before the reference of the same word."""
    if page.file.src_uri.startswith("reference/"):
        page.meta["search"] = {"boost": REFERENCE_BOOST}


def studies_of_page(markdown: str) -> list[str]:
    """Return the studies with results that a page calls so; `make docs` writes their pages."""
    if not (ROOT / "reports/results/verdicts.json").is_file():
        return []
    called = re.findall(r"\bstud(?:y|ies)\s+((?:`[\w-]+`(?:,\s+|\s+and\s+)?)+)", markdown)
    studies = dict.fromkeys(name for names in called for name in re.findall(r"[\w-]+", names.replace(" and ", " ")))
    return [study for study in studies if (ROOT / "reports/results/studies" / f"{study}.json").is_file()]


def on_page_content(content: str, page: Any, config: Any, files: Files) -> str:
    """Set the equations of a page."""

    def mathml(match: re.Match[str]) -> str:
        display = "block" if match[1] == "div" else "inline"
        return convert(html.unescape(match[2]).strip(), display=display)

    links = [f'<a href="gallery/study-{study}.html">{study}</a>' for study in studies_of_page(page.markdown)]
    results = f"<p>Results in the gallery: {', '.join(links)}.</p>" if links else ""
    return EQUATION.sub(mathml, content) + results


def on_post_page(output: str, page: Any, config: Any) -> str:
    """Lead from the footer of each page to the page of versions."""
    depth = page.file.dest_uri.count("/")
    return output.replace("{changelog}", "../" * depth + "changelog.html")
