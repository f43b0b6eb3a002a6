"""The paper, the sources of the methods, and who wrote what.

A text cites a source by its key in `references.bib`, as in ``Newmark's scheme @newmark1959``. The report sets keys as
numbers of its last page, the gallery as links to its page of references.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Any

BIBLIOGRAPHY = Path(__file__).with_name("references.bib")
ENTRY = re.compile(r"^@(\w+)\{(\w+),\n(.*?)^\}", re.M | re.S)
FIELD = re.compile(r"^\s*(\w+)\s*= \{(.*)\},$", re.M)
PAPER = (
    "X. Feng, Q. Jiang, A. Wu, W. Wei and X. Zhang, Study on the Damping of the Discontinuous Deformation Analysis "
    "Based on Two-Block Model, Mathematical Problems in Engineering 2017, article 7480937, 9 pages, published 18 July "
    "2017 @feng2017"
)
SOURCES = {  # study -> what the methods of its chapter rest on
    "core": "DDA @shi1985, @shi1988; Newmark's scheme @newmark1959, in DDA @doolin2004, @lin2015; elements by "
    "scikit-fem @gustafsson2020; damping measured by the matrix pencil @hua1990.",
    "two-codes": "scikit-fem @gustafsson2020.",
    "paper": "the paper @feng2017; kinetic damping @jiang2013, @hatzor2004.",
    "stiff-contact": "Newmark's scheme @newmark1959, its algorithmic damping in DDA @doolin2004.",
    "opening": "exact switches in ball arithmetic @johansson2017; the bar by convolution quadrature @lubich1988; the "
    "states of a step as a complementarity problem @murty1974, which open-close iteration may cycle on "
    "@bengharbia2012.",
    "rebound": "implicit contact forces @kane1999; energy-conserving ones @armero1998.",
    "methods": "generalised-alpha schemes @hilber1977, @wood1980, @chung1993; composite ones @bathe2005, @noh2019; "
    "impact laws @jean1999; implicit contact forces @kane1999; energy-conserving ones @armero1998; what is said of "
    "cures for DDA @peng2014, @yu2019, @bao2014, @li2015, @peng2020, @liu2023.",
    "impacts": "benchmarks of the dynamic Signorini problem @doyen2011; waves in bars @graff1975.",
    "slopes": "sliding blocks @newmark1965, in DDA @hatzor2001, @tsesarsky2005, @maclaughlin2006; penalty "
    "and step @doolin2001, @doolin2002; kinetic damping @hatzor2004.",
    "creep": "kinetic damping @hatzor2004, @tsesarsky2005, @jiang2013.",
    "rocking": "rigid blocks that rock @housner1963.",
    "toppling": "rigid blocks that rock @housner1963.",
    "waves": "transmitting bases @lysmer1969, @bao2012; joints of finite stiffness @schoenberg1980.",
    "columns": "complementarity @murty1974; spalls @graff1975; joints that slip @miller1977, @miller1978.",
}


def references(text: str | None = None) -> dict[str, dict[str, str]]:
    """Return the fields of the sources by their keys, in the order of the file, of a BibTeX text or of ours."""
    entries = {}
    for kind, key, body in ENTRY.findall(BIBLIOGRAPHY.read_text("utf-8") if text is None else text):
        fields = {name: value.replace("{", "").replace("}", "") for name, value in FIELD.findall(body)}
        entries[key] = {"kind": kind, **fields}
    return entries


def identity(provenances: Iterable[Mapping[str, Any]]) -> str:
    """Return who made the suite and which version, date and commit the results are of, as far as the runs know."""
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
