"""Formulas of rows and bands whose terms no scene tells apart: at odd numbers, beside values by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.made_cases import made_row

from validation.gates.gate import Gate, Status, Verdict
from validation.metrics.values import NOT_REPORTED
from validation.runs.history import History
from validation.scenes.scene import load_scene
from validation.studies.beams import formulas as beams
from validation.studies.paper import formulas as paper
from validation.studies.patch import formulas as patch
from validation.studies.slopes import formulas as slopes
from validation.studies.two_codes import formulas as two_codes
from validation.studies.waves import formulas as waves
from validation.studies.waves import rows
from validation.studies.waves.measure import Guide
from validation.suite.matrix import _reported
from validation.suite.own_solver.block_data import (
    scenes,
)
from validation.suite.own_solver.gates import shown_by_history
from validation.suite.own_solver.history import _bound, rest, root
from validation.theory import waves as theory_of_waves
from validation.theory.stepping import Stepping


def test_the_order_of_blocks_in_a_beam_is_that_of_the_last_halving():
    elements = made_row("fem", {"displacement.static": 2.0, "frequency.1": 40.0, "frequency.2": "undefined"})
    levels = []
    for static, frequency in ((9.0, 9.0), (2.16, 41.2), (2.02, 40.6)):
        row = made_row("dda", {"displacement.static": static, "frequency.1": frequency, "frequency.2": 1.0, "x": 1.0})
        levels.append((None, row, elements))
    assert beams.ratios(*levels[1]) == pytest.approx({"displacement.static": 1.08, "frequency.1": 1.03})
    assert beams.orders(levels) == pytest.approx({"displacement.static": 3.0, "frequency.1": 1.0})


@pytest.mark.parametrize(
    ("hypothesis", "modulus", "ratio"), [("plane stress", 7.0, 0.2), ("plane strain", 7 / 0.96, 0.25)]
)
def test_a_patch_is_longer_by_both_stresses(hypothesis, modulus, ratio):
    plane = SimpleNamespace(
        polygons=[[(1, 0), (2, 5)], [(2, 1), (4, 0)]],
        stress=(2.0, 5.0, 9.0),
        young=7.0,
        poisson=0.2,
        hypothesis=hypothesis,
    )
    case = SimpleNamespace(table=lambda section: plane)
    assert patch._elastic(case) == pytest.approx(3 * (2 - ratio * 5) / modulus)


def test_waves_in_a_layer_are_told_by_its_blocks(monkeypatch):
    layer = SimpleNamespace(thickness=6.0, blocks=4, density=3.0)
    column = SimpleNamespace(layer=[layer], modulus=lambda layer: 12.0, glue=5.0)
    monkeypatch.setattr(waves, "column_of", lambda case: column)
    case = SimpleNamespace(time=SimpleNamespace(step=0.31, alpha=0.25, delta=0.5, discount=0.98))
    assert waves.closed(case) == {"courant": 0.413333, "scheme": "0.25, 0.5, 0.98", "glue": 0.625}
    column.glue = None
    assert "glue" not in waves.closed(case)


def test_what_a_history_shows_is_asked_of_it():
    square = load_scene("figures-3-4").with_values({"time.step": 0.002})
    flat = square.with_values({"block.poisson": 0.2})
    rows = [
        (square, ("mine",), "displacement.static", True),
        (square, ("mine", "dda-60"), "displacement.static", False),
        (flat, ("mine",), "displacement.static", False),
        (scenes()[1], ("mine",), "displacement.static", True),
        (scenes()[1], ("mine",), "mode1.frequency", False),
        (square, ("mine",), "mode1.frequency", True),
        (square, ("mine",), "stability.growth", False),
    ]
    for scene, pair, metric, is_shown in rows:
        assert shown_by_history(Gate("s", pair, metric, 0.0, 1.0, "r"), scene) == is_shown, (scene.name, pair, metric)


def test_a_slanting_top_carries_its_load_onto_the_base():
    edges = {"top": ((0.0, 2.0), (3.0, 6.0)), "base": ((1.0, 0.0), (5.0, 2.0))}
    block = SimpleNamespace(edge=edges.get, top="top", base="base", base_length=20**0.5)
    assert two_codes.carried(SimpleNamespace(block=block, load=SimpleNamespace(pressure=7.0))) == pytest.approx(7.0)


def test_the_root_of_a_history_is_known_the_better_the_longer_it_swings():
    """Of N samples, and those a root of size |z| leaves: (1 - |z|^2 + 1/N)^(3/2)."""
    assert _bound(0.6 + 0.3j, 50) == pytest.approx(0.57**1.5)
    assert _bound(1.2j, 50) == pytest.approx(0.02**1.5)


def test_a_history_rests_in_the_middle_of_its_last_fifth():
    assert rest(np.array([9.0] * 8 + [1.0, 4.0])) == (2.5, 3.0)
    still = History(0.1 * np.arange(1, 31), {"displacement": np.zeros(30)})
    assert root(load_scene("figures-3-4").with_values({"time.step": 0.1}), still) is None


def test_modes_are_told_by_their_angle_in_a_step():
    case = SimpleNamespace(time=SimpleNamespace(step=0.002))
    frequencies = {"mode1.frequency": 50.0, "contact.frequency": 1e9}
    assert paper.angles(case, made_row("dda", frequencies)) == {"mode1": pytest.approx(0.1)}


def test_a_wave_of_blocks_has_the_wavenumber_that_its_middles_have():
    column = theory_of_waves.Column(height=0.7, density=3.0, modulus=5.0)
    guide = Guide(column, 1.29, 3.9, Stepping(0.01, 0.25, 0.5), omega=2 * math.pi / 0.5)
    time = 0.01 * np.arange(1, 151)  # three periods
    columns = {f"x{n}": 0.3 * np.cos(guide.omega * time - 1.3 * n * 0.7 + 0.2) for n in range(3)}
    assert guide.measured(History(time, columns), list(columns)) == pytest.approx(1.3)


def test_the_order_of_a_joint_is_that_at_which_it_tends_to_the_continuum(monkeypatch):
    continuum = float(theory_of_waves.joint_transmission(1.0))
    guided = [SimpleNamespace(blocks=n, guide=n, scene=SimpleNamespace(name="s"), solver="dda") for n in (10, 20, 40)]
    monkeypatch.setattr(rows, "averaged", lambda: guided)
    for sign, order in ((1, pytest.approx(1.7)), (-1, "undefined")):
        parts = {n: (1j * continuum + 1j * sign * n**-1.7, 0.0) for n in (10, 20, 40)}
        monkeypatch.setattr(rows, "joint_parts", lambda guide, *given, parts=parts: parts[guide])
        finished = SimpleNamespace(needed_history=lambda *given: None)
        assert rows.joint_order(finished) == {"joint.order": order}


def test_a_block_stands_that_rests_on_its_slope_and_does_not_slip():
    def told(angle, slip_rate):
        case = load_scene("field-sliding").with_values({"load.slope": angle})
        return slopes.start(case, made_row("dda", {"contact.slip_rate": slip_rate}))

    assert told(3.0, 1e-13) == {"state": "stands", "slip": 0.0}
    assert told(3.0, 0.7) == {"slip": 0.7} and told(60.0, 1e-13) == {"slip": 1e-13}


def test_what_a_solver_cannot_report_is_no_failure():
    gate = Gate("s", ("mine",), "m", 0.0, 1.0, "r")
    assert _reported(Verdict(gate, NOT_REPORTED, Status.FAIL)).status is Status.NOT_RUN
    failed = Verdict(gate, math.pi, Status.FAIL)
    assert _reported(failed) is failed
