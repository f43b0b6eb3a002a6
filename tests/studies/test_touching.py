"""The study `touching`: roots and impacts against numbers of other programs; a wrong query is seen."""

import numpy as np
import pytest

import dda
from validation.scenes.scene import load_scene
from validation.studies.touching import formulas
from validation.suite.bands import cases
from validation.suite.folders import get_study
from validation.theory.corner_impact import on_springs, rigid_impulse

FIRST = {  # roots at 30 digits and conservative advancement: instant, block, corner, edge, share of the edge
    "square": (0.29324274279782854, 0, 0, 2, 0.298445579700372),
    "pentagon": (0.42995110874143777, 1, 2, 2, 0.25033421768386),
    "clip": (0.666, 1, 2, 3, 0.000707106781),
    "graze": (0.42906001317402766, 1, 2, 3, 0.0129234864785704),
    "fast": (0.3527302571494969, 1, 2, 0, 0.248366804045104),
    "half": (1.58578643762690495, 0, 0, 2, 0.0),
    "edges": (1.0, 0, 0, 2, 0.75),
    "almost": (0.9999990000005, 0, 0, 2, 0.7499995),
}
ON_SPRINGS = [
    (1e7, 0.0615372660744, -0.541520284042, -5.23028125747),
    (1e9, 0.0191921799220, -0.235108315664, -4.91792913621),
]
RIGID = [
    (0.1, (727.951675388, 15939.6969773)),
    (0.3, (3025.86264502, 16766.364898)),
    (0.6, (8251.94559121, 19440.7971126)),
    (1.0, (8199.52945306, 19349.5997556)),
]
BY_RATIO = [
    (0.6, 0.4, (-176.250747, 14950.49192)),
    (0.6, 1.0, (-59.8333442, 14160.27913)),
    (0.6, 10.0, (4648.63023, 16423.22847)),
    (0.3, 1.0, (-548.974281, 14367.9)),
]


@pytest.mark.parametrize("name", FIRST)
def test_first_touches_are_those_of_another_program(name):
    touch = formulas.touch_of(load_scene(f"touching-{name}"))
    time, block, corner, edge, foot = FIRST[name]
    assert (touch.block, touch.corner, touch.edge) == (block, corner, edge)
    assert (touch.time, touch.foot) == pytest.approx((time, foot), rel=1e-9, abs=1e-12)


def test_a_corner_on_a_corner_may_be_pushed_along_what_both_cones_share():
    scenes = [load_scene(f"touching-{name}") for name in ("corner", "half")]
    shared = [formulas.normals(*formulas.polygons(scene), formulas.touch_of(scene)) for scene in scenes]
    assert np.degrees(shared) == pytest.approx(np.array([[0.0, 90.0], [45.0, 90.0]]), abs=1e-9)


@pytest.mark.parametrize(("p", "time", "vy", "spin"), ON_SPRINGS)
def test_a_smooth_corner_leaves_springs_as_another_program_has_it(p, time, vy, spin):
    left = on_springs(formulas.falling(load_scene("touching-smooth")), p, 0.0, None, 1.0)
    assert (left.time, *left.state[4:]) == pytest.approx((time, vy, spin), rel=1e-9)


@pytest.mark.parametrize(("mu", "impulse"), RIGID)
def test_a_rigid_corner_slips_sticks_and_slips_backwards_as_another_program_has_it(mu, impulse):
    assert rigid_impulse(formulas.falling(load_scene("touching-smooth")), mu, 1.0) == pytest.approx(impulse, rel=1e-9)


@pytest.mark.parametrize(("mu", "ratio", "impulse"), BY_RATIO)
def test_springs_along_the_plane_change_the_impulse_as_another_program_has_it(mu, ratio, impulse):
    body = formulas.falling(next(iter(cases("touching-rough"))))
    left = on_springs(body, 1e13, ratio * 1e13, mu, 1.0)
    assert left.impulse == pytest.approx(impulse, abs=5.0)  # it turns by 2e-4 in the millimetre above


@pytest.mark.long
def test_two_corners_rise_and_turn_as_another_program_has_them():
    assert formulas.two_corners((-1.0, 0.5), 2 / 3) == pytest.approx((0.99561982, -0.11450666), abs=1e-7)


def other_edge(contact):
    """Name the next edge, and an edge where nothing touches."""
    if contact is None:
        return dda.first_contact([(0, 0), (1, 0), (0, 1)], [(0, 0), (1, 0), (0, 1)], (2, 0, 0, -1, 0, 0), (0,) * 6, 3.0)
    touches = tuple(
        touch._replace(
            kind="none", points=tuple(point._replace(edge=(point.edge + 1) % 3, corner=9) for point in touch.points)
        )
        for touch in contact.touches
    )
    return contact._replace(touches=touches)


def later(contact):
    """Let the touch be a nanosecond late, and its foot as much of the edge away."""
    if contact is None:
        return None
    touches = tuple(
        touch._replace(points=tuple(point._replace(foot=point.foot + 1e-9) for point in touch.points))
        for touch in contact.touches
    )
    return contact._replace(time=contact.time + 1e-9, touches=touches)


@pytest.mark.long
@pytest.mark.parametrize(("wrong", "metrics"), [(other_edge, {"wrong"}), (later, {"later", "foot"})])
def test_a_wrong_query_is_seen_on_every_scene(wrong, metrics, monkeypatch):
    gates = [gate for gate in get_study("touching").gates() if gate.pair == ("query",) and gate.metric in metrics]
    sound = dda.first_contact
    monkeypatch.setattr(dda, "first_contact", lambda *a: wrong(sound(*a)))
    for gate in gates:
        value = formulas.query(load_scene(gate.scene), None)[gate.metric]
        assert not gate.low <= value <= gate.high, gate.id
