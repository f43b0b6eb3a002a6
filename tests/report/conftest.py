"""What tests of the report share."""

import os
import re
import textwrap
from dataclasses import fields
from itertools import groupby
from pathlib import Path

import pytest
from oracles import made_results as made
from oracles.made_results import figure_text, looks
from oracles.pages import NUMBER
from oracles.stand_ins import summed

from validation.report.blocks import TableColumn
from validation.report.figures import histories


@pytest.fixture(scope="session")
def core_results(tmp_path_factory):
    return made.core_results(tmp_path_factory.mktemp("core"))


@pytest.fixture(scope="session")
def made_results(tmp_path_factory):
    return made.made_results(tmp_path_factory.mktemp("made"))


@pytest.fixture
def drawn(monkeypatch):
    """Catch the figures that a chapter writes, by the names of their files."""
    caught = {}
    monkeypatch.setattr(histories, "save", lambda figure, path: caught.setdefault(path.name, figure))
    return caught


@pytest.fixture
def kept():
    """Hold blocks of made rows to a page in `pages`, word by word; with ``KEEP_PAGES=1`` it is written anew."""

    def check(name, blocks):
        _held(name, "\n".join(line for block in blocks for line in lines_of(block)) + "\n")

    return check


@pytest.fixture
def kept_text():
    """Hold lines to a page in `pages`."""
    return lambda name, lines: _held(name, "".join(f"{line.strip()}\n" for line in lines if line.strip()))


def is_told(word):
    """Whether a word is a number, a key, a sign or has one."""
    return re.search(r"[\d|@_=]", word) is not None


def shortened(text):
    """Return a text in which words between numbers have become the first, how many more there are, and the last."""
    shown = []
    for told, run in groupby(text.replace("\xa0", "~").split(" "), is_told):
        words = list(run)
        shown += words if told or len(words) < 5 else [words[0], f"…{len(words) - 2}", words[-1]]
    return " ".join(shown)


def wrapped(text):
    return textwrap.wrap(text, 118, subsequent_indent="  ", break_on_hyphens=False) or [""]


def lines_of(block):
    """Return the kind of a block but a paragraph, and what is no default, a line a row; `~` is a space that holds."""
    if isinstance(block, str):
        return wrapped(shortened(block))
    if isinstance(block, TableColumn):
        kind = "" if block.kind == "text" else f"{block.kind[0]}:"
        return f"{kind}{block.group} / {block.title}".replace(" / ", "", not block.group)
    if isinstance(block, tuple):
        return lines_of(" | ".join(block)) if isinstance(block[0], str) else wrapped(" | ".join(map(lines_of, block)))
    kind = type(block).__name__.replace("Paragraph", "")
    lines = []
    for field in fields(block):
        value = getattr(block, field.name)
        value = (value,) if field.name == "columns" else value
        if field.name in ("tone", "level") and value != field.default:
            kind += f" {value}:"
        elif value not in (field.default, ""):
            inner = [line for one in value for line in lines_of(one)] if isinstance(value, tuple) else []
            name = "" if field.name in ("text", "columns", "rows", "items", "file") else f"{field.name}: "
            lines += lines_of(f"{name}{value}") if not inner else [*[name.rstrip()] * bool(name), *inner]
    first, *others = lines or [""]
    return [f"{kind} {first}".strip(), *(f"  {line}" for line in others)]


@pytest.fixture
def kept_figures():
    """Hold figures to a page in `pages`: what their words and numbers sum to; a test that fails prints them."""

    def check(name, drawn):
        lines = []
        for file, figure in sorted(drawn.items()):
            text = figure_text(figure)
            print(text)
            words = [float(word) if NUMBER.fullmatch(word) else word for word in text.split()]
            lines.append(f"{file}: {len(text.splitlines())} lines, {summed(words) + summed(looks(figure)):.4f}\n")
        _held(name, "".join(lines))

    return check


def _held(name, text):
    page = Path(__file__).with_name("pages") / f"{name}.txt"
    if os.environ.get("KEEP_PAGES"):
        page.write_text(text, encoding="utf-8")
    assert text == page.read_text(encoding="utf-8")
