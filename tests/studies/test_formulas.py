"""Formulas of rows and bands whose terms no scene tells apart: at odd numbers, beside values by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.made_cases import made_row

from validation.gates.gate import Gate, Status, Verdict
from validation.metrics.values import NOT_REPORTED
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.scenes.scene import load_scene
from validation.studies.beams import formulas as beams
from validation.studies.core import damping
from validation.studies.paper import formulas as paper
from validation.studies.paper.register import dominance_margin
from validation.studies.patch import formulas as patch
from validation.studies.slopes import formulas as slopes
from validation.studies.two_codes import formulas as two_codes
from validation.studies.waves import formulas as waves
from validation.studies.waves import rows
from validation.studies.waves.measure import Guide
from validation.suite import judging
from validation.suite.claims import Evidence
from validation.suite.matrix import reported
from validation.suite.own_solver.history import AT_REST, _bound, rest, root, shown
from validation.theory import spectra
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


def test_a_slanting_top_carries_its_load_onto_the_base():
    edges = {"top": ((0.0, 2.0), (3.0, 6.0)), "base": ((1.0, 0.0), (5.0, 2.0))}
    block = SimpleNamespace(edge=edges.get, top="top", base="base", base_length=20**0.5)
    assert two_codes.carried(SimpleNamespace(block=block, load=SimpleNamespace(pressure=7.0))) == pytest.approx(7.0)


def test_the_root_of_a_history_is_known_the_better_the_longer_it_swings():
    """Of N samples, and those a root of size |z| leaves: (1 - |z|^2 + 1/N)^(3/2)."""
    assert _bound(0.6 + 0.3j, 50) == pytest.approx(0.57**1.5)
    assert _bound(1.2j, 50) == pytest.approx(0.02**1.5)


def test_a_history_rests_in_the_middle_of_its_last_fifth():
    x = np.array([9.0] * 6 + [1.0, 4.0])
    assert rest(x) == rest(np.array([9.0, 9.0, *x])) == (2.5, 3.0)
    resting, value = shown(
        Gate("s", ("mine",), "displacement.static", 2.0, 3.0, "r"), None, History(x, {"displacement": x})
    )
    assert (resting.metric, value, resting.low + 1) == (AT_REST, 2.5, pytest.approx(-2.5e-6, rel=1e-6))
    still = History(0.1 * np.arange(1, 31), {"displacement": np.zeros(30)})
    assert root(load_scene("figures-3-4").with_values({"time.step": 0.1}), still) is None


@pytest.mark.parametrize(
    ("discount", "ratio", "error", "frequency"),
    [(1.0, 0.0, 5.98643e-06, 5.1713e-03), (0.95, 0.0751552, 1.18133e-04, 4.38609e-02)],
)
def test_a_gate_is_as_wide_as_the_noise_of_a_history(discount, ratio, error, frequency):
    scene = load_scene("figure-8").with_values({"time.alpha": 0.25, "time.delta": 0.5, "time.gg": discount})
    n = np.arange(1, 181)
    of_modes = spectra.dda_frequency(scene), spectra.contact_frequency(scene)
    slow, fast = (np.real(spectra.roots(scene, w)[0] ** n) for w in of_modes)
    x = (0.009 * slow + 0.0023 * fast - 0.013) * (1 + 3e-5 * np.sin(1e3 * n**2))
    history = History(scene.time.step * n, {"displacement": x})
    strongest, found = shown(Gate("s", ("mine",), "mode1.damping", 0.07, 0.08, "r"), scene, history)
    assert (strongest.metric, found) == ("mode1.measured_damping", pytest.approx(ratio, abs=1e-5))
    assert (0.07 - strongest.low, strongest.high - 0.08) == pytest.approx((error, error), rel=1e-3)
    natural, found = shown(Gate("s", ("mine",), "mode1.frequency", 340.0, 345.0, "r"), scene, history)
    assert found == pytest.approx(of_modes[0], rel=1e-5)
    assert (340 - natural.low, natural.high - 345) == pytest.approx((frequency, frequency), rel=1e-3)


def test_the_worst_of_some_values_is_one_that_is_none():
    assert damping._worst({"a": 2.0, "b": 3.5, "c": 1.0}) == 3.5
    assert damping._worst({"a": 2.0, "b": "not reported", "c": "undefined"}) == "not reported"


def test_dominance_is_lost_by_the_length_that_goes_with_a_strain():
    """Of the last row 1 - p/(a (i/12 + E + p/2)), i = 128 the inertia, a = 0.2 the side in another unit."""
    scene = SimpleNamespace(
        contact=SimpleNamespace(stiffness=3.0),
        block=SimpleNamespace(young=5.0, density=2.0),
        time=SimpleNamespace(alpha=0.25),
    )
    assert dominance_margin(scene, 2.0, 0.5, 0.1) == pytest.approx(1 - 3 / (0.2 * (128 / 12 + 6.5)))
    assert dominance_margin(scene, 2.0, 0.5, 60.0) == pytest.approx(1 - 3 * 120 / 134)


def test_a_history_that_is_none_settles_never():
    evidence = Evidence(SimpleNamespace(history=lambda *case: None))
    assert len(evidence.scaled("case", "displacement")) == 0 and math.isnan(evidence.settles("case", "displacement"))


def test_who_judges_says_how_far_it_is(monkeypatch):
    told = []
    monkeypatch.setattr(judging, "completed", lambda *asked: Run(Outcome.NOT_RUN))
    problems = [SimpleNamespace(name=name, scene=None) for name in "abc"]
    answered = judging.answers_of("dda", problems, lambda *far: told.append(far))
    judging.judged_sets([answered, answered], lambda *far: told.append(far))
    each = [f"dda {name}" for name in "abc"]
    assert told == [*((n, 3, each[n]) for n in range(3)), *((n, 6, (each + each)[n]) for n in range(6))]


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
    assert reported(Verdict(gate, NOT_REPORTED, Status.FAIL)).status is Status.NOT_RUN
    failed = Verdict(gate, math.pi, Status.FAIL)
    assert reported(failed) is failed
