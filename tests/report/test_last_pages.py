"""The appendix, and the chapters whose tables are made from rows alone: each number in its place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.made_cases import kept_study, made_case, made_group, made_history

from validation.problems.quantities import Quantity
from validation.report.appendix.gates import gate_table
from validation.report.appendix.provenance import parameter_table, provenance
from validation.report.chapters import gates
from validation.report.chapters import judged as judged_chapter
from validation.report.chapters.scene import history_block
from validation.report.figures import motion
from validation.report.figures.curves import HistoryPanel
from validation.runs.results import Results
from validation.scenes.scene import load_scene

PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 100})


def verdict(scene: str, value: float, band: tuple[float, float] = (0.0, 1.0), **more: Any) -> Any:
    rest = {"study": "core", "pair": ["dda", "bar"], "metric": "m", "verdict": "PASS", "reason": "so", "why": ""}
    rest |= {"reference_kind": "exact", "reference_uncertainty": 0.0, "alarms": [], "id": f"{scene}:dda-bar:m"}
    return rest | {"scene": scene, "value": value, "band": list(band)} | more


def test_the_appendix_says_what_is_shared_once(kept: Any, tmp_path: Path) -> None:
    """Scenes and metrics of a reason beyond the second are counted, data of later scenes are those that differ."""
    own = [verdict(f"a[x={i}]", 0.5, id=f"a[x={i}]:dda-bar:m@0.2s") for i in range(3)]
    own += [verdict(name, 0.1, reason="else", metric=name.upper()) for name in "bcd"]
    own.append(verdict("e", 0.25, study="limits", reference_kind="other code"))
    failed = verdict("f", 9.0, verdict="FAIL")
    stiff = PAPER.with_values({"contact.stiffness": 1e11})
    cases = [made_case(PAPER.with_values({"time.step": step}, label=True), {}) for step in (0.002, 0.001)]
    found = {"a": replace(made_group(*cases), name="a"), "b": replace(made_group(made_case(stiff, {})), name="b")}
    results = Results(tmp_path)
    for name, commit in (("a", "one"), ("b", "two"), ("c", "two")):
        kept_study(results, [], study=name, provenance={"commit": commit, "system": "Linux"})
    kept("appendix", [*gate_table([*own, failed]), *parameter_table(found), *provenance(results, ["a", "b", "c"])])
    assert gate_table([failed]) == []


# ---- histories ----------------------------------------------------------------------------------------------------


def panel(**values: Any) -> HistoryPanel:
    histories = {name: made_history(0.1, np.array(v)) for name, v in values.items()}
    return HistoryPanel("", histories, {"displacement": 1.0}, "bar")


def test_lines_on_one_another_are_one_line_with_all_names() -> None:
    base = np.linspace(0, 1, 50)
    some = panel(dda=base + 0.1, textbook=base + 0.1 + 1e-6, bar=base, fem=base + 1e-3, far=base + 3e-3)
    assert motion.twins([some], ["displacement"]) == {
        "dda": {"textbook": pytest.approx(1e-6 / 1.1)}, "bar": {"fem": pytest.approx(1e-3)}, "far": {},
    }  # fmt: skip
    alone = panel(dda=base, bar=base + 1)
    assert "textbook" in motion.twins([some, alone], ["displacement"])["dda"]
    repeated = panel(**{"dda": base, "dda-textbook": base + 1e-9})
    assert motion.twins([repeated], ["displacement"]) == {"dda": {}}  # on dda, which it repeats
    assert "dda-textbook" in motion.twins([panel(**{"dda": base, "dda-textbook": base + 0.1})], ["displacement"])
    other = panel(dda=base, textbook=base + 1)
    assert motion.twins([some, other], ["displacement"])["dda"] == {}  # on one another in one case only
    figure = motion.history_figure([some], "displacement")
    assert {text.get_text() for text in figure.axes[0].texts} == {"dda, textbook", "bar, fem", "far"}


def test_more_swings_than_can_be_drawn_are_a_band_with_their_start_below() -> None:
    time = np.arange(1, 20_001)
    fast = panel(dda=1 - np.cos(0.5 * time))  # 1592 periods
    slow = panel(dda=1 - np.cos(0.005 * time) + 0.09 * np.cos(time))  # 16, and noise on them
    assert motion.start_of([slow], "displacement") is None
    assert motion.start_of([panel(dda=1 - np.cos(0.05 * time))], "displacement") is not None  # 159
    span = motion.start_of([fast], "displacement")
    assert span == pytest.approx(12 * 2 * np.pi / 0.5 * 0.1, rel=0.01)  # 24 crossings, 12 periods
    slower = panel(dda=1 - np.cos(0.25 * time))
    assert motion.start_of([slower, fast], "displacement") == pytest.approx(2 * span, rel=0.01)
    top, start = motion.history_figure([fast], "displacement").axes
    assert top.collections and not start.collections  # a filled band, and lines
    assert start.get_xlim()[1] == pytest.approx(span, rel=0.01) and start.get_ylabel() == "its start"
    middles, low, high = motion.band(np.arange(600.0), np.tile([3.0, -1.0], 300))
    assert middles.size == motion.BINS and set(low) == {-1.0} and set(high) == {3.0}


def test_a_figure_ends_when_all_lines_have_long_settled(drawn: dict[str, Figure], tmp_path: Any) -> None:
    history = made_history(0.002, np.linspace(-0.02, -0.01, 100))
    rows = {"dda": {"displacement.settling_step": 20.0}, "bar": {"displacement.settling_step": 10.0}}
    group = made_group(made_case(PAPER, rows, {"dda": history, "bar": history}))
    caption = history_block(group, ["displacement"], tmp_path).caption
    assert "The first 0.060 s; all have settled to 1\u00a0% by then." in caption
    assert drawn["scene-history.svg"].axes[0].get_xlim()[1] == pytest.approx(0.06)  # as the caption says
    rows["bar"] = {"displacement.settling_step": "undefined"}
    group = made_group(made_case(PAPER, rows, {"dda": history, "bar": history}))
    caption = history_block(group, ["displacement"], tmp_path).caption
    assert "settled" not in caption and "bar lies on dda (within <10⁻¹²)." in caption
    assert "settled" in history_block(group, ["displacement"], tmp_path, without=["bar"]).caption


def test_a_count_that_is_none_is_no_small_number() -> None:
    scene = PAPER.name
    count = verdict(scene, 0.0, (0.0, 0.0), metric="displacement.fine_settling_step")
    error = verdict(scene, 0.0, (0.0, 1e-9), metric="displacement.l2")
    assert [gates.value_cell(v["value"], v["metric"]) for v in (count, error)] == ["0", "<10⁻¹²"]
    (told,) = judged_chapter.numbers_table((Quantity("openings", "1", 0.0, 5.0),)).rows
    assert told == ("openings", "0", "5", "1")
    (told,) = judged_chapter.numbers_table((Quantity("damping ratio", "1", 0.0, 0.1),)).rows
    assert told[1] == "<10⁻¹²"


# ---- chapters -----------------------------------------------------------------------------------------------------
