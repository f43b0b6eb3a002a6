"""Quadratures and closed forms of rigid and strained motions against their equations, from Newton's laws once more."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import polar

from validation.theory.corner_impact import FallingRectangle, on_springs, rigid_impulse
from validation.theory.edges import edge
from validation.theory.first_touch import MovingPolygon, first_touches, normals
from validation.theory.rocking import Rectangle
from validation.theory.spinning import Slide, Spinning
from validation.theory.truss import HalfTruss
from validation.theory.wedges import Wedges

TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}


def steepest(energy, q):
    """Return minus the gradient of an energy, by complex steps: no difference, and no formula of a force."""
    return np.array([-energy(q + 1e-30j * unit).imag / 1e-30 for unit in np.eye(len(q))])


# ---- about a corner --------------------------------------------------------------------------------------------------

BOX = Rectangle(0.7, 1.9, 3.7)
ARM2 = (0.7**2 + 1.9**2) / 3  # moment of inertia about a corner over the mass


def rocked(duration, state, k=0.0, event=None):
    """Return the motion of a tilt about a corner by its levers, under k g along the base."""

    def rates(_, state):
        tilt, rate = state
        right = 0.35 * math.cos(tilt) - 0.95 * math.sin(tilt)
        up = 0.95 * math.cos(tilt) + 0.35 * math.sin(tilt)
        return [rate, 3.7 * (k * up - right) / ARM2]

    if event:
        event.terminal = True
    return solve_ivp(rates, (0.0, duration), state, events=event, **TIGHT)


def test_a_box_that_is_let_go_comes_down_and_keeps_its_momentum_about_the_new_corner():
    fall = rocked(9.0, [0.23, 0.0], event=lambda _, state: state[0])
    assert BOX.quarter_period(0.23) == pytest.approx(fall.t[-1], rel=1e-10)
    assert BOX.landing_rate(0.23) == pytest.approx(-fall.y[1, -1], rel=1e-10)
    radius2, own = (0.7**2 + 1.9**2) / 4, (0.7**2 + 1.9**2) / 12
    assert BOX.housner == pytest.approx((own + radius2 * math.cos(2 * BOX.alpha)) / (own + radius2), rel=1e-13)


def test_a_box_that_falls_over_from_beyond_its_corner():
    start, turned = 0.17, 1.1
    still = [BOX.alpha + start, 0.0]
    fall = rocked(9.0, still, event=lambda _, state: state[0] - BOX.alpha - start - turned)
    assert BOX.fall_time(start, turned) == pytest.approx(fall.t[-1], rel=1e-9)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    rates = [rocked(0.4 * (1 + node), still).y[1, -1] for node in nodes]
    assert BOX.squared_rate(start, 0.8) == pytest.approx(0.4 * weights @ np.square(rates), rel=1e-6)


def test_a_pulse_of_the_base_tilts_a_box_or_overturns_it():
    duration = 0.61
    threshold = BOX.pulse_threshold(duration)
    for k in (0.9 * threshold, 1.2 * threshold):
        pulse = rocked(duration, [0.0, 0.0], k)
        tilt, rate = pulse.y[:, -1]
        assert BOX.pulse_end(k, duration) == pytest.approx(tilt, rel=1e-9)
        assert float(BOX.pulse_rate2(k, np.array(tilt))) == pytest.approx(rate**2, rel=1e-9)
        if k < threshold:
            after = rocked(20.0, [tilt, rate], event=lambda _, state: state[1])
            assert BOX.pulse_peak(k, duration) == pytest.approx(after.y[0, -1], rel=1e-9)
            assert after.y[0, -1] < BOX.alpha
        else:
            after = rocked(20.0, [tilt, rate], event=lambda _, state: state[0] - BOX.alpha)
            assert BOX.pulse_overturning(k, duration) == pytest.approx(duration + after.t[-1], rel=1e-9)
    tilt, rate = rocked(duration, [0.0, 0.0], threshold).y[:, -1]  # it just carries the centre above the corner
    lift = math.hypot(0.35, 0.95) * (1 - math.cos(BOX.alpha - tilt))
    assert ARM2 * rate**2 / 2 == pytest.approx(3.7 * lift, rel=1e-7)


# ---- a block that spins, a block on a ledge --------------------------------------------------------------------------


def test_a_strained_block_spins_by_the_energy_of_its_stretch():
    body = Spinning(1.9, 0.7, 2300.0, 6e8, 0.27, 31.0)
    S = 2300.0 * 1.9 * 0.7 * np.diag([1.9**2, 0.7**2]) / 12
    elastic = 6e8 / (1 - 0.27**2) * np.array([[1, 0.27, 0], [0.27, 1, 0], [0, 0, 0.365]])

    def rates(_, state):
        F, V = state.reshape(2, 2, 2)
        Q, U = polar(F)
        sx, sy, sxy = elastic @ (U[0, 0] - 1, U[1, 1] - 1, 2 * U[0, 1])
        T, turn = np.array([[sx, sxy], [sxy, sy]]), np.array([[0.0, -1.0], [1.0, 0.0]])
        T = T - np.trace(T.T @ turn @ U) / np.trace(U) * turn  # Biot's stress does no work in a turn
        return np.concatenate([V.ravel(), (-1.9 * 0.7 * Q @ T @ np.linalg.inv(S)).ravel()])

    times = np.array([0.0031, 0.0047])
    spin = np.array([[0.0, -31.0], [31.0, 0.0]])
    done = solve_ivp(rates, (0, times[-1]), [1, 0, 0, 1, *spin.ravel()], t_eval=times, **TIGHT)
    found = body.at(times)
    for i, F in enumerate(done.y[:4].T.reshape(-1, 2, 2)):
        Q, U = polar(F)
        assert found["angle"][i] == pytest.approx(math.atan2(Q[1, 0], Q[0, 0]), abs=1e-10)
        strains = [found[name][i] for name in ("ex", "ey", "gxy")]
        assert strains == pytest.approx([U[0, 0] - 1, U[1, 1] - 1, 2 * U[0, 1]], abs=1e-10)
    assert body.momentum == pytest.approx(31.0 * np.trace(S), rel=1e-14)
    square = replace(body, height=1.9)
    s = 1 + square.steady_strain
    inertia = 2300.0 * 1.9**4 / 6
    assert (inertia * 31.0) ** 2 / (inertia * s**3) == pytest.approx(2 * 6e8 / 0.73 * 1.9**2 * (s - 1), rel=1e-9)


def test_a_block_slides_to_a_ledge_and_tips_about_it():
    """The corner of the ledge stays on its face: N keeps the distance of the centre from it."""
    slide = Slide(1.3, 0.8, 0.21, -0.9, 2.9, 7.3)
    braked = 0.21 * 7.3
    tips, speed = slide.tips
    assert slide.stopping_distance == pytest.approx(2.9**2 / 2 / braked)
    way = 0.9 - 0.21 * 0.4
    assert 2.9 * tips - braked * tips**2 / 2 == pytest.approx(way) and speed == pytest.approx(2.9 - braked * tips)
    assert (
        replace(slide, speed=1.3, friction=0.5).tips is None
        and replace(slide, friction=0.0).stopping_distance == math.inf
    )

    def rates(_, state):
        x, y, turn, u, v, spin = state
        t, n = np.array([math.cos(turn), -math.sin(turn)]), np.array([math.sin(turn), math.cos(turn)])
        c, rate, g = np.array([x, y]), np.array([u, v]), np.array([0.0, -7.3])
        force = n - 0.21 * t  # of a unit of N, as it slides on
        lever = -(c[1] * force[0] - c[0] * force[1])  # clockwise, of the force at the origin about the centre
        r2 = (1.3**2 + 0.8**2) / 12
        # of (c . n)'' = 0: c'' n + 2 c' n' + c n'', n' = spin t and t' = -spin n
        known = g @ n + 2 * spin * rate @ t - spin**2 * (c @ n)
        N = -known / (force @ n + lever / r2 * (c @ t))
        return [u, v, spin, *(g + N * force), N * lever / r2]

    start = [-0.21 * 0.4, 0.4, 0.0, speed, 0.0, 0.0]
    done = solve_ivp(rates, (tips, tips + 0.35), start, **TIGHT)
    assert slide.turn(tips + 0.35) == pytest.approx(done.y[2, -1], rel=1e-8) and slide.turn(tips) == 0.0
    with pytest.raises(ValueError, match=r"^time: "):
        replace(slide, speed=1.62).turn(3.0)
    slow = replace(slide, speed=1.62)  # 0.35 m/s over the ledge
    assert 0 < slow.turn(slow.tips[0] + 0.01) < 0.01


# ---- a truss, wedges -------------------------------------------------------------------------------------------------


def test_half_a_truss_falls_by_the_gradient_of_its_energy_and_rests_up_to_its_limit():
    half = HalfTruss(2.1, 0.6, 3100.0, 0.02, (0.004, 0.003), 2.13, 3e7, 1.7e7, 8.3)

    def energy(q):
        x, y, turn = q
        u = math.atan2(0.6, 2.1) - turn
        across, up = half.diagonal / 2 * np.cos(u), half.diagonal / 2 * np.sin(u)
        springs = 3e7 * ((x - across) ** 2 + (y - up - 0.003) ** 2) + 1.7e7 * (x + across - 2.13) ** 2
        return springs / 2 + 3100.0 * 8.3 * y

    inertia = np.array([3100.0, 3100.0, 3100.0 * (2.1**2 + 0.6**2) / 12])
    u = math.atan2(0.6, 2.1) - 0.02
    start = np.array([0.004 + half.diagonal / 2 * math.cos(u), 0.003 + half.diagonal / 2 * math.sin(u), 0.02])
    times = np.array([0.0, 0.013, 0.05])
    done = solve_ivp(
        lambda _, q: [*q[3:], *(steepest(energy, q[:3]) / inertia)], (0, 0.05), [*start, 0, 0, 0], t_eval=times, **TIGHT
    )
    for row, q in zip(half.motion(times), done.y[:3].T, strict=True):
        u = math.atan2(0.6, 2.1) - q[2]
        x_A, y_A = q[:2] - half.diagonal / 2 * np.array([math.cos(u), math.sin(u)])
        forces = [-3e7 * x_A, 1.7e7 * (q[0] + half.diagonal / 2 * math.cos(u) - 2.13), -3e7 * (y_A - 0.003)]
        assert row == pytest.approx([*q, *forces], rel=1e-8, abs=1e-9)
    most = half.limit[1]
    rest = half.rest(0.7 * most)
    weight, load, u = 3100.0 * 8.3, 0.7 * most, math.atan2(0.6, 2.1) - rest["turn"]
    across, up = half.diagonal * math.cos(u), half.diagonal * math.sin(u)
    assert rest["thrust"] * up == pytest.approx((weight + load) * across / 2, rel=1e-10)  # about A
    assert across - 2.13 == pytest.approx(rest["thrust"] * (1 / 3e7 + 1 / 1.7e7), rel=1e-9)
    assert rest["shear"] == weight + load / 2
    assert half.rest(1.0001 * most) is None
    assert half.rest(0.999999 * most)["turn"] == pytest.approx(math.atan2(0.6, 2.1) - half.limit[0], abs=1e-3)


def balanced(wedges, masses, dips):
    """Return A1, A2, N1, N2 and the normal force between two wedges, from their forces in x and y."""
    matrix, right = np.zeros((5, 5)), np.zeros(5)
    for i, (mass, dip, sign) in enumerate(zip(masses, dips, (-1, 1), strict=True)):
        down, normal = np.array([math.cos(dip), -math.sin(dip)]), np.array([math.sin(dip), math.cos(dip)])
        rows = slice(2 * i, 2 * i + 2)
        matrix[rows, i] = mass * down
        matrix[rows, 2 + i] = wedges.below * down - normal
        matrix[rows, 4] = -sign * np.array([1.0, -wedges.between])
        right[rows] = [0.0, -mass * wedges.gravity]
    matrix[4, :2] = math.cos(dips[0]), -math.cos(dips[1])
    return np.linalg.solve(matrix, right)


def test_two_wedges_slide_by_their_forces_and_stand_with_their_factor_of_safety():
    masses, dips = (4100.0, 2300.0), (0.93, 0.11)
    wedges = Wedges(masses, dips, 0.31, 0.24, 8.7)
    names = ("active", "passive", "active base", "passive base", "interface")
    assert [wedges.motion()[name] for name in names] == pytest.approx(balanced(wedges, masses, dips), rel=1e-9)
    firm = replace(wedges, below=0.9, between=0.5)
    F = firm.factor_of_safety
    at_limit = replace(firm, below=0.9 / F, between=0.5 / F)
    assert balanced(at_limit, masses, dips)[:2] == pytest.approx([0.0, 0.0], abs=1e-9)


# ---- a corner that hits a plane --------------------------------------------------------------------------------------

FALLING = FallingRectangle(1.1, 0.7, 900.0, (0.3, 1.4), 0.4, (3.3, -0.6), -0.8, 6.1)


def corner_of(q, number=0):
    x, y = [(-0.55, -0.35), (0.55, -0.35), (0.55, 0.35), (-0.55, 0.35)][number]
    return q[0] + x * np.cos(q[2]) - y * np.sin(q[2]), q[1] + x * np.sin(q[2]) + y * np.cos(q[2])


@pytest.mark.parametrize(("mu", "ps"), [(None, 0.0), (1e9, 3e6), (0.04, 3e8)], ids=["smooth", "sticks", "slips"])
def test_a_corner_rebounds_from_springs_by_the_gradient_of_their_energy(mu, ps):
    time, number = FALLING.landing(2.0)
    t = time
    q = np.array([0.3 + 3.3 * t, 1.4 - 0.6 * t - 3.05 * t * t, 0.4 - 0.8 * t, 3.3, -0.6 - 6.1 * t, -0.8])
    held, depth = corner_of(q, number)
    assert depth == pytest.approx(0.0, abs=1e-12)
    assert min(corner_of(q, other)[1] for other in range(4)) >= -1e-12
    inertia = np.array([900.0, 900.0, 900.0 * (1.1**2 + 0.7**2) / 12])

    def rates(_, state):
        def energy(q):
            x, y = corner_of(q, number)
            return 2e6 * y * y / 2 + (mu == 1e9) * ps * (x - held) ** 2 / 2 + 900.0 * 6.1 * q[1]

        force = steepest(energy, state[:3])
        normal = -2e6 * corner_of(state, number)[1]
        if mu == 0.04:  # it slips on towards +x
            force = force + 0.04 * normal * steepest(lambda q: corner_of(q, number)[0], state[:3])
        return [*state[3:6], *(force / inertia), normal]

    rebound = on_springs(FALLING, 2e6, ps, mu, 2.0)
    done = solve_ivp(rates, (time, rebound.time), [*q, 0.0], **TIGHT)
    assert rebound.state == pytest.approx(done.y[:6, -1], rel=1e-7, abs=1e-8)
    assert rebound.impulse[1] == pytest.approx(done.y[6, -1], rel=1e-8)
    assert rebound.impulse[0] == pytest.approx(900.0 * (rebound.state[3] - 3.3), rel=1e-8, abs=1e-6)
    assert corner_of(np.array(rebound.state), number)[1] == pytest.approx(0.0, abs=1e-10)


def test_stiff_springs_tend_to_the_rigid_impulse():
    """It slips on, and where its slip has come to rest, slips back."""
    for speed, mu in ((0.2, 0.15), (-4.0, 0.6), (4.0, 0.15)):
        body = replace(FALLING, velocity=(speed, -2.0))
        soft = on_springs(body, 1e11, 1e14, mu, 2.0).impulse
        assert rigid_impulse(body, mu, 2.0) == pytest.approx(soft, rel=0.03)
    landed = FALLING.flown(FALLING.landing(2.0)[0])
    x, y = np.array(corner_of([*landed.place, landed.angle], FALLING.landing(2.0)[1])) - landed.place
    mobility = 1 / 900.0 + x * x / FALLING.inertia
    speed = landed.velocity[1] + landed.spin * x
    assert rigid_impulse(FALLING, 0.0, 2.0) == (0.0, pytest.approx(-2 * speed / mobility, rel=1e-12))
    # it holds from the first instant on where it comes straight down: both parts of its velocity take one impulse
    square = np.array([[1 / 900.0 + y * y / FALLING.inertia, -x * y / FALLING.inertia], [0.0, mobility]])
    square[1, 0] = square[0, 1]
    still = replace(FALLING, velocity=(landed.spin * y, -0.6))
    along, across = rigid_impulse(still, 0.9, 2.0)
    assert along / across == pytest.approx(-square[0, 1] / square[0, 0], rel=1e-9)


# ---- a first touch, an edge of what holds ----------------------------------------------------------------------------


def test_a_corner_touches_an_edge_where_a_line_says_and_a_corner_within_a_cone():
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    turned = square @ np.array([[0.6, 0.8], [-0.8, 0.6]])
    upper = MovingPolygon(turned, (0.3, 4.0), (0.1, -2.0), 0.0)
    (touch,) = first_touches(upper, MovingPolygon(square, (0.0, 0.0), (0.0, 0.0), 0.0), 3.0, 0.0)
    lowest = int(np.argmin(turned[:, 1]))
    time = (4.0 + turned[lowest, 1] - 1.0) / 2.0
    assert (touch.time, touch.block, touch.corner, touch.edge) == (pytest.approx(time, abs=1e-12), 0, lowest, 2)
    assert touch.foot == pytest.approx((1.0 - 0.3 - 0.1 * time - turned[lowest, 0]) / 2.0, abs=1e-11)
    other = MovingPolygon(square, (0.0, 0.0), (0.0, 0.0), 0.0)
    assert normals(upper, other, touch) == (pytest.approx(math.pi / 2),) * 2
    aimed = replace(upper, centroid=(0.5 + 1.0 - turned[lowest, 0], 4.0), velocity=(-0.5 / 0.8, -2.0))
    aimed = replace(aimed, velocity=(-0.5 / time, -2.0))
    low, high = normals(aimed, other, replace(touch, foot=0.0, edge=2))
    own = math.atan2(0.8, 0.6), math.pi - math.atan2(0.6, 0.8)  # of the two edges that meet in the lowest corner
    assert (low, high) == (pytest.approx(max(0.0, min(own))), pytest.approx(min(math.pi / 2, max(own))))


def test_a_polygon_turns_about_its_centroid_as_it_moves():
    corners = np.array([(-1.1, -0.4), (0.9, -0.6), (0.3, 1.2)])
    moving = MovingPolygon(corners, (0.3, -2.0), (1.7, 0.6), -0.9)
    plane = np.exp(-0.9j * 0.35) * (corners @ [1, 1j]) + complex(0.3, -2.0) + 0.35 * complex(1.7, 0.6)
    assert moving.at(np.array([0.0, 0.35]))[1] @ [1, 1j] == pytest.approx(plane, rel=1e-14)


def test_an_edge_lies_between_what_holds_and_what_does_not():
    assert edge(lambda x: x < 2.7, 1.0, 30.0, 1e-6) == pytest.approx(2.7, rel=1e-6)
    assert 2.7 < edge(lambda x: x > 2.7, 40.0, 1.0, 1e-6) < 2.7 * (1 + 1e-6)
