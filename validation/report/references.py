"""The paper, the sources of the methods, and who wrote what.

A text cites a source by its key in `references.bib`, as in ``Newmark's scheme @newmark1959``. The report sets keys as
numbers of its last page, the site as links to its page of references.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Any

BIBLIOGRAPHY = Path(__file__).with_name("references.bib")
ENTRY = re.compile(r"^@(\w+)\{(\w+),\n(.*?)^\}", re.M | re.S)
CITED = "\ue000"  # stands for the @ of a key that cites a source, once it is told from that of a user's own words
FIELD = re.compile(r"^\s*(\w+)\s*= \{(.*)\},$", re.M)
PAPER = (
    "X. Feng, Q. Jiang, A. Wu, W. Wei and X. Zhang, Study on the Damping of the Discontinuous Deformation Analysis "
    "Based on Two-Block Model, Mathematical Problems in Engineering 2017, article 7480937, 9 pages, published 18 July "
    "2017 @feng2017"
)


def references() -> dict[str, dict[str, str]]:
    """Return the fields of the sources by key, in the order of the file."""
    entries = {}
    for kind, key, body in ENTRY.findall(BIBLIOGRAPHY.read_text("utf-8")):
        fields = {name: value.replace("{", "").replace("}", "") for name, value in FIELD.findall(body)}
        entries[key] = {"kind": kind, **fields}
    return entries


@cache
def _key() -> re.Pattern[str]:
    return re.compile(rf"(?<!\\)@(?=(?:{'|'.join(references())})\b)")


def marked(text: str) -> str:
    """Return a text in which keys that cite a source are told from a user's own words."""
    return _key().sub(CITED, text)


def named(text: str, form: Callable[[str, str], str] = lambda name, key: name) -> str:
    """Return a text in which authors and year, in a form of them and the key, stand for keys."""
    entries = references()

    def name(match: re.Match[str]) -> str:
        authors = [author.split(",")[0] for author in entries[match[1]]["author"].split(" and ")]
        who = " and ".join(authors) if len(authors) <= 2 else f"{authors[0]} and others"
        return form(f"{who} {entries[match[1]]['year']}", match[1])

    return re.sub(rf"{_key().pattern}(\w+)", name, text)


def identity(provenances: Iterable[Mapping[str, Any]]) -> str:
    """Return who made the suite, and version, date and commit of the results as far as known."""
    values: dict[str, dict[str, None]] = {"version": {}, "run on": {}, "commit": {}}
    for provenance in provenances:
        packages = provenance.get("packages")
        version = packages.get("dda-validation") if isinstance(packages, Mapping) else None
        for name, value in zip(values, (version, provenance.get("date"), provenance.get("commit")), strict=True):
            values[name] |= {str(value): None} if value else {}
    try:
        authors = str(metadata("dda-validation")["Author"])
    except PackageNotFoundError:
        authors = "authors unknown"
    parts = [f"{name} {', '.join(texts)}" for name, texts in values.items() if texts]
    return ", ".join([f"dda-validation ({authors})", *parts])
