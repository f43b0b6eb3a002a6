"""Histories, drawings and names as a page has them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from gallery.samples import unpacked

from validation.gallery.cases import GalleryScene
from validation.gallery.histories import LEAST, MOST, STEPS, Sampling, lines_of, packed, samples_for
from validation.gallery.scene_data import FEWEST, MOST_LINES, all_lines, drawn, most_lines
from validation.gallery.svg import Sheet, slim
from validation.report.chapters.data import CaseResults
from validation.runs.history import History
from validation.runs.run import Outcome

FIGURE = """<?xml version="1.0"?><!DOCTYPE svg><svg xmlns:xlink="x" width="10pt" viewBox="0 0 10 10" xmlns="y">
 <metadata>when</metadata><defs><style type="text/css">*{}</style></defs>
 <g id="figure_1"><g id="text_1"><!-- 5 --><g transform="translate(1.234567 2) scale(0.065 -0.065)"><defs>
 <path id="DejaVuSans-18" d="M 691 4666
L 3169 4666
L 3169.123456 4134
z
" transform="scale(0.015625)"/></defs><use xlink:href="#DejaVuSans-18" transform="translate(63.623047 0.125)"/>
 <use xlink:href="#DejaVuSans-18" transform="translate(1 38.965625) scale(0.7)"/></g></g>
 <path d="M 1 2 L 3 4" clip-path="url(#p1)" style="fill: none; stroke: #d55e00"/></g>
 <defs><clipPath id="p1"><rect x="1"/></clipPath></defs></svg>"""


def test_values_are_kept_to_two_bytes() -> None:
    values = np.array([-1e300, 1e300, np.nan, 0.0])
    assert np.isnan(unpacked(*packed(values))[2])
    assert unpacked(*packed(values))[:2].tolist() == [-1e300, 1e300]
    line = np.sin(np.linspace(0, 30, 1001))
    assert np.abs(unpacked(*packed(line)) - line).max() <= 0.501 * np.ptp(line) / STEPS
    assert unpacked(*packed(np.full(3, 7.5))).tolist() == [7.5] * 3
    assert np.isnan(unpacked(*packed(np.full(3, np.nan)))).all()


@pytest.mark.parametrize("count", [200, 1001, 100_000])
def test_no_peak_of_a_long_history_is_lost(count: int) -> None:
    values = np.random.default_rng(1).normal(size=count)
    values[[count // 3, count // 2]] = 40.0, -50.0
    sampling = Sampling(count, 200)
    shown = sampling.sampled(values)
    assert shown.min() == -50.0 and shown.max() == 40.0
    assert len(shown) == len(sampling.times(np.arange(float(count)))) == 200
    for i, (a, b) in enumerate(zip(sampling.edges, sampling.edges[1:], strict=False)):
        pair = shown[2 * i : 2 * i + 2] if count > 200 else values[a:b]
        assert {pair.min(), pair.max()} == {values[a:b].min(), values[a:b].max()}


def test_a_history_that_ended_early_is_drawn_to_its_end() -> None:
    time = np.arange(1, 1001) / 100
    histories = {"long": History(time, {"v": time}), "short": History(time[:400], {"v": -time[:400]})}
    found = lines_of(histories, 100)
    shown = unpacked(*found["columns"]["v"]["short"])
    assert found["steps"] == 1000 and not found["whole"] and found["time"] == [0.01, 10.0, ""]
    assert np.isfinite(shown[:40]).all() and np.isnan(shown[40:]).all() and shown[39] == pytest.approx(-4.0, rel=1e-4)


def test_uneven_instants_are_kept() -> None:
    time = np.array([0.1, 0.2, 0.9])
    assert lines_of({"a": History(time, {"v": time})}, 100)["time"][2] == [0.1, 0.2, 0.9]


def test_samples_share_the_room() -> None:
    assert samples_for(1, 1e6) == MOST and samples_for(10**9, 1e6) == samples_for(10, -1.0) == LEAST
    assert samples_for(1000, 1e6) == pytest.approx(375, abs=2) and samples_for(1000, 1e6) % 2 == 0


def test_a_drawing_keeps_what_is_seen() -> None:
    text = slim(FIGURE)
    assert "when" not in text and "<!--" not in text and "figure_1" not in text
    assert 'd="M691 4666L3169 4666 3169.12 4134z"' in text
    assert "scale(0.065 -0.065)" in text and "scale(0.01562)" in text  # a scale of letters is no coordinate
    assert "fill:none;stroke:#d55e00" in text


def test_letters_are_drawn_once_a_page_and_other_names_are_a_figure_s_own() -> None:
    sheet = Sheet()
    first, second = sheet.placed(FIGURE, 'a "b" <c>'), sheet.placed(FIGURE, "d")
    assert first.count('<path id="l0"') == 1 and '<path id="l0"' not in second
    for number, text in enumerate((first, second), 1):
        assert text.count('href="#l0"') == 2 and "DejaVu" not in text
        assert f'id="f{number}-p1"' in text and f"url(#f{number}-p1)" in text
    assert '<use href="#l0" x="63.62" y="0.125"/>' in first
    assert '<use href="#l0" transform="translate(1 38.97) scale(0.7)"/>' in first
    assert 'aria-label="a &quot;b&quot; &lt;c&gt;"' in first and "width=" not in first.partition(">")[0]


def scene_of(name: str, cases: int, solvers: int) -> GalleryScene:
    """Return a scene of so many cases, each finished by so many solvers, of two columns."""
    row = SimpleNamespace(outcome=Outcome.COMPLETED)
    scene = SimpleNamespace(run=SimpleNamespace(columns=("displacement", "contact_pressure")))
    listed = [CaseResults(str(i), str(i), scene, dict.fromkeys(range(solvers), row)) for i in range(cases)]  # type: ignore[arg-type]
    return GalleryScene(name, name, f"{name}.html", tuple(listed), (), ())


def test_large_scenes_are_thinned_and_small_ones_are_not() -> None:
    scenes = [scene_of("small", 9, 2), *(scene_of(f"large {i}", 144, 7) for i in range(20))]
    most = most_lines(scenes)
    assert 0.8 * MOST_LINES < all_lines(scenes, most) <= MOST_LINES
    assert len(drawn(scenes[0], most)) == 9
    chosen = [case.name for case in drawn(scenes[1], most)]
    assert FEWEST <= len(chosen) < 144 and chosen[0] == "0" and chosen[-1] == "143"
    alone = scene_of("alone", 100, 7)
    assert len(drawn(alone, most_lines([alone]))) == 100
