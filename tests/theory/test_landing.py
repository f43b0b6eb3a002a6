"""The landing of the block of one strain: against the exact motion, and in its limits."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validation import load_scene
from validation.theory import landing
from validation.theory.stepping import Stepping

UNLOADED = (
    load_scene("impact")
    .expand()[0]
    .with_values({"contact.gap": 0.0, "block.velocity": -1.0, "contact.shear_stiffness": 0.0})
)


def integrated(k):
    """Return x'' = N, e''/12 + e = -N/2 on springs k, stretch by stretch, as `OwnLanding` has it."""

    def gap(_, y, closed=True):
        return y[0] - y[1] / 2

    def turns(_, y, closed=True):
        return y[2] - y[3] / 2

    def rates(_, y, closed):
        N = -k * gap(0, y) if closed else 0.0
        return [y[2], y[3], N, 12 * (-N / 2 - y[1])]

    gap.terminal = True
    turns.direction = 1
    state, closed, ends, lowest, first = np.array([0.0, 0.0, -1.0, 0.0]), True, [0.0], [], None
    while True:
        gap.direction = 1 if closed else -1
        span = ends[-1], ends[-1] + 40.0
        done = solve_ivp(rates, span, state, "DOP853", rtol=1e-12, atol=1e-14, events=[gap, turns], args=(closed,))
        if not len(done.t_events[0]):
            contacts = len(ends) // 2
            return float(state[2]), first, max(lowest) * math.sqrt(4 * k), ends[1], contacts
        state = done.y[:, -1]
        ends.append(done.t[-1])
        first = turns(0, state) if first is None else first
        lowest += [-gap(0, y) for y in done.y_events[1]] if closed else []
        closed = not closed


@pytest.mark.parametrize("ratio", [pytest.param(0.37, marks=pytest.mark.long), 41.0])
def test_the_own_landing_is_that_of_its_equations(ratio):
    own = landing.own_landing(2 * ratio)
    restitution, first, depth, duration, contacts = integrated(2 * ratio)
    assert own.restitution == pytest.approx(restitution, abs=1e-9)
    assert (own.first_rate, own.duration) == (pytest.approx(first, abs=1e-9), pytest.approx(duration, abs=1e-9))
    assert own.depth == pytest.approx(depth, rel=1e-6) and own.contacts == contacts


def test_springs_next_to_rigid_land_as_the_rigid_stop():
    """Where rounding would hide the gap: a contact at k = 1e291 has an end."""
    below, above = (landing.own_landing(factor * landing.STIFFEST) for factor in (1.0, 1 + 1e-9))
    for name in ("restitution", "first_rate", "depth"):
        assert getattr(below, name) == pytest.approx(getattr(above, name), rel=1e-6)
    assert below.duration == pytest.approx(above.duration, rel=1e-8)
    assert below.contacts == above.contacts == landing.own_landing(1e291).contacts


def test_the_force_of_a_wave_is_its_impedance_times_the_speed():
    scene = UNLOADED.with_values({"block.density": 2100.0, "block.young": 7e8})
    expected = 1.7 * math.sqrt(7e8 * 2100.0) * scene.block.base_length
    assert landing.wave_force(scene, -1.7) == pytest.approx(expected, rel=1e-12)


def test_a_step_hides_that_a_pressed_block_leaves_its_springs():
    pressed = load_scene("open-close").expand()[0].with_values({"load.gravity": 30.0, "time.alpha": 0.3})
    pressed = pressed.with_values({"time.start": "zero", "contact.gap": 0.0})
    block, h = pressed.block, pressed.block.extent[1]
    weight = block.density * 30.0 * h / pressed.load.pressure
    expected = h / math.sqrt(block.young / block.density) * math.sqrt((1 - weight / 2) / (1 + weight) / 1.8)
    assert landing.hidden_from(pressed) == pytest.approx(expected, rel=1e-12)
    for values in (
        {"load.gravity": -1e6},  # it leaves them at every step
        {"load.gravity": 1e6},
        {"time.start": "consistent"},
        {"time.alpha": 0.0, "time.delta": 0.5},
        {"contact.gap": 1e-4},
        {"block.velocity": -0.1},
        {"load.pressure": 0.0},
        {"time.scheme": "chung-hulbert", "time.rho_inf": 0.5},
    ):
        assert landing.hidden_from(pressed.with_values(values)) is None, values
    assert landing.hidden_from(pressed.with_values({"time.start": "consistent", "time.alpha": 0.5})) is not None


def test_some_steps_and_rules_put_no_energy_into_a_contact():
    for values, expected in (
        ({"time.alpha": 0.5, "time.delta": 1.0}, True),
        ({"time.alpha": 0.49, "time.delta": 1.0}, False),
        ({"time.alpha": 0.6, "time.delta": 0.99}, False),
        ({"time.alpha": 0.25, "time.delta": 0.5}, False),
        ({"time.alpha": 0.25, "time.delta": 0.5, "contact.rule": "implicit"}, True),
        ({"time.scheme": "wbz", "time.rho_inf": 0.0}, False),
    ):
        assert landing.cannot_gain(UNLOADED.with_values(values)) is expected, values


def test_springs_too_soft_for_double_precision_are_refused():
    with pytest.raises(FloatingPointError):
        landing.stiffness_ratio(UNLOADED.with_values({"block.young": 1e300, "contact.stiffness": 1e-30}))


def test_a_block_next_to_rigid_lands_in_closed_form(monkeypatch):
    """The rigid blocks of the study `rebound` have k down to 1e-16, at which strain rings 1e8 times in a contact."""
    above, below = (landing.own_landing(factor * landing.SOFTEST) for factor in (1.0, 1 - 1e-9))
    for name, band in (("restitution", 1e-12), ("first_rate", 1e-6), ("depth", 1e-9)):
        assert getattr(below, name) == pytest.approx(getattr(above, name), abs=band)
    assert below.duration == pytest.approx(above.duration, rel=1e-9)
    assert below.contacts == above.contacts == 1

    def ring(*_, **__):
        raise AssertionError("the contact is followed from wave to wave")

    monkeypatch.setattr(landing._Motion, "gap", ring)
    assert landing.own_landing(1.08e-16).duration == pytest.approx(math.pi / math.sqrt(1.08e-16))
    rigid_block = load_scene("rebound-constant").expand()[0]
    expected = math.sqrt(2 * rigid_block.contact.stiffness / rigid_block.block.mass)
    assert landing.contact_frequency(rigid_block) == pytest.approx(expected, rel=1e-6)


def test_a_landing_of_very_many_steps_is_not_stepped():
    few, many = (landing.stepped_landing(Stepping(1.0, 0.5, 1.0), 2.0, step, 1.0) for step in (4e-3, 1e-5))
    assert few is not None and many is None
