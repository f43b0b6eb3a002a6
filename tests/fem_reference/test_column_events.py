"""The exact motion of columns whose contacts open or slip: known histories, an independent integration, identities."""

import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from conftest import thinned
from flint import arb
from oracles.column_motions import COLUMNS, RIGID, blocks, half_unit, kind_of

from fem_reference.events import column_drive as drives
from fem_reference.events import contacts, report
from fem_reference.events.column_events import solve
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnModel, ColumnProblem
from fem_reference.events.enclosure import precision
from fem_reference.events.series import Start, column, expand, step_length
from fem_reference.events.switches import LostDigitsError, TooManySwitchesError

MOTIONS = {}


def motion_of(name):
    if name not in MOTIONS:
        MOTIONS[name] = solve(COLUMNS[name].problem, COLUMNS[name].end)
    return MOTIONS[name]


def labels(motion):
    return [f"{switch.joint}{kind_of(switch.kind, switch.sign)}" for switch in motion.switches]


def misprinted(known, motion):
    """Printed numbers that differ from the motion by more than half a unit of their last digit."""
    wrong = []
    first = known.switches.split(", ")
    last = known.last.split(", ") if known.last else []
    pairs = [*zip(first, motion.switches, strict=False), *zip(reversed(last), reversed(motion.switches), strict=False)]
    for printed, switch in pairs:
        label, time = printed.split()
        right = label == f"{switch.joint}{kind_of(switch.kind, switch.sign)}"
        if not right or abs(Decimal(switch.midpoint) - Decimal(time)) > half_unit(time):
            wrong.append(f"{printed}: {switch}")
    for instant, name, numbers in known.values:
        values = getattr(motion.at([instant]), name)[:, 0]
        for printed, value in zip(numbers.split(), values, strict=True):
            # what a printed zero stands for is a joint that is open
            if printed != "-" and abs(Decimal(float(value)) - Decimal(printed)) > half_unit(printed):
                wrong.append(f"{name} at {instant}: {printed}, {value!r}")
    return wrong


LONG = {"A1", "A2", "A3", "A5", "A6", "A8", "S1", "S2", "S3"}  # whose motions take seconds


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.long] * (name in LONG)) for name in COLUMNS])
def test_the_printed_digits_of_known_columns_come_out(name):
    known, motion = COLUMNS[name], motion_of(name)
    assert misprinted(known, motion) == []
    assert len(motion.switches) == known.count
    assert motion.radius < 1e-20 * known.end
    assert motion.touches == ()


def test_energy_is_conserved_with_what_friction_takes():
    for name in ("A4",):
        energy = motion_of(name).at(np.linspace(0, COLUMNS[name].end, 25)).energy
        np.testing.assert_allclose(energy, energy[0], rtol=1e-12)
    problem = replace(COLUMNS["S3"].problem, base_motion=drives.still)
    motion = solve(problem, 0.05)
    assert len(motion.switches) > 1
    state = motion.at(np.linspace(0, 0.05, 25))
    np.testing.assert_allclose(state.energy, state.energy[0], rtol=1e-12)
    assert state.friction[-1] > 0.1 * state.energy[0]


def test_blocks_in_common_flight_touch_without_force():
    problem = ColumnProblem(
        blocks(3, 2500, 1e9, -1.0), (ColumnJoint(1e9, 0.01), ColumnJoint(1e9), ColumnJoint(2e9)), gravity=9.81
    )
    motion = solve(problem, 0.012)
    assert motion.resting == (1, 2)
    assert motion.states_at_start == (contacts.OPEN,) * 3
    assert motion.at([0.005]).force.tolist() == [[0.0]] * 3
    # the far face of a block moves the wrong way first: its joint opens as the joint below closes
    assert labels(motion)[0] == "0C"
    assert motion.at([0.01, 0.012]).force[0].min() > 0


def test_a_joint_without_strength_lets_its_block_coast():
    problem = ColumnProblem(
        blocks(1, 2500, RIGID, 0.5),
        (ColumnJoint(1e8, strength=0.0),),
        law="frictional",
        base_motion=drives.integrated(drives.sine(1.0, 10.0)),
    )
    motion = solve(problem, 0.2)
    assert labels(motion)[:2] == ["0-", "0+"]
    assert {switch.kind for switch in motion.switches} == {"slips"}
    assert motion.at([0.2]).velocity[0, 0] == pytest.approx(0.5, rel=1e-14)


def test_a_welded_foot_passes_a_jump_of_the_base_on():
    # a record that begins at once: the far face gets half of the jump, the wrong way, by the consistent mass
    record = drives.integrated(drives.recorded([0.001, 0.004], [1.0, 1.0]))
    problem = ColumnProblem(
        (ColumnBlock(1.0, 2500, 1e9), ColumnBlock(1.0, 2500, 1e9)),
        (None, ColumnJoint(1e9, 0.5)),
        base_motion=record,
    )
    state = solve(problem, 0.003).at([0.0005, 0.001 + 1e-12])
    np.testing.assert_allclose(state.foot_velocity[0], [0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(state.top_velocity[0], [0.0, -0.5], atol=1e-5)


def test_welded_blocks_get_one_velocity_by_an_impulse_between_them():
    pair = (ColumnBlock(1.0, 2500, 1e9, 1.0), ColumnBlock(2.0, 2500, RIGID, -0.2), ColumnBlock(1.0, 2500, 1e9))
    problem = ColumnProblem(pair, (None, None, ColumnJoint(1e9, 1.0)), base="free")
    state = solve(problem, 1e-4).at([0.0])
    # mobilities of the faces that meet: 4 / m of the elastic one, 1 / m of the rigid one; 2 / m the other way
    impulse = 1.2 / (4 / 2500 + 1 / 5000)
    np.testing.assert_allclose(state.top_velocity[0], 1.0 - 4 * impulse / 2500, rtol=1e-14)
    np.testing.assert_allclose(state.foot_velocity[1], state.top_velocity[0], rtol=1e-14)
    np.testing.assert_allclose(state.foot_velocity[0], 1.0 + 2 * impulse / 2500, rtol=1e-14)
    on_base = replace(problem, base="rigid", blocks=(ColumnBlock(1.0, 2500, 1e9, -1.0), *pair[:2]))
    on_base = replace(on_base, joints=(None, ColumnJoint(1e9, 1.0), None))
    state = solve(on_base, 1e-4).at([0.0])
    assert state.foot_velocity[0, 0] == 0
    np.testing.assert_allclose(state.top_velocity[0], -1.5, rtol=1e-14)


def test_a_graze_is_named_and_not_guessed():
    # a rigid block thrown upwards under a lid that it reaches with its last velocity: both are free of forces
    height = 0.5**2 / 2 / 9.8125  # exact in floats: 0.25 / 19.625 is not, so that the miss is below 1e-17 m
    problem = ColumnProblem(
        (ColumnBlock(1.0, 2500, RIGID, -0.5),),
        (ColumnJoint(1e9, height),),
        gravity=-9.8125,
    )
    motion = solve(problem, 0.1)
    near = [switch.time for switch in motion.switches] + list(motion.touches)
    assert all(abs(time - 0.5 / 9.8125) < 1e-7 for time in near)


@pytest.mark.long
def test_a_horizon_is_named_where_the_digits_do_not_do(monkeypatch):
    monkeypatch.setattr(report, "MOST_DIGITS", 30)
    monkeypatch.setattr(report, "PROMISED", 1e-29)
    with pytest.raises(LostDigitsError) as error:
        solve(COLUMNS["A5"].problem, 0.12, digits=30)
    assert 0.05 < error.value.time < 0.12
    with pytest.raises(TooManySwitchesError):
        solve(COLUMNS["A1"].problem, 0.06, limit=5)


@pytest.mark.long
def test_a_column_that_is_welded_throughout_is_the_bonded_one():
    """Without any contact it goes as the springs between its faces do, and no instant has a motion of no length."""
    drive = drives.integrated(drives.half_sine(0.1, 0.02))
    pair = blocks(2, 2500, 1e9)
    welded = solve(ColumnProblem(pair, (None, None), base_motion=drive), 0.01)
    stiff = solve(ColumnProblem(pair, (ColumnJoint(1e12), ColumnJoint(1e12)), "frictional", base_motion=drive), 0.01)
    times = np.linspace(0.0, 0.01, 7)
    assert not welded.switches
    assert welded.at(times).top[-1] == pytest.approx(stiff.at(times).top[-1], abs=4e-6)
    assert welded.at([]).top.shape == (2, 0)


def test_drives_are_their_series_and_their_integrals_derive_to_them():
    pairs = [
        (drives.half_sine(2.0, 0.7), drives.integrated(drives.half_sine(2.0, 0.7))),
        (drives.sine(1.5, 3.0), drives.integrated(drives.sine(1.5, 3.0))),
        (drives.sine(1.5, 3.0, quarters=1), drives.integrated(drives.sine(1.5, 3.0, quarters=1))),
        (drives.triangle(2.0, 0.9), drives.integrated(drives.triangle(2.0, 0.9))),
        (drives.ricker(2.0, 3.0), drives.integrated(drives.ricker(2.0, 3.0))),
        (
            drives.recorded([0.1, 0.3, 0.8], [1.0, 4.0, 2.0]),
            drives.integrated(drives.recorded([0.1, 0.3, 0.8], [1.0, 4.0, 2.0])),
        ),
    ]
    with precision(200):
        for value, integral in pairs:
            series = []
            for drive in (value, integral):
                piece = drive().piece_at(0.41)
                series.append(piece.series(arb(0.41), 0.05, 40))
                # the series at its end is that of the piece from there on, but for what the tail bounds
                there = piece.series(arb(0.41) + arb(0.05), 0.05, 1)[0]
                assert abs(sum(series[-1], arb(0)) - there) <= piece.tail(arb(0.41), 0.05, 40) + arb(1e-55)
            for k in range(39):
                derived = series[1][k + 1] * (k + 1) / arb(0.05)
                assert abs(derived - series[0][k]) < 1e-50


def test_a_record_is_linear_between_its_rows():
    course = drives.recorded([0.1, 0.3, 0.8], [1.0, 4.0, 2.0])()
    values = [float(course.piece_at(t).series(arb(t), 1.0, 1)[0]) for t in (0.2, 0.5)]
    assert values == pytest.approx([2.5, 3.2], rel=1e-14)


def test_the_parts_of_a_course_begin_at_once():
    pieces = [drives.still().piece_at(0.0), *(drives.sine(size, 3.0)().piece_at(0.0) for size in (1.0, 2.0))]
    course = drives.Course((-0.1, 0.3), tuple(pieces))
    assert course.parts() == [(0.0, pieces[1]), (0.3, pieces[2])]


@pytest.mark.parametrize(("modulus", "stiffness"), [(math.inf, 1e5), (1e9, 1e10)])
@pytest.mark.parametrize(
    ("drive", "size"),  # the greatest value
    [
        (drives.integrated(drives.ricker(0.3, 60.0)), 0.3 / (math.pi * 60)),
        (drives.ricker(2e5, 60.0), 2e5),
        (drives.sine(0.1, 60.0), 0.1),
        (drives.still, 0.0),
    ],
)
def test_tails_bound_what_is_left_out_of_the_step_that_is_taken(drive, size, stiffness, modulus):
    pair = tuple(ColumnBlock(1.0, 2500.0, modulus, 0.1) for _ in range(2))
    problem = ColumnProblem(pair, (ColumnJoint(stiffness),) * 2, law="frictional", base_motion=drive)
    further = 40
    for bits in (100, 223):
        with precision(bits):
            model = ColumnModel(problem)
            states = (contacts.STICKS,) * 2
            base = drive().piece_at(0.0)
            pressure = drives.still().piece_at(0.0)
            pieces = base, pressure
            length = step_length(model, states, pieces)
            for moment in (0.0, 0.0331):
                still = [arb(0)] * model.size
                start = Start(arb(moment), column(still), column([arb(0.1)] * model.size), [arb(0)] * 2)
                segment = expand(model, states, start, pieces, length)
                count = segment.count
                series = base.series(start.time, length, count + further)
                left_out = sum(abs(c) * k**3 for k, c in enumerate(series) if k >= count - 2)
                assert left_out <= segment.drive_tails[0] <= size * count**4 * arb(2) ** (8 - bits)
                terms = expand(model, states, start, pieces, length, count + further).terms
                left_out = sum(model.norm(terms[k].entries()) * k**3 for k in range(count, count + further))
                assert left_out <= segment.tail


@pytest.mark.parametrize("base", thinned(["transmitting", "rigid", "free"], 3))
def test_the_forces_at_both_ends_make_the_momentum(base):
    """Between two instants the momentum changes by the integral of the force on the foot less that on the top."""
    joints = (ColumnJoint(1e9) if base == "rigid" else None, ColumnJoint(3e8, 1e-4))
    problem = ColumnProblem(
        (ColumnBlock(1.0, 2500.0, 1e9), ColumnBlock(0.7, 2200.0, 3e8, -0.1)),
        joints,
        base=base,
        impedance=4e6 if base == "transmitting" else 0.0,
        base_motion=drives.still if base == "free" else drives.integrated(drives.ricker(0.5, 60.0)),
        pressure=drives.half_sine(1e5, 0.02),
    )
    time = np.linspace(0.0, 0.01, 101)
    state = solve(problem, time[-1]).at(time)
    momentum = np.array([2500.0, 1540.0]) @ state.velocity
    pushed = state.face_force[0] - state.face_force[-1]
    impulse = np.append(0.0, np.cumsum((pushed[1:] + pushed[:-1]) / 2)) * time[1]
    assert momentum - momentum[0] == pytest.approx(impulse, abs=8e-3 * np.abs(momentum).max())


@pytest.mark.parametrize("seed", range(1))
def test_the_norm_of_the_mass_bounds_unknowns_rows_and_rates(seed):
    """Both sides of each bound, for a column above a half-space; the greatest ones are nearly reached."""
    blocks_of_two = (ColumnBlock(1.0, 2500.0, 1e9), ColumnBlock(0.7, 2200.0, 3e8))
    problem = ColumnProblem(blocks_of_two, (None, ColumnJoint(1e9)), base="transmitting", impedance=1e6)
    rng = np.random.default_rng(seed)
    with precision(100):
        model = ColumnModel(problem)
        rates = model.bounds_of((contacts.STICKS,))
        motion = model.motion((contacts.STICKS,))
        x = column(rng.normal(size=model.size).tolist())
        size = model.norm(x.entries())
        assert all(abs(x[i, 0]) <= size * float(model.sizes[i]) for i in range(model.size))
        assert abs((model.rows * x)[0, 0]) <= size * float(model.row_sizes[0])
        for _ in range(60):
            x = motion.A * x * (1 / size)
            size = model.norm(x.entries())
            assert size <= rates.frequency**2
        assert size >= rates.frequency**2 * (1 - 1e-6)
        damped = model.norm((motion.D * x).entries()) / size
        assert damped <= rates.motion - rates.frequency**2 / rates.motion
