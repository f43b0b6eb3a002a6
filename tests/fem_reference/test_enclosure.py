"""Ball arithmetic of the exact motions: first falls that must not be missed, and enclosures that hold.

Their sizes are what they were: `enclosures.txt`, at eight digits. `KEEP_PAGES=1` writes it anew.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned
from flint import arb
from oracles.kept_numbers import hold

from fem_reference.events import block_march, report, watching
from fem_reference.events.block_events import solve
from fem_reference.events.block_impacts import Hops, State
from fem_reference.events.block_model import BlockModel, BlockProblem
from fem_reference.events.column_drive import ricker, sine
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnModel, ColumnProblem
from fem_reference.events.contacts import LEFT, OPEN, RELEASED, RIGHT, STICKS
from fem_reference.events.ellipsoid import Ellipsoid
from fem_reference.events.enclosure import ball, bits_of, first_fall, precision
from fem_reference.events.enclosure import polynomial as smooth
from fem_reference.events.series import Start, column, expand
from fem_reference.events.switches import LostDigitsError, NoContactStateError, TooMuchWorkError
from fem_reference.events.watching import Change, first_doubt
from fem_reference.problem.motion import Motion

PAPER = BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6)
ROUGH = replace(PAPER, shear_stiffness=4e8, friction=30.0, poisson=0.2, cohesion=1e3)
STATES = [(OPEN, OPEN), (STICKS, STICKS), (STICKS, OPEN), (RIGHT, LEFT), (RIGHT, RIGHT), (LEFT, STICKS), (OPEN, RIGHT)]


def polynomial(c):
    return smooth([arb(x) for x in c], arb(1))


def values(function, at):
    return function(at, arb(0)).value


def state(seed, size=1.0, unknowns=6):
    """A state of random numbers, with references of a tenth."""
    x = np.random.default_rng(seed).normal(size=2 * unknowns) * size
    references = [arb(0.1 * size), arb(-0.3 * size)]
    return Start(arb(0), column(x[:unknowns].tolist()), column(x[unknowns:].tolist()), references)


def watched(model, states, start):
    return list(model.watches(states, start.references))


def test_a_touch_is_named_and_counts_as_none():
    with precision(bits_of(50)):
        third = arb(1) / 3
        touches = []
        touching = polynomial([third * third + ball(arb("1e-45")), -2 * third, arb(1)])
        assert first_fall(touching, arb(1), touches) is None
        assert touches
        assert all(abs(float(touch) - 1 / 3) < 1e-15 for touch in touches)


def test_a_touch_is_told_by_the_motion(monkeypatch):
    def grazing(_function, end, touches):
        touches.append(end / 2)

    monkeypatch.setattr(watching, "first_fall", grazing)
    with precision(bits_of(50)):
        march = block_march.BlockMarch(PAPER, 0.0033, 100)
        with pytest.raises(NoContactStateError):  # open corners that have gone through the base
            march.run()
    assert march.touches[0] == pytest.approx(0.0032525750597312, rel=1e-3)


def test_a_fall_that_may_be_a_touch_is_both(monkeypatch):
    tilted = replace(ROUGH, eccentricity=0.3)
    sound = solve(tilted, 0.009)
    found = []

    def flat(function, end, touches):
        fall = first_fall(function, end, touches)
        found.append(fall)
        return fall and fall._replace(grazing=True)

    monkeypatch.setattr(watching, "first_fall", flat)
    motion = solve(tilted, 0.009)
    assert motion.switches == sound.switches and len(found) >= len(motion.switches) > 1
    assert set(motion.touches) == {switch.time for switch in motion.switches}
    wider = motion.nodes[-1].error / sound.nodes[-1].error
    assert np.log2(wider[[0, 12]]) == pytest.approx([2.775, 6.216], abs=0.1)


PAIR = (ColumnBlock(1.0, 2500.0, 1e9), ColumnBlock(0.7, 2200.0))
COLUMN = ColumnProblem(PAIR, (ColumnJoint(1e9), ColumnJoint(3e8)))
SLIDING = replace(COLUMN, joints=(ColumnJoint(1e9, strength=1e4), ColumnJoint(3e8, strength=1e4)), law="frictional")
SYSTEMS = [
    *((replace(ROUGH, stiffness=1e13), states) for states in STATES),
    *((replace(PAPER, damping=damping), (STICKS, RELEASED)) for damping in (1e6, 4e7)),
    *((COLUMN, states) for states in ((OPEN, OPEN), (STICKS, OPEN))),
    *((SLIDING, states) for states in ((STICKS, RIGHT), (STICKS, STICKS))),
]


def model_of(problem):
    return BlockModel(problem) if isinstance(problem, BlockProblem) else ColumnModel(problem)


def members(ellipsoid, count):
    """Deviations on the border of the set, shape (count, entries)."""
    y = np.random.default_rng(1).normal(size=(count, len(ellipsoid.shape)))
    y /= np.linalg.norm(y, axis=1)[:, None]
    return y @ (ellipsoid.inverse @ ellipsoid.shape).T * float(ellipsoid.size)


OFFSETS = [(*one, offset) for one in SYSTEMS for offset in (0.0, 1e-9)]


@pytest.mark.parametrize(("problem", "states", "offset"), thinned(OFFSETS, 5))
def test_the_reach_of_a_function_bounds_what_its_terms_are_off(problem, states, offset):
    """Of any motion in the set, begun at any instant that the switch may be at; its first term comes near to it."""
    with precision(bits_of(50)):
        model = model_of(problem)
        n = model.size
        drives = [piece for _ in range(2) for piece in sine(1e-3, 9.0)().pieces] * isinstance(problem, ColumnProblem)
        start = state(6, 1e-3, n)
        ellipsoid = Ellipsoid(model)
        ellipsoid.take([abs(x) * arb(1e-9) for x in (*start.u.entries(), *start.v.entries(), arb(1), arb(0))])
        ellipsoid.advance(states, arb(1.0 / model.rate(states)))
        length = 3.0 / model.rate(states)
        segment = expand(model, states, start, drives, length)
        largest = {}
        for z in members(ellipsoid, 15):
            u, v, shifts = (column(part.tolist()) for part in (z[:n], z[n : 2 * n], z[2 * n :]))
            moved = [r + shift for r, shift in zip(start.references, shifts.entries(), strict=True)]
            other = expand(model, states, Start(arb(0), start.u + u, start.v + v, moved), drives, length)
            if offset:
                late = Start(arb(offset) * arb(length), *other.state(arb(offset)), moved)
                other = expand(model, states, late, drives, length)
            pairs = zip(watched(model, states, start), watched(model, states, Start(arb(0), u, v, moved)), strict=True)
            for number, (watch, of_other) in enumerate(pairs):
                reaches = ellipsoid.reach(watch, states, segment, offset * length).terms()
                assert len(reaches) == len(segment.function(watch))
                off = [abs(x - y) for x, y in zip(segment.function(watch), other.function(of_other), strict=False)]
                assert all(one <= reach for one, reach in zip(off, reaches, strict=False))
                largest[number] = max(largest.get(number, 0.0), float(off[0] / reaches[0]))
        assert all(share > 0.03 for share in largest.values()) or offset


def test_too_much_work_stops_at_a_horizon(monkeypatch):
    monkeypatch.setattr(block_march, "STEPS", 20)
    with pytest.raises(TooMuchWorkError, match="20 steps") as caught:
        solve(replace(PAPER, stiffness=1e18, pressure=0.0, gravity=9.81), 1e-3)
    assert 0 < caught.value.time < 5e-5


def test_a_locked_block_that_takes_too_many_steps_is_refused_before_the_first(monkeypatch):
    monkeypatch.setattr(block_march, "STEPS", 50)
    monkeypatch.setattr(block_march.BlockMarch, "step", None)
    with pytest.raises(TooMuchWorkError, match="would be needed") as caught:
        solve(replace(PAPER, locked=True), 1.0)
    assert 0 < caught.value.time < 1.0


def test_digits_that_are_lost_are_asked_for_again_and_missed_at_last(monkeypatch):
    stiff = replace(PAPER, stiffness=1e11)
    assert solve(stiff, 0.004, digits=30).digits == 30
    monkeypatch.setattr(report, "PROMISED", 1e-40)
    assert solve(stiff, 0.004, digits=30).digits > 30
    monkeypatch.setattr(report, "MOST_DIGITS", 30)
    monkeypatch.setattr(report, "PROMISED", 1e-34)  # of the first switches, not of the last ones
    with pytest.raises(LostDigitsError) as caught:
        solve(stiff, 0.004, digits=30)
    assert caught.value.time == pytest.approx(0.00325257506, rel=1e-8)


# -- how large they are


def size(values):
    """Logarithm of a product, in which each number but zero counts in its own unit."""
    return sum(math.log(abs(x)) for x in map(float, values) if x)


def set_numbers():
    rigid = replace(PAPER, stiffness=math.inf, restitution=0.4, poisson=0.2)
    for problem, was in (*(SYSTEMS[i] for i in (3, 7, 10, 11)), (rigid, (OPEN, OPEN))):
        model = model_of(problem)
        contact = getattr(model, "contact", None)
        start = state(6, 1e-3, model.size)
        rate = model.rate(was)
        drives = [d().pieces[0] for d in (sine(1e-3, 9.0), ricker(2e3, 60.0))] * isinstance(problem, ColumnProblem)
        segment = expand(model, was, start, drives, 2.3 / rate)
        box = [x * arb(1e-3) for x in (*map(abs, start.u.entries() + start.v.entries()), arb(1), arb(3))]
        ellipsoid = Ellipsoid(model)
        ellipsoid.take(box)
        ellipsoid.advance(was, arb(0.7 / rate))
        sizes = [size(model.growth(was, ellipsoid.record(), 0.3 / rate))]
        for watch in watched(model, was, start):
            value, slope = segment.value_and_slope(watch, arb(0.3))
            reaches = [ellipsoid.reach(watch, was, segment, late).terms()[:5] for late in (0.0, 0.2 / rate)]
            sizes.append(size([*reaches[0], *reaches[1], segment.function_tail(watch), value, slope]))
        for late, grazing in ((1e-4, False), (0.03, False), (0.1, True)):
            ellipsoid = Ellipsoid(model)
            ellipsoid.take(box)
            impact = contact and contact.impact
            radii = [arb(3e-9), arb(4e-9)]
            change = Change(start, start, was, was[1:] * 2, watch, value, slope, grazing, late / rate, radii, impact)
            ellipsoid.switch(change, drives)
            sizes.append(size(ellipsoid.record()))
        yield "set", sizes


def hop_numbers():
    model = BlockModel(replace(PAPER, stiffness=math.inf, restitution=0.4, pressure=-5e6, gravity=9.81))
    hops = Hops(model, model.contact)
    near = state(7, 1e-5)
    off = column([ball(1e-11 * k) for k in range(1, 7)])
    flying = State(near.u + off, near.v + off)
    speed = arb(0.012) + ball(1e-7)
    moved = hops.after(flying, arb(1e-4)), hops.pushed(flying, speed, arb(1e-5)), hops.spread(flying, arb(1e-3))
    sums = hops.find_hop(flying, speed), hops.find_accumulation(flying, speed)
    for balls in (*sums, *([*one.u.entries(), *one.v.entries(), hops.change_norm(one)] for one in moved)):
        yield "hops", size(x.mid() for x in balls), size(x.rad() for x in balls)


class Blurred(block_march.BlockMarch):
    """A motion that begins within balls, which hide what rounding adds."""

    def initial(self):
        start, states = super().initial()
        return start._replace(u=start.u + column([ball(1e-24 * k) for k in range(1, 7)])), states


def march_numbers():
    base = Motion((0.0, 0.004), (0.0, 1e-3), (0.0, -5e-3))
    rough = replace(PAPER, shear_stiffness=4e8, friction=17.0, cohesion=1e3, traction=1e6, eccentricity=0.2, base=base)
    heavy = replace(PAPER, young=math.inf, height=1.5, eccentricity=0.2, damping=2e6, velocity=-0.4)
    rigid = replace(PAPER, stiffness=math.inf, restitution=0.2)
    for problem, end in ((rough, 0.009), (heavy, 0.009), (rigid, 0.0045)):
        march = Blurred(problem, end, 100)
        march.run()
        radii = [switch.radius for switch in march.switches]
        yield "march", size(radii), size(x for node in march.nodes for x in node.error), len(march.nodes)


def fall_numbers():
    for value, slope, bend in ((0.1, -1.2, 0.3), (0.35, -1.0, 0.45), (0.3, 0.7, -1.9)):
        for off in (1e-9, 0.12):
            function = smooth([arb(value) + ball(off), arb(slope), arb(bend)], arb(2), arb(0.01), arb(1e-4))
            at = first_fall(function, arb(1)).at
            yield "fall", float(at), float(at.rad())
    terms = np.pad([(0.1, -0.7, 1.3), (0.37**2, -0.74, 1.0), (1.0, 0.3, -1.2)], [(0, 0), (0, watching.FLOAT_TERMS - 3)])
    for margin in (1e-3, 0.01):
        yield "doubt", *first_doubt(terms, np.full(3, margin))


PARTS = {part.__name__: part for part in (set_numbers, hop_numbers, fall_numbers, march_numbers)}


@pytest.mark.parametrize("part", PARTS)
def test_enclosures_are_as_large_as_they_were(part):
    with precision(bits_of(50)):
        hold(Path(__file__).with_name("enclosures.txt"), PARTS, part)
