"""The open-close iteration: the one solution of frictionless contact, states of friction, and where it does not end."""

from dataclasses import replace

import numpy as np
import pytest

from dda import Unilateral
from dda.contact import kernel
from dda.contact.kernel import (
    FOUND,
    NONE,
    SEVERAL,
    Contacts,
    Flexibility,
    Free,
    find_contacts,
    law_of,
    shear_law_of,
    work_for,
)
from dda.contact.unilateral import OPEN, SLIP, STICK
from dda.stepping.compiled import as_lists


def solved(law, C, gap, slide=None, before=None, limit=6):
    """Return outcome, solves and the contacts, as lists."""
    n = len(gap)
    before = before or kernel.at_rest(np.zeros(n))
    slide = np.zeros(n) if slide is None else np.array(slide, dtype=float)
    paired = np.array([slide.sum() / 2, slide[-1] - slide[0]]) if n == 2 else slide
    C_paired = np.array(C, dtype=float)
    if n == 2 and len(C) == 4:
        kernel.change_slides(np.array(C), kernel.TO_PAIR, C_paired)
    given = (before, Free(np.array(gap), slide, paired), Flexibility(np.array(C), C_paired))
    after, work = as_lists(kernel.at_rest(np.zeros(n))), as_lists(work_for(n))
    outcome, solves = find_contacts(law_of(law, limit), shear_law_of(law), *map(as_lists, given), after, work)
    return outcome, solves, Contacts(*map(np.array, after))


@pytest.mark.parametrize("limit", [1, 6])
@pytest.mark.parametrize("n", [1, 2, 7])
def test_frictionless_contact_always_finds_the_one_solution(n, limit):
    """Random problems, set all at once or one at a time: 0 <= N, w = w_f + C N = -N/p where N > 0."""
    rng, more = np.random.default_rng(1), 0
    for _ in range(60):
        A = rng.standard_normal((n, n))
        C, gap, law = A @ A.T + 0.02 * np.eye(n), rng.standard_normal(n), Unilateral(rng.uniform(0.5, 50.0))
        outcome, solves, after = solved(law, C, gap, limit=limit)
        shut = after.state != OPEN
        assert outcome == FOUND and np.all(after.normal >= 0) and np.all(after.gap[~shut] >= 0)
        assert np.all(after.normal[~shut] == 0) and np.allclose(gap + C @ after.normal, after.gap, atol=1e-10)
        assert np.allclose(after.gap[shut], -after.normal[shut] / law.stiffness, rtol=1e-14)
        more += solves > limit
    assert more > 15 or limit == 6
    assert n > 2 or limit == 1 or more == 0


CYCLES = [
    ([[14.0, -14.0, 13.0], [-14.0, 17.0, -12.0], [13.0, -12.0, 13.0]], [-4.0, 5.0, -2.0]),
    ([[12.0, -10.0, -8.0], [-10.0, 13.0, 13.0], [-8.0, 13.0, 14.0]], [-5.0, 4.0, 1.0]),
]


@pytest.mark.parametrize(("C", "w"), CYCLES)
def test_contacts_that_cycle_when_set_at_once_are_set_one_at_a_time(C, w):
    outcome, solves, after = solved(Unilateral(20.0), C, w)
    assert outcome == FOUND and solves > 6 and solved(Unilateral(20.0), C, w, limit=40)[1] > 40  # for ever
    assert np.all(after.normal >= 0) and np.all(after.gap >= -after.normal / 20.0 * (1 + 1e-14))
    assert np.array(w) + np.array(C) @ after.normal == pytest.approx(after.gap, rel=1e-12)


def three():
    """Return a law, three contacts that were pressed, and the flexibility of a step."""
    pressed = np.full(3, 1e5)
    nothing = np.zeros(3)
    before = Contacts(np.full(3, STICK), -pressed / 1e9, nothing, pressed, nothing, nothing, nothing)
    return Unilateral(1e9, 4e8, friction=0.5), before, 1e-9 * (np.eye(6) + 0.1)


def test_contacts_stick_slip_and_open_at_once():
    law, before, C = three()
    gap = np.array([-1e-4, -2e-4, 5e-4])
    for slide, cohesion, states in ((1e-3, 0.0, [SLIP, SLIP, OPEN]), (-1e-3, 0.0, [-SLIP, -SLIP, OPEN]),
                                    (1e-3, 1e6, [STICK, STICK, OPEN])):  # fmt: skip
        outcome, _, after = solved(replace(law, cohesion=cohesion), C, gap, [slide] * 3, before)
        assert outcome == FOUND and after.state.tolist() == states
        limit = 0.5 * after.normal + cohesion
        assert np.all(np.abs(after.shear) <= limit * (after.state != OPEN) * (1 + 1e-12))
        assert np.all(after.slipped * slide >= 0)


def test_one_by_one_finds_what_all_at_once_finds():
    law, before, C = three()
    gap, slide = np.array([-1e-4, -2e-4, 5e-4]), [1e-3] * 3
    whole = solved(law, C, gap, slide, before)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kernel, "TRIED", 1)
        singly = solved(law, C, gap, slide, before, limit=1)
    assert singly[0] == FOUND and singly[1] > 1
    assert singly[2].normal == pytest.approx(whole[2].normal, rel=1e-12)


def never_agrees(law, shear_law, state, *given):
    return STICK if state == OPEN else OPEN


def test_what_does_not_end_has_no_state_or_several(monkeypatch):
    law, before, C = three()
    problem = law, C, [-1e-4, -2e-4, 5e-4], [1e-3] * 3, before
    monkeypatch.setattr(kernel, "agreed_state", never_agrees)
    assert solved(*problem, limit=2)[:2] == (NONE, 2 + 4**3)
    calls = []

    def agrees_later(law, shear_law, state, *given):
        calls.append(1)
        return state if len(calls) > 20 else never_agrees(law, shear_law, state)

    monkeypatch.setattr(kernel, "agreed_state", agrees_later)
    assert solved(*problem, limit=2)[0] == SEVERAL
    monkeypatch.setattr(kernel, "TRIED", 1)  # of many contacts not all states are tried: they come back
    monkeypatch.setattr(kernel, "agreed_state", never_agrees)
    assert solved(*problem, limit=2)[0] == NONE


@pytest.mark.parametrize("p_s", [1e-3, 1.0, 1e9])
def test_two_contacts_in_mean_and_difference_are_those_in_their_own_slides(p_s):
    rng = np.random.default_rng(4)
    for _ in range(20):
        A = rng.standard_normal((4, 4))
        C, paired, own = A @ A.T + 0.1 * np.eye(4), np.zeros((4, 4)), np.zeros((4, 4))
        kernel.change_slides(C, kernel.TO_PAIR, paired)
        kernel.change_slides(paired, kernel.TO_OWN, own)
        assert np.allclose(own, C, rtol=1e-13, atol=1e-13)
        gap, slide = -1 - rng.random(2), rng.standard_normal(2)
        before = Contacts(np.full(2, STICK), -np.ones(2), *(np.zeros(2) for _ in range(5)))
        outcome, _, after = solved(Unilateral(1e3, p_s), C, gap, slide, before)
        if outcome == FOUND and np.all(after.state == STICK):
            w, s = np.split(np.concatenate([gap, slide]) + C @ [*after.normal, *after.shear], 2)
            size = 1e-11 * np.max(np.abs(C)) * np.max(after.normal)
            assert w == pytest.approx(-after.normal / 1e3, abs=size)
            assert s == pytest.approx(-after.shear / p_s, rel=1e-9, abs=size)
