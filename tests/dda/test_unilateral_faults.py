"""Slips that contact codes are known for, each put in once: some check of the stepping must notice it."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from faults import steps
from faults.steps import after, damped_again, marked, notices, stopped, velocity_twice
from oracles import unilateral_mp
from oracles.unilateral_checks import DT, apart, checked, random_model, run, size, sums

import dda.contact.conserving as conserving
import dda.contact.glued as glued
import dda.contact.iteration as iteration
import dda.contact.points as points
import dda.one_block.unilateral as unilateral
import dda.one_block.unilateral_phase as phases
import dda.one_block.unilateral_step as step
import dda.system.opening as opening
from dda import (
    Block,
    Contact,
    Material,
    Scheme,
    TwoBlockModel,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    opening_subdivided,
    solve_opening_system,
    solve_system,
    solve_unilateral,
    subdivided,
)
from dda.contact.unilateral import Corners

RECTANGLE = 5  # a seed whose block is a rectangle, off-centre and glued


def invariants():
    for seed in range(8):
        checked(random_model(seed), Scheme(0.5, 1.0, 1.0, DT), 200)


def digits():
    """Against 60 digits: a glued block that lands, opens and lands again."""
    model, scheme = random_model(RECTANGLE), Scheme(0.5, 1.0, 0.99, 4 * DT)
    result, exact = solve_unilateral(model, scheme, 60), unilateral_mp.history(model, scheme, 60)
    for values, part, i in (
        (result.normal_force_m, 1, 0),
        (result.shear_force_m, 2, 0),
        (result.shear_force_n, 2, 1),
    ):
        assert unilateral_mp.lost(values, [row[part][i] for row in exact]) < 1e-10


def stiff_digits():
    model = replace(random_model(1, glued=False), contact=Unilateral(1e24), gravity=0.0, pressure=0.0, velocity=-1.0)
    scheme = Scheme(0.5, 1.0, 0.99, 1e-3)
    result, exact = solve_unilateral(model, scheme, 20), unilateral_mp.history(model, scheme, 20)
    assert unilateral_mp.lost(result.normal_force_m, [row[1][0] for row in exact]) < 1e-12


def cutting():
    """The first trials fail: the step is repeated, shorter, from the state that was saved."""
    model = replace(random_model(1, glued=False), contact=Unilateral(1e9, gap=1.0), gravity=0.0, pressure=0.0)
    result, calls = stopped(0, 2, partial(run, replace(model, velocity=-0.8), gg=0.9, steps=3))
    assert result.step_cuts.tolist() == [2, 0, 0]
    assert calls[0] == calls[1] == calls[2]
    assert result.velocity == pytest.approx([-0.8 * 0.9, -0.8 * 0.81, -0.8 * 0.729], rel=1e-14)


def at_once():
    """Steps made at once between switches against all made singly."""
    for seed, glued_shear in ((1, False), (2, False), (5, True)):
        model, scheme = random_model(seed, glued=glued_shear), Scheme(0.3, 0.6, 0.999, 5e-5, "consistent")
        result = solve_unilateral(model, scheme, 300)
        singly = solve_unilateral(model, scheme, 300, options=UnilateralOptions(full=True))
        assert result.history.glides and np.count_nonzero(np.diff(result.closed)) > 0
        for name in ("normal_force_m", "gap_n", "shear_force_n", "velocity"):
            assert apart(getattr(result, name), getattr(singly, name)) <= 1e-9, name


def kept_energy():
    """Energy-conserving contact: landing, pressed, lifting off, with one corner and with two."""
    for seed in (1, 2):
        options = UnilateralOptions(rule="energy-conserving", energies=True)
        result = solve_unilateral(random_model(seed, glued=False), Scheme(0.25, 0.5, 1.0, DT), 100, options=options)
        total, _ = sums(result)
        assert np.max(np.abs(total - total[0])) < 1e-11 * size(result)


def sub_blocks():
    """One sub-block against the block; two that never open against the locked ones."""
    model, scheme = random_model(RECTANGLE), Scheme(0.5, 1.0, 0.99, 2 * DT)
    block, one = (
        solve_unilateral(model, scheme, 100),
        solve_opening_system(opening_subdivided(model, 1, 1, 1e15), scheme, 100),
    )
    for name in ("normal_force_m", "shear_force_n", "gap_n"):
        assert apart(getattr(one, name), getattr(block, name)) <= 1e-9, name
    pressed = UnilateralModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.2)), Unilateral(1e9, 1e9), 5e6)
    springs, scheme = TwoBlockModel(pressed.block, Contact(1e9), 5e6), Scheme(0.5, 1.0, 1.0, 1e-2)
    opens = solve_opening_system(opening_subdivided(pressed, 2, 1, 1e12), scheme, 20).columns["displacement"]
    locked = solve_system(subdivided(springs, 2, 1, 1e12), scheme, 20).columns["displacement"]
    assert apart(opens, locked) <= 1e-9


CHECKS = (invariants, digits, stiff_digits, cutting, at_once, kept_energy, sub_blocks)


def crossing_at_start(law, before, N):
    return 1.0, 0.0


def old_reference(monkeypatch):
    """A corner that closes again keeps the stretch that it opened with."""
    real, kept = glued.glued, {}

    def faulty(law, before, free, closed):
        for i, shut in enumerate(before.closed):
            if shut:
                kept[i] = before.stretch[i]
        stretch = tuple(kept.get(i, 0.0) for i in range(len(closed)))
        return real(law, before._replace(closed=(True,) * len(closed), stretch=stretch), free, closed)

    monkeypatch.setattr(iteration, "glued", faulty)


def dead_band(monkeypatch):
    monkeypatch.setattr(Unilateral, "stays_closed", lambda law, N: -law.stiffness * 1e-6 <= N)


def kept_shear(monkeypatch):
    steps.kept_shear(monkeypatch, step, "find_states")


def gap_of_the_increment(monkeypatch):
    steps.gap_of_the_increment(monkeypatch, step, "find_states")


def remembered_tension(monkeypatch):
    """A corner closes again where it opened, not where it touches."""
    monkeypatch.setattr(Unilateral, "closes", lambda law, w: w < 2e-5)


def lost_weight(monkeypatch):
    """The contact force of the step's start is forgotten in the velocity."""
    monkeypatch.setattr(step, "velocity_corrector", lambda scheme, P, f, f1: scheme.gg * P + f1 * 0.999)


def crossed_at_start(monkeypatch):
    """A corner closes with the reference of the step's start, not of the crossing."""
    monkeypatch.setattr(glued, "slipped_share", crossing_at_start)


def one_step_too_many(monkeypatch):
    """The step in which a contact switches is made as if it did not."""

    def change(found, phase, v, closed, first, left):
        if found is None or found[0].steps == left:
            return found
        part, end = found
        z, constant = phase.start(end)
        return part._replace(steps=part.steps + 1), phase.shown @ phase.after(z, 1) + constant

    after(monkeypatch, unilateral, "glide", change)


def weightless_switch(monkeypatch):
    """The loads are forgotten in the step of a switch."""

    class Faulty(step.Jump):
        def __init__(self, form, law, length):
            super().__init__(form, law, length)
            self.constant[:] = 0.0

    monkeypatch.setattr(unilateral, "Jump", Faulty)


def undamped_flight(monkeypatch):
    """Gg is forgotten in the rigid motion of steps made at once."""
    real = phases.rigid_maps
    monkeypatch.setattr(phases, "rigid_maps", lambda gg, a, levels: real(1.0, a, levels))


def old_equilibrium(monkeypatch):
    """Steps made at once tend to where they began, not to where the loads press."""

    def change(found, phase, v):
        z, constant = found
        return z - phase.tended + np.eye(len(z))[-1], constant

    after(monkeypatch, phases.Phase, "start", change)


def trapezoid(monkeypatch):
    """A contact presses with the mean of the forces at both ends of the step."""
    real = conserving.one_contact

    def faulty(p, C, w0, w_f):
        _, N, slope = real(p, C, w0, w_f)
        for _ in range(60):
            N = (N + p * (max(-w0, 0.0) + max(-(w_f + C * N), 0.0)) / 2) / 2
        return w_f + C * N, N, slope

    monkeypatch.setattr(conserving, "one_contact", faulty)


def whole_springs(monkeypatch):
    """Every point of the base has the springs of a corner, not its share."""
    monkeypatch.setattr(
        opening, "replace", lambda item, **given: item if "stiffness" in given else replace(item, **given)
    )


def points_cross_at_start(monkeypatch):
    monkeypatch.setattr(points, "slipped_share", crossing_at_start)


def points_keep_shear(monkeypatch):
    """A point that opens goes on pulling along the base."""

    def change(found, law, before, free, closed):
        return replace(found, shear=np.where(closed, found.shear, before.shear / 2))

    after(monkeypatch, points, "trial", change)


FAULTS = {
    old_reference: [digits],
    crossed_at_start: [digits],
    dead_band: [invariants],
    damped_again: [cutting],
    velocity_twice: [cutting],
    kept_shear: [invariants, digits],
    gap_of_the_increment: [invariants, digits],
    remembered_tension: [invariants],
    lost_weight: [invariants, digits],
    one_step_too_many: [at_once],
    weightless_switch: [at_once, invariants],
    undamped_flight: [at_once],
    old_equilibrium: [at_once],
    trapezoid: [kept_energy],
    whole_springs: [sub_blocks],
    points_cross_at_start: [sub_blocks],
    points_keep_shear: [sub_blocks],
}


@pytest.mark.parametrize("check", marked(CHECKS, CHECKS[:4]))
def test_nothing_is_noticed_without_a_fault(check):
    assert not notices(check)


SHORT = (crossed_at_start, dead_band, damped_again)  # one of each check


@pytest.mark.parametrize("fault", marked(FAULTS, SHORT))
def test_a_known_slip_is_noticed(monkeypatch, fault):
    fault(monkeypatch)
    assert all(map(notices, FAULTS[fault]))


def test_the_corners_of_the_faults_are_those_of_the_package():
    assert Corners._fields == ("closed", "gap", "stretch", "reference", "normal", "shear", "state", "slipped")
