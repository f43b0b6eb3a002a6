"""Soft constraints of engines: their numbers, against a motion that is integrated and engines' loops written anew."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validation.theory.soft_contact import (
    PHASES,
    Impedance,
    SoftContact,
    curve_rebounds,
    effective_mass,
    implicit_ratio,
    implicit_step,
    local_damping_ratio,
    local_damping_restitution,
)

GRAVITY = 9.81
SUBSTEP = 1 / 240


@pytest.mark.parametrize(
    ("hertz", "penetration", "determinant"), [(30, 0.276100e-3, 0.05772068), (60, 0.069025e-3, 0.02866699)]
)
def test_a_box2d_contact_at_rest_and_in_a_step(hertz: float, penetration: float, determinant: float) -> None:
    for mass in (1.0, 2700.0):  # neither depends on the mass
        contact = SoftContact.of_box2d(mass, hertz, 10.0)
        assert contact.rest_penetration(mass * GRAVITY) == pytest.approx(penetration, abs=5e-10)
        assert contact.determinant(SUBSTEP) == pytest.approx(determinant, abs=5e-9)
        assert contact.rebounds(SUBSTEP).max() < 0.0021


def test_a_mujoco_contact_at_rest() -> None:
    contact = SoftContact.of_mujoco(3.0, 0.02, 1.0, 0.95, 1.0)
    assert contact.rest_penetration(3.0 * GRAVITY) == pytest.approx(0.196200e-3, abs=5e-10)
    assert (contact.frequency, contact.ratio) == pytest.approx((50.0, 1.0))


def test_the_effective_mass_is_not_the_mass() -> None:
    m, h = 10800.0, 2.0
    base = effective_mass(1 / m, (h / 2) ** 2 / (m * h**2 / 12))
    assert base == pytest.approx(m / 4)
    assert effective_mass(1 / 2.0, 1 / 6.0) == pytest.approx(1.5)
    stiffness = [SoftContact.of_box2d(mass, 30.0, 10.0).stiffness for mass in (base, m)]
    assert stiffness[1] / stiffness[0] == pytest.approx(4)


@pytest.mark.parametrize(("omega", "mean"), [(0.1, 0.6359), (1.0, 0.1875), (10.0, 0.0053)])
def test_rebounds_of_steps(omega: float, mean: float) -> None:
    assert SoftContact.of_ratio(7.0, omega / 0.01, 0.1).rebounds(0.01).mean() == pytest.approx(mean, abs=5e-5)


@pytest.mark.parametrize(("ratio", "omega"), [(0.0, 0.37), (0.13, 0.8), (1.0, 0.4), (2.5, 1.7)])
def test_a_box2d_substep_is_that_of_the_engine(ratio: float, omega: float) -> None:
    """The engine's own arithmetic: soft factors, an impulse that is clipped, and a velocity."""
    h, mass = 0.004, 3.0
    contact = SoftContact.of_ratio(mass, omega / h, ratio)
    a1 = 2 * ratio + omega
    a2 = omega * a1
    bias_rate = omega / h / a1
    x, v = -0.01, 0.3
    impulse = -mass * a2 / (1 + a2) * (v + bias_rate * x)
    v1 = v + impulse / mass
    assert contact.step_matrix(h) @ [x, h * v] == pytest.approx([x + h * v1, h * v1], abs=1e-15)
    assert contact.determinant(h) == pytest.approx(1 / (1 + a2), rel=1e-12)


@pytest.mark.parametrize("implicit", [True, False])
def test_rebounds_are_those_of_one_landing_after_the_other(implicit: bool) -> None:
    mass, w, zeta, h = 2.0, 90.0, 0.2, 0.008
    contact = SoftContact(mass, mass * w**2, 2 * zeta * mass * w, implicit=implicit)
    values = []
    for i in range(200):
        x, v, landed = (i + 0.5) / 200 * h, -1.0, False
        for _ in range(1000):
            place = x + h * v if implicit else x
            if place < 0:
                landed = True
                force = -(contact.stiffness * place + contact.damping * v)
                if implicit:
                    force /= 1 + h * contact.damping / mass + h**2 * contact.stiffness / mass
                v += h * max(force, 0.0) / mass
            x += h * v
            if landed and x >= 0 and v >= 0:
                break
        values.append(v)
    assert contact.rebounds(h) == pytest.approx(np.array(values), abs=1e-12)


@pytest.mark.parametrize(
    "solimp", [(0.9, 0.95, 0.001, 0.5, 2.0), (0.5, 0.99, 0.01, 0.3, 3.0), (0.9, 0.9, 0.1, 0.5, 1.0)]
)
def test_a_mujoco_impedance_at_rest_is_where_the_motion_ends(solimp: tuple[float, ...]) -> None:
    timeconst, dampratio = 0.03, 1.2
    curve = Impedance(*solimp)

    def slope(_: float, y: np.ndarray) -> list[float]:
        r, v = y
        d = curve(-r) if r < 0 else 0.0
        b = 2 / (curve.greatest * timeconst)
        k = d / (curve.greatest * timeconst * dampratio) ** 2
        return [v, -d * (b * v + k * r) - (1 - d) * GRAVITY]

    end = solve_ivp(slope, (0, 5), [-1e-3, 0.0], rtol=1e-10, atol=1e-14, method="LSODA").y[0, -1]
    d = curve.at_rest(1 / (timeconst * dampratio), GRAVITY)
    contact = SoftContact.of_mujoco(1.0, timeconst, dampratio, d, d / curve.greatest)
    assert contact.rest_penetration(GRAVITY) == pytest.approx(-end, rel=1e-5)


def test_bullet_is_the_same_step_in_other_words() -> None:
    h, erp, cfm = 0.01, 0.3, 2e-5
    contact = SoftContact.of_bullet(4.0, erp, cfm, h)
    x, v = -0.02, -0.5
    # erp and cfm as they are defined: v1 + cfm lambda = -erp x / h with the impulse lambda h
    force = -(erp * x / h + v) / (cfm + h / 4.0)
    v1 = v + h * force / 4.0
    assert contact.step_matrix(h) @ [x, h * v] == pytest.approx([x + h * v1, h * v1], abs=1e-15)
    assert math.isclose(contact.stiffness * h / (contact.stiffness * h + contact.damping), erp)


@pytest.mark.parametrize("is_ball", [True, False])
def test_a_landing_by_steps_of_bullet(is_ball: bool) -> None:
    """Its constraint row: an impulse towards the velocity that closes a gap, or that corrects an overlap by erp."""
    m, k, c, h, g, V = 3.0, 4e4, 150.0, 1 / 300, 9.81, 0.8
    cfm = 1 / (h * k + c) / h
    erp = h * k / (h * k + c)
    measured = []
    for phase in (np.arange(PHASES) + 0.5) / PHASES:
        x, v, impulse, has_touched = phase * V * h, -V, 0.0, False
        while not (has_touched and x >= 0 and v >= 0):
            free = v - g * h
            wanted = -x / h if x > 0 else -erp * x / h
            acts = is_ball or x < 0
            impulse = max((wanted - free) / (1 / m + cfm), 0.0) if acts else 0.0
            has_touched |= impulse > 0
            v = free + impulse / m
            x += h * v
        measured.append(v / V)
    contact = SoftContact(m, k, c, stops_ahead=is_ball, starts_inside=not is_ball)
    assert contact.rebounds(h, g * h / V) == pytest.approx(np.array(measured), rel=1e-9)


@pytest.mark.parametrize("alpha", [0.05, 0.2, 0.6])
def test_damping_of_all_forces(alpha: float) -> None:
    contact = SoftContact(2.0, 2e4, 0.0, implicit=False, local_damping=alpha)
    assert contact.rebounds(1e-5).mean() == pytest.approx(local_damping_restitution(alpha), rel=1e-3)
    # over a cycle the amplitude falls by e^2, which is that of a viscous damping up to its square
    assert math.exp(-2 * math.pi * local_damping_ratio(alpha)) == pytest.approx(local_damping_restitution(alpha) ** 2)


@pytest.mark.parametrize("W", [1e-3, 0.3, 4.0])
def test_implicit_steps_damp_a_spring_by_their_roots(W: float) -> None:
    contact = SoftContact(1.0, W**2, 0.0)
    root = np.log(np.linalg.eigvals(contact.step_matrix(1.0))[0])
    assert contact.numerical_ratio(1.0) == pytest.approx(-root.real / abs(root), rel=1e-6)
    assert implicit_step(implicit_ratio(W)) == pytest.approx(W, rel=1e-9)


@pytest.mark.parametrize("points", [1, 4])
def test_a_curve_of_one_impedance_is_that_impedance(points: int) -> None:
    curve = Impedance(0.9, 0.9)
    contact = SoftContact.of_mujoco(5.0, 0.03, 0.7, 0.9, 1.0, points)
    expected = contact.rebounds(0.002, 9.81 * 0.002 / 2.5)
    assert curve_rebounds(curve, 0.03, 0.7, points, 0.002, 2.5, 9.81) == pytest.approx(expected, rel=1e-9)
    direct = SoftContact.of_mujoco(5.0, -1 / (0.03 * 0.7) ** 2, -2 / 0.03, 0.9, 1.0, points)
    assert (direct.stiffness, direct.damping) == pytest.approx((contact.stiffness, contact.damping))
