"""The bibliography: sources that are cited are known, and a report that lists them sets their numbers."""

import re

import pytest
from pypdf import PdfReader

from validation.report.blocks import Paragraph, References
from validation.report.names import quoted
from validation.report.references import PAPER, named, references
from validation.report.render.html import page
from validation.report.render.pdf import typeset
from validation.suite.folders import sources_of, study_folders, study_names

CITATION = re.compile(r"@([a-z]+\d{4})\b")


def test_what_is_cited_is_a_source():
    texts = [PAPER, *map(sources_of, study_names())]
    texts += [(folder.path / "front.toml").read_text("utf-8") for folder in [study_folders()["core"]]]
    cited = set(CITATION.findall(" ".join(texts)))
    assert {"feng2017", "shi1985", "newmark1959", "doolin2004", "hatzor2004", "armero1998", "kane1999"} <= cited
    assert {"housner1963", "miller1978"} <= cited <= set(references())


@pytest.mark.parametrize("lists", [True, False])
def test_a_key_is_a_number_where_the_sources_are_listed(lists, tmp_path):
    """A key that is none stays as it stands, as every key does in a document without a list."""
    sentence = "As @housner1963 has it, and me@nowhere2020."
    blocks = [Paragraph(sentence), *[References()] * lists]
    (tmp_path / "r.pdf").write_bytes(typeset(tmp_path, blocks))
    (page,) = PdfReader(tmp_path / "r.pdf").pages
    text = " ".join(page.extract_text().split())
    assert (sentence.replace("@housner1963", "[1]") in text) == lists == ("pendulum" in text)
    assert (sentence in text) != lists


def test_the_site_links_keys_and_nothing_else():
    text = page("t", [Paragraph("<b> @kane1999 @me2020 " + quoted("@kane1999"))])
    assert '&lt;b&gt; <a href="references.html#kane1999">Kane 1999</a> @me2020 @kane1999</p>' in text
    assert (
        named("@feng2017, @shi1985, @doyen2011") == "Feng and others 2017, Shi and Goodman 1985, Doyen and others 2011"
    )
