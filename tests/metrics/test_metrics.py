"""Metrics against signals whose answers are known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from validation.metrics import poles as pencil
from validation.metrics.catalogue import pair, solo
from validation.metrics.columns import first_peak, settling_step
from validation.metrics.measurable import Measurable
from validation.metrics.modes import operator_damping, operator_frequency
from validation.metrics.pairs import relative_l2, relative_max
from validation.metrics.values import NOT_REPORTED, UNDEFINED, ratio
from validation.runs.history import History
from validation.runs.modes import Mode
from validation.runs.run import Outcome


def test_norms_neither_overflow_nor_vanish():
    x, y = np.array([3.0, 4.0]), np.array([0.0, 0.0])
    for scale in (1.0, 1e300, 1e-300):
        assert relative_l2(1.5 * x * scale, x * scale) == pytest.approx(0.5, rel=1e-15)
        assert relative_max(x * scale, 0.5 * x * scale) == pytest.approx(1.0, rel=1e-15)
    assert relative_l2(x, y) == relative_max(y, y) == UNDEFINED


def test_settling_step_counts_from_one():
    x = np.array([0.5, 1.2, 1.005, 0.98, 1.009, 1.0])
    assert settling_step(x, 1.0) == 5
    assert settling_step(x[:4], 1.0) == UNDEFINED
    assert settling_step(np.ones(3), 1.0) == 1
    assert settling_step(x, 0.0) == UNDEFINED


def test_first_peak_is_the_top_of_the_first_excursion_beyond_static():
    x = -np.array([0.2, 0.9, 1.4, 1.6, 1.5, 1.7, 0.8, 1.9])
    assert first_peak(x, -1.0) == 5
    assert first_peak(x[:4], -1.0) is None
    assert first_peak(0.5 * np.ones(4), 1.0) is None


def test_damping_of_an_operator_by_kind_of_roots():
    xi, w = 0.2, 0.5
    root = np.exp((-xi + 1j * math.sqrt(1 - xi * xi)) * w)
    assert operator_damping((root, root.conjugate())) == pytest.approx(xi, rel=1e-14)
    assert operator_frequency((root, root.conjugate()), 0.1) == pytest.approx(5.0, rel=1e-14)
    a, b = 0.3, 0.7  # decay rates of an overdamped mode: xi = (a + b) / (2 sqrt(a b))
    assert operator_damping((math.exp(-a), math.exp(-b))) == pytest.approx(0.5 / math.sqrt(0.21), rel=1e-14)
    assert operator_damping((-0.5, 0.2)) == operator_damping((0.5, 0.0)) == UNDEFINED
    assert operator_frequency((-0.5, 0.2), 1.0) == UNDEFINED


def test_absent_and_undefined_are_different_things():
    flat = Measurable(History(np.arange(1.0, 9.0), {"displacement": np.zeros(8)}), 1.0, {"displacement": 0.0}, ())
    found = solo(flat)
    assert found["displacement.settling_step"] == found["displacement.peak"] == UNDEFINED
    assert found["pressure.final"] == found["mode1.frequency"] == NOT_REPORTED
    assert pair("pressure.l2", flat.history, flat.history) == NOT_REPORTED
    assert pair("displacement.l2", flat.history, flat.history) == UNDEFINED
    assert ratio(UNDEFINED, 1.0) == UNDEFINED


@pytest.mark.parametrize(
    ("radius", "outcome", "word"),
    [
        (1 - 1e-6, Outcome.COMPLETED, "stable"),
        (1.0, Outcome.COMPLETED, "marginal"),
        (1 + 1e-6, Outcome.COMPLETED, "unstable as predicted"),
        (1.1, Outcome.OVERFLOW, "overflow"),
        (math.inf, Outcome.COMPLETED, NOT_REPORTED),
        (None, Outcome.COMPLETED, NOT_REPORTED),
    ],
)
def test_a_run_is_called_by_the_radius_of_its_step(radius, outcome, word):
    diagnostics = {} if radius is None else {"predicted_radius": radius}
    m = Measurable(History(np.zeros(0), {}), 1.0, diagnostics=diagnostics, outcome=outcome)
    assert solo(m, ("stability",))["stability.kind"] == word


def test_no_metric_is_ever_nan():
    broken = History(np.arange(1.0, 9.0), {"displacement": np.full(8, np.inf), "contact_pressure": np.full(8, -np.inf)})
    for static in (1.0, 0.0, math.inf):
        modes = (Mode(1.0, 1.0, (0.5 + 0.1j, 0.5 - 0.1j)),)
        values = solo(Measurable(broken, 1.0, {"displacement": static, "contact_pressure": static}, modes))
        assert not [key for key, value in values.items() if isinstance(value, float) and not math.isfinite(value)]


def test_a_fast_mode_is_no_slow_one_where_every_tenth_sample_is_read():
    """It turns by 2.9 rad a step, and ten of them look like a mode of 0.26 rad in ten steps; a zigzag turns by pi."""
    n, frequency, dt = np.arange(6000), 200.0, 1e-4
    found = pencil.poles(np.cos(frequency * dt * n) + 0.5 * np.cos(2.9 * n) + 2 * (-1.0) ** n, dt)
    assert [pole.frequency for pole in found] == pytest.approx([frequency], rel=1e-6)


def test_the_drift_of_a_modes_energy_is_that_from_the_first_to_the_last_steps():
    growth, n = 1 + 1e-6, np.arange(10_000)
    root = np.exp(0.5j)
    history = History(n + 1.0, {"displacement": 1 + 0.1 * growth**n * np.cos(0.5 * n)})
    m = Measurable(history, 1.0, {"displacement": 1.0}, (Mode(0.5, 1.0, (root, root.conjugate())),))
    assert solo(m, ("energy",))["energy.drift"] == pytest.approx(2 * 6000e-6, rel=1e-2)  # 6000 steps between the two
    short = History(n[:3000] + 1.0, {"displacement": np.cos(0.5 * n[:3000])})
    assert solo(replace(m, history=short), ("energy",))["energy.drift"] == UNDEFINED
    assert solo(replace(m, modes=()), ("energy",))["energy.drift"] == NOT_REPORTED
