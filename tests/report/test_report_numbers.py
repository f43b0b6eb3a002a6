"""Every number on a scene's page and on the front page, from results made by hand: value, unit, column and words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from oracles.made_cases import (
    between,
    line_in,
    made_case,
    made_group,
    made_history,
    names_at,
    rules_of,
)

from validation.report.blocks import Paragraph
from validation.report.chapters import ledger as chapters_ledger
from validation.report.chapters import scene as chapters
from validation.report.chapters import text as chapters_text
from validation.report.figures.curves import style_of
from validation.scenes.scene import load_scene

BASE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 40})


def stepped(step: float) -> Any:
    return BASE.with_values({"time.step": step}, label=True)


# ---- the table of damping, settling and peaks ---------------------------------------------------------------------


# ---- the conclusion -----------------------------------------------------------------------------------------------


def test_the_conclusion_gives_ranges_tension_and_the_trend_with_the_damping() -> None:
    ratios = {0.01: (0.30, 0.0081, 0.0067), 0.002: (0.16, 0.0363, 0.0403), 0.001: (0.08, 0.0897, 0.104)}
    cases = [
        made_case(
            stepped(step),
            {
                "dda": {"mode1.damping": xi, "pressure.minimum": -1e6 * step},
                "fem": {"pressure.minimum": -9e6},  # named after dda and the bar
                "bar": {"pressure.minimum": -2e8 * step},
            },
        )
        for step, (xi, _, _) in ratios.items()
    ]
    pairs = [between(stepped(step).name, "dda", "bar", displacement_l2=v, pressure_l2=p)
             for step, (_, v, p) in ratios.items()]  # fmt: skip
    said = chapters.conclusion(made_group(*cases, comparisons=tuple(pairs), verdicts=()))
    assert said == (
        "Against bar, dda differs by 0.81\u00a0% to 8.97\u00a0% in displacement and 0.67\u00a0% to 10.4\u00a0% in "
        "contact pressure (relative L2 over 1\u00a0s); no gate judges this scene; the locked contact hides tension, "
        "down to −0.0100 MPa in dda and −2.00 MPa in bar; the difference falls as the damping grows, from "
        "8.97\u00a0% at ξ₁ = 8.00\u00a0% to 0.81\u00a0% at ξ₁ = 30.00\u00a0%: both are damped, which is no sign of "
        "accuracy."
    )


# ---- figures of a page --------------------------------------------------------------------------------------------


def test_a_figure_compares_cases_over_the_time_that_all_of_them_run(drawn: dict[str, Figure], tmp_path: Path) -> None:
    """0.02 s and 0.1 s: both panels stop at 0.02 s, the last of its steps included."""
    cases = []
    for step, last in ((0.002, 10), (0.001, 100)):
        histories = {name: made_history(step, -0.01 * scale * np.ones(last), 5e6 * scale * np.ones(last))
                     for name, scale in (("dda", 1.1), ("bar", 1.0))}  # fmt: skip
        metrics = {"dda": {"displacement.static": -0.02}, "bar": {"displacement.static": -0.01}}
        cases.append(made_case(stepped(step), metrics, histories))
    block = chapters.history_block(made_group(*cases), ["displacement"], tmp_path)
    assert "The first 0.0200 s, the time that all cases run." in block.caption
    (figure,) = drawn.values()
    for axes, count in zip(figure.axes[:2], (10, 20), strict=True):
        x, y = line_in(axes, to_hex(style_of("dda").color))
        assert len(x) == count and x[-1] == pytest.approx(0.02) and np.allclose(y, -11)
        assert rules_of(axes, "#bbbbbb") == ([pytest.approx(-10)], [])  # the reference's static value, in mm
    assert names_at(figure.axes[1])["dda"][0] == pytest.approx(-11)


def test_a_case_without_a_step_in_the_common_time_is_left_out(drawn: dict[str, Figure], tmp_path: Path) -> None:
    """Ten steps of 1e-4 s end before the first of 0.02 s."""
    cases = [made_case(stepped(step), {"dda": {}}, {"dda": made_history(step, np.ones(10))}) for step in (0.02, 1e-4)]
    assert chapters.history_block(made_group(*cases), ["displacement"], tmp_path).caption.startswith("1 of 2 cases.")


# ---- the ledger and the front page --------------------------------------------------------------------------------

PAIRS = {  # part of the ledger -> solver, reference, displacement, pressure
    "code": ("dda", "dda-textbook", 1.1e-13, 1.2e-13),
    "mesh": ("fem", "bar", 2.1e-6, 2.2e-6),
    "model form": ("dda", "bar", 0.031, 0.032),
    "time": ("bar", "continuum", 0.41, 0.42),
}
OTHERS = (("dda", "continuum", 0.51, 0.52), ("dda", "fem", 0.61, 0.62), ("fem", "continuum", 0.71, 0.72))


def ledger_group() -> Any:
    every = [*PAIRS.values(), *OTHERS]
    pairs = [between(BASE.name, a, b, displacement_l2=v, pressure_l2=p) for a, b, v, p in every]
    solvers = ("dda", "dda-textbook", "fem", "bar", "continuum")
    return made_group(made_case(BASE, {solver: {} for solver in solvers}, label="one"), comparisons=tuple(pairs))


OPENING_PAIRS = {  # contact that opens: part of the ledger -> solver, reference, displacement, pressure
    "code": ("fem", "fenicsx", 1.1e-13, 1.2e-13),
    "mesh": ("fem", "bar", 2.1e-6, 2.2e-6),
    "model form": ("block-events", "bar-events", 0.31, 0.32),
    "time": ("dda", "block-events", 0.41, 0.42),
}


def test_contact_that_opens_has_a_ledger_of_its_own_pairs() -> None:
    scene = load_scene("unlocked").expand()[1]
    others = (("dda", "bar", 0.51, 0.52), ("dda", "fem", 0.61, 0.62), ("bar", "bar-events", 0.71, 0.72))
    every = [*OPENING_PAIRS.values(), *others]
    pairs = [between(scene.name, a, b, displacement_l2=v, pressure_l2=p) for a, b, v, p in every]
    solvers = ("dda", "fem", "fenicsx", "bar", "block-events", "bar-events")
    group = made_group(made_case(scene, {solver: {} for solver in solvers}, label="one"), comparisons=tuple(pairs))
    for part, values in OPENING_PAIRS.items():
        assert chapters_ledger.entry(group, group.cases[0], part) == values[2:]
    parts = chapters_ledger.OPENING_PARTS
    assert chapters_ledger.with_entries([group], chapters_ledger.PARTS) == [] and chapters_ledger.with_entries(
        [group], parts
    ) == [group]
    assert chapters_ledger.with_entries([ledger_group()], parts) == []
    alone = made_group(made_case(scene, {"dda": {}}))
    assert chapters_ledger.entry(alone, alone.cases[0], "code") == chapters_ledger.NOTHING


def test_the_headline_gives_displacement_pressure_code_and_mesh_each_its_own_number() -> None:
    assert chapters_ledger.headline([ledger_group()]) == (
        "The model form is 3.1\u00a0% in displacement and 3.2\u00a0% in contact pressure (relative L2); of the "
        "displacement's difference code and rounding are at most 1.1×10⁻¹³ and the finite-element mesh is at most "
        "2.1×10⁻⁶, so that neither explains it: it is one strain in the block in place of a wave."
    )


def test_two_cases_have_a_ledger_and_one_has_none(drawn: dict[str, Figure], tmp_path: Path) -> None:
    one, two = ledger_group(), replace(ledger_group(), name="other")
    assert chapters_ledger.ledger_blocks([one], "s", tmp_path) == []
    _, said, figure = chapters_ledger.ledger_blocks([one, two], "s", tmp_path)
    assert said == Paragraph(chapters_ledger.headline([one, two]))
    assert [*drawn] == ["s-ledger.svg"] and "model form: dda − bar" in figure.caption  # type: ignore[union-attr]


def test_code_and_mesh_are_told_by_the_worst_of_the_cases() -> None:
    scenes = [BASE.with_values({"time.step": step}, label=True) for step in (0.002, 0.001)]
    pairs = [between(s.name, "fem", "bar", displacement_l2=e) for s, e in zip(scenes, (0.01, 0.04), strict=True)]
    group = made_group(*(made_case(scene, {}) for scene in scenes), comparisons=tuple(pairs))
    assert "the finite-element mesh is at most 4\u00a0%, so that" in chapters_ledger._shares([group], 0.05)
    assert "so that" not in chapters_ledger._shares([group], 0.02)


# ---- data of a scene ----------------------------------------------------------------------------------------------


def test_the_data_of_a_scene_are_those_of_the_scene_with_their_units() -> None:
    changes = {
        "block.side": 3.0, "block.density": 2500.0, "block.young": 2e9, "block.poisson": 0.25,
        "contact.stiffness": 6e10, "load.pressure": 4e6, "time.step": 0.003, "time.steps": 70,
        "time.alpha": 0.4, "time.delta": 0.7, "time.gg": 0.98, "fem.elements": 12, "fem.degree": 1,
    }  # fmt: skip
    scene = BASE.with_values(changes)
    assert chapters_text.parameters(scene, set()) == (
        "a = 3 m, ρ = 2500 kg/m³, E = 2×10⁹ Pa, μ = 0.25, plane stress, p = 6×10¹⁰ N/m, q = 4×10⁶ Pa, n = 12, degree "
        "= 1, foundation = distributed, dt = 0.003 s, steps = 70, α = 0.4, δ = 0.7, gg = 0.98, start = zero."
    )
    assert "dt =" not in chapters_text.parameters(scene, {"time.step"})
    other = load_scene("slope-base").with_values({"contact.band": [1e-3, 0.0], "damping.mass": 0.5})
    line = chapters_text.parameters(other, {"contact.friction"})
    for part in ("law = unilateral", "band = 0.001, 0 m", "base motion = slope-base.csv", "mass = 0.5 1/s"):
        assert f", {part}," in f", {line}"
    assert "φ" not in line and "cut" not in line
    assert chapters_text.parameters(load_scene("beams-supported"), set()).startswith(
        "256 blocks, E = 1×10⁹ Pa, ρ = 2700 kg/m³, μ = 0.25, g = 1×10⁹ m, gravity = 0, −9.81 m/s², W = 8 m, H = 1 m"
    )
