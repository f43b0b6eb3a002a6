"""What the history of every body over contacts obeys to rounding: laws, momentum, energy, mirror, parts of a whole."""

import math
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from oracles.contact_bodies import (
    CASES,
    OneBlock,
    SubBlocks,
    TurningBlock,
    apart,
    put_stage,
    size,
    with_law,
)

from dda import Load
from dda.contact.rows import FOUND, INSIDE, NONE, OUTCOMES
from dda.march.energy import STORED
from dda.march.step import push_modes

WHOLE = [name for name in CASES if CASES[name](0).kind is not SubBlocks]  # whose modes a history keeps
FRAMES = ["dashpot by averages", "turning", "bonded", "rough", "dashpot", "dashpot by two stages", "rough sub-blocks"]
PENETRATION = 1e-9  # m, that the passes of an augmented Lagrangian leave


def of_every_body(names, every=1, always=()):
    """Take a seed a body, in turn; two more, and all but every n-th body, are long."""
    cases = []
    for number, name in enumerate(names):
        for seed in range(number % 4, number % 4 + 3):
            is_short = seed == number % 4 and (number % every == 0 or name in always)
            cases.append(pytest.param(name, seed, marks=() if is_short else pytest.mark.long))
    return pytest.mark.parametrize(("name", "seed"), cases)


@of_every_body(CASES)
def test_a_body_obeys_its_laws(name, seed, held):
    case = CASES[name](seed)
    result = case.run()
    assert result.outcome == "completed" and len(result.time) == case.steps
    keeps_laws(case, result)
    if has_impulses(case):
        keeps_momentum(case, result)
    keeps_energy(case, result)
    loses_energy(case, result)
    keeps_mirror(case, result)
    held(name, result)


def keeps_springs(case, result, N, w, closed):
    """An open contact without force, a closed one at w = -N/p; a dead band holds what others let go."""
    law = case.model.contact
    p = law.stiffness * result.multiplicity * case.kind.share
    assert np.all(w[~closed] >= -law.band[0]) and np.max(w, where=closed, initial=-1.0) <= law.band[1]
    assert np.allclose(w[closed], -N[closed] / p, rtol=1e-14, atol=0)


def keeps_dashpots(case, result, N, w, closed):
    """A pressed one at N = -(p w + c w'), all others where that would pull, or open."""
    law = case.model.contact
    rate = case.kind.gap_rates(case.model, case.scheme, result)[:, 1:]
    force = -(law.stiffness * w + law.damping * rate) * result.multiplicity
    scale = np.max(np.abs(force))
    pressed = N > 0
    assert pressed.any() and np.max(np.abs(N - force)[pressed]) < 1e-9 * scale
    assert np.all((w >= 0)[~pressed] | (force <= 1e-9 * scale)[~pressed])


def keeps_restitution(case, result, N, w, closed):
    """Of a gap that would be closed half a step on w'_1 + e w' >= 0, zero under an impulse; none elsewhere."""
    e = case.options["restitution"]
    rate = case.kind.gap_rates(case.model, case.scheme, result)
    u = case.scheme.gg * rate[:, :-1]
    near = np.column_stack([np.full(len(w), case.model.contact.gap), w[:, :-1]]) + case.scheme.step * u / 2 <= 0
    excess = rate[:, 1:] + e * u
    speed = np.max(np.abs(rate))
    assert near.any() and np.all(N[~near] == 0)
    assert np.all(excess[near] >= -1e-9 * speed) and np.max(np.abs(excess[N > 0])) < 1e-9 * speed


def keeps_stops(case, result, N, w, closed):
    assert np.all(w[~closed] >= 0) and np.all(w[closed] >= -PENETRATION)


RULES = {"impact": keeps_restitution, "augmented": keeps_stops}


def keeps_laws(case, result):
    law = case.model.contact
    n = result.contacts
    rows = result.history
    N, w = rows.force[1:, :n].T, rows.opening[1:, :n].T
    closed = rows.state[1:, :n].T == INSIDE
    assert closed.any() or case.kind.loads(case.model)[1] > 0  # pulled away
    assert np.all(-law.pull * result.multiplicity <= N) and np.all(N[~closed] == 0)
    assert np.all(result.step_solves[closed.any(axis=0)] > 0)
    keeps = keeps_dashpots if law.damping else RULES.get(case.rule, keeps_springs)
    keeps(case, result, N, w, closed)
    if rows.path.shape[1] == 0:  # a base that cannot slide
        return
    keeps_ways(case, result, closed)
    if law.friction is not None and law.rules == "consistent":
        keeps_friction(case, result, N, closed)


def keeps_ways(case, result, closed):
    """Reference and stretch of a contact are its way, which the block's place tells too; what slips moves it alone."""
    rows = result.history
    ways = rows.path.shape[1]
    assert np.array_equal(result.shear[-1] * result.multiplicity, rows.force[1:, -1])
    way = (rows.path + rows.opening[:, -ways:]).T
    rounding = 1e-13 * case.kind.rounding * (1 + np.max(np.abs(way)))  # of places at some 1 m
    assert np.max(np.abs(way[:, 1:] - way[:, :1] - result.slide[-ways:])) < rounding
    stays = closed[:, 1:] & closed[:, :-1] & (result.step_cuts[1:] == 0)
    moved = np.diff(rows.path.T[:, 1:]) - rows.slip.T[:, 2:]
    left = np.abs(moved)[stays] > rounding
    opened = 0.5 if len(case.scheme.stages) == 2 else 0.0  # at most: they bounced between its stages
    assert np.count_nonzero(left) <= opened * np.count_nonzero(rows.slip.T[:, 2:][stays])


def keeps_friction(case, result, N, closed):
    """|T| <= tan(phi) N + c, met by what slips, against T."""
    law = case.model.contact
    rows = result.history
    T, slip, state = (part[1:, -len(N) :].T for part in (rows.force, rows.slip, rows.state))
    scale = np.max(N) + law.cohesion
    cohesion = law.cohesion * result.multiplicity * case.kind.share
    limit = np.where(closed, law.friction * N + cohesion, 0.0)
    slips = closed & (state != INSIDE)
    assert np.max(np.abs(T) - limit) <= 2e-12 * scale
    assert np.max(np.abs(np.abs(T) - limit)[slips], initial=0.0) <= 1e-14 * scale
    assert np.all(T[slips] * state[slips] >= 0)
    if len(case.scheme.stages) == 1:  # else the first one may slip the other way
        once = slip[:, result.step_cuts == 0]
        assert np.all(once[~slips[:, result.step_cuts == 0]] == 0)
        assert np.max(T[:, result.step_cuts == 0] * once) <= 0


def has_impulses(case):
    """Tell whether the impulse of a step is known from the forces that a history keeps."""
    one_rule = case.scheme.table is None and case.rule != "energy-conserving"
    return one_rule and case.options.get("rotation") != "first-order"


def keeps_momentum(case, result):
    """M dV = dt [(1 - delta) R_n + delta R_{n+1}] + (gg - 1) M V; some rules take contact at the end alone."""
    scheme = case.scheme
    mass = case.model.block.material.density * case.model.block.section.area
    late = scheme.delta if case.rule != "impact" else (scheme.delta + 0.5) / 2
    late_contact = 1.0 if case.rule in ("implicit", "impact") else scheme.delta
    t = scheme.step * np.arange(case.steps + 1.0)
    share = np.clip(t / case.model.load.ramp, 0, 1) if case.model.load.ramp else np.ones_like(t)
    contacts = np.stack([result.shear.sum(axis=0), result.normal.sum(axis=0)])
    loads = case.kind.loads(case.model)
    velocities = case.kind.velocities(case.model, result)
    for V, N, load in zip(velocities, contacts, loads, strict=True):
        F = load * share
        N = np.array([0.0, *N])
        before = F[:-1].copy()
        if scheme.start == "zero" and case.rule != "impact":
            before[0] = 0.0
        pushed = (1 - late_contact) * N[:-1] + late_contact * N[1:]
        impulse = (1 - late) * before + late * F[1:] + pushed
        residual = mass * (V[1:] - scheme.gg * V[:-1]) - scheme.step * impulse
        scale = mass * np.max(np.abs(velocities)) + scheme.step * (np.max(np.abs(N)) + np.max(np.abs(loads)))
        assert np.max(np.abs(residual)[result.step_cuts == 0]) < 1e-14 * case.kind.rounding * scale * math.sqrt(
            case.steps
        )
    if case.kind is TurningBlock and not np.any(result.step_cuts):
        assert result.impulse == pytest.approx(scheme.step * np.cumsum(pushed), rel=1e-12)


DIGITS = {"dashpot": 1e-11, "impact": 1e-10}  # of rates that are differences, and of impulses


def keeps_energy(case, result):
    """Energy and the losses, each computed from its own formula, sum up to what there was at the start."""
    first = case.kind.first_energy(case.model, result)
    balance = sum(result.energies.values()) - first
    assert np.max(np.abs(balance)) < DIGITS.get(name_of(case), 1e-12) * case.kind.rounding * size(result)


def name_of(case):
    return "dashpot" if case.model.contact.damping else case.rule


def loses_energy(case, result):
    e = result.energies
    total = sum(e[part] for part in STORED)
    law = case.model.contact
    scale = size(result) * case.kind.rounding
    once = result.step_cuts[1:] == 0
    if case.scheme.lag == 0:
        damped = (1 - case.scheme.gg**2) * e["kinetic"][:-1]
        assert np.max(np.abs(np.diff(e["kinetic damping"]) - damped)[once]) < 1e-12 * scale
    if case.scheme.table is None:
        rubbed = np.sum(np.abs(result.slipped * result.shear), axis=0)[1:]
        assert np.max(np.abs(np.diff(e["friction"]) - rubbed)[once], initial=0.0) < 1e-12 * scale
    assert np.min(np.diff(e["friction"])) >= 0
    if law.damping:
        assert e["dashpot"][-1] > 0
    if case.rule == "energy-conserving":
        lost = [values for part, values in e.items() if part not in (*STORED, "kinetic damping")]
        assert np.max(np.abs(lost)) < 1e-12 * scale
    if never_gains(case):
        assert np.max(np.diff(total)) < 1e-13 * scale
    if case.kind is TurningBlock and never_gains(case):
        lost = np.diff([e[part] for part in ("algorithmic", "kinetic damping", "switching", "friction")])
        assert np.min(lost) > -1e-13 * scale


def never_gains(case):
    """Tell whether no step may gain energy: where forces act as at its end, on springs that let go at once."""
    law = case.model.contact
    if law.damping or any(law.band) or law.rules == "lagged" or case.options.get("rotation"):
        return False
    return case.rule == "implicit" or (case.rule == "newmark" and case.scheme.table is None and case.scheme.delta == 1)


def keeps_mirror(case, result):
    """Fewer steps are the first ones, of the mirror image of what is mirrored."""
    steps = min(12, case.steps)
    model, order = case.kind.mirrored(case.model)
    other = case.run(steps, model)
    for field, sign in (("normal", 1), ("gap", 1), ("shear", -1)):
        values = getattr(result, field)[:, :steps]
        assert apart(sign * getattr(other, field)[order], values) < 1e-8 or not values.any(), field
    V = case.kind.velocities(case.model, result)[:, : steps + 1]
    moved = case.kind.velocities(model, other) * [[-1], [1]]
    assert apart(moved, V) < 1e-8


@of_every_body(FRAMES, every=4)
def test_a_base_that_moves_evenly_changes_nothing_but_the_frame(name, seed):
    """Of an undamped block: a discount is one of velocities in the frame that is at rest."""
    case = CASES[name](seed)
    case = replace(case, scheme=replace(case.scheme, gg=1.0))
    at_rest, moved = (case.run(40, model) for model in (case.model, case.kind.carried(case.model)))
    for field in ("normal", "gap", "shear"):
        values = getattr(at_rest, field)
        assert apart(getattr(moved, field), values) < 1e-8 or not values.any(), field


def copied(part):
    return [copied(getattr(part, name)) for name in part.__slots__] if hasattr(part, "__slots__") else deepcopy(part)


@of_every_body(WHOLE, every=3, always=["dashpot by two stages"])
def test_a_step_that_fails_is_made_in_parts_from_where_it_began(name, seed, monkeypatch):
    """Every stage leaves the states that it starts from, and is bitwise the same again."""
    case = CASES[name](seed)
    motion = case.model.load.motion
    parts = []

    def change(make_stage):
        def once(march, stage, start, before, after, course, part):
            saved = copied(start), copied(before)
            made = make_stage(march, stage, start, before, after, course, part)
            again = copied(after)
            assert make_stage(march, stage, start, before, after, course, part) == made
            assert (copied(start), copied(before), copied(after)) == (*saved, again)
            if motion is not None:
                ends = (part.begun + part.ratio * stage.numbers.end) * case.scheme.step
                assert march.room.end[:2] == pytest.approx(case.kind.base_at(case.model, ends), abs=1e-15)
            if made[0] == FOUND and case.kind is OneBlock and case.rule in ("newmark", "augmented"):
                push_modes(march, after.rows.force)
                acting = [F - k * z for F, k, z in zip(march.room.load, march.body.k, after.z, strict=True)]
                R = np.add(acting, march.room.pushed) * case.scheme.step**2  # however long the part is
                assert np.max(np.abs(after.R - R)) < 1e-12 * np.max(np.abs([after.R, march.room.pushed]))
            parts.append((part.begun, part.ratio))
            return (NONE, 1) if parts.count((3.0, 1.0)) == 1 and parts[-1] == (3.0, 1.0) else made

        return once

    put_stage(monkeypatch, change)
    result = case.run(7)
    if case.scheme.lag:  # velocities of half a step before go on in equal steps only
        assert result.outcome == OUTCOMES[NONE] and len(result.time) == 3
        return
    assert result.outcome == "completed" and result.step_cuts[3] >= 1
    of_step = [part for part in dict.fromkeys(parts) if 3 <= part[0] < 4]
    assert np.array(of_step[:3]) == pytest.approx(np.array([(3, 1), (3, 0.3), (3.3, 0.7)])) or result.step_cuts[3] > 1
    keeps_energy(case, result)
    if case.model.contact.damping and result.normal.any():
        keeps_laws(case, result)


@pytest.mark.parametrize("name", ["rough", "turning"])
def test_cutting_ends_at_a_hundredth_with_the_named_outcome(name, monkeypatch):
    case = CASES[name](2)
    tried = []
    put_stage(monkeypatch, lambda make_stage: lambda *given: (tried.append(given[-1].ratio), (NONE, 3))[1])
    result = case.run(5)
    assert result.outcome == OUTCOMES[NONE] and len(result.time) == 0 and "at step 1" in result.notes[-1]
    assert tried == pytest.approx([1.0, 0.3, 0.09, 0.027, 0.01])


@pytest.mark.parametrize("name", ["frictionless", "turning"])
def test_overflow_is_an_outcome(name):
    case = CASES[name](3)
    model = replace(with_law(case.model, gap=100.0), load=Load(gravity=-1e300))
    case = replace(case, model=model, scheme=replace(case.scheme, step=1e6))
    result = case.run(20)
    assert result.outcome == "overflow" and len(result.time) < 20
