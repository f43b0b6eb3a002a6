"""What tests of the report share."""

import os
from collections.abc import Callable
from pathlib import Path
from pprint import pformat

import pytest
from matplotlib.figure import Figure

from validation.report.blocks import Blocks
from validation.report.figures import histories


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> dict[str, Figure]:
    """Catch the figures that a chapter writes, by the names of their files."""
    caught: dict[str, Figure] = {}
    monkeypatch.setattr(histories, "save", lambda figure, path: caught.setdefault(path.name, figure))
    return caught


@pytest.fixture
def kept() -> Callable[[str, Blocks], None]:
    """Hold blocks of made rows to a page in `pages`, word by word; with ``KEEP_PAGES=1`` it is written anew."""

    def check(name: str, blocks: Blocks) -> None:
        page = Path(__file__).with_name("pages") / f"{name}.txt"
        text = "\n".join(pformat(block, width=120) for block in blocks) + "\n"
        if os.environ.get("KEEP_PAGES"):
            page.write_text(text, encoding="utf-8")
        assert text == page.read_text(encoding="utf-8")

    return check
