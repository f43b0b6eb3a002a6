"""The studies of rocking and toppling: closed forms against scipy, numbers of the text."""

import math
from pathlib import Path

import pytest

from validation.studies.toppling import formulas as toppling
from validation.suite.bands import cases
from validation.theory.rocking import Rectangle


def test_the_numbers_of_the_page_are_those_of_the_closed_forms():
    page = (Path(__file__).parents[2] / "docs/rotation.md").read_text(encoding="utf-8")
    text = " ".join(page.split())
    blocks = [Rectangle(2.0, height, 9.81) for height in (2.0, 4.0, 8.0)]
    rows = [line.split("|")[2:5] for line in page.splitlines() if line.startswith("|")]
    times, constant, ratios = ([float(word) for word in row] for row in rows[2:5])
    assert times == [round(block.quarter_period(1e-3), 5) for block in blocks]
    small = [math.sqrt(2e-3 * (b.width**2 + b.height**2) / 3 / (b.gravity * b.width / 2)) for b in blocks]
    assert constant == [round(value, 5) for value in small]
    assert ratios == [round(block.housner, 3) for block in blocks]
    (growing,), standing = cases("toppling-growth"), [case.load.slope for case in cases("toppling-threshold")]
    assert "by 0.51 % at dt = 20 ms" in text and growing.time.step == 0.02 and standing == [21.6, 22.0]
    assert toppling.growth(growing) == pytest.approx(0.0051, abs=1e-4)  # DDA's is gated beside it
    upright = growing.with_values({"block.tilt": 0.0})
    assert "released on its lower corner with a tilt of 1 deg" in text and growing.block.tilt == -1.0
    assert "(0.47 % from no tilt" in text and toppling.growth(upright) == pytest.approx(0.0047, abs=5e-5)
    assert f"tan(b) = a/h at {math.degrees(math.atan(10 / 25)):.2f} deg" in text
