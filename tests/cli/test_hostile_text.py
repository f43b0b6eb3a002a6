"""Text from outside acts on no terminal, no Markdown page and no HTML page."""

import json
import re

import pytest
from conftest import SCENE, typed

from validation.report.figures import histories

CLEAR, OVERRIDE, SCRIPT = "\x1b[2J", "\u202e", "<script>alert(1)</script>"
EVIL = f"r {CLEAR} {SCRIPT} {OVERRIDE} a | `b`"


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Return all that is printed and written of a scene whose title and reason are hostile."""
    place = tmp_path_factory.mktemp("evil")
    judged = '[[gate]]\npair = ["dda", "bar"]\nmetric = "displacement.l2"\nband = [0.0, 1e-9]\n'
    gate = judged + f"reason = {json.dumps(EVIL)}\n"
    text = SCENE.replace('"A small scene"', json.dumps(EVIL)) + '[run]\nsolvers = ["dda", "bar", "bar-events"]\n' + gate
    (place / "evil.toml").write_text(text)
    summary = place / "summary.md"
    ran = typed("run", "evil.toml", "--verbose", "--results", "r", "--summary", summary, cwd=place)
    assert ran.returncode == 1 and re.search(r"\n\nevil bar-events: ", ran.stdout)
    shown = typed("show", "evil.toml", cwd=place)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(histories, "save", lambda figure, path: path)
        assert typed("report", "--results", "r", "--site", "g", cwd=place).returncode == 0
    html = "\n".join(path.read_text() for path in (place / "g").glob("*.html"))
    return {"terminal": ran.stdout + ran.stderr + shown.stdout, "summary": summary.read_text(), "site": html}


@pytest.mark.parametrize("page", ["terminal", "summary", "site"])
def test_control_characters_and_overrides_of_direction_are_escapes(pages, page):
    assert "\x1b" not in pages[page] and OVERRIDE not in pages[page]
    assert "alert(1)" in pages[page]
