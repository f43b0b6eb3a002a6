"""Metrics of short histories with odd numbers, beside values worked out by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from validation.metrics import contact, growth, modes, rotation
from validation.metrics.catalogue import pair
from validation.metrics.measurable import Measurable
from validation.metrics.poles import LARGEST_MISFIT, poles, swing
from validation.metrics.transform import spectrum
from validation.metrics.values import NOT_REPORTED, UNDEFINED, ratio
from validation.runs.contact import ContactRecord
from validation.runs.history import History
from validation.runs.modes import Mode
from validation.runs.run import Outcome

TIME = 0.25 * np.arange(1, 8)
VALUES = np.array([0.5, 2.5, 3.5, 2.75, 1.5, 2.125, 1.75])
PRESSED = np.array([3.0, -2.0, -5.0, 1.0, -4e-14, 2.0, 4.0])


@pytest.fixture
def made():
    history = History(TIME, {"displacement": VALUES, "contact_pressure": PRESSED})
    return Measurable(history, 0.25, {"displacement": 2.0})


def test_ratios():
    assert ratio(3.0, 4.0) == -0.25
    assert ratio(UNDEFINED, 4.0) == UNDEFINED and ratio(3.0, NOT_REPORTED) == NOT_REPORTED
    assert ratio(3.0, 0.0) == UNDEFINED


def test_a_spectrum_is_a_sum():
    omega = np.array([0.7, 3.1])
    by_hand = [sum(v * np.exp(-1j * w * t) for t, v in zip(TIME, VALUES, strict=True)) for w in omega]
    assert spectrum(TIME, VALUES, omega) == pytest.approx(np.array(by_hand), rel=1e-13)


def test_growth_is_that_of_the_last_values():
    n = np.arange(60)
    developed = 1e-9 * 1.5**n + 1e-12 * (-1.1) ** n
    assert growth.growth(developed) == pytest.approx(1.5, rel=1e-9)
    turning = 1e-9 * 1.4**n * np.cos(0.9 * n + 0.3)  # two roots
    assert growth.growth(turning) == pytest.approx(1.4, rel=1e-6)
    assert growth.growth(np.append(developed, [np.inf, np.nan])) == pytest.approx(1.5, rel=1e-9)
    assert growth.growth(1.1 ** np.arange(8.0)) is None  # has not grown
    assert growth.growth(developed[:7]) is None and growth.growth(np.zeros(20)) is None
    run = Measurable(History(n, {"displacement": developed}), 1.0, outcome=Outcome.COMPLETED)
    assert growth.growth_of_run(run) == UNDEFINED
    left = replace(run, outcome=Outcome.OVERFLOW)
    assert growth.growth_of_run(left) == pytest.approx(1.5, rel=1e-9)
    assert growth.growth_of_run(replace(left, history=History(n, {"displacement": np.ones(60)}))) == UNDEFINED


def test_angles_and_landings():
    values = np.array([-1.0, 0.0, 1.0, 4.0, 2.0])
    time = np.array([1.0, 2.0, 4.0, 5.0, 7.0])
    assert rotation.crossing(time, values, 2.5) == pytest.approx(4.5)
    assert rotation.crossing(time, values, 0.5) == pytest.approx(3.0)
    assert math.isnan(rotation.crossing(time, values, 9.0)) and math.isnan(rotation.crossing(time, values, -2.0))
    gap = np.array([7.0, 5.0, 4.0, -1.0, 3.0])
    assert rotation.landing(time, gap) == pytest.approx(4.0 + 4.0 / 1.0 * 2.0)
    assert rotation.landing(time, np.array([4.0, 1.0, -1.0, 2.0, 2.0])) == pytest.approx(2.0 + 1.0 / 3.0)
    assert math.isnan(rotation.landing(time, np.array([1.0, -1.0, 2.0, 2.0, 2.0])))
    assert math.isnan(rotation.landing(time, np.ones(5)))
    turned = History(time, {"rotation": np.array([0.25, 0.75, 0.5, 0.5, 2.0])})
    assert rotation.increments(turned).tolist() == [0.25, 0.5, -0.25, 0.0, 1.5]


def record(**parts):
    nothing = np.zeros(len(TIME))
    given = {
        "time": TIME,
        "force": np.array([0.0, 0.0, 4.0, 0.0, 0.0, 3.0, 0.0]),
        **dict.fromkeys(("impulse", "penetration", "gap"), nothing),
        "open_share": np.array([1.0, 1.0, 0.0, 1.0, 1.0, 0.5, 1.0]),
        "energies": dict.fromkeys(contact.STORED, nothing),
        "start_energy": 8.0,
        "input_energy": 4.0,
        "velocity": np.array([-1.0, -2.0, -0.5, 1.0, 0.75, -3.0, 1.5]),
        "start_velocity": -0.125,
    }
    return ContactRecord(**given | parts)


def test_landings_by_hand():
    assert contact.restitution(record()) == 1.5 / 2.0
    before, after = contact.landing(record())
    assert before == -2.0 and after.tolist() == [1.0, 0.75, 1.5]
    at_once = record(force=np.array([1.0, 0, 0, 0, 0, 0, 0]))
    assert contact.landing(at_once)[0] == -0.125
    assert contact.restitution(record(force=np.zeros(7))) == UNDEFINED
    assert contact.landing(record(force=np.zeros(7)))[0] == 0.0
    rising = record(velocity=np.array([-1.0, 0.5, -0.5, 1.0, 0.75, -3.0, 1.5]))
    assert contact.restitution(rising) == UNDEFINED
    assert contact.restitution(record(velocity=None)) == NOT_REPORTED


def test_energies_by_hand():
    kinetic = np.array([8.0, 7.0, 6.0, 9.0, 8.0, 7.0, 6.0])
    lost = np.array([0.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0])
    energies = record().energies | {"kinetic": kinetic}
    of = record(energies=energies)
    assert contact.rise(of) == 0.25
    assert contact.rise(record(energies={})) == contact.imbalance(of) == NOT_REPORTED
    names = dict.fromkeys((*contact.LOST, *contact.LOST_AT_IMPACTS), np.zeros(7))
    balanced = record(energies=energies | names | {contact.LOST_AT_IMPACTS[0]: lost})
    defects = kinetic + lost - 8.0
    assert contact.imbalance(balanced) == np.max(np.abs(defects)) / 9.0
    switched = record(energies=energies | names | {contact.LOST[2]: lost})
    assert contact.switching(switched) == -0.75


def test_pairs_by_hand():
    first = History(TIME, {"displacement": VALUES})
    second = History(TIME, {"displacement": VALUES + 0.5})
    size = math.sqrt(sum((VALUES + 0.5) ** 2))
    assert pair("displacement.l2", first, second) == pytest.approx(math.sqrt(7 * 0.25) / size)
    assert pair("displacement.max", first, second) == pytest.approx(0.5 / 4.0)
    for static, error in ((-3.0, 0.125), (-5.0, 0.1)):
        assert pair("displacement.scaled", first, second, {"displacement.static": static}) == pytest.approx(error)
    assert pair("displacement.scaled", first, second, {}) == NOT_REPORTED
    assert pair("pressure.scaled", first, second, {"pressure.static": 1.0}) == NOT_REPORTED
    longer = History(np.append(TIME, 2.0), {"displacement": np.append(VALUES, 90.0)})
    assert pair("displacement.max", longer, second) == pair("displacement.max", first, second)


def test_a_swing_is_about_a_constant_or_the_mean_of_the_end():
    n = np.arange(80)
    signal = 3.0 + 2.0 * 0.97**n * np.cos(0.4 * n + 0.2)
    found = swing(signal, 0.5)
    assert found.static == pytest.approx(3.0, rel=1e-8)
    assert found.pole.amplitude == pytest.approx(2.0, rel=1e-6)
    assert found.pole.frequency == pytest.approx(abs(np.log(0.97) + 0.4j) / 0.5, rel=1e-8)
    noise = np.random.default_rng(7).normal(size=80)
    assert swing(noise, 0.5).static == pytest.approx(np.mean(noise[-8:]))
    assert swing(noise[:12], 0.5, order=2).static == pytest.approx(np.mean(noise[10:12]))
    assert swing(signal[:15], 0.5).pole is None and swing(signal[:16], 0.5).static == pytest.approx(3.0)
    assert swing(np.zeros(40), 0.5).static is None
    assert poles(noise, 0.5, order=2) == [] and LARGEST_MISFIT < 1
    assert not poles(np.full(40, np.inf), 0.5) and not poles(np.zeros(40), 0.5)
    assert not poles(0.5 ** np.arange(50), 0.5) and not poles(np.ones(3), 0.5)
    (only,) = poles(signal - 3.0, 0.5)
    assert only.damping == pytest.approx(-np.log(0.97) / abs(np.log(0.97) + 0.4j), rel=1e-8)


def test_limits_and_horizons_are_those_of_what_is_asked(made):
    assert growth.limit(made) == NOT_REPORTED and growth.limit(replace(made, limit=lambda: 1.75)) == 1.75
    shadow = History(TIME, {"displacement": VALUES, "rotation": np.zeros(7)})
    run = History(TIME, {"displacement": VALUES, "rotation": np.ones(7)})
    assert contact.horizon(replace(made, history=run, shadow=lambda: shadow)) == TIME[-1]


def test_numbers_of_modes_by_hand(made):
    roots = (0.6 + 0.3j, 0.6 - 0.3j), (-0.9 + 0j, 0.4 + 0j)
    of = replace(
        made, modes=(Mode(9.0, 0.1, roots[0], 0.3), Mode(4.0, 0.7, roots[1], -0.9), Mode(6.5, 0.2, roots[0], 0.5))
    )
    assert [modes.natural(of, number) * 2 * math.pi for number in (1, 2, 3)] == pytest.approx([4.0, 6.5, 9.0])
    assert (
        modes.natural(of, 4) == NOT_REPORTED == modes.first_axial(made, "frequency") == modes.contact(made, "damping")
    )
    size = abs(np.log(0.6 + 0.3j))
    assert modes.first_axial(of, "numerical_frequency") == pytest.approx(size / 0.25, rel=1e-13)
    assert modes.first_axial(of, "damping") == pytest.approx(-math.log(math.hypot(0.6, 0.3)) / size, rel=1e-13)
    assert modes.first_axial(of, "frequency") == 9.0
    assert modes.contact(of, "least_root") == -0.9 and modes.contact(of, "damping") == UNDEFINED
    assert modes.contact(of, "spectral_radius") == pytest.approx(0.9)


def test_what_only_turns_has_no_centre_of_its_own():
    n = np.arange(80)
    assert swing(2 * 0.97**n * np.cos(0.4 * n), 0.5, order=2).static is None
