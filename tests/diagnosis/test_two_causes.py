"""Two causes at once, and what a fit leaves open, among few candidates and over few steps."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.few_moves import AVERAGE, FEW, among

from validation.diagnosis import judgement, search
from validation.diagnosis.causes import band_interval
from validation.diagnosis.fits.fit import fit_one
from validation.diagnosis.fits.target import Target
from validation.diagnosis.judgement import _told_apart as told_apart
from validation.diagnosis.moves import Move
from validation.diagnosis.schemes import companion_split
from validation.diagnosis.search import Explanation, Verdict, simple, twofold, with_same_rows
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant

BLOCK = Rectangle(2.0, 2.0, 2700.0, 1e9, 0.0, False, 2e9, 2e9, 5e6)
OWN = Variant(0.5, 1.0, 1.0)
STEPS = np.full(30, 2e-3)


@pytest.fixture(autouse=True)
def few_moves(monkeypatch):
    among(monkeypatch, FEW)


def target_of(theirs, columns=2, block=BLOCK, steps=STEPS):
    run = histories(block, [theirs], steps)
    both = np.array([run.displacement[:, 0], run.pressure[:, 0]])
    return Target(block, steps, np.arange(len(steps)), both[:columns])


def told(theirs, columns=2, scene=OWN):
    target = target_of(theirs, columns)
    one = simple(target, scene)
    two = one if one.explains else twofold(target, scene, one)
    return target, one, two


@pytest.mark.parametrize(
    ("theirs", "ids", "numbers"),
    [
        (
            {"viscous": 9.0, "structural": 3e-4},
            ("viscous-damping", "stiffness-damping"),
            {"viscous": 9.0, "structural": 3e-4},
        ),
        (
            {"gg": 0.96, "weight": 1.0, "softness": 0.03, "point": 1.0},
            ("gg", "springs-factor", "own-weight", "geometry-updated"),
            {"gg": 0.96, "weight": 1.0, "softness": 0.03},
        ),
    ],
)
def test_two_causes_are_found_where_one_explains_nothing(theirs, ids, numbers, monkeypatch):
    among(monkeypatch, [move for move in FEW if move.id in (*ids, *search.SURROUNDINGS, "gg")])
    _, one, two = told(replace(OWN, **theirs))
    assert not one.explains and one.single[0].fit.misfit <= one.single[-1].fit.misfit
    assert two.explained and {*two.best.ids} == {*ids}
    found = two.best.fit
    assert {name: getattr(found.variant, name) for name in numbers} == pytest.approx(numbers, rel=1e-4)
    assert found.misfit < 1e-7 and two.left < 1e-5


def test_two_factors_of_a_product_stand_for_two_others(monkeypatch):
    """Block and springs 1.2 times as stiff: the rows of a block of 1 / 1.2 of the mass under as much of the load."""
    young = Move("young-factor", {}, ("young",), (1.3,))
    load = Move("load-factor", {}, ("load",), (0.8,))
    monkeypatch.setattr(search, "moves", lambda target, scene: [*FEW[2:5], young, load, *FEW[-2:]])
    target = target_of(replace(OWN, young=1.2, softness=-np.log(1.2)), 1)
    two = search.twofold(target, OWN, search.simple(target, OWN))  # not kept: rounding tells which pair is first
    ties = search.with_same_rows(target, OWN, two)
    pairs = {frozenset(each.ids): each.fit.variant for each in (ties.best, *ties.alike)}
    assert not ties.explained and len(pairs) == 2
    stiffer = pairs[frozenset(["young-factor", "springs-factor"])]
    lighter = pairs[frozenset(["density-factor", "load-factor"])]
    assert (stiffer.young, np.exp(-stiffer.softness)) == pytest.approx((1.2, 1.2), rel=1e-4)
    assert (lighter.density, lighter.load) == pytest.approx((1 / 1.2, 1 / 1.2), rel=1e-4)
    both = two.best.moves
    several = [Explanation(some, two.best.fit) for some in (both[:1], both, (*both, FEW[2]))]
    monkeypatch.setattr(search, "relatives", lambda *given: several)
    assert [each.ids for each in search.with_same_rows(target, OWN, two).alike] == [each.ids for each in several[:2]]
    monkeypatch.undo()
    for explained in (True, False):
        alone = Verdict(two.scene_fit, Explanation((), two.scene_fit), explained)
        assert search.with_same_rows(target, OWN, alone).same_rows == ()


def test_a_density_and_a_modulus_stand_for_a_height(monkeypatch):
    young = Move("young-factor", {}, ("young",), (0.8,))
    tall = Move("height-factor", {}, ("tall",), (1.2,))
    monkeypatch.setattr(search, "moves", lambda *given: [FEW[3], young, tall])
    target, one, _ = told(replace(OWN, tall=1.25))
    named = with_same_rows(target, OWN, one)
    assert (named.explained, named.best.ids) == (True, ("height-factor",))
    (pair,) = (each.fit.variant for each in named.same_rows if {*each.ids} == {"density-factor", "young-factor"})
    assert (pair.density, pair.young) == pytest.approx((1.25, 0.8), rel=1e-4)


def test_two_variants_are_one_program_at_every_step():
    target = target_of(OWN)
    average = replace(OWN, start="consistent", **AVERAGE)
    one = replace(average, family="chung-hulbert", spectral=1.0)
    assert search.same_program(target, average, one)
    assert not search.same_program(target, average, replace(one, spectral=0.999))
    assert not search.same_program(target, average, replace(average, alpha=0.25 + 1e-6))


def test_what_the_rows_leave_open_of_a_scheme_is_told_by_its_usual_form():
    scheme = replace(OWN, family="composite", split=0.7, spectral=0.3, start="consistent")
    other = companion_split(scheme)
    usual, words = told_apart(target_of(scheme), scheme)
    assert usual.split == pytest.approx(min(0.7, other))
    assert "0.7" in words["split"] and f"{other:.4g}" in words["split"]
    opens = replace(scheme, opens=True)
    assert told_apart(target_of(opens), opens)[0].split == 0.7
    usual = replace(scheme, split=0.0)
    assert " or " not in told_apart(target_of(usual), usual)[1]["split"]
    dashpot = replace(OWN, contact="dashpot", dashpot=0.4, clipped=False, opens=True, **AVERAGE)
    pulling = target_of(dashpot, block=STIFF, steps=np.full(60, 2e-4))
    held = replace(dashpot, opens=False)
    assert told_apart(target_of(held), held)[0].clipped
    not_clipped, words = told_apart(pulling, dashpot)
    assert not not_clipped.clipped and words != told_apart(target_of(dashpot), dashpot)[1]
    gaps = replace(OWN, family="hht", spectral=0.2, contact="mean gap", opens=True)
    assert "form" in told_apart(target_of(gaps), gaps)[1]
    locked = replace(gaps, opens=False, contact="springs")
    assert "form" not in told_apart(target_of(gaps), locked)[1]
    assert told_apart(target_of(OWN), OWN) == (OWN, {})


READINGS = [  # errors corrected in each of two readings, whether it is explained, what is left; the one that is taken
    ((1, True, 0.1), (0, True, 0.2), 1),
    ((0, False, 0.2), (1, True, 0.01), 0),
    ((0, False, 0.5), (1, True, 0.01), 1),
    ((0, False, 0.5), (1, False, 0.4), 1),
]


def test_the_likeliest_reading_that_is_explained_is_taken(monkeypatch):
    for *readings, taken in READINGS:
        cases = []
        verdicts = []
        for number, (errors, explains, misfit) in enumerate(readings):
            reading = SimpleNamespace(corrected=errors * ("",))
            best = SimpleNamespace(fit=SimpleNamespace(misfit=misfit))
            cases.append(SimpleNamespace(reading=reading, target=number, scene_variant=OWN))
            verdicts.append(SimpleNamespace(same=False, explains=explains, best=best))
        for name in ("as_it_is", "simple"):
            monkeypatch.setattr(judgement, name, lambda number, scene, verdicts=verdicts: verdicts[number])
        assert judgement._best(cases) == (cases[taken], verdicts[taken])
        verdicts[1].same = True
        assert judgement._best(cases) == (cases[1], verdicts[1])


STIFF = replace(BLOCK, young=3e9, density=2900.0, normal=6e10, shear=6e10, pressure=6e6)


def test_a_limit_lies_between_two_that_happened():
    theirs = replace(OWN, opens=True, hold=3e-5)
    target = target_of(theirs, 1, STIFF, np.full(60, 2e-4))
    unit = STIFF.normal / STIFF.width
    low, high = band_interval(target, theirs, "opening-tension")
    assert low < theirs.hold * unit < high

    def misfit(limit):
        return fit_one(target, replace(theirs, hold=limit / unit)).misfit

    for end, outward in ((low, -1), (high, 1)):
        assert misfit(end * (1 - outward * 2e-3)) < 1e-9, "the same rows"
        assert misfit(end * (1 + outward * 2e-3)) > 1e-6, "others"
