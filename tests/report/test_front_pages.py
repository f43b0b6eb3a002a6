"""The pages that are read first: every number in sentence, table and chart, from closed forms or from made rows."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.made_cases import between, made_case, made_group, made_row

from dda.scheme import spectral
from validation.report.blocks import Callout, Table
from validation.report.figures.curves import style_of
from validation.report.figures.model import model_figure
from validation.report.front import closed, decisions, first, pages
from validation.scenes.scene import load_scene

PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 100})
OTHER = PAPER.with_values(
    {"block.side": 3.0, "block.density": 2500.0, "block.young": 4e9, "contact.stiffness": 1.2e10, "load.pressure": 2e6}
)
FREQUENCIES = {1.0: 344.5612, 10.0: 498.812, 100.0: 524.096}  # rad/s, of the paper's block


# ---- closed forms -------------------------------------------------------------------------------------------------


def test_a_step_for_a_ratio_gives_that_ratio_and_is_the_least() -> None:
    for ratio, frequency in FREQUENCIES.items():
        scene = closed.stiffer(PAPER, ratio)
        step = closed.step_for(scene, 0.05)
        assert step is not None and closed.first_damping(closed.timed(scene, step=step)) == pytest.approx(
            0.05, rel=1e-9
        )
        assert step == pytest.approx(4 * 0.05 / frequency, rel=0.02)  # xi is about w dt / 4
    assert closed.step_for(PAPER, 0.5) is None  # 0.373 is the greatest
    assert closed.step_for(PAPER.with_values({"time.alpha": 0.25, "time.delta": 0.5}), 0.05) is None


# ---- five sentences -----------------------------------------------------------------------------------------------


def case(step: float = 2e-3, ratio: float = 1.0, **metrics: Any) -> Any:
    scene = closed.stiffer(PAPER, ratio).with_values({"time.step": step, "contact.stiffness": ratio * 1e9}, label=True)
    return made_case(scene, {"dda": {name.replace("__", "."): value for name, value in metrics.items()}})


def model_form() -> Any:
    rows = (
        (2e-3, 1e5, 0.16, 8.4e6, 8e6),
        (1e-2, 1e6, 0.372, 6.3e6, 7e6),
        (1e-4, -1.4e6, 0.009, 11e6, 10e6),
    )
    cases = []
    for step, least, xi, peak, bar in rows:
        own = case(step, pressure__static=5e6, pressure__minimum=least, mode1__damping=xi, pressure__peak=peak)
        cases.append(replace(own, rows={**own.rows, "bar": made_row("bar", {"pressure.peak": bar}, own.name)}))
    numbers = {2e-3: (0.036, 0.04), 1e-2: (0.008, 0.007), 1e-4: (0.64, 0.74)}
    pairs = [between(c.name, "dda", "bar", displacement_l2=numbers[c.scene.time.step][0],
                     pressure_l2=numbers[c.scene.time.step][1]) for c in cases]  # fmt: skip
    pairs += [
        between(c.name, "bar", "continuum", displacement_l2=0.5 + i / 10, pressure_l2=0.7) for i, c in enumerate(cases)
    ]
    shortest = cases[-1].name
    pair = ["dda", "bar"]
    windows = [
        {"scene": shortest, "pair": pair, "metric": metric, "value": value, "id": f"{shortest}:{metric}{at}"}
        for metric, value, at in (
            ("pressure.l2", 0.74, ""),
            ("pressure.l2", 0.21, "@0.002s"),
            ("displacement.l2", 0.11, "@0.002s"),
        )
    ]
    return made_group(*cases, comparisons=tuple(pairs), verdicts=tuple(windows))


FOUND = {
    "model-form": model_form(),
    "figures-3-4": made_group(case(1e-3, mode1__damping=0.0845), case(1e-2, mode1__damping=0.372)),
    "figures-5-6": made_group(
        case(ratio=10.0, displacement__settling_step=22.0, pressure__settling_step=25.0),
        case(ratio=100.0, displacement__settling_step=21.0, pressure__settling_step=24.0,
             displacement__fine_settling_step=41.0, pressure__fine_settling_step=157.0),
    ),
    "figure-9": made_group(case(mode1__measured_damping=1e-12), case(mode1__measured_damping=0.123)),
}  # fmt: skip


def test_the_first_pages_say_what_was_found(kept: Any, drawn: Any, tmp_path: Path) -> None:
    """With all that they speak of, and with a pressure at rest that is not the load and a tension that is rounding."""
    wrong = case(pressure__static=4.9e6, pressure__minimum=-1e-3)
    less = {"model-form": made_group(wrong, comparisons=FOUND["model-form"].comparisons)}
    for name, groups in (("front", FOUND), ("front-of-less", less)):
        blocks = [*first.first_page(groups, PAPER, [], tmp_path), *decisions.decisions(groups, PAPER, tmp_path)]
        kept(name, blocks)
    assert len(drawn) == 5
    assert first.force({}) is None and first.beware({}) is None and first.springs({}) is None


def test_the_first_frequency_is_too_high_before_it_is_stepped_and_on_springs_that_are_not_soft() -> None:
    """From eigenvalues of the pencil and of the step; the bar's from b tan b = 2p/E."""
    exact = {0.1: 0.4328 * 608.581 / 2, 1.0: 327.682, 10.0: 455.258, 100.0: 475.600}  # b = 0.4328 at p = 0.1E
    natural = {}
    for ratio, bar in exact.items():
        p, m = ratio * 1e9, 10_800.0
        K, M = np.array([[2 * p, -2 * p], [-2 * p, 4e9 + 2 * p]]), np.diag([m, m / 3])
        w = math.sqrt(min(np.linalg.eigvals(np.linalg.solve(M, K)).real))
        natural[ratio] = w / bar - 1
        for step in (1e-4, 2e-3, 5e-3):
            root = spectral.eigenvalues(w * step, 0.5, 1.0, 1.0)
            stepped = np.abs(np.log(root[np.abs(root) > 1e-9])).max() / step
            scene = closed.stiffer(PAPER, ratio).with_values({"time.step": step, "contact.stiffness": p})
            assert first.stepped_frequency(scene) == pytest.approx(stepped, rel=1e-9)
    assert natural[0.1] == pytest.approx(0.008, abs=2e-4)
    assert natural[1.0] == pytest.approx(0.0515, abs=1e-4) and natural[100.0] == pytest.approx(0.102, abs=1e-4)
    for step, excess in ((1e-4, 0.0514), (2e-3, 0.0146), (5e-3, -0.0978)):
        assert first.stepped_frequency(closed.timed(PAPER, step=step)) / 327.682 - 1 == pytest.approx(excess, abs=5e-5)


@pytest.mark.parametrize(
    ("words", "said", "tone"),
    [
        (["PASS", "PASS"], "2 gates: 2 passed, 0 failed, 0 not run.", "pass"),
        (["PASS", "NOT RUN"], "2 gates: 1 passed, 0 failed, 1 not run.", "warn"),
        (["FAIL", "NOT RUN", "PASS"], "3 gates: 1 passed, 1 failed, 1 not run.", "fail"),
        ([], "No gate was judged.", "warn"),
    ],
)
def test_one_line_of_verdicts(words: list[str], said: str, tone: str) -> None:
    assert first.verdict_line([{"verdict": word} for word in words]) == Callout(said, tone)  # type: ignore[misc, arg-type]


def test_the_figure_of_the_first_page_holds_closed_form_and_runs() -> None:
    damping, error = first.damping_and_error(FOUND, PAPER)
    line, dots = damping.lines
    assert np.interp(2.0, line.x, line.y) == pytest.approx(16.02, abs=0.02)
    assert sorted(zip(dots.x, dots.y, strict=True)) == [(1.0, pytest.approx(8.45)), (10.0, pytest.approx(37.2))]
    assert damping.marks == {"1": 1.0, "10": 10.0}
    model, time = error.lines
    assert (list(model.x), list(model.y)) == (pytest.approx([0.1, 2, 10]), pytest.approx([64, 3.6, 0.8]))
    assert list(time.y) == pytest.approx([70, 50, 60])


@pytest.mark.parametrize("beyond", [0, 1])
def test_scenes_are_listed_as_long_as_a_page_has_lines_for_them(beyond: int, tmp_path: Path) -> None:
    group = made_group(made_case(OTHER, {"dda": {}}))
    groups = {f"scene-{number}": group for number in range(pages.OVERVIEW_SCENES + beyond)}
    blocks = pages.front_pages(groups, [], [], tmp_path)
    assert [isinstance(block, Table) for block in blocks].count(True) == 1 - beyond


# ---- the conditions of rules --------------------------------------------------------------------------------------


# ---- what is drawn ------------------------------------------------------------------------------------------------


def test_the_model_is_drawn_with_its_words() -> None:
    (axes,) = model_figure("a = 2 m", "q = 5 MPa").axes
    place = {text.get_text(): text.get_position() for text in axes.texts}
    assert place["M"][0] < place["A"][0] < place["N"][0] and place["B, fixed"][1] < place["M"][1] < place["A"][1]
    words = [text.get_text() for text in axes.texts]
    assert {"A", "B, fixed", "M", "N", "u", "v", "r", "a = 2 m", "q = 5 MPa, from t = 0 on"} <= set(words)
    assert words.count("p") == 4  # two springs a corner
    springs = [line for line in axes.lines if line.get_color() == style_of("dda").color and len(line.get_xdata()) > 5]
    assert len(springs) == 4
