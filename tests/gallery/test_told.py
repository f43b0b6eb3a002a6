"""What the pages of the gallery tell, from rows and verdicts made by hand: each number in its place and unit."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.made_cases import kept_study, made_history, made_row

from validation.gallery import cases as cases_of_gallery
from validation.gallery import chapters, judged, scene_data, verdicts
from validation.gallery.calculators import CALCULATORS
from validation.gallery.cases import GalleryScene, GalleryStudy, studies_and_scenes
from validation.gallery.histories import Sampling
from validation.gallery.pages import Pages, environment
from validation.gallery.svg import Sheet
from validation.problems.judge import Word
from validation.report.blocks import Table, TableColumn
from validation.report.chapters.data import CaseResults
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene

CASE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 4})


def test_a_thinned_history_is_drawn_at_the_begin_and_the_middle_of_each_part() -> None:
    sampling = Sampling(1000, 20)  # ten parts of a hundred steps
    assert sampling.times(np.arange(1000.0)).tolist() == [i * 50.0 for i in range(20)]


def test_no_two_pages_share_a_file_whatever_the_letters_case() -> None:
    page = cases_of_gallery._pages()
    titles = ["Figure 7", "figure 7", "Figure/7", "..", "x" * 200]
    assert [page("scene", title) for title in titles] == [
        "scene-Figure-7.html",
        "scene-figure-7-2.html",
        "scene-Figure-7-3.html",
        "scene-unnamed.html",
        f"scene-{'x' * 94}.html",
    ]


# ---- verdicts -----------------------------------------------------------------------------------------------------


def verdict(word: str, gate: str, reason: str, value: float | None = 0.5) -> Any:
    return {"verdict": word, "scene": "s", "pair": ["dda", "bar"], "metric": "displacement.l2", "value": value,
            "band": [0.0, 1.0], "id": gate, "reason": reason, "reference_kind": "exact", "why": ""}  # fmt: skip


def test_the_table_of_gates_has_failures_first_each_with_its_window_and_its_reason() -> None:
    found = verdicts.table([verdict("PASS", "s:a:m", "one"), verdict("NOT RUN", "s:b:m", "two", None),
                            verdict("FAIL", "s:c:m@0.2s", "three", 2.0)])  # fmt: skip
    rows = [[found["words"][i] for i in row[:6]] for row in found["rows"]]
    assert rows == [
        ["FAIL", "s", "dda – bar", "displacement.l2@0.2s", "2", "0 … 1"],
        ["NOT RUN", "s", "dda – bar", "displacement.l2", "–", "0 … 1"],
        ["PASS", "s", "dda – bar", "displacement.l2", "0.5", "0 … 1"],
    ]
    assert [found["reasons"][row[6]] for row in found["rows"]] == ["three [exact]", "two [exact]", "one [exact]"]


def test_verdicts_are_counted_by_their_own_word() -> None:
    many = [verdict(word, "s:a:m", "r") for word in ("PASS", "PASS", "PASS", "FAIL", "NOT RUN", "NOT RUN")]
    assert verdicts.counts(many) == {"PASS": 3, "FAIL": 1, "NOT RUN": 2}


@pytest.mark.parametrize(
    ("word", "color", "withheld", "rest"),
    [
        (Word.PASS, "#1c6b2f", (), "</"),
        (Word.PARTIAL, "#8a5a00", ("contact_pressure",), "; contact_pressure not reported</"),
        (Word.FAIL, "#a80f0f", ("contact_pressure",), "; contact_pressure not reported</"),
    ],
)
def test_a_badge_tells_its_verdict_by_color_the_error_and_what_is_withheld(
    word: Word, color: str, withheld: tuple[str, ...], rest: str
) -> None:
    found: Any = SimpleNamespace(word=word, deciding=SimpleNamespace(error=0.13, band=0.057), withheld=withheld)
    text = judged.badge(SimpleNamespace(judgement=found, problem=SimpleNamespace(name="locked")))  # type: ignore[arg-type]
    assert f"{word} 13 %{rest}" in text and f'fill="{color}"' in text


# ---- scenes -------------------------------------------------------------------------------------------------------


def test_a_case_tells_its_limit_how_its_runs_ended_and_its_numbers(tmp_path: Any) -> None:
    results = Results(tmp_path)
    metrics = {"displacement.static": -0.01, "displacement.settling_step": 12.0, "pressure.peak": 6.5e6,
               "mode1.damping": 3e-14}  # fmt: skip
    own = made_row("dda", metrics, CASE.name, work={"steps": 4})
    late = made_row("fem", {}, CASE.name, outcome=Outcome.TIMEOUT, notes=("after 5 s",))
    results.append(own, made_history(0.002, [-0.01] * 4, [5e6] * 4))
    case = CaseResults(CASE.name, "dt = 2 ms", CASE, {"dda": own, "fem": late})
    found = scene_data._case(results, case, 100)
    assert found["dots"] == {}  # dda is stepped
    turning = made_row("continuum", {}, CASE.name)
    results.append(turning, made_history(0.002, [0.0, -0.02, 0.001, -0.019], [5e6] * 4))
    exact = CaseResults(CASE.name, "dt = 2 ms", CASE, {"dda": own, "continuum": turning})
    assert scene_data._case(results, exact, 100)["dots"] == {"displacement": ["continuum"]}
    assert (found["label"], found["limit"]) == ("dt = 2 ms", pytest.approx(0.06))
    assert found["told"] == [f"fem: timeout. {Outcome.TIMEOUT.sentence} after 5 s"]
    assert {name: list(lines) for name, lines in found["columns"].items()} == {
        "displacement": ["dda"], "contact_pressure": ["dda"]
    }  # fmt: skip
    names = scene_data._metrics([case])
    assert names == ["displacement.static", "displacement.settling_step", "pressure.peak", "mode1.damping"]
    first, second = scene_data._numbers(case, names)
    assert first == ["dda", "−0.01000", "12", "6.500×10⁶", "<10⁻¹²", "4"] and second[0] == "fem"


def scene_named(name: str) -> GalleryScene:
    return GalleryScene(name, name, f"{name}.html", (), (), ())


def test_a_chapter_that_cannot_be_drawn_says_why(tmp_path: Any) -> None:
    study = GalleryStudy("lost", "study-lost.html", {"study": "lost"}, (), ())
    results = Results(tmp_path)
    results.write_json("studies/lost.json", {"study": "another"})
    (said,) = chapters.page_blocks(results, study)
    assert "The chapter cannot be drawn from these results" in said["text"] and "another" in said["text"]


def page_of(*words: tuple[str, int]) -> Pages:
    """Return the pages of two studies with two scenes; the first study's verdicts are those given, so many of each."""
    verdicts_of = [verdict(word, "s:a:m", f"because {word}", 2.0) for word, n in words for _ in range(n)]
    cases = tuple(CaseResults(f"c{i}", f"c{i}", CASE, {}) for i in range(3))
    scenes = [GalleryScene(name, f"The scene {name}", f"{name}.html", cases, (of,), ())
              for name, of in (("one", "a"), ("two", "b"))]  # fmt: skip
    studies = [GalleryStudy(name, f"study-{name}.html", {"study": name, "title": f"Of {name}"}, (), own)
               for name, own in (("a", tuple(verdicts_of)), ("b", ()))]  # fmt: skip
    return Pages(Results("nowhere"), studies, scenes)


def test_the_first_page_lists_what_fails_with_value_before_band_and_counts_by_word() -> None:
    text = " ".join(page_of(("PASS", 4), ("FAIL", 1), ("NOT RUN", 3)).index().split())
    assert "4 passed" in text and "1 failed" in text and "3 not run" in text
    assert "s, dda – bar, displacement.l2: 2, band 0 … 1. because FAIL [exact]</li>" in text
    assert "because NOT RUN" not in text and text.count('<span class="fail">FAIL</span>') == 1


def test_the_page_of_a_scene_names_its_own_studies_and_the_cases_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    pages = page_of()
    monkeypatch.setattr(scene_data, "drawn", lambda scene, most: list(scene.cases[:2]))
    text = pages.scene(pages._scenes[0])
    assert 'href="study-a.html"' in text and 'href="study-b.html"' not in text and "of the study" in text
    assert "2 of 3 cases are drawn" in text


def test_a_table_of_a_chapter_keeps_its_notes() -> None:
    table = Table((TableColumn("a"),), (("1",),), "The caption", ("what it means",))
    made = environment().from_string('{% import "parts.html.j2" as parts %}{{ parts.block(b) }}')
    text = made.render(b=chapters.placed(table, Path(), Sheet()))
    assert "<caption>The caption</caption>" in text and '<p class="small">what it means</p>' in text


def test_a_full_model_is_not_shown_beside_the_one_that_it_checks(tmp_path: Path) -> None:
    results = Results(tmp_path)
    rows = [made_row(solver, {}, CASE.name) for solver in ("fem", "fem:full")]
    kept_study(results, [(CASE, row, made_history(0.002, [-0.01] * 4)) for row in rows])
    _, (scene,) = studies_and_scenes(results, ["made"])
    assert [list(case.rows) for case in scene.cases] == [["fem"]]


# ---- error against cost, calculators --------------------------------------------------------------------------------


def test_the_calculators_begin_with_the_papers_block() -> None:
    paper = load_scene("figures-3-4")
    wanted = {"side": paper.block.side, "density": paper.block.density, "young": paper.block.young, "step": 0.002,
              "stiffness_ratio": paper.contact.stiffness / paper.block.young}  # fmt: skip
    for calculator in CALCULATORS:
        controls = [c for c in (*calculator.controls, *calculator.block) if not c.options]
        begins = {c.id: c.value for c in controls if c.id in wanted}
        if calculator.id in ("rebound", "engines"):  # at a step that a contact lasts, at that of an engine
            assert begins.pop("step") == {"rebound": 0.0005, "engines": 0.004}[calculator.id]
        assert begins.items() <= wanted.items() and len({c.id for c in controls}) == len(controls)
    assert {c.id for c in CALCULATORS[0].block} == {"side", "density", "young"}
