"""The page of a scene: its drawing, and the case and window that show what the solvers differ by."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.made_cases import made_case, made_group, made_history

from validation.problems.quantities import Quantity
from validation.report.blocks import Paragraph
from validation.report.chapters.compare import _facts
from validation.report.chapters.damping import damping_table
from validation.report.chapters.gates import value_cell
from validation.report.chapters.judged import numbers_table
from validation.report.chapters.scene import PERIODS, _reading, free_window, history_block, lead_difference, lead_figure
from validation.report.chapters.summary import _frequency, damping_blocks
from validation.report.chapters.text import _pressure
from validation.report.figures.curves import HistoryPanel
from validation.scenes.scene import load_scene

FREQUENCY = 345.0  # rad/s
BASE = load_scene("figures-3-4").with_values({"time.step": 0.001, "time.steps": 200})


def vibrating(step, share, metrics):
    """Return a case whose DDA is so large a share off its bar at every instant."""
    time = step * np.arange(1, round(0.2 / step) + 1)
    bar = -0.01 * (1 - np.cos(FREQUENCY * time))
    scene = BASE.with_values({"time.step": step, "time.steps": len(time)}, label=True)
    histories = {"dda": made_history(step, (1 + share) * bar), "bar": made_history(step, bar)}
    return made_case(scene, {"dda": metrics, "bar": metrics}, histories, f"dt = {step:g} s")


@pytest.mark.parametrize("known", [True, False], ids=["frequency known", "counted"])
def test_the_case_and_the_window_that_open_a_page(known, drawn, tmp_path):
    """Of 0.5, 8 and 60 % the middle one, over the first periods of the slowest mode."""
    metrics = {"mode1.frequency": FREQUENCY} if known else {}
    cases = [vibrating(*numbers, metrics) for numbers in ((0.002, 0.005), (0.001, 0.08), (0.0005, 0.6))]
    (block,) = lead_figure(made_group(*cases), tmp_path)
    assert block.caption.startswith("dt = 0.001 s, of 3 cases")
    window = drawn["scene-lead.svg"].axes[0].get_xlim()[1]
    assert re.search(f"{window:.3g} s dda .* 8\u00a0% .* bar .* displacement", block.caption)
    assert window == pytest.approx(PERIODS * 2 * np.pi / FREQUENCY, rel=0.02 if known else 0.2)


def test_a_stress_stands_in_megapascals_where_it_is_large_and_a_zero_without_unit():
    stresses = ("0.0", "-9e3x70", "2e4x-3e6")
    assert [*map(_pressure, stresses)] == [("0", ""), ("-9000, 70", " Pa"), ("0.02, -3", " MPa")]


def test_a_count_that_is_none_is_no_small_number():
    assert value_cell(0.0, "displacement.fine_settling_step") == "0" and value_cell(0.0, "displacement.l2") == "<10⁻¹²"
    numbers = (Quantity("openings", "1", 0.0, 5.0), Quantity("damping ratio", "1", 0.0, 0.1))
    assert [row[1] for row in numbers_table(numbers).rows] == ["0", "<10⁻¹²"]


def test_what_damping_removed_is_told_by_its_parts(kept):
    still = BASE.with_values({"time.alpha": 0.25, "time.delta": 0.5})
    damped = still.with_values({"time.gg": 0.997, "damping.mass": 7.0, "damping.stiffness": 3e-5})
    open_contact = load_scene("unlocked-constant").expand()[0]
    energies = {"energy.given": 7e5, "energy.lost_algorithmic": -2e4, "energy.lost_switching": 9e4}
    blocks = []
    mode = {"mode1.frequency": FREQUENCY, "mode1.damping": 0.371}
    for scene, metrics in ((still, mode), (damped, mode), (open_contact, energies), (open_contact, {})):
        blocks += damping_blocks(made_group(made_case(scene, {"dda": metrics})))
    labels = [made_case(still, {"dda": {"mode1.damping": x}, "fem": {}}, None, 40 * "l") for x in (0.013, 0.029)]
    dense = made_history(0.001, 1 - np.cos(0.5 * np.arange(1.0, 20_001.0)))
    slow = HistoryPanel("", {"dda": dense}, {"displacement": 1.0}, None)
    assert _frequency(made_group(made_case(still, {"dda": {}, "fem": mode}))) == []
    blocks += _frequency(made_group(made_case(still, {"dda": mode, "fem": {"mode1.frequency": 360.0}})))
    reading = map(Paragraph, _reading([slow], ["displacement"], True))
    kept("damping", [*blocks, damping_table(made_group(*labels)), *reading])


def test_the_nearest_explanation_is_told_where_it_has_a_cause():
    answer = SimpleNamespace(causes=(), nearest=None, unexplained=0.0371, alike=[], departure=None, opened=(3, 17))
    for nearest in (None, {"causes": ["gg", "start"], "values": {}}):
        answer.nearest = nearest
        assert _facts(answer)[0].rows[:-1] == (("nearest", "gg and start: 3.7 % left"),) * bool(nearest)


def test_few_swings_and_driven_motions_show_all():
    x = np.sin(0.5 * np.arange(1.0, 21.0))
    histories = {"bar": made_history(0.01, x), "dda": made_history(0.01, x, x)}
    assert free_window(made_case(BASE, {"dda": {}}, histories), "contact_pressure") == pytest.approx(0.2)
    driven = made_case(BASE.with_values({"load.base_motion": "x.csv"}), {"dda": {"mode1.frequency": 345.0}}, histories)
    assert free_window(driven, "displacement") == pytest.approx(0.2)
    one = HistoryPanel("", histories, {}, "bar")
    others = (one, replace(one, histories={"dda": histories["dda"], "bar": made_history(0.01, x[:9], x[:9])}))
    assert [lead_difference(panel, "contact_pressure") for panel in others] == [None, None]


def test_a_case_without_a_step_in_the_common_time_is_left_out(drawn, tmp_path):
    """Ten steps of 1e-4 s end before the first of 0.02 s."""
    scenes = [BASE.with_values({"time.step": step}, label=True) for step in (0.02, 1e-4)]
    cases = [made_case(scene, {"dda": {}}, {"dda": made_history(scene.time.step, np.ones(10))}) for scene in scenes]
    assert history_block(made_group(*cases), ["displacement"], tmp_path).caption.startswith("1 of 2 cases.")
