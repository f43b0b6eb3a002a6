"""Pages of the PDF: what belongs together stands together, whatever is above it."""

import pytest
from matplotlib.figure import Figure
from pypdf import PdfReader

from validation.report.blocks import Callout, FigureBlock, Heading, PageBreak, Paragraph, table
from validation.report.figures.histories import save
from validation.report.render.pdf import typeset

pytestmark = pytest.mark.long
LINES = 46  # of text that fill a page
CASES = range(2, LINES, 6)  # lines above a chapter, so that it begins at each height of a page


def chapter(name):
    """Return a chapter whose parts have names of their own."""
    rows = [(f"row {name}.{row}", "1") for row in range(8)]
    return [
        Heading(f"Chapter {name}"),
        Paragraph(f"Lead {name}.", "lead"),
        Paragraph(f"Sources {name}.", "small"),
        Callout(f"Rule {name}.", "rule"),
        FigureBlock("figure.svg", f"Figure {name}."),
        table(["Case", "Number"], rows, f"Table {name}."),
    ]


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    root = tmp_path_factory.mktemp("pdf")
    save(Figure(figsize=(4.0, 2.0)), root / "figure.svg")
    blocks = []
    for lines in CASES:
        blocks += [PageBreak(), *(Paragraph(f"Above {lines}.") for _ in range(lines)), *chapter(lines)]
    (root / "made.pdf").write_bytes(typeset(root, blocks))
    return [page.extract_text() for page in PdfReader(root / "made.pdf").pages]


def test_title_lead_rule_figure_and_table_of_a_chapter_are_on_one_page(pages):
    for name in CASES:
        (own,) = [text for text in pages if f"\nLead {name}." in text]
        parts = (f"Chapter {name}", f"Sources {name}.", f"Rule {name}.", f"Figure {name}.", f"Table {name}.")
        missing = [part for part in (*parts, f"row {name}.0", f"row {name}.7") if part not in own]
        assert not missing, (name, missing)
