"""What the pages of the gallery tell, from rows and verdicts made by hand: each number in its place and unit."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.made_cases import made_history, made_row

from validation.gallery import chapters, judged, pages, scene_data, verdicts, work
from validation.gallery.calculators import BLOCK, CALCULATORS, Control
from validation.gallery.cases import GalleryCase, GalleryScene, GalleryStudy
from validation.gallery.histories import Sampling
from validation.problems.judge import Word
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.studies.work.points import Point

CASE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 4})


def test_a_thinned_history_is_drawn_at_the_begin_and_the_middle_of_each_part() -> None:
    sampling = Sampling(1000, 20)  # ten parts of a hundred steps
    assert sampling.times(np.arange(1000.0)).tolist() == [i * 50.0 for i in range(20)]


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


@pytest.mark.parametrize(("word", "color"), [(Word.PASS, "#1c6b2f"), (Word.FAIL, "#a80f0f")])
def test_a_badge_is_green_or_red_by_its_verdict_and_tells_the_error(word: Word, color: str) -> None:
    found: Any = SimpleNamespace(word=word, deciding=SimpleNamespace(error=0.13, band=0.057))
    text = judged.badge(SimpleNamespace(judgement=found, problem=SimpleNamespace(name="locked")))  # type: ignore[arg-type]
    assert f"DDA field: locked: {word} 13 %" in text and f'fill="{color}"' in text


# ---- scenes -------------------------------------------------------------------------------------------------------


def test_a_case_tells_its_limit_how_its_runs_ended_and_its_numbers(tmp_path: Any) -> None:
    results = Results(tmp_path)
    metrics = {"displacement.static": -0.01, "displacement.settling_step": 12.0, "pressure.peak": 6.5e6,
               "mode1.damping": 3e-14}  # fmt: skip
    own = made_row("dda", metrics, CASE.name, work={"steps": 4})
    late = made_row("fem", {}, CASE.name, outcome=Outcome.TIMEOUT, notes=("after 5 s",))
    results.append(own, made_history(0.002, [-0.01] * 4, [5e6] * 4))
    case = GalleryCase(CASE.name, "dt = 2 ms", CASE, {"dda": own, "fem": late})
    found = scene_data._case(results, case, 100)
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


def test_a_figure_is_that_of_the_scene_with_the_longest_name_that_fits() -> None:
    scenes = [scene_named(name) for name in ("rocking", "rocking-pulse", "slope")]
    for file, name in (("rocking-pulse-history.svg", "rocking-pulse"), ("rocking-history.svg", "rocking")):
        found = chapters.scene_of_figure(file, scenes)
        assert found is not None and found.name == name
    assert chapters.scene_of_figure("first.svg", scenes) is None


def test_a_chapter_that_cannot_be_drawn_says_why(tmp_path: Any) -> None:
    study = GalleryStudy("lost", "study-lost.html", {"study": "lost"}, (), ())
    results = Results(tmp_path)
    results.write_json("studies/lost.json", {"study": "another"})
    (said,) = chapters.chapter_for(results, study).blocks
    assert "The chapter cannot be drawn from these results" in said.text and "another" in said.text  # type: ignore[union-attr]


def test_the_foot_names_the_newest_study_s_commit_and_version() -> None:
    made = [GalleryStudy(name, "", {"study": name, "provenance": {
        "date": date, "commit": f"of {name}", "packages": {"dda-validation": version}}}, (), ())
        for name, date, version in (("a", "2024-01-02", "1"), ("b", "2025-03-04", "2"), ("c", "2023-01-01", "3"))
    ]  # fmt: skip
    assert pages._provenance(made) == {"date": "2025-03-04", "commit": "of b", "version": "2"}
    assert set(pages._provenance([]).values()) == {"unknown"}


# ---- error against cost, calculators --------------------------------------------------------------------------------


def test_a_run_has_its_label_its_costs_and_its_errors_by_quantity_and_reference() -> None:
    errors = {("displacement", "bar"): 0.25, ("displacement", "continuum"): 0.5, ("contact pressure", "bar"): 0.0}
    cost = {"work": {"unknowns": 6, "steps": 40}, "seconds": {"setup": 0.25, "stepping": 0.5}}
    run = Point("fem, linear", CASE, made_row("fem", **cost), errors)
    found = work._plot([run])
    assert found["references"] == ["continuum", "bar"]
    assert found["quantities"][:2] == ["displacement", "contact pressure"]
    (one,) = found["runs"]
    assert one["label"] == f"dt = 2 ms, {CASE.fem.per_side} elements a side"
    assert one["errors"][:2] == [[0.5, 0.25], [None, None]]
    assert dict(zip(found["costs"], one["costs"], strict=True))["seconds"] == 0.75 and 240.0 in one["costs"]


def test_the_calculators_begin_with_the_papers_block() -> None:
    paper = load_scene("figures-3-4")
    wanted = {"side": paper.block.side, "density": paper.block.density, "young": paper.block.young, "step": 0.002,
              "stiffness_ratio": paper.contact.stiffness / paper.block.young}  # fmt: skip
    for calculator in CALCULATORS:
        controls = [c for c in (*calculator.controls, *calculator.block) if isinstance(c, Control)]
        begins = {c.id: c.value for c in controls if c.id in wanted}
        if calculator.id == "rebound":  # at a step that a contact lasts
            assert begins.pop("step") == 0.0005
        assert begins.items() <= wanted.items() and len({c.id for c in controls}) == len(controls)
    assert {c.id for c in BLOCK} == {"side", "density", "young"}
