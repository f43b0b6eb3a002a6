"""Slips that contact codes are known for, each put in once: some check of the stepping must notice it."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from faults.steps import (
    crossed_at_start,
    damped_again,
    gap_of_the_increment,
    kept_shear,
    marked,
    notices,
    stopped,
    velocity_twice,
)
from oracles import unilateral_mp
from oracles.unilateral_checks import DT, apart, checked, random_model, run, size, sums

import dda.contact.conserving as conserving
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
from dda.contact import kernel
from dda.contact.unilateral import OPEN, STICK

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


CHECKS = (invariants, digits, stiff_digits, cutting, kept_energy, sub_blocks)


def old_reference(monkeypatch):
    """A corner that closes again keeps the stretch that it opened with."""
    real, kept = kernel.trial, {}

    def faulty(law, shear_law, before, free, flexible, contacts, work):
        for i in range(len(before.gap)):
            if before.state[i] != OPEN:
                kept[i] = before.stretch[i]
        stretch = [kept.get(i, 0.0) for i in range(len(before.gap))]
        closed = before._replace(state=[STICK] * len(before.gap), stretch=stretch)
        real(law, shear_law, closed, free, flexible, contacts, work)

    monkeypatch.setattr(kernel, "trial", faulty)


def dead_band(monkeypatch):
    monkeypatch.setattr(kernel, "stays_closed", lambda law, N: law.compliance * -N <= 1e-6)


def remembered_tension(monkeypatch):
    """A corner closes again where it opened, not where it touches."""
    monkeypatch.setattr(kernel, "closes", lambda law, w: w < 2e-5)


def lost_weight(monkeypatch):
    """The contact force of the step's start is forgotten in the velocity."""
    monkeypatch.setattr(step, "velocity_corrector", lambda scheme, P, f, f1: scheme.gg * P + f1 * 0.999)


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


def points_keep_shear(monkeypatch):
    """A point that opens goes on pulling along the base."""
    real = kernel.trial

    def faulty(law, shear_law, before, free, flexible, contacts, work):
        real(law, shear_law, before, free, flexible, contacts, work)
        for i in range(len(before.gap)):
            if contacts.state[i] == OPEN:
                contacts.shear[i] = before.shear[i] / 2

    monkeypatch.setattr(kernel, "trial", faulty)


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
    trapezoid: [kept_energy],
    whole_springs: [sub_blocks],
    points_keep_shear: [invariants],
}


@pytest.mark.parametrize("check", marked(CHECKS, CHECKS[:4]))
def test_nothing_is_noticed_without_a_fault(check):
    assert not notices(check)


SHORT = (crossed_at_start, dead_band, damped_again)  # one of each check


@pytest.mark.parametrize("fault", marked(FAULTS, SHORT))
def test_a_known_slip_is_noticed(monkeypatch, fault):
    fault(monkeypatch)
    assert all(map(notices, FAULTS[fault]))
