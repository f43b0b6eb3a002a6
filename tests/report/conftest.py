"""What tests of the report share."""

import pytest
from matplotlib.figure import Figure

from validation.report.figures import histories


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> dict[str, Figure]:
    """Catch the figures that a chapter writes, by the names of their files."""
    caught: dict[str, Figure] = {}
    monkeypatch.setattr(histories, "save", lambda figure, path: caught.setdefault(path.name, figure))
    return caught
