"""Blocks as HTML: a page each, with its figures and, unless it carries it, the style sheet beside it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from importlib import resources
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from validation.report.blocks import Block, as_data
from validation.report.names import unescaped
from validation.report.references import CITED, marked, references
from validation.runs.text import shown, visible

if TYPE_CHECKING:
    import jinja2
    from markupsafe import Markup

STYLE = "page.css"
SCRIPT = "filter.js"
REFERENCES = "references.html"  # to which citations lead
_CITATION = re.compile(rf"{CITED}([a-z]+\d{{4}})")
_DIRECTORIES = re.compile(r"(?<![\w.:/-])(?:[A-Za-z]:[\\/]|/)(?:[^\s/\\'\"]+[\\/])+")
Menu = Sequence[tuple[str, str]]  # address and name of each page


def readable(text: str) -> str:
    """Return a text for a page: no control characters, and of an absolute path only its last part."""
    return _DIRECTORIES.sub("", shown(text))


def page(
    title: str,
    blocks: Sequence[Block],
    *,
    file: str = "",
    name: str = "",
    menu: Menu = (),
    imprint: str = "",
    figure: Callable[[str], str] = str,
    scenes: Mapping[str, str] = {},
    template: str = "page.html.j2",
    package: str = "validation.report.render",
    **values: object,
) -> str:
    """Return a page.

    Parameters
    ----------
    file, name, menu
        Its own address, what the site is called and where its other pages are.
    imprint
        The last line.
    figure
        The address of a figure's file.
    scenes
        The pages of scenes, to which their figures lead.
    template, package
        That of all pages, or one that extends it with parts of its own, which `values` fill.
    """
    data = [as_data(block, lambda text: _cleaned(unescaped(text, marked))) for block in blocks]
    anchors = set()
    for block in data:
        if block["block"] == "Heading":
            place = anchor(block["text"])
            block["anchor"] = "" if place in anchors else place
            anchors.add(place)
    environment = _environment(package)
    return environment.get_template(template).render(
        title=unescaped(title), blocks=data, file=file, name=name, menu=menu, imprint=readable(imprint), figure=figure,
        scenes=scenes, style=STYLE, script=SCRIPT, sources=references(), **values,
    )  # fmt: skip


def anchor(heading: str) -> str:
    """Return the anchor of the first heading with a text."""
    return re.sub(r"\W+", "-", heading).strip("-").lower()


def _spans(columns: Sequence[dict[str, str]]) -> list[tuple[str, int]]:
    """Return the titles that neighbouring columns share, and how many do; nothing where none does."""
    if not any(column["group"] for column in columns):
        return []
    return [(title, len([*shared])) for title, shared in groupby(columns, key=itemgetter("group"))]


def _cleaned(text: str) -> str:
    """Return the lines of a text with marked citations."""
    lines = (CITED.join(readable(part) for part in line.split(CITED)) for line in text.split("\n"))
    return "\n".join(lines)


@cache
def _environment(package: str) -> jinja2.Environment:
    import jinja2

    packages = dict.fromkeys((package, __package__))
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([jinja2.PackageLoader(name, "") for name in packages]),
        autoescape=True,
        finalize=_finalized,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"cited": _cited, "spans": _spans}
    return environment


def _finalized(value: Any) -> Any:
    """Return a value as a page writes it: texts made visible, markup as it is."""
    from markupsafe import Markup

    if not isinstance(value, str) or isinstance(value, Markup):
        return value
    return visible(value.replace(CITED, "@"))


def _cited(text: str) -> Markup:
    """Return a text whose citations link to the page of references, as author and year."""
    from markupsafe import Markup, escape

    def link(match: re.Match[str]) -> str:
        source = references()[match[1]]
        author = escape(source["author"].partition(",")[0])
        return f'<a href="{REFERENCES}#{match[1]}">{author} {source["year"]}</a>'

    parts = (str(escape(visible(part))) for part in text.split(CITED))
    return Markup(_CITATION.sub(link, CITED.join(parts)))


def static(name: str) -> str:
    """Return a style sheet or script of the pages."""
    return resources.files(__package__).joinpath(name).read_text("utf-8")
